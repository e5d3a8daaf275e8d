//! Files that a person hands over: what each is, by its name, and what becomes of it.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::{Action, Bench, Severity};
use crate::bus::BusCommand;
use crate::module::{Addition, Catalogue, Standing};
use crate::record::write_whole;

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

    /// The definition that the file at `path` would replace, if there is one and it is another.
    pub fn replaced_by(&self, path: &Path) -> Option<Addition> {
        let addition = Addition::judge(self.definitions.as_deref()?, path).ok()?;
        (addition.standing == Standing::Other).then_some(addition)
    }

    /// The file is judged before it is copied. It counts at once: modules that were not known, and those whose definition
    /// it replaces, are asked again what they are.
    pub(super) fn add_definition(&mut self, path: &Path, replace: bool) {
        let Some(folder) = self.definitions.clone() else {
            let text = "The definition was not added: there is no folder for settings – name one in DCON_BENCH_CONFIG";
            return self.notify(Severity::Error, text.to_owned());
        };
        match keep(&folder, path, replace) {
            Ok(id) => self.take_definitions(&folder, &id),
            Err(reason) => self.notify(Severity::Error, format!("The definition was not added – {reason}")),
        }
    }

    /// Knows what `folder` holds from now on, of which `id` is new.
    fn take_definitions(&mut self, folder: &Path, id: &str) {
        let (catalogue, faulty) = Catalogue::with_folder(folder);
        let label = catalogue.get(id).map_or_else(|| id.to_owned(), |definition| definition.label.clone());
        self.catalogue = catalogue.into();
        self.send(BusCommand::Know(self.catalogue.clone()));
        self.tell_faulty(&faulty);
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

/// Writes a good definition into `folder`, over another one of its model only if it may `replace` that. Returns the id.
fn keep(folder: &Path, path: &Path, replace: bool) -> Result<String, String> {
    let Addition { id, text, place, standing } = Addition::judge(folder, path).map_err(|error| error.to_string())?;
    let written = match standing {
        Standing::Same => Ok(()),
        Standing::Other if !replace => {
            let place = place.display();
            return Err(format!("{place} defines {id} in another way – add this file alone to replace that one"));
        }
        Standing::Other | Standing::Nothing => {
            fs::create_dir_all(folder).and_then(|()| write_whole(&place, |mut file| file.write_all(text.as_bytes())))
        }
    };
    written.map(|()| id).map_err(|error| format!("{} cannot be written: {error}", place.display()))
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
