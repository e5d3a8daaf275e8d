//! What a click on the recording offers.

use eframe::egui::{RichText, ScrollArea, Ui};

use super::{Wish, status};
use crate::bench::Action;
use crate::ui::app::Pass;
use crate::ui::{theme, widgets, words};

pub fn show(ui: &mut Ui, pass: &mut Pass<'_>) {
    ui.set_width(theme::RECORDING_MENU);
    ui.label(RichText::new("Recording").heading());
    for line in status::facts(pass.bench) {
        widgets::quiet(ui, &line);
    }
    ui.add_space(theme::UNIT);
    ui.spacing_mut().item_spacing.y = 0.0;
    start_or_stop(ui, pass);
    if let Some(folder) = pass.recordings.folder(pass.settings) {
        let place = folder.display().to_string();
        entry(ui, pass, true, "Open folder", &place, Wish::ShowFolder(folder));
    }
    entry(ui, pass, true, "Open a recording…", "Plots and events of an earlier time", Wish::Open);
    entry(ui, pass, true, "Recording settings…", "The folder, and what is kept for how long", Wish::Settings);
    newest(ui, pass);
}

fn start_or_stop(ui: &mut Ui, pass: &mut Pass<'_>) {
    if pass.bench.recording().is_some() {
        let means = "Writes what waits and closes the file; readings stay in memory";
        return entry(ui, pass, true, "Stop recording", means, Wish::Stop);
    }
    let obstacle = pass.recordings.obstacle(pass.settings);
    let means = obstacle.as_deref().unwrap_or("A new file, with everything that is measured from now on");
    entry(ui, pass, obstacle.is_none(), "Start recording", means, Wish::Start);
}

fn entry(ui: &mut Ui, pass: &mut Pass<'_>, enabled: bool, title: &str, means: &str, wish: Wish) {
    let response = widgets::menu_entry(ui, enabled, title, means);
    if response.on_hover_text(means).clicked() {
        pass.recordings.ask(wish);
        ui.close();
    }
}

/// The files of the folder, the newest first; a click opens one.
fn newest(ui: &mut Ui, pass: &mut Pass<'_>) {
    pass.recordings.recent.take_in();
    let Some(files) = pass.recordings.recent.files() else { return };
    widgets::section(ui, "Newest recordings");
    if files.is_empty() {
        widgets::quiet(ui, "None yet: the first begins with the first module that is polled.");
    }
    ScrollArea::vertical().max_height(theme::RECENT_HEIGHT).show(ui, |ui| {
        for file in files {
            let means = format!("{}, {}", words::minute(file.changed, pass.settings.utc), words::size(file.bytes));
            if widgets::menu_entry(ui, true, &super::file_name(&file.path), &means).clicked() {
                pass.actions.push(Action::OpenRecording(file.path.clone()));
                ui.close();
            }
        }
    });
}
