//! Which program this is, and which state of it.

pub const NAME: &str = env!("CARGO_PKG_NAME");
/// Version and commit, such as `0.1.0 (64d6be7f02)`; the version alone if it was built from an archive without history.
pub const WITH_COMMIT: &str = env!("DCON_BENCH_VERSION");

/// Such as `dcon-bench 0.1.0 (64d6be7f02)`.
pub fn named() -> String {
    format!("{NAME} {WITH_COMMIT}")
}
