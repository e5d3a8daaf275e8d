//! Readings taken away: which, of what time and how, and the files that are being written.

mod choice;
mod form;
mod running;

use eframe::egui;

use super::Source;
use crate::bench::{Bench, RecordingId};
use crate::record::{History, SeriesId};
use crate::ui::app::Pass;
use crate::ui::dialogs::Dialogs;
use crate::ui::settings::Settings;
use form::Form;
pub use running::{Plan, Running};

/// What the plots show when readings are to be exported.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InPlots {
    pub series: Vec<SeriesId>,
    /// The span in view, in seconds since 1970 UTC.
    pub view: Option<[f64; 2]>,
    /// The times of both cursors, in any order.
    pub cursors: Option<[f64; 2]>,
}

/// Readings to be taken away; the user is asked which and how.
pub struct Wanted {
    /// `None` for the live history.
    recording: Option<RecordingId>,
    /// What the file is called first.
    name: String,
    plots: InPlots,
}

/// Opens the dialog that asks which readings go into which file.
pub fn ask(source: &Source<'_>, plots: InPlots, pass: &mut Pass<'_>) {
    *pass.export = Some(Wanted { recording: source.recording, name: source.name.clone(), plots });
}

/// The dialog, while it is open.
#[derive(Default)]
pub struct ExportForm {
    form: Option<Form>,
}

impl ExportForm {
    pub fn open(&mut self, wanted: Wanted, settings: &Settings) {
        self.form = Some(Form::new(wanted, settings.utc));
    }

    pub fn show(&mut self, ctx: &egui::Context, bench: &Bench, dialogs: &mut Dialogs) {
        let Some(mut form) = self.form.take() else { return };
        // A recording that was closed meanwhile has nothing to give.
        let Some(history) = history_of(bench, form.recording()) else { return };
        match form.show(ctx, history, bench.now()) {
            form::Answer::None => self.form = Some(form),
            form::Answer::Cancel => {}
            form::Answer::Save(plan) => dialogs.ask_to_export(ctx, plan),
        }
    }
}

/// The live history, or that of an opened recording.
fn history_of(bench: &Bench, recording: Option<RecordingId>) -> Option<&History> {
    match recording {
        None => Some(bench.history()),
        Some(id) => bench.opened_recording(id)?.history(),
    }
}
