//! Recording in the window: how it fares, starting and stopping, its settings, and recordings that are opened again.

mod file_manager;
mod form;
mod popup;
mod recent;
mod status;

use std::path::{Path, PathBuf};

use eframe::egui::{self, Ui};

use super::app::Pass;
use super::dialogs::Dialogs;
use super::settings::Settings;
use crate::bench::{Action, Bench, Severity};
use crate::record::Destination;
use file_manager::FileManager;
use form::Form;
use recent::Recent;

/// How the names of recordings end.
pub const ENDING: &str = "sqlite";

/// What the user asks for; it is carried out when everything is drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Wish {
    Start,
    Stop,
    /// Choose a recording to look at.
    Open,
    /// Show a folder in the system's file manager; of a file, the one that holds it.
    ShowFolder(PathBuf),
    Settings,
}

/// What the window remembers of recording.
#[derive(Default)]
pub struct Recordings {
    /// Where recordings go unless the settings name another folder.
    home: Option<PathBuf>,
    /// Whether recording begins by itself, which tests do not want.
    by_itself: bool,
    /// It has begun or was left to the user, so that it does not begin by itself any more.
    decided: bool,
    wishes: Vec<Wish>,
    form: Option<Form>,
    recent: Recent,
    file_manager: FileManager,
}

impl Recordings {
    /// Begins by itself from now on, in `home` unless the settings name another folder.
    pub fn begin_by_itself(&mut self, home: Option<PathBuf>) {
        self.home = home;
        self.by_itself = true;
    }

    /// Tells paths instead of opening the system's file manager.
    pub fn without_file_manager(&mut self) {
        self.file_manager.only_tells = true;
    }

    pub fn ask(&mut self, wish: Wish) {
        self.wishes.push(wish);
    }

    /// Where recordings go.
    pub fn folder(&self, settings: &Settings) -> Option<PathBuf> {
        match settings.recording_folder.trim() {
            "" => self.home.clone(),
            named => Some(PathBuf::from(named)),
        }
    }

    /// Why no recording can be started, if so.
    pub fn obstacle(&self, settings: &Settings) -> Option<String> {
        let missing = self.folder(settings).is_none();
        missing.then(|| "There is no folder for recordings – name one in the recording settings".to_owned())
    }

    fn destination(&self, settings: &Settings) -> Option<Destination> {
        Some(Destination::Folder { folder: self.folder(settings)?, keeping: settings.keeping() })
    }

    /// What begins the recording when the first module is polled.
    pub fn begin(&mut self, bench: &Bench, settings: &Settings) -> Option<Action> {
        let is_due = self.by_itself && settings.record && !self.decided && bench.recording().is_none();
        if !is_due || bench.modules().iter().all(|module| module.interval.is_none()) {
            return None;
        }
        self.decided = true;
        self.destination(settings).map(Action::Record)
    }

    /// Shows the settings while they are open, and carries out what was asked for.
    pub fn show(
        &mut self,
        ctx: &egui::Context,
        bench: &Bench,
        settings: &mut Settings,
        dialogs: &mut Dialogs,
        actions: &mut Vec<Action>,
    ) {
        for wish in std::mem::take(&mut self.wishes) {
            self.carry_out(ctx, wish, settings, dialogs, actions);
        }
        if let Some(text) = self.file_manager.problem() {
            actions.push(Action::Notify(Severity::Warning, text));
        }
        self.show_form(ctx, bench, settings, dialogs, actions);
    }

    fn carry_out(
        &mut self,
        ctx: &egui::Context,
        wish: Wish,
        settings: &Settings,
        dialogs: &mut Dialogs,
        actions: &mut Vec<Action>,
    ) {
        match wish {
            Wish::Start => {
                self.decided = true;
                actions.extend(self.destination(settings).map(Action::Record));
            }
            Wish::Stop => {
                self.decided = true;
                actions.push(Action::StopRecording);
            }
            Wish::Open => dialogs.ask_for_recording(ctx, self.folder(settings)),
            Wish::ShowFolder(path) => self.file_manager.show(ctx, path),
            Wish::Settings => self.form = Some(Form::of(settings)),
        }
    }

    fn show_form(
        &mut self,
        ctx: &egui::Context,
        bench: &Bench,
        settings: &mut Settings,
        dialogs: &mut Dialogs,
        actions: &mut Vec<Action>,
    ) {
        let Some(mut form) = self.form.take() else { return };
        match form.show(ctx, self.home.as_deref(), dialogs) {
            form::Answer::None => self.form = Some(form),
            form::Answer::Cancel => {}
            form::Answer::Save => {
                let before = self.destination(settings);
                form.put_into(settings);
                let now = self.destination(settings);
                // A new file begins with the new choices.
                if bench.recording().is_some() && now != before {
                    actions.extend(now.map(Action::Record));
                }
            }
        }
    }
}

/// How the recording fares, in the status bar; a click shows what can be done.
pub fn section(ui: &mut Ui, pass: &mut Pass<'_>) {
    if !pass.recordings.by_itself && pass.bench.recording().is_none() {
        return;
    }
    let response = status::show(ui, pass.bench);
    if response.clicked() {
        let folder = pass.recordings.folder(pass.settings);
        pass.recordings.recent.look(ui.ctx(), folder);
    }
    egui::Popup::menu(&response)
        .align(egui::RectAlign::TOP_START)
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| popup::show(ui, pass));
}

/// The file's name without its folder.
fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
