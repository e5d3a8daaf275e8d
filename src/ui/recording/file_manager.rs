//! Shows folders in the system's file manager.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use eframe::egui;

/// What could not be shown and was not told yet; more is told by the log only.
const WAITING: usize = 4;

pub struct FileManager {
    /// The system's is not opened.
    pub only_tells: bool,
    tell: SyncSender<String>,
    problems: Receiver<String>,
}

impl Default for FileManager {
    fn default() -> Self {
        let (tell, problems) = sync_channel(WAITING);
        Self { only_tells: false, tell, problems }
    }
}

impl FileManager {
    /// Shows `path`, or the folder that holds it if it is a file.
    pub fn show(&self, ctx: &egui::Context, path: PathBuf) {
        if self.only_tells {
            return say(&self.tell, format!("The folder is {}", folder_of(&path).display()));
        }
        let (tell, ctx) = (self.tell.clone(), ctx.clone());
        let open = move || {
            if let Err(reason) = open(&folder_of(&path)) {
                say(&tell, reason);
                ctx.request_repaint();
            }
        };
        if let Err(error) = std::thread::Builder::new().name("file manager".to_owned()).spawn(open) {
            say(&self.tell, format!("The folder was not opened ({error}) – close other programs and try again"));
        }
    }

    /// Why a folder was not shown; each is told once.
    pub fn problem(&self) -> Option<String> {
        self.problems.try_recv().ok()
    }
}

fn say(tell: &SyncSender<String>, text: String) {
    if let Err(error) = tell.try_send(text) {
        log::warn!("{error}");
    }
}

fn folder_of(path: &Path) -> PathBuf {
    let folder = if path.is_dir() { None } else { path.parent().filter(|folder| folder.is_dir()) };
    folder.unwrap_or(path).to_owned()
}

/// Blocks as long as the file manager says nothing.
fn open(folder: &Path) -> Result<(), String> {
    let place = folder.display();
    if !folder.is_dir() {
        return Err(format!("There is no folder {place} yet – it is made when a recording begins"));
    }
    let program = match () {
        () if cfg!(windows) => "explorer",
        () if cfg!(target_os = "macos") => "open",
        () => "xdg-open",
    };
    let mut command = Command::new(program);
    command.arg(folder).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    match command.status() {
        // Explorer ends with 1 although it has opened the folder.
        Ok(status) if status.success() || cfg!(windows) => Ok(()),
        Ok(status) => Err(format!("{program} did not open {place} ({status}) – open it by hand")),
        Err(error) => Err(format!("{program} cannot be started ({error}) – open {place} by hand")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_file_the_folder_that_holds_it_is_shown() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("readings.csv");
        std::fs::write(&file, "").unwrap();
        assert_eq!(folder_of(&file), folder.path());
        assert_eq!(folder_of(folder.path()), folder.path());
        let nowhere = folder.path().join("no").join("such");
        assert!(open(&folder_of(&nowhere)).unwrap_err().contains("There is no folder"));
    }
}
