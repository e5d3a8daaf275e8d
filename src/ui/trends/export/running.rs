//! Files of readings that are being written, each on a thread of its own.

use std::path::PathBuf;

use eframe::egui::{self, Align2, Ui};
use jiff::tz::TimeZone;

use super::history_of;
use crate::bench::{Action, Bench, RecordingId, Severity};
use crate::record::{ExportError, ExportJob, Format, Micros, Rows, SeriesId, Source};
use crate::ui::tables::grouped;
use crate::ui::{theme, widgets};

/// What goes into a file; the user is asked where.
pub struct Plan {
    /// The proposed file name, with its ending.
    pub name: String,
    /// `None` for the live history.
    pub recording: Option<RecordingId>,
    pub series: Vec<SeriesId>,
    /// Without an end where there is `None`.
    pub span: [Option<Micros>; 2],
    pub format: Format,
    pub rows: Rows,
    pub zone: TimeZone,
}

impl Plan {
    /// Begins to write `path`.
    ///
    /// # Errors
    /// Why it cannot, and what to do.
    pub fn start(self, path: PathBuf, bench: &Bench, ctx: &egui::Context) -> Result<Running, String> {
        let Self { recording, series, span: [from, to], format, rows, zone, .. } = self;
        let history = history_of(bench, recording)
            .ok_or_else(|| "The recording was closed – open it again and export again".to_owned())?;
        let source = Source::new(history, &series, from, to, bench.archive(recording));
        let waker = ctx.clone();
        let job = ExportJob::start(path.clone(), source, format, rows, zone, move || waker.request_repaint())
            .map_err(|error| format!("Nothing was written ({error}) – close other programs and try again"))?;
        Ok(Running { path, job })
    }
}

/// A file that is being written.
pub struct Running {
    path: PathBuf,
    job: ExportJob,
}

impl Running {
    /// Shows how far it is; false when it has ended. `place` counts the files that are written at a time.
    pub fn go_on(&mut self, ctx: &egui::Context, place: usize, actions: &mut Vec<Action>) -> bool {
        let path = self.path.display();
        let action = match self.job.outcome() {
            None => {
                self.show(ctx, place);
                return true;
            }
            Some(Ok(progress)) => {
                let rows = grouped(usize::try_from(progress.rows).unwrap_or(usize::MAX));
                let text = format!("{rows} row{} written to {path}", if progress.rows == 1 { "" } else { "s" });
                Action::TellOfFile(text, self.path.clone())
            }
            Some(Err(ExportError::Stopped)) => {
                Action::Notify(Severity::Warning, format!("Stopped: {path} was not written"))
            }
            Some(Err(error)) => {
                let text = format!("{path} was not written ({error}) – choose another place and export again");
                Action::Notify(Severity::Error, text)
            }
        };
        actions.push(action);
        false
    }

    fn show(&self, ctx: &egui::Context, place: usize) {
        let above = (place as f32 + 1.0) * theme::EXPORT_ROW;
        let area = egui::Area::new(egui::Id::unique(("exporting", place)))
            .anchor(Align2::RIGHT_BOTTOM, [-theme::GAP, -theme::STATUS_HEIGHT - theme::GAP - above])
            .order(egui::Order::Foreground);
        area.show(ctx, |ui| egui::Frame::popup(ui.style()).show(ui, |ui| self.tell(ui)));
    }

    fn tell(&self, ui: &mut Ui) {
        let progress = self.job.progress();
        ui.horizontal(|ui| {
            let name = self.path.file_name().unwrap_or(self.path.as_os_str()).to_string_lossy();
            ui.label(format!("Exporting {name}"));
            widgets::progress(ui, progress.part, "Exporting");
            if ui.button("Cancel").clicked() {
                self.job.cancel();
            }
        });
    }
}
