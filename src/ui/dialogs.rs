//! Asks for a file: with the system's dialog, on a thread of its own, or in a field where the system has none.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::time::{Duration, Instant};

use eframe::egui::{self, TextEdit};

use super::recording;
use super::saving::{SaveAs, Saving};
use super::trends::export;
use super::{modal, theme, widgets};
use crate::bench::{Action, Bench, Severity};

/// A dialog that is closed sooner was never shown: the system has none.
const SOONEST_ANSWER: Duration = Duration::from_millis(700);

/// What a file is asked for.
enum Purpose {
    AddDefinition,
    Save(SaveAs),
    Export(export::Plan),
    /// A recording to look at; the dialog begins in this folder.
    OpenRecording(Option<PathBuf>),
    /// Where recordings go.
    RecordingFolder(Option<PathBuf>),
}

impl Purpose {
    fn title(&self) -> &str {
        match self {
            Self::AddDefinition => "Add definition file",
            Self::Save(save) => &save.title,
            Self::Export(_) => "Export readings",
            Self::OpenRecording(_) => "Open a recording",
            Self::RecordingFolder(_) => "Folder for recordings",
        }
    }

    /// The system's dialog; blocks until it is answered.
    fn question(&self) -> impl FnOnce() -> Option<PathBuf> + Send + 'static {
        let dialog = rfd::FileDialog::new().set_title(self.title());
        let at = |folder: &Option<PathBuf>| match folder.as_ref().filter(|folder| folder.is_dir()) {
            Some(folder) => dialog.clone().set_directory(folder),
            None => dialog.clone(),
        };
        let dialog = match self {
            Self::AddDefinition => dialog.add_filter("Module definitions", &["toml"]),
            Self::Save(SaveAs { name, .. }) | Self::Export(export::Plan { name, .. }) => dialog.set_file_name(name),
            Self::OpenRecording(folder) => at(folder).add_filter("Recordings", &[recording::ENDING]),
            Self::RecordingFolder(folder) => at(folder),
        };
        let (is_new, is_folder) = (self.is_new_file(), matches!(self, Self::RecordingFolder(_)));
        move || match (is_new, is_folder) {
            (true, _) => dialog.save_file(),
            (_, true) => dialog.pick_folder(),
            _ => dialog.pick_file(),
        }
    }

    fn is_new_file(&self) -> bool {
        matches!(self, Self::Save(_) | Self::Export(_))
    }

    /// What stands in the field at first.
    fn proposal(&self) -> String {
        match self {
            Self::AddDefinition => String::new(),
            Self::Save(SaveAs { name, .. }) | Self::Export(export::Plan { name, .. }) => {
                std::env::current_dir().unwrap_or_default().join(name).display().to_string()
            }
            Self::OpenRecording(folder) | Self::RecordingFolder(folder) => {
                folder.as_ref().map_or_else(String::new, |folder| folder.join("").display().to_string())
            }
        }
    }
}

#[derive(Default)]
pub struct Dialogs {
    /// The system's dialog, and since when it is open.
    pending: Option<(Purpose, Receiver<Option<PathBuf>>, Instant)>,
    /// The field that stands in for it.
    field: Option<(Purpose, String)>,
    saving: Vec<Saving>,
    exports: Vec<export::Running>,
    /// The folder that was chosen for recordings.
    folder: Option<PathBuf>,
    /// The system is not asked.
    pub only_field: bool,
}

impl Dialogs {
    /// Opens the system's dialog; the action follows when a file was chosen.
    pub fn ask_for_definition(&mut self, ctx: &egui::Context) {
        self.ask(ctx, Purpose::AddDefinition);
    }

    /// Opens the system's dialog; the file is written when a place was chosen, and a notice tells of it.
    pub fn ask_to_save(&mut self, ctx: &egui::Context, save: SaveAs) {
        self.ask(ctx, Purpose::Save(save));
    }

    /// Opens the system's dialog; readings are exported when a place was chosen, and a notice tells of it.
    pub fn ask_to_export(&mut self, ctx: &egui::Context, plan: export::Plan) {
        self.ask(ctx, Purpose::Export(plan));
    }

    /// Opens the system's dialog in `folder`; the recording is opened when one was chosen.
    pub fn ask_for_recording(&mut self, ctx: &egui::Context, folder: Option<PathBuf>) {
        self.ask(ctx, Purpose::OpenRecording(folder));
    }

    /// Opens the system's dialog in `folder`; [`Self::take_folder`] gives what was chosen.
    pub fn ask_for_folder(&mut self, ctx: &egui::Context, folder: Option<PathBuf>) {
        self.ask(ctx, Purpose::RecordingFolder(folder));
    }

    /// The folder that was chosen, once.
    pub fn take_folder(&mut self) -> Option<PathBuf> {
        self.folder.take()
    }

    fn ask(&mut self, ctx: &egui::Context, purpose: Purpose) {
        if self.pending.is_some() || self.field.is_some() {
            return;
        }
        ctx.request_repaint();
        if self.only_field {
            return self.ask_in_field(purpose);
        }
        let (answer, pending) = sync_channel(1);
        let (ctx, question) = (ctx.clone(), purpose.question());
        let ask = move || {
            // Nobody waits any more if the window was closed meanwhile.
            let _ = answer.send(question());
            ctx.request_repaint();
        };
        match std::thread::Builder::new().name("file dialog".to_owned()).spawn(ask) {
            Ok(_) => self.pending = Some((purpose, pending, Instant::now())),
            Err(error) => {
                log::warn!("the file dialog cannot be opened: {error}");
                self.ask_in_field(purpose);
            }
        }
    }

