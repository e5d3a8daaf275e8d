//! Which recordings there are in the folder: looked up on a thread of its own, because folders may be far away.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, sync_channel};

use eframe::egui;

use super::ENDING;
use crate::folders::{self, Found};

/// Recordings that are listed.
const MOST: usize = 20;

#[derive(Default)]
pub struct Recent {
    files: Option<Vec<Found>>,
    pending: Option<Receiver<Vec<Found>>>,
}

impl Recent {
    /// Looks anew; what was found before stays until then.
    pub fn look(&mut self, ctx: &egui::Context, folder: Option<PathBuf>) {
        let Some(folder) = folder else { return self.files = None };
        let (tell, pending) = sync_channel(1);
        let ctx = ctx.clone();
        let look = move || {
            // Nobody waits any more if the window was closed meanwhile.
            let _ = tell.send(folders::newest(&folder, ENDING, MOST));
            ctx.request_repaint();
        };
        match std::thread::Builder::new().name("recordings".to_owned()).spawn(look) {
            Ok(_) => self.pending = Some(pending),
            Err(error) => log::warn!("recordings cannot be listed: {error}"),
        }
    }

    pub fn take_in(&mut self) {
        if let Some(files) = self.pending.as_ref().and_then(|pending| pending.try_recv().ok()) {
            self.files = Some(files);
            self.pending = None;
        }
    }

    /// The newest first; `None` until they are known.
    pub fn files(&self) -> Option<&[Found]> {
        self.files.as_deref()
    }
}
