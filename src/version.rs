//! Which program this is, and which state of it.

pub const NAME: &str = env!("CARGO_PKG_NAME");
/// Such as `0.1.0`.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// The short hash of the commit that it was built from; `None` if it was built from an archive without history.
pub const COMMIT: Option<&str> = option_env!("DCON_BENCH_COMMIT");

/// Such as `0.1.0 (64d6be7f02)`.
pub fn with_commit() -> String {
    COMMIT.map_or_else(|| VERSION.to_owned(), |commit| format!("{VERSION} ({commit})"))
}

/// Such as `dcon-bench 0.1.0 (64d6be7f02)`.
pub fn named() -> String {
    format!("{NAME} {}", with_commit())
}
