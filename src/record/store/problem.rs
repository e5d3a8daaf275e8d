//! What can happen to a recording, and what to do.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use rusqlite::ErrorCode;

/// Why a recording cannot be written or read, and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StoreError {
    #[error("{path} does not exist – check its name")]
    NotThere { path: PathBuf },
    #[error("The folder of {path} does not exist – create it or choose another one")]
    NoFolder { path: PathBuf },
    #[error("{path} is not a recording of this program and was not changed – choose another file")]
    NotARecording { path: PathBuf },
    #[error("{path} was written by a later version of this program – use that version or a later one")]
    Later { path: PathBuf },
    #[error("{path} is being recorded by another copy of this program – end that recording or choose another file")]
    InUse { path: PathBuf },
    #[error("Another program holds {path} – close that program")]
    Busy { path: PathBuf },
    #[error("The disk of {path} is full – make room there or choose another folder")]
    Full { path: PathBuf },
    #[error("{path} cannot be written, because it or its folder is read-only – choose another folder or allow writing")]
    ReadOnly { path: PathBuf },
    #[error("{path} cannot be read, because that is not allowed – allow reading or use another account")]
    NotAllowed { path: PathBuf },
    #[error(
        "{path} was removed or replaced while it was in use – what was in it is gone, open it again for what is new"
    )]
    Removed { path: PathBuf },
    #[error("{path} is damaged ({reason}) – record into another file and read this one from a copy")]
    Damaged { path: PathBuf, reason: String },
    #[error(
        "The clock is earlier than the last sample in {path}, where nothing can be put before it – set the clock or \
         record into another file"
    )]
    Earlier { path: PathBuf },
    #[error("{count} samples and events were not written: {reason}")]
    Unwritten { count: u64, reason: String },
    #[error("{path}: {reason} – check the disk and try again")]
    Other { path: PathBuf, reason: String },
}

impl StoreError {
    pub(super) fn damaged(path: &Path, reason: impl ToString) -> Self {
        Self::Damaged { path: path.to_owned(), reason: reason.to_string() }
    }

    /// What the system says about a file that is to be written.
    pub(super) fn writing(path: &Path, error: &io::Error) -> Self {
        let path = path.to_owned();
        match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => Self::NoFolder { path },
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => Self::ReadOnly { path },
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Self::Full { path },
            _ => Self::Other { path, reason: error.to_string() },
        }
    }

    /// What the system says about a file that is to be read.
    pub(super) fn reading(path: &Path, error: &io::Error) -> Self {
        let path = path.to_owned();
        match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => Self::NotThere { path },
            ErrorKind::PermissionDenied => Self::NotAllowed { path },
            _ => Self::Other { path, reason: error.to_string() },
        }
    }

    /// What SQLite says about a file.
    pub(super) fn sqlite(path: &Path, error: &rusqlite::Error) -> Self {
        let reason = error.to_string();
        let at = path.to_owned();
        match error.sqlite_error_code() {
            Some(ErrorCode::DiskFull) => Self::Full { path: at },
            Some(ErrorCode::ReadOnly) => Self::ReadOnly { path: at },
            Some(ErrorCode::PermissionDenied) => Self::NotAllowed { path: at },
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => Self::Busy { path: at },
            Some(ErrorCode::NotADatabase) => Self::NotARecording { path: at },
            Some(ErrorCode::DatabaseCorrupt | ErrorCode::ConstraintViolation | ErrorCode::Unknown) => {
                Self::Damaged { path: at, reason }
            }
            None => Self::Damaged { path: at, reason },
            Some(_) => Self::Other { path: at, reason },
        }
    }
}
