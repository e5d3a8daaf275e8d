//! Files that the user asks for: contents are made step by step between the pictures of the window, and written on a
//! thread of their own.

use std::io;
use std::path::PathBuf;

use eframe::egui::{self, Align2, Ui};

use super::{theme, widgets};
use crate::bench::{Action, Bench, Severity};
use crate::record::FileWriter;

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
    /// Made, and not taken by the writer yet.
    ready: Option<Step>,
    /// The last part was handed over.
    complete: bool,
    writer: FileWriter,
}

impl Saving {
    /// # Errors
    /// If no thread can be started.
    pub fn start(path: PathBuf, contents: Box<dyn Contents>, ctx: &egui::Context) -> io::Result<Self> {
        let waker = ctx.clone();
        let writer = FileWriter::start(path.clone(), move || waker.request_repaint())?;
        Ok(Self { path, contents, ready: None, complete: false, writer })
    }

    /// Goes on a little; false when it has ended.
    pub fn go_on(&mut self, ctx: &egui::Context, bench: &Bench, actions: &mut Vec<Action>) -> bool {
        match self.writer.outcome() {
            Some(Ok(())) => {
                let text = format!("{} written to {}", self.contents.what(), self.path.display());
                actions.push(Action::TellOfFile(text, self.path.clone()));
                return false;
            }
            Some(Err(error)) => return self.failed(&error, actions),
            None => {}
        }
        if let Err(error) = self.hand_over(bench) {
            return self.failed(&error, actions);
        }
        if !self.complete {
            ctx.request_repaint();
        }
        true
    }

    fn hand_over(&mut self, bench: &Bench) -> io::Result<()> {
        if self.complete {
            return Ok(());
        }
        let Step { bytes, is_last } = match self.ready.take() {
            Some(step) => step,
            None => self.contents.step(bench)?,
        };
        match self.writer.put(bytes) {
            Some(bytes) => self.ready = Some(Step { bytes, is_last }),
            None if is_last && self.writer.end() => self.complete = true,
            None if is_last => self.ready = Some(Step { bytes: Vec::new(), is_last }),
            None => {}
        }
        Ok(())
    }

    fn failed(&self, error: &io::Error, actions: &mut Vec<Action>) -> bool {
        let path = self.path.display();
        let text = format!("{path} was not written ({error}) – choose another place and export again");
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
            ui.button("Stop").on_hover_text("The file is not written").clicked()
        })
        .inner
    }

    /// What the user is told who stopped it.
    pub fn stopped(&self) -> String {
        format!("Stopped after {}: {} was not written", self.contents.what(), self.path.display())
    }
}
