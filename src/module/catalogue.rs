//! All module definitions: those built in, and the user's own files beside or instead of them.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use super::check::{self, Problem};
use super::definition::Definition;
use super::file::File;

/// The definitions that come with the program: file name and text.
const BUILT_IN: [(&str, &str); 4] = [
    ("pir-130.toml", include_str!("../../assets/modules/pir-130.toml")),
    ("pir-230.toml", include_str!("../../assets/modules/pir-230.toml")),
    ("pir-234.toml", include_str!("../../assets/modules/pir-234.toml")),
    ("dl-302.toml", include_str!("../../assets/modules/dl-302.toml")),
];

/// A definition file that was left out, or that does not do what it seems to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileError {
    pub file: String,
    /// 1-based; `None` if the file could not be read at all.
    pub line: Option<usize>,
    pub reason: String,
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}, line {line}: {}", self.file, self.reason),
            None => write!(f, "{}: {}", self.file, self.reason),
        }
    }
}

impl std::error::Error for FileError {}

/// The known models, by id.
#[derive(Debug, Clone, Default)]
pub struct Catalogue {
    definitions: BTreeMap<String, std::sync::Arc<Definition>>,
}

struct Source {
    name: String,
    text: String,
    file: File,
}

impl Catalogue {
    /// The built-in definitions alone.
    pub fn built_in() -> (Self, Vec<FileError>) {
        Self::from_texts(built_in_texts())
    }

    /// The built-in definitions, and the `*.toml` files of `folder`, which add to them or replace those of the same
    /// id. A faulty file is left out and reported; a folder that does not exist is empty.
    pub fn with_folder(folder: &Path) -> (Self, Vec<FileError>) {
        let mut texts = built_in_texts();
        let mut unreadable = Vec::new();
        for path in definition_files(folder) {
            let name = path.display().to_string();
            match std::fs::read_to_string(&path) {
                Ok(text) => texts.push((name, text)),
                Err(error) => {
                    unreadable.push(FileError { file: name, line: None, reason: left_out(&error.to_string()) })
                }
            }
        }
        let (catalogue, mut errors) = Self::from_texts(texts);
        errors.extend(unreadable);
        (catalogue, errors)
    }

    /// Definitions from pairs of file name and text; of the same id, the later good one counts.
    pub fn from_texts(texts: Vec<(String, String)>) -> (Self, Vec<FileError>) {
        let mut sources: Vec<Source> = Vec::new();
        let mut errors = Vec::new();
        for (name, text) in texts {
            match toml::from_str::<File>(&text) {
                Ok(file) => sources.push(Source { name, text, file }),
                Err(error) => errors.push(FileError {
                    line: error.span().map(|span| line_of(&text, span.start)),
                    reason: left_out(error.message()),
                    file: name,
                }),
            }
        }
        let mut catalogue = Self::default();
        for source in &sources {
            match resolve(source, &sources) {
                Ok(definition) => {
                    catalogue.definitions.insert(definition.id.clone(), definition.into());
                }
                Err(Problem { at, reason }) => {
                    let line = Some(line_of(&source.text, at));
                    errors.push(FileError { file: source.name.clone(), line, reason: left_out(&reason) });
                }
            }
        }
        errors.extend(catalogue.same_identity(&sources));
        (catalogue, errors)
    }

    /// Models that cannot be told apart by what they say of themselves; the first by id is taken.
    fn same_identity(&self, sources: &[Source]) -> Vec<FileError> {
        let all: Vec<_> = self.definitions.values().collect();
        let mut clashes = Vec::new();
        for (index, first) in all.iter().enumerate() {
            for second in all.iter().skip(index.saturating_add(1)) {
                let Some(source) = sources.iter().rev().find(|source| *source.file.id.get_ref() == second.id) else {
                    continue;
                };
                if first.identity.names_overlap(&second.identity) {
                    clashes.push(FileError {
                        file: source.name.clone(),
                        line: Some(line_of(&source.text, source.file.id.span().start)),
                        reason: format!("a module with this identity is taken for a {}: it says the same", first.id),
                    });
                }
            }
        }
        clashes
    }

