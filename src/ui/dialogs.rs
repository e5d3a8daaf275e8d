//! Asks for a file: with the system's dialog, on a thread of its own, or in a field where the system has none.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::time::{Duration, Instant};

use eframe::egui::{self, Id, Modal, TextEdit};

use super::save_dialog::SaveDialog;
use super::{theme, widgets};
use crate::bench::{Action, Severity};

/// A dialog that is closed sooner was never shown: the system has none.
const SOONEST_ANSWER: Duration = Duration::from_millis(700);

#[derive(Default)]
pub struct Dialogs {
    /// The system's dialog, and since when it is open.
    pending: Option<(Receiver<Option<PathBuf>>, Instant)>,
    /// The field that stands in for it.
    path: Option<String>,
    pub save: SaveDialog,
}

impl Dialogs {
    /// Opens the system's dialog; the action follows when a file was chosen.
    pub fn ask_for_definition(&mut self, ctx: &egui::Context) {
        if self.pending.is_some() || self.path.is_some() {
            return;
        }
        let (answer, pending) = sync_channel(1);
        let ctx = ctx.clone();
        let ask = move || {
            let dialog =
                rfd::FileDialog::new().set_title("Add definition file").add_filter("Module definitions", &["toml"]);
            // Nobody waits any more if the window was closed meanwhile.
            let _ = answer.send(dialog.pick_file());
            ctx.request_repaint();
        };
        match std::thread::Builder::new().name("file dialog".to_owned()).spawn(ask) {
            Ok(_) => self.pending = Some((pending, Instant::now())),
            Err(error) => {
                log::warn!("the file dialog cannot be opened: {error}");
                self.path = Some(String::new());
            }
        }
    }

    pub fn show(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        self.take_answer(actions);
        self.save.show(ctx, actions);
        if let Some(mut path) = self.path.take() {
            self.path = path_field(ctx, &mut path, actions).then_some(path);
        }
    }

    fn take_answer(&mut self, actions: &mut Vec<Action>) {
        let Some((pending, since)) = &self.pending else { return };
        match pending.try_recv() {
            Err(TryRecvError::Empty) => return,
            Ok(Some(path)) => actions.push(Action::AddDefinition(path)),
            Ok(None) if since.elapsed() > SOONEST_ANSWER => {}
            Ok(None) => self.path = Some(String::new()),
            Err(TryRecvError::Disconnected) => {
                actions.push(Action::Notify(
                    Severity::Warning,
                    "The file dialog ended – write the path instead".to_owned(),
                ));
                self.path = Some(String::new());
            }
        }
        self.pending = None;
    }
}

/// Asks for a path; false when it is done with.
fn path_field(ctx: &egui::Context, path: &mut String, actions: &mut Vec<Action>) -> bool {
    let mut open = true;
    let modal = Modal::new(Id::unique("path")).show(ctx, |ui| {
        ui.set_width(theme::PATH_WIDTH);
        ui.heading("Add definition file");
        widgets::quiet(ui, "This system has no file dialog. Write the path of a *.toml file:");
        let field =
            ui.add(TextEdit::singleline(path).desired_width(f32::INFINITY).hint_text("/home/me/my-module.toml"));
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Path"));
        field.request_focus();
        ui.add_space(theme::UNIT);
        ui.horizontal(|ui| {
            let enter = ui.input(|input| input.key_pressed(egui::Key::Enter));
            let add = ui.add_enabled(!path.trim().is_empty(), egui::Button::new("Add"));
            if add.clicked() || (enter && !path.trim().is_empty()) {
                actions.push(Action::AddDefinition(PathBuf::from(path.trim())));
                open = false;
            }
            if ui.button("Cancel").clicked() {
                open = false;
            }
        });
    });
    open && !modal.should_close()
}
