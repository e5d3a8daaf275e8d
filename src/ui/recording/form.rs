//! Recording settings: where recordings go, and what is kept for how long.

use std::path::{Path, PathBuf};

use eframe::egui::{self, Button, DragValue, Role, TextEdit, Ui, WidgetInfo};

use crate::ui::dialogs::Dialogs;
use crate::ui::settings::{LEAST_FILE_MEGABYTES, MOST_MEGABYTES, Settings};
use crate::ui::{modal, theme, widgets};

/// Offered when "all" is taken back.
const DEFAULT_DAYS: u32 = 365;
const MOST_DAYS: u32 = 36_500;

/// The choices while they are being made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Form {
    record: bool,
    folder: String,
    file_megabytes: u32,
    /// 0 keeps all, as in the settings.
    total_megabytes: u32,
    days: u32,
}

/// What became of the form.
pub enum Answer {
    /// It is still open.
    None,
    Save,
    Cancel,
}

impl Form {
    pub fn of(settings: &Settings) -> Self {
        Self {
            record: settings.record,
            folder: settings.recording_folder.clone(),
            file_megabytes: settings.recording_file_megabytes,
            total_megabytes: settings.recording_total_megabytes,
            days: settings.recording_days,
        }
    }

    pub fn put_into(self, settings: &mut Settings) {
        let Self { record, folder, file_megabytes, total_megabytes, days } = self;
        settings.record = record;
        settings.recording_folder = folder.trim().to_owned();
        settings.recording_file_megabytes = file_megabytes;
        settings.recording_total_megabytes = total_megabytes;
        settings.recording_days = days;
    }

    pub fn show(&mut self, ctx: &egui::Context, home: Option<&Path>, dialogs: &mut Dialogs) -> Answer {
        if let Some(folder) = dialogs.take_folder() {
            self.folder = folder.display().to_string();
        }
        let mut answer = Answer::None;
        let modal = modal::show(ctx, "recording settings", theme::QUESTION_WIDTH, |ui| {
            ui.heading("Recording settings");
            ui.add_space(theme::GAP);
            ui.checkbox(&mut self.record, "Record by itself when the first module is polled")
                .on_hover_text("Otherwise a recording begins only when it is started in the status bar");
            ui.add_space(theme::GAP);
            self.folder(ui, home, dialogs);
            ui.add_space(theme::GAP);
            self.sizes(ui);
            ui.add_space(theme::GAP);
            for line in self.in_words() {
                widgets::quiet(ui, &line);
            }
            ui.add_space(theme::GAP);
            ui.horizontal(|ui| {
                let obstacle = self.obstacle();
                let save = ui.add_enabled(obstacle.is_none(), Button::new("Save"));
                if save.on_disabled_hover_text(obstacle.unwrap_or_default()).clicked() {
                    answer = Answer::Save;
                }
                if ui.button("Cancel").clicked() {
                    answer = Answer::Cancel;
                }
            });
        });
        if matches!(answer, Answer::None) && modal.should_close() { Answer::Cancel } else { answer }
    }

    fn folder(&mut self, ui: &mut Ui, home: Option<&Path>, dialogs: &mut Dialogs) {
        ui.label("Folder");
        ui.horizontal(|ui| {
            let browse = !dialogs.only_field;
            let room = if browse { theme::BUTTON_WIDTH + theme::GAP } else { 0.0 };
            let hint = home.map_or_else(|| "/data/recordings".to_owned(), |home| home.display().to_string());
            let field = TextEdit::singleline(&mut self.folder).hint_text(hint);
            let field = ui.add(field.desired_width(ui.available_width() - room - theme::FIELD_MARGIN));
            widgets::name_field(&field, "Folder", &self.folder);
            field.on_hover_text("Where the files of recordings are written, as a whole path");
            let browse_button = |ui: &mut Ui| ui.button("Browse…").on_hover_text("Choose the folder in a dialog");
            if browse && browse_button(ui).clicked() {
                let named = self.folder.trim();
                let start = if named.is_empty() { home.map(Path::to_owned) } else { Some(PathBuf::from(named)) };
                dialogs.ask_for_folder(ui.ctx(), start);
            }
        });
        let left_empty = if home.is_some() { "Empty: the program's own folder, as shown." } else { "" };
        widgets::quiet_small(ui, left_empty);
    }

