//! Where the program keeps its files.

use std::path::PathBuf;

/// Overrides the configuration folder; for tests and portable use.
pub const OVERRIDE: &str = "DCON_BENCH_CONFIG";

/// The user's configuration folder, whether it exists or not.
pub fn config() -> Option<PathBuf> {
    match std::env::var_os(OVERRIDE) {
        Some(folder) => Some(PathBuf::from(folder)),
        None => directories::ProjectDirs::from("", "", "dcon-bench").map(|dirs| dirs.config_dir().to_path_buf()),
    }
}

/// Where the user's own module definitions are looked for.
pub fn definitions() -> Option<PathBuf> {
    config().map(|folder| folder.join("modules"))
}
