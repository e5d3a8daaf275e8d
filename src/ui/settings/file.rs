//! The file of the settings: read once at the start, replaced as a whole when something changed.
//!
//! A new file is written beside the old one and takes its name when it is complete, so that neither a crash nor a
//! second copy of the program leaves half a file.

use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use toml::Table;

use super::{Settings, table};

const NAME: &str = "settings.toml";
/// A change is written so long after it was seen; what changes meanwhile is written with it.
const WRITE_AFTER: Duration = Duration::from_secs(3);
/// Far more than choices and a history need; a larger file is not ours.
const LARGEST: u64 = 4 << 20;

/// What [`open`] found.
pub struct Opened {
    pub settings: Settings,
    /// Nothing can be kept without it.
    pub file: Option<SettingsFile>,
    /// For the user, as sentences.
    pub warnings: Vec<String>,
}

/// Reads the settings kept in `folder`. There is always a valid value; what could not be used is told.
pub fn open(folder: Option<&Path>) -> Opened {
    match folder {
        Some(folder) => SettingsFile::open(folder.join(NAME)),
        None => {
            let text = format!(
                "There is no folder for settings, so choices are not kept – name one in {}",
                crate::folders::OVERRIDE
            );
            Opened { settings: Settings::default(), file: None, warnings: vec![text] }
        }
    }
}

/// Whether the file may be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Access {
    Free,
    /// Writing failed, which was told; it is tried again only on demand.
    Failed,
    /// Something stands there that must not be lost.
    Closed,
}

/// Keeps settings in a file.
pub struct SettingsFile {
    path: PathBuf,
    /// What was read or written last; changes are told from it.
    kept: Settings,
    /// When a change that was seen is written.
    due: Option<Instant>,
    access: Access,
}

/// What came of a look for changes.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// For the user, as a sentence.
    pub warning: Option<String>,
    /// A change waits that long to be written.
    pub look_again: Option<Duration>,
}

/// Why the file was not written.
#[derive(Debug, thiserror::Error)]
enum Problem {
    #[error("{0} – make the file and its folder writable")]
    Failed(String),
    #[error("it was written by a newer version of this program (version {0}) – use that one, or move the file away")]
    Newer(i64),
}

enum Found {
    Nothing,
    Table(Table),
    /// Of a version that is not known here.
    Newer(i64, Table),
    Broken(String),
}

impl SettingsFile {
    fn open(path: PathBuf) -> Opened {
        let mut file = Self { path, kept: Settings::default(), due: None, access: Access::Free };
        let mut warnings = Vec::new();
        match find(&file.path) {
            Found::Nothing => {}
            Found::Table(table) => file.take(&table, &mut warnings),
            Found::Newer(version, table) => {
                file.access = Access::Closed;
                warnings.push(format!(
                    "{} was written by a newer version of this program (version {version}) – what is known of it is \
                     used, and it is left as it is",
                    file.path.display()
                ));
                file.take(&table, &mut warnings);
            }
            Found::Broken(reason) => warnings.push(file.put_aside_in_words(&reason)),
        }
        Opened { settings: file.kept.clone(), file: Some(file), warnings }
    }

    fn take(&mut self, table: &Table, warnings: &mut Vec<String>) {
        let (settings, unusable) = table::read(table);
        self.kept = settings;
        warnings.extend(unusable.into_iter().map(|text| format!("{}: {text}", self.path.display())));
    }

    fn put_aside_in_words(&mut self, reason: &str) -> String {
        let path = self.path.display();
        match put_aside(&self.path) {
            Ok(aside) => format!(
                "{path} could not be read ({reason}) – it was renamed to {}, and the defaults are used",
                aside.display()
            ),
            Err(error) => {
                let text = format!(
                    "{path} could not be read ({reason}) nor renamed ({error}) – the defaults are used and nothing is \
                     kept until it is moved away"
                );
                self.access = Access::Closed;
                text
            }
        }
    }

    /// To be called with every frame: writes what changed, some seconds later and at most once in that time. After a
    /// failure, which is told once, only [`Self::keep_now`] tries again.
    pub fn keep(&mut self, settings: &Settings, now: Instant) -> Outcome {
        if self.access != Access::Free || *self.to_keep(settings) == self.kept {
            self.due = None;
            return Outcome::default();
        }
        let due = *self.due.get_or_insert(now + WRITE_AFTER);
        let left = due.saturating_duration_since(now);
        if !left.is_zero() {
            return Outcome { look_again: Some(left), ..Outcome::default() };
        }
        Outcome { warning: self.keep_now(settings), look_again: None }
    }