    pub fn get(&self, id: &str) -> Option<std::sync::Arc<Definition>> {
        self.definitions.get(id).cloned()
    }

    pub fn iter(&self) -> impl Iterator<Item = &std::sync::Arc<Definition>> {
        self.definitions.values()
    }
}

/// The checked definition of `source`, completed by the one it is based on.
fn resolve(source: &Source, all: &[Source]) -> Result<Definition, Problem> {
    let Some(base_id) = &source.file.based_on else { return check::check(&source.file) };
    let wrong_base = |reason| Problem { at: source.file.id.span().start, reason };
    // A user's file may be based on the built-in file of its own id.
    let base = all.iter().find(|other| other.file.id.get_ref() == base_id && !std::ptr::eq(*other, source));
    let base = base.ok_or_else(|| wrong_base(format!("it is based on \"{base_id}\", which is not there")))?;
    if base.file.based_on.is_some() {
        return Err(wrong_base(format!("\"{base_id}\" is itself based on another definition")));
    }
    check::check(&base.file)
        .map_err(|problem| wrong_base(format!("it is based on \"{base_id}\", which is faulty: {}", problem.reason)))?;
    // What is wrong now lies in an entry of this file, or in how it fits the base.
    check::check(&check::complete(&source.file, &base.file)).map_err(|problem| {
        let at = check::entry(&source.file, &problem.reason).unwrap_or(source.file.id.span().start);
        Problem { at, ..problem }
    })
}

fn left_out(reason: &str) -> String {
    format!("{reason} – this definition is left out")
}

/// File name and text of each definition that comes with the program.
pub(super) fn built_in_texts() -> Vec<(String, String)> {
    BUILT_IN.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
}

/// The definition files of `folder` in the order in which they are read.
pub(super) fn definition_files(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<_> =
        entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    files
}

fn line_of(text: &str, at: usize) -> usize {
    text.bytes().take(at).filter(|byte| *byte == b'\n').count().saturating_add(1)
}

/// The definition in the file at `path`, which may be based on a built-in one and need not be in any folder.
pub fn load_file(path: &Path) -> Result<std::sync::Arc<Definition>, FileError> {
    let name = path.display().to_string();
    let unusable = |reason: String| FileError { file: name.clone(), line: None, reason };
    let text = std::fs::read_to_string(path).map_err(|error| unusable(error.to_string()))?;
    let mut sources: Vec<Source> = Vec::new();
    for (name, text) in built_in_texts().into_iter().chain([(name.clone(), text)]) {
        let file = toml::from_str::<File>(&text).map_err(|error| FileError {
            file: name.clone(),
            line: error.span().map(|span| line_of(&text, span.start)),
            reason: error.message().to_owned(),
        })?;
        sources.push(Source { name, text, file });
    }
    let source = sources.last().ok_or_else(|| unusable("it is empty".to_owned()))?;
    match resolve(source, &sources) {
        Ok(definition) => Ok(definition.into()),
        Err(Problem { at, reason }) => {
            Err(FileError { file: name.clone(), line: Some(line_of(&source.text, at)), reason })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_change_to_a_definition_file_makes_the_reader_panic(at in 0usize..40_000, length in 0usize..40, put: String) {
            let (name, text) = BUILT_IN[2];
            let start = text.floor_char_boundary(at);
            let end = text.floor_char_boundary(start.saturating_add(length));
            let changed = format!("{}{put}{}", &text[..start], &text[end..]);
            let (catalogue, errors) = Catalogue::from_texts(vec![(name.to_owned(), changed)]);
            prop_assert!(catalogue.iter().count() + errors.len() == 1);
        }
    }
}
