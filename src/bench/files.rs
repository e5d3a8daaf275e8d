//! Files that a person hands over: what each is, by its name, and what becomes of it.

use std::path::{Path, PathBuf};

use super::{Action, Bench, Severity};
use crate::bus::BusCommand;
use crate::module::{Catalogue, add_file};

/// What a file is, as far as its name tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A module definition.
    Definition,
    Recording,
    /// Frames of a line, which the window does not show.
    Capture,
    Unknown,
}

impl FileKind {
    pub fn of(path: &Path) -> Self {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "toml" => Self::Definition,
            "sqlite" | "sqlite3" | "db" => Self::Recording,
            "pcapng" | "pcap" => Self::Capture,
            _ => Self::Unknown,
        }
    }

    /// What becomes of a file of this kind, as a person is told before it is handed over.
    pub fn becomes(self) -> &'static str {
        match self {
            Self::Definition => "is checked and added to the module definitions",
            Self::Recording => "is opened as a recording",
            Self::Capture => "is a capture, which the window does not show",
            Self::Unknown => "cannot be opened here",
        }
    }
}

/// The file's name without its folder.
pub fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// What a file handed over is to do, or why it does nothing.
pub fn opening(path: PathBuf) -> Action {
    let name = name_of(&path);
    match FileKind::of(&path) {
        FileKind::Definition => Action::AddDefinition(path),
        FileKind::Recording => Action::OpenRecording(path),
        FileKind::Capture => {
            let text =
                format!("{name} is a capture – read it with \"dcon-bench replay {name}\", or open it in Wireshark");
            Action::Notify(Severity::Warning, text)
        }
        FileKind::Unknown => {
            let text = format!(
                "{name} was not opened: it is neither a module definition (.toml) nor a recording (.sqlite) – choose \
                 such a file"
            );
            Action::Notify(Severity::Error, text)
        }
    }
}

impl Bench {
    /// Keeps definitions that are added in `folder`, and not in the user's own; for tests.
    pub fn with_definitions_in(mut self, folder: PathBuf) -> Self {
        self.definitions = Some(folder);
        self
    }

    /// The file is checked before it is copied. It counts at once: modules that were not known, and those whose definition
    /// it replaces, are asked again what they are.
    pub(super) fn add_definition(&mut self, path: &Path) {
        let Some(folder) = self.definitions.clone() else {
            let text = "The definition was not added: there is no folder for settings – name one in DCON_BENCH_CONFIG";
            return self.notify(Severity::Error, text.to_owned());
        };
        match add_file(&folder, path) {
            Ok(id) => self.take_definition(&folder, &id),
            Err(error) => self.notify(Severity::Error, format!("The definition was not added – {error}")),
        }
    }

    fn take_definition(&mut self, folder: &Path, id: &str) {
        let (catalogue, _) = Catalogue::with_folder(folder);
        let label = catalogue.get(id).map_or_else(|| id.to_owned(), |definition| definition.label.clone());
        self.catalogue = catalogue.into();
        self.send(BusCommand::Know(self.catalogue.clone()));
        let is_meant = |model: &str| model == id || model == "unknown";
        let asked: Vec<_> = self
            .modules
            .iter()
            .filter(|module| is_meant(module.identified.model()))
            .map(|module| module.target)
            .collect();
        let again = match asked.len() {
            0 => "modules of this model are known from now on".to_owned(),
            1 => "1 module of the list is asked again what it is".to_owned(),
            many => format!("{many} modules of the list are asked again what they are"),
        };
        self.notify(Severity::Info, format!("The definition of {label} was added – {again}"));
        if self.line.is_open() {
            asked.into_iter().for_each(|target| self.look_for(target));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_known_by_its_ending_and_an_unknown_one_is_refused_with_a_reason() {
        let kinds = ["a.TOML", "b.sqlite", "c.pcapng", "d.txt", "e"].map(|name| FileKind::of(Path::new(name)));
        use FileKind::{Capture, Definition, Recording, Unknown};
        assert_eq!(kinds, [Definition, Recording, Capture, Unknown, Unknown]);
        let Action::Notify(Severity::Error, text) = opening("/tmp/letter.txt".into()) else { panic!() };
        assert!(text.starts_with("letter.txt was not opened: it is neither"), "{text}");
        let Action::Notify(Severity::Warning, text) = opening("/tmp/hall.pcapng".into()) else { panic!() };
        assert!(text.contains("dcon-bench replay hall.pcapng"), "{text}");
    }
}