    fn sizes(&mut self, ui: &mut Ui) {
        egui::Grid::new("keeping").num_columns(2).show(ui, |ui| {
            ui.label("Begin a new file after");
            let range = LEAST_FILE_MEGABYTES..=MOST_MEGABYTES;
            number(ui, &mut self.file_megabytes, range, " MB", "Megabytes of a file");
            ui.end_row();
            let default = self.file_megabytes.saturating_mul(10).min(MOST_MEGABYTES);
            limit(ui, "Keep at most", &mut self.total_megabytes, default, |ui, value| {
                number(ui, value, self.file_megabytes..=MOST_MEGABYTES, " MB", "Megabytes of all files");
            });
            ui.end_row();
            limit(ui, "Keep each file for", &mut self.days, DEFAULT_DAYS, |ui, value| {
                number(ui, value, 1..=MOST_DAYS, " days", "Days");
            });
            ui.end_row();
        });
    }

    /// What happens to which file, and when.
    fn in_words(&self) -> Vec<String> {
        let mut lines = Vec::new();
        match (self.total_megabytes, self.days) {
            (0, 0) => lines.push("No recording is ever removed; the disk may fill up.".to_owned()),
            (0, days) => lines.push(format!("Recordings older than {days} days are removed.")),
            (total, 0) => {
                lines.push(format!("When all recordings take more than {total} MB, the oldest files are removed."));
            }
            (total, days) => lines.push(format!(
                "Recordings older than {days} days are removed, and the oldest files when all take more than {total} MB."
            )),
        }
        lines.push(
            "The file that is being written is never removed. A recording under way goes on in a new file.".into(),
        );
        lines
    }

    fn obstacle(&self) -> Option<String> {
        let named = self.folder.trim();
        let relative = !named.is_empty() && !Path::new(named).is_absolute();
        relative.then(|| format!("{named} does not say where it begins – write the folder's whole path"))
    }
}

/// A number that can be left away, which is 0.
fn limit(ui: &mut Ui, text: &str, value: &mut u32, default: u32, field: impl FnOnce(&mut Ui, &mut u32)) {
    let mut is_limited = *value > 0;
    if ui.checkbox(&mut is_limited, text).changed() {
        *value = if is_limited { default } else { 0 };
    }
    if is_limited { field(ui, value) } else { drop(widgets::quiet(ui, "no limit")) }
}

fn number(ui: &mut Ui, value: &mut u32, range: std::ops::RangeInclusive<u32>, unit: &str, name: &str) {
    *value = (*value).clamp(*range.start(), *range.end());
    let response = ui.add(DragValue::new(value).range(range).suffix(unit));
    response.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, name));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_chosen_comes_into_the_settings_as_it_was_shown() {
        let settings = Settings::default();
        let mut unchanged = settings.clone();
        Form::of(&settings).put_into(&mut unchanged);
        assert_eq!(unchanged, settings);
        let form = Form { record: false, folder: " /data ".into(), file_megabytes: 20, total_megabytes: 0, days: 7 };
        assert!(form.in_words()[0].contains("older than 7 days"));
        assert_eq!(form.obstacle(), None);
        let mut changed = settings;
        form.put_into(&mut changed);
        assert_eq!((changed.recording_folder.as_str(), changed.recording_days), ("/data", 7));
    }

    #[test]
    fn a_folder_without_its_beginning_is_not_taken() {
        let form = Form { folder: "here".to_owned(), ..Form::of(&Settings::default()) };
        assert!(form.obstacle().is_some_and(|text| text.contains("whole path")));
    }
}
