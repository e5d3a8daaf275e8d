//! Files that the user asks for: contents are made step by step between the pictures of the window, and written on a
//! thread of their own.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};

use eframe::egui::{self, Align2, Ui};

use super::{theme, widgets};
use crate::bench::{Action, Bench, Severity};

/// Steps that may wait for the disk.
const WAITING: usize = 4;

/// What the user wants to save; the dialog asks where.
pub struct SaveAs {
    /// What the dialog says, such as "Export traffic".
    pub title: String,
    /// The proposed file name, with its ending.
    pub name: String,
    pub contents: Box<dyn Contents>,
}

/// What a file is made of.
pub trait Contents {
    /// Makes the next part.
    ///
    /// # Errors
    /// What the format's writer says.
    fn step(&mut self, bench: &Bench) -> io::Result<Step>;

    /// How much of it is made, from 0 to 1.
    fn part(&self) -> f32;

    /// What was made so far, such as "12 345 frames".
    fn what(&self) -> String;
}

/// One part of a file.
pub struct Step {
    pub bytes: Vec<u8>,
    pub is_last: bool,
}

/// A text that is there as a whole.
pub struct WholeText {
    /// Such as "The summary".
    pub what: String,
    pub text: String,
}

impl Contents for WholeText {
    fn step(&mut self, _bench: &Bench) -> io::Result<Step> {
        Ok(Step { bytes: std::mem::take(&mut self.text).into_bytes(), is_last: true })
    }

    fn part(&self) -> f32 {
        1.0
    }

    fn what(&self) -> String {
        self.what.clone()
    }
}

/// A file that is being written.
pub struct Saving {
    path: PathBuf,
    contents: Box<dyn Contents>,
    /// Made, and not taken by the thread yet.
    ready: Option<Step>,
    /// Until the last part is handed over.
    parts: Option<SyncSender<Vec<u8>>>,
    outcome: Receiver<io::Result<()>>,
}

impl Saving {
    /// # Errors
    /// If no thread can be started.
    pub fn start(path: PathBuf, contents: Box<dyn Contents>, ctx: &egui::Context) -> io::Result<Self> {
        let (parts, incoming) = sync_channel::<Vec<u8>>(WAITING);
        let (tell, outcome) = sync_channel(1);
        let (to, ctx) = (path.clone(), ctx.clone());
        let write = move || {
            // Nobody waits any more if the window was closed meanwhile.
            let _ = tell.send(write_all(&to, &incoming));
            ctx.request_repaint();
        };
        std::thread::Builder::new().name("export".to_owned()).spawn(write)?;
        Ok(Self { path, contents, ready: None, parts: Some(parts), outcome })
    }

    /// Goes on a little; false when it has ended.
    pub fn go_on(&mut self, ctx: &egui::Context, bench: &Bench, actions: &mut Vec<Action>) -> bool {
        match self.outcome.try_recv() {
            Ok(Ok(())) => {
                let text = format!("{} written to {}", self.contents.what(), self.path.display());
                actions.push(Action::Notify(Severity::Info, text));
                return false;
            }
            Ok(Err(error)) => return self.failed(&error, actions),
            Err(TryRecvError::Disconnected) => return self.failed(&io::Error::other("the writing ended"), actions),
            Err(TryRecvError::Empty) => {}
        }
        if let Err(error) = self.hand_over(bench) {
            return self.failed(&error, actions);
        }
        if self.parts.is_some() {
            ctx.request_repaint();
        }
        true
    }

    fn hand_over(&mut self, bench: &Bench) -> io::Result<()> {
        let Some(parts) = &self.parts else { return Ok(()) };
        let Step { bytes, is_last } = match self.ready.take() {
            Some(step) => step,
            None => self.contents.step(bench)?,
        };
        match parts.try_send(bytes) {
            Ok(()) if is_last => self.parts = None,
            Ok(()) => {}
            Err(TrySendError::Full(bytes)) => self.ready = Some(Step { bytes, is_last }),
            // The thread says why it has ended.
            Err(TrySendError::Disconnected(_)) => self.parts = None,
        }
        Ok(())
    }

    fn failed(&self, error: &io::Error, actions: &mut Vec<Action>) -> bool {
        let path = self.path.display();
        let text = format!("{path} was not written whole ({error}) – choose another place and export again");
        actions.push(Action::Notify(Severity::Error, text));
        false
    }

    /// What is written, and how far it is; true if the user has had enough of it.
    pub fn show(&self, ctx: &egui::Context) -> bool {
        let area = egui::Area::new(egui::Id::unique("saving"))
            .anchor(Align2::RIGHT_BOTTOM, [-theme::GAP, -theme::STATUS_HEIGHT - theme::GAP])
            .order(egui::Order::Foreground);
        area.show(ctx, |ui| egui::Frame::popup(ui.style()).show(ui, |ui| self.tell(ui)).inner).inner
    }

    fn tell(&self, ui: &mut Ui) -> bool {
        ui.horizontal(|ui| {
            let name = self.path.file_name().unwrap_or(self.path.as_os_str()).to_string_lossy();
            ui.label(format!("Writing {name}"));
            widgets::progress(ui, self.contents.part(), "Writing");
            ui.button("Stop").clicked()
        })
        .inner
    }

    /// What the user is told who stopped it.
    pub fn stopped(&self) -> String {
        format!("Stopped after {}: {} is not whole", self.contents.what(), self.path.display())
    }
}

fn write_all(path: &Path, parts: &Receiver<Vec<u8>>) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    while let Ok(part) = parts.recv() {
        file.write_all(&part)?;
    }
    file.flush()
}
