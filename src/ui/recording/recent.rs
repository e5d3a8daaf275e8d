//! Which recordings there are in the folder: looked up on a thread of its own, because folders may be far away.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

use eframe::egui;

use super::ENDING;
use crate::folders::{self, Found};

/// Recordings that are listed.
const MOST: usize = 20;

/// What is known of the recordings in the folder.
#[derive(Default)]
pub enum Recent {
    #[default]
    NoFolder,
    Looking(Receiver<Vec<Found>>),
    /// The newest first.
    Known(Vec<Found>),
    /// The system starts no thread that could look.
    Unknown,
}

impl Recent {
    /// Looks anew. What was found before is given up, as the files that are found now stand at other places.
    pub fn look(&mut self, ctx: &egui::Context, folder: Option<PathBuf>) {
        let Some(folder) = folder else { return *self = Self::NoFolder };
        let (tell, pending) = sync_channel(1);
        let ctx = ctx.clone();
        let look = move || {
            // Nobody waits any more if the window was closed meanwhile.
            let _ = tell.send(folders::newest(&folder, ENDING, MOST));
            ctx.request_repaint();
        };
        *self = match std::thread::Builder::new().name("recordings".to_owned()).spawn(look) {
            Ok(_) => Self::Looking(pending),
            Err(error) => {
                log::warn!("recordings cannot be listed: {error}");
                Self::Unknown
            }
        };
    }

    pub fn take_in(&mut self) {
        let Self::Looking(pending) = self else { return };
        match pending.try_recv() {
            Ok(files) => *self = Self::Known(files),
            Err(TryRecvError::Disconnected) => *self = Self::Unknown,
            Err(TryRecvError::Empty) => {}
        }
    }

    /// What is said where no file is listed.
    pub fn in_words(&self) -> Option<&'static str> {
        match self {
            Self::NoFolder => Some("There is no folder for them: name one in the recording settings."),
            Self::Looking(_) => Some("Looking into the folder…"),
            Self::Known(files) if files.is_empty() => {
                Some("None yet: the first begins with the first module that is polled.")
            }
            Self::Known(_) => None,
            Self::Unknown => Some("They cannot be listed at present – open the folder instead."),
        }
    }

    pub fn files(&self) -> &[Found] {
        if let Self::Known(files) = self { files } else { &[] }
    }
}
