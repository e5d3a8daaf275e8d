//! Saves a text as a file: with the system's dialog, on a thread of its own that writes the file too, or in a field for
//! the path where the system has none.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::time::{Duration, Instant};

use eframe::egui::{self, Id, Key, Modal, TextEdit};

use super::{theme, widgets};
use crate::bench::{Action, Severity};

/// A dialog that is closed sooner was never shown: the system has none.
const SOONEST_ANSWER: Duration = Duration::from_millis(700);

#[derive(Default)]
pub struct SaveDialog {
    /// The thread at work, and since when.
    pending: Option<(Receiver<Answer>, Instant)>,
    request: Option<Request>,
    /// The path in the field that stands in for the system's dialog.
    path: Option<String>,
}

#[derive(Debug, Clone)]
struct Request {
    title: String,
    file_name: String,
    /// Without a dot.
    extension: String,
    contents: Arc<str>,
}

enum Answer {
    /// Closed without a choice.
    NoPath,
    Written(PathBuf, io::Result<()>),
}

impl SaveDialog {
    /// Asks where to save `contents` and writes them; what became of it is told as a notice. Nothing while another
    /// question is open.
    pub fn ask(&mut self, ctx: &egui::Context, title: &str, file_name: String, extension: &str, contents: String) {
        if self.request.is_some() {
            return;
        }
        let request =
            Request { title: title.to_owned(), file_name, extension: extension.to_owned(), contents: contents.into() };
        self.request = Some(request.clone());
        self.start(ctx, move || {
            let dialog = rfd::FileDialog::new()
                .set_title(&request.title)
                .set_file_name(&request.file_name)
                .add_filter(request.extension.to_uppercase(), &[&request.extension]);
            match dialog.save_file() {
                // The dialog has asked before it gave the name of a file that exists.
                Some(path) => Answer::Written(path.clone(), std::fs::write(&path, request.contents.as_bytes())),
                None => Answer::NoPath,
            }
        });
    }

    /// Disks can be slow and dialogs wait for people: neither holds up the window.
    fn start(&mut self, ctx: &egui::Context, work: impl FnOnce() -> Answer + Send + 'static) {
        let (answer, pending): (SyncSender<Answer>, _) = sync_channel(1);
        let ctx = ctx.clone();
        let run = move || {
            // Nobody waits any more if the window was closed meanwhile.
            let _ = answer.send(work());
            ctx.request_repaint();
        };
        match std::thread::Builder::new().name("save dialog".to_owned()).spawn(run) {
            Ok(_) => self.pending = Some((pending, Instant::now())),
            Err(error) => {
                log::warn!("the file dialog cannot be opened: {error}");
                self.offer_field();
            }
        }
    }

    fn offer_field(&mut self) {
        self.path = self.request.as_ref().map(|request| request.file_name.clone());
    }

    pub fn show(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        self.take_answer(actions);
        let (Some(mut path), Some(request)) = (self.path.take(), self.request.clone()) else { return };
        match path_field(ctx, &request, &mut path) {
            Choice::Open => self.path = Some(path),
            Choice::Cancel => self.request = None,
            Choice::Save => self.start(ctx, move || {
                let path = PathBuf::from(path.trim());
                let result = write_new(&path, &request.contents);
                Answer::Written(std::path::absolute(&path).unwrap_or(path), result)
            }),
        }
    }

    fn take_answer(&mut self, actions: &mut Vec<Action>) {
        let Some((pending, since)) = &self.pending else { return };
        match pending.try_recv() {
            Err(TryRecvError::Empty) => return,
            Ok(Answer::Written(path, result)) => {
                actions.push(outcome(&path, &result));
                self.request = None;
            }
            Ok(Answer::NoPath) if since.elapsed() > SOONEST_ANSWER => self.request = None,
            Ok(Answer::NoPath) => self.offer_field(),
            Err(TryRecvError::Disconnected) => {
                let text = "The file dialog ended – write the path instead".to_owned();
                actions.push(Action::Notify(Severity::Warning, text));
                self.offer_field();
            }
        }
        self.pending = None;
    }
}

fn outcome(path: &Path, result: &io::Result<()>) -> Action {
    let path = path.display();
    match result {
        Ok(()) => Action::Notify(Severity::Info, format!("Saved as {path}")),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
            Action::Notify(Severity::Error, format!("{path} was not saved: it exists already – use another name"))
        }
        Err(error) => {
            Action::Notify(Severity::Error, format!("{path} was not saved ({error}) – save it in another folder"))
        }
    }
}

/// A path that was written by hand must not overwrite anything, as nobody has asked.
fn write_new(path: &Path, contents: &str) -> io::Result<()> {
    std::fs::File::create_new(path)?.write_all(contents.as_bytes())
}

enum Choice {
    Open,
    Save,
    Cancel,
}

fn path_field(ctx: &egui::Context, request: &Request, path: &mut String) -> Choice {
    let mut choice = Choice::Open;
    let modal = Modal::new(Id::unique("save path")).show(ctx, |ui| {
        ui.set_width(theme::PATH_WIDTH);
        ui.heading(&request.title);
        widgets::quiet(ui, "This system has no file dialog. Write the path of the new file:");
        let field = ui.add(TextEdit::singleline(path).desired_width(f32::INFINITY));
        widgets::name_field(&field, "Path", path);
        field.request_focus();
        ui.add_space(theme::UNIT);
        ui.horizontal(|ui| {
            let named = !path.trim().is_empty();
            let enter = ui.input(|input| input.key_pressed(Key::Enter));
            if ui.add_enabled(named, egui::Button::new("Save")).clicked() || (enter && named) {
                choice = Choice::Save;
            }
            if ui.button("Cancel").clicked() {
                choice = Choice::Cancel;
            }
        });
    });
    match choice {
        Choice::Open if modal.should_close() => Choice::Cancel,
        choice => choice,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::accesskit::Role;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    /// A dialog on a system that has none.
    fn field(path: &Path) -> SaveDialog {
        let request = Request {
            title: "Save as HTML".to_owned(),
            file_name: path.display().to_string(),
            extension: "html".to_owned(),
            contents: "a page".into(),
        };
        let mut dialog = SaveDialog { request: Some(request), ..SaveDialog::default() };
        dialog.offer_field();
        dialog
    }

    fn save(path: &Path) -> (Severity, String) {
        let state = (field(path), Vec::new());
        let mut window = Harness::new_ui_state(
            |ui, (dialog, actions): &mut (SaveDialog, Vec<Action>)| dialog.show(ui.ctx(), actions),
            state,
        );
        window.step();
        window.get_by_role_and_label(Role::Button, "Save").click();
        let start = Instant::now();
        while window.state().1.is_empty() {
            assert!(start.elapsed() < Duration::from_secs(20), "nothing was told");
            window.step();
        }
        assert!(window.query_by_role_and_label(Role::Button, "Save").is_none());
        match window.state_mut().1.remove(0) {
            Action::Notify(severity, text) => (severity, text),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_path_in_the_field_is_written_and_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.html");
        assert_eq!(save(&path), (Severity::Info, format!("Saved as {}", path.display())));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "a page");
    }

    #[test]
    fn a_file_that_exists_is_kept_and_a_folder_that_does_not_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.html");
        std::fs::write(&path, "older").unwrap();
        let (severity, text) = save(&path);
        assert!(severity == Severity::Error && text.contains("exists already"), "{text}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "older");
        let (severity, text) = save(&folder.path().join("none").join("a.html"));
        assert!(severity == Severity::Error && text.contains("was not saved ("), "{text}");
    }
}
