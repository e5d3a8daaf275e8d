//! What a click on the recording offers. All of it has its room from the beginning, so that no entry moves when there is more
//! to say.

use eframe::egui::{RichText, ScrollArea, Sense, Ui, UiBuilder, vec2};

use super::{Wish, status};
use crate::bench::Action;
use crate::ui::app::Pass;
use crate::ui::{theme, widgets, words};

pub fn show(ui: &mut Ui, pass: &mut Pass<'_>) {
    ui.set_width(theme::RECORDING_MENU);
    ui.label(RichText::new("Recording").heading());
    in_room(ui, "facts", theme::RECORDING_FACTS, |ui| {
        status::facts(pass.bench).iter().for_each(|line| drop(widgets::quiet(ui, line)));
    });
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
    widgets::section(ui, "Newest recordings");
    // A low window has room for fewer.
    let above = ui.min_rect().height();
    let left = ui.ctx().content_rect().height() - above - theme::STATUS_HEIGHT - theme::GAP_SECTION;
    let height = left.clamp(theme::RECENT_LEAST, theme::RECENT_HEIGHT);
    in_room(ui, "newest", height, |ui| {
        if let Some(words) = pass.recordings.recent.in_words() {
            widgets::quiet(ui, words);
        }
        for file in pass.recordings.recent.files() {
            let means = format!("{}, {}", words::minute(file.changed, pass.settings.utc), words::size(file.bytes));
            let entry = widgets::menu_entry(ui, true, &super::file_name(&file.path), &means);
            if entry.on_hover_text(file.path.display().to_string()).clicked() {
                pass.actions.push(Action::OpenRecording(file.path.clone()));
                ui.close();
            }
        }
    });
}

/// A room of this height, whatever is in it; what is more is scrolled.
fn in_room(ui: &mut Ui, name: &str, height: f32, contents: impl FnOnce(&mut Ui)) {
    let (room, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let mut ui = ui.new_child(UiBuilder::new().max_rect(room).id_salt(name));
    ScrollArea::vertical().auto_shrink(false).show(&mut ui, contents);
}
