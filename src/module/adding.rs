//! A definition file that is to be added to the user's own: whether it is good, and where it is to stand.

use std::fs;
use std::path::{Path, PathBuf};

use super::catalogue::{Catalogue, FileError, built_in_texts, definition_files};
use super::file::File;

/// Characters of a model's id that its file's name has at most.
const LONGEST_NAME: usize = 64;

/// A good definition, and its place in the user's folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Addition {
    /// The model that it defines.
    pub id: String,
    pub text: String,
    /// The file that has this id already, else one that is named by it.
    pub place: PathBuf,
    pub standing: Standing,
}

/// What stands at a definition's place now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    Nothing,
    /// The very same.
    Same,
    /// The model as another file defines it.
    Other,
}

impl Addition {
    /// Judges the file at `path` as a part of `folder`: it may be based on what stands there, and takes the place of what
    /// has its id. Nothing is written.
    ///
    /// # Errors
    /// What is wrong with it, or with the file at its place.
    pub fn judge(folder: &Path, path: &Path) -> Result<Self, FileError> {
        let name = path.display().to_string();
        let text = fs::read_to_string(path).map_err(|error| unusable(&name, error.to_string()))?;
        let id = id_in(&text);
        let place = id.as_deref().map(|id| place(folder, id));
        let (_, errors) = Catalogue::from_texts(with_folder(folder, place.as_deref(), (name.clone(), text.clone())));
        if let Some(error) = errors.into_iter().find(|error| error.file == name) {
            return Err(error);
        }
        let (Some(id), Some(place)) = (id, place) else { return Err(unusable(&name, "it has no id".to_owned())) };
        let standing = standing(&place, &id, &text)?;
        Ok(Self { id, text, place, standing })
    }
}

fn unusable(file: &str, reason: String) -> FileError {
    FileError { file: file.to_owned(), line: None, reason }
}

fn id_in(text: &str) -> Option<String> {
    toml::from_str::<File>(text).ok().map(|file| file.id.into_inner())
}

/// Of several files with this id the last one counts.
fn place(folder: &Path, id: &str) -> PathBuf {
    let has_id = |path: &PathBuf| fs::read_to_string(path).is_ok_and(|text| id_in(&text).as_deref() == Some(id));
    definition_files(folder).into_iter().rfind(has_id).unwrap_or_else(|| folder.join(file_name(id)))
}

/// An id may hold what no file's name may, on one system or another.
fn file_name(id: &str) -> String {
    let harmless = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
    let stem: String = id.chars().map(harmless).take(LONGEST_NAME).collect();
    format!("{}.toml", if stem.is_empty() { "_" } else { &stem })
}

/// What the folder would hold with `added` in place of the file at `place`. What cannot be read is no reason to refuse it.
fn with_folder(folder: &Path, place: Option<&Path>, added: (String, String)) -> Vec<(String, String)> {
    let others = definition_files(folder).into_iter().filter(|path| Some(path.as_path()) != place);
    let read = |path: PathBuf| Some((path.display().to_string(), fs::read_to_string(&path).ok()?));
    let mut texts = built_in_texts();
    // The file that is added may stand in the folder already, under its own name.
    texts.extend(others.filter_map(read).filter(|(name, _)| *name != added.0));
    texts.push(added);
    texts
}

fn standing(place: &Path, id: &str, text: &str) -> Result<Standing, FileError> {
    if !place.exists() {
        return Ok(Standing::Nothing);
    }
    let name = place.display().to_string();
    let there = fs::read_to_string(place).map_err(|error| unusable(&name, error.to_string()))?;
    match id_in(&there) {
        _ if there == text => Ok(Standing::Same),
        Some(other) if other != id => {
            let reason = format!("it defines another model, {other} – rename it, then add this one again");
            Err(unusable(&name, reason))
        }
        _ => Ok(Standing::Other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_id_leads_out_of_the_folder() {
        for (id, name) in
            [("tm-1", "tm-1.toml"), ("../../tm", "______tm.toml"), ("C:\\tm 1", "C__tm_1.toml"), ("", "_.toml")]
        {
            assert_eq!(file_name(id), name);
        }
        assert_eq!(file_name(&"a".repeat(500)).len(), LONGEST_NAME + ".toml".len());
    }
}