    fn ask_in_field(&mut self, purpose: Purpose) {
        let path = purpose.proposal();
        self.field = Some((purpose, path));
    }

    /// Takes in answers, goes on with files that are written, and shows the field.
    pub fn show(&mut self, ctx: &egui::Context, bench: &Bench, actions: &mut Vec<Action>) {
        self.take_answer(ctx, bench, actions);
        if let Some((purpose, mut path)) = self.field.take() {
            match path_field(ctx, &purpose, &mut path) {
                Answer::None => self.field = Some((purpose, path)),
                Answer::Path(path) => self.carry_out(ctx, bench, purpose, path, actions),
                Answer::Nothing => {}
            }
        }
        self.saving.retain_mut(|saving| {
            let has_more = saving.go_on(ctx, bench, actions);
            let is_stopped = has_more && saving.show(ctx);
            if is_stopped {
                actions.push(Action::Notify(Severity::Warning, saving.stopped()));
            }
            has_more && !is_stopped
        });
        let mut place = 0;
        self.exports.retain_mut(|export| {
            let goes_on = export.go_on(ctx, place, actions);
            place += usize::from(goes_on);
            goes_on
        });
    }

    fn take_answer(&mut self, ctx: &egui::Context, bench: &Bench, actions: &mut Vec<Action>) {
        let Some((purpose, pending, since)) = self.pending.take() else { return };
        match pending.try_recv() {
            Err(TryRecvError::Empty) => self.pending = Some((purpose, pending, since)),
            Ok(Some(path)) => self.carry_out(ctx, bench, purpose, path, actions),
            Ok(None) if since.elapsed() > SOONEST_ANSWER => {}
            Ok(None) => self.ask_in_field(purpose),
            Err(TryRecvError::Disconnected) => {
                actions.push(Action::Notify(
                    Severity::Warning,
                    "The file dialog ended – write the path instead".to_owned(),
                ));
                self.ask_in_field(purpose);
            }
        }
    }

    fn carry_out(
        &mut self,
        ctx: &egui::Context,
        bench: &Bench,
        purpose: Purpose,
        path: PathBuf,
        actions: &mut Vec<Action>,
    ) {
        match purpose {
            Purpose::OpenRecording(_) => actions.push(Action::OpenRecording(path)),
            Purpose::RecordingFolder(_) => self.folder = Some(path),
            Purpose::Export(plan) => match plan.start(path, bench, ctx) {
                Ok(export) => self.exports.push(export),
                Err(text) => actions.push(Action::Notify(Severity::Error, text)),
            },
            Purpose::AddDefinition => actions.push(Action::AddDefinition(path)),
            Purpose::Save(save) => match Saving::start(path, save.contents, ctx) {
                Ok(saving) => {
                    self.saving.push(saving);
                    ctx.request_repaint();
                }
                Err(error) => {
                    let text = format!("Nothing was written ({error}) – close other programs and try again");
                    actions.push(Action::Notify(Severity::Error, text));
                }
            },
        }
    }
}

/// What became of the field.
enum Answer {
    /// It is still open.
    None,
    Path(PathBuf),
    Nothing,
}

/// Asks for a path.
fn path_field(ctx: &egui::Context, purpose: &Purpose, path: &mut String) -> Answer {
    let (explanation, hint, does) = match purpose {
        Purpose::AddDefinition => ("Write the path of a *.toml file:", "/home/me/my-module.toml", "Add"),
        Purpose::Save(_) | Purpose::Export(_) => ("Write the path of the new file:", "/home/me/file.csv", "Save"),
        Purpose::OpenRecording(_) => ("Write the path of a recording:", "/home/me/recording.sqlite", "Open"),
        Purpose::RecordingFolder(_) => ("Write the path of a folder:", "/home/me/recordings", "Choose"),
    };
    let mut answer = Answer::None;
    let modal = modal::show(ctx, "path", theme::PATH_WIDTH, |ui| {
        ui.heading(purpose.title());
        widgets::quiet(ui, &format!("This system has no file dialog. {explanation}"));
        let field = ui.add(TextEdit::singleline(path).desired_width(f32::INFINITY).hint_text(hint));
        widgets::name_field(&field, "Path", path);
        let field = field.on_hover_text("The whole path, from the root on; Enter takes it");
        if ui.memory(|memory| memory.focused().is_none()) {
            field.request_focus();
        }
        let chosen = Path::new(path.trim());
        let replaces = purpose.is_new_file() && chosen.exists();
        widgets::quiet_small(ui, if replaces { "There is such a file already; it will be replaced." } else { "" });
        ui.horizontal(|ui| {
            let enter = ui.input(|input| input.key_pressed(egui::Key::Enter));
            let is_named = !path.trim().is_empty();
            let button = ui.add_enabled(is_named, egui::Button::new(if replaces { "Replace" } else { does }));
            if button.clicked() || (enter && is_named) {
                answer = Answer::Path(chosen.to_path_buf());
            }
            if ui.button("Cancel").clicked() {
                answer = Answer::Nothing;
            }
        });
    });
    if matches!(answer, Answer::None) && modal.should_close() { Answer::Nothing } else { answer }
}