    /// Writes what changed at once. Returns a warning if that failed and was not told yet.
    pub fn keep_now(&mut self, settings: &Settings) -> Option<String> {
        self.due = None;
        let settings = self.to_keep(settings).into_owned();
        if self.access == Access::Closed || settings == self.kept {
            return None;
        }
        match self.write(&settings) {
            Ok(()) => {
                self.kept = settings;
                self.access = Access::Free;
                None
            }
            Err(problem) => {
                let told = self.access == Access::Failed;
                let newer = matches!(problem, Problem::Newer(_));
                self.access = if newer { Access::Closed } else { Access::Failed };
                let text = format!("Choices are not kept in {}: {problem}", self.path.display());
                (!told || newer).then_some(text)
            }
        }
    }

    /// A span that has no name is not kept; the one before it is.
    fn to_keep<'a>(&self, settings: &'a Settings) -> Cow<'a, Settings> {
        if settings.has_named_span() {
            Cow::Borrowed(settings)
        } else {
            Cow::Owned(Settings { span: self.kept.span, ..settings.clone() })
        }
    }

    /// What stands in the file by now, perhaps from another copy of the program, is kept where nothing changed here.
    fn write(&self, settings: &Settings) -> Result<(), Problem> {
        let (mut table, before) = match find(&self.path) {
            Found::Nothing => (Table::new(), None),
            Found::Table(table) => (table, Some(&self.kept)),
            Found::Newer(version, _) => return Err(Problem::Newer(version)),
            Found::Broken(reason) => {
                let aside = put_aside(&self.path).map_err(|error| Problem::Failed(error.to_string()))?;
                log::warn!("{} could not be read ({reason}), now {}", self.path.display(), aside.display());
                (Table::new(), None)
            }
        };
        table::overlay(&mut table, before, settings).map_err(|error| Problem::Failed(error.message().to_owned()))?;
        let text = toml::to_string_pretty(&table).map_err(|error| Problem::Failed(error.to_string()))?;
        replace(&self.path, |file| file.write_all(text.as_bytes())).map_err(|error| Problem::Failed(error.to_string()))
    }
}

fn find(path: &Path) -> Found {
    let text = match read_text(path) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => return Found::Nothing,
        Err(error) => return Found::Broken(error.to_string()),
    };
    match text.parse::<Table>() {
        Ok(table) => match table::version(&table) {
            newer if newer > table::VERSION => Found::Newer(newer, table),
            _ => Found::Table(table),
        },
        Err(error) => Found::Broken(with_line(&text, &error)),
    }
}

fn read_text(path: &Path) -> io::Result<String> {
    // A pipe would never end.
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a file"));
    }
    let mut text = String::new();
    let read = File::open(path)?.take(LARGEST + 1).read_to_string(&mut text)?;
    if read as u64 > LARGEST {
        return Err(io::Error::other(format!("it is larger than {} MB", LARGEST >> 20)));
    }
    Ok(text)
}

fn with_line(text: &str, error: &toml::de::Error) -> String {
    let before = error.span().and_then(|span| text.get(..span.start));
    let line = before.map(|before| format!("line {}: ", before.matches('\n').count() + 1));
    format!("{}{}", line.unwrap_or_default(), error.message())
}

/// Only one file is kept aside, the latest.
fn put_aside(path: &Path) -> io::Result<PathBuf> {
    let aside = path.with_extension("toml.broken");
    fs::rename(path, &aside)?;
    Ok(aside)
}

/// Each running copy of the program has its own.
fn temporary(path: &Path) -> PathBuf {
    path.with_extension(format!("toml.{}.tmp", std::process::id()))
}

/// Puts what `fill` writes in place of the file at `path`, or leaves that as it is. A link stays a link.
fn replace(path: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let temporary = temporary(&path);
    let mut file = File::create(&temporary)?;
    let written = fill(&mut file).and_then(|()| file.sync_all());
    drop(file);
    let outcome = written.and_then(|()| fs::rename(&temporary, &path));
    if outcome.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    outcome
}

#[cfg(test)]
mod tests;
