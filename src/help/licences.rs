//! What the program is built from, and under which licences: the list that `.ci/licences` writes.

use std::io::Read;

use flate2::read::GzDecoder;

const LIST: &str = include_str!("../../assets/licences.tsv");
const TEXTS: &[u8] = include_bytes!("../../assets/licences.json.gz");
const OWN: [(&str, &str); 2] =
    [("MIT", include_str!("../../LICENSE-MIT")), ("Apache-2.0", include_str!("../../LICENSE-APACHE"))];
const SOURCES: &str = "The sources of a package are at https://crates.io/crates/ with its name behind.";
/// From here on the list names what the program does not contain.
const NOT_IN_PROGRAM: &str = "# not in the program";

/// A part of the program by others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    pub name: &'static str,
    /// Empty where it has none of its own.
    pub version: &'static str,
    /// In SPDX's words where there are such.
    pub licence: &'static str,
    /// The names of its texts.
    texts: &'static str,
}

/// Every part by others: first what is no package of the language's registry, then all packages by name.
pub fn parts() -> Vec<Part> {
    let lines = LIST.lines().take_while(|line| *line != NOT_IN_PROGRAM);
    lines.filter(|line| !line.starts_with('#')).filter_map(part).collect()
}

fn part(line: &'static str) -> Option<Part> {
    let mut columns = line.split('\t');
    let (name, version, licence, texts) = (columns.next()?, columns.next()?, columns.next()?, columns.next()?);
    Some(Part { name, version, licence, texts })
}

impl Part {
    /// Such as `serde 1.0.219`.
    pub fn title(&self) -> String {
        if self.version.is_empty() { self.name.to_owned() } else { format!("{} {}", self.name, self.version) }
    }

    /// Whether every word of `sought` is in its name, version or licence.
    pub fn has(&self, sought: &str) -> bool {
        let all = format!("{} {} {}", self.name, self.version, self.licence).to_lowercase();
        sought.split_whitespace().all(|word| all.contains(&word.to_lowercase()))
    }
}

/// The full texts of all licences; unpacked when they are asked for.
#[derive(Debug, Clone, Default)]
pub struct Texts(serde_json::Map<String, serde_json::Value>);

impl Texts {
    /// None if the program's own data is damaged.
    pub fn unpacked() -> Option<Self> {
        let mut text = String::new();
        GzDecoder::new(TEXTS).read_to_string(&mut text).ok()?;
        serde_json::from_str(&text).ok().map(Self)
    }

    /// All texts of a part, one after the other.
    pub fn of(&self, part: &Part) -> String {
        let texts = part.texts.split(' ').filter_map(|name| self.0.get(name)?.as_str());
        texts.collect::<Vec<_>>().join(&format!("\n{}\n\n", "-".repeat(40)))
    }

    /// Each text with the parts that come under it, in the order in which parts have them.
    fn by_text<'a>(&'a self, parts: &[Part]) -> Vec<(&'a str, Vec<String>)> {
        let mut texts: Vec<(&str, Vec<String>)> = Vec::new();
        for part in parts {
            for name in part.texts.split(' ') {
                match texts.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, users)) => users.push(part.title()),
                    None => texts.push((name, vec![part.title()])),
                }
            }
        }
        texts.into_iter().filter_map(|(name, users)| Some((self.0.get(name)?.as_str()?, users))).collect()
    }
}

/// The program's own licences, by name and text.
pub fn own() -> [(&'static str, &'static str); 2] {
    OWN
}

/// Everything as one text: own licences, the list, then each text with the parts that come under it.
pub fn whole() -> Option<String> {
    let (parts, texts) = (parts(), Texts::unpacked()?);
    let rule = "=".repeat(80);
    let mut whole = format!("{} comes under the licences MIT or Apache-2.0, at your choice.\n", crate::version::NAME);
    for (name, text) in OWN {
        whole.push_str(&format!("\n{rule}\n{name}\n{rule}\n\n{text}"));
    }
    whole.push_str(&format!("\n{rule}\nParts by others\n{rule}\n\n{SOURCES}\n\n"));
    for part in &parts {
        whole.push_str(&format!("{}: {}\n", part.title(), part.licence));
    }
    for (text, users) in texts.by_text(&parts) {
        whole.push_str(&format!("\n{rule}\nOf {}\n{rule}\n\n{text}", users.join(", ")));
    }
    Some(whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Name and version of every package that comes from elsewhere.
    fn locked() -> BTreeSet<(String, String)> {
        let lock: toml::Table = toml::from_str(include_str!("../../Cargo.lock")).unwrap();
        let packages = lock["package"].as_array().unwrap().iter().filter(|package| package.get("source").is_some());
        let text = |package: &toml::Value, key: &str| package[key].as_str().unwrap().to_owned();
        packages.map(|package| (text(package, "name"), text(package, "version"))).collect()
    }

    #[test]
    fn the_list_knows_every_package_of_the_lock_file_and_no_other() {
        let (_, others) = LIST.split_once(NOT_IN_PROGRAM).unwrap();
        let mut listed: BTreeSet<(String, String)> = others
            .lines()
            .filter_map(|line| line.split_once('\t'))
            .map(|(name, version)| (name.to_owned(), version.to_owned()))
            .collect();
        listed.extend(packages().into_iter().map(|part| (part.name.to_owned(), part.version.to_owned())));
        let locked = locked();
        let missing: Vec<_> = locked.difference(&listed).chain(listed.difference(&locked)).collect();
        assert!(missing.is_empty(), "run .ci/licences: {missing:?}");
    }

    /// Parts that are packages of the registry.
    fn packages() -> Vec<Part> {
        let known: BTreeSet<String> = locked().into_iter().map(|(name, _)| name).collect();
        parts().into_iter().filter(|part| known.contains(part.name)).collect()
    }

    #[test]
    fn what_the_program_calls_directly_is_in_it() {
        let manifest: toml::Table = toml::from_str(include_str!("../../Cargo.toml")).unwrap();
        let parts = parts();
        for name in manifest["dependencies"].as_table().unwrap().keys() {
            assert!(parts.iter().any(|part| part.name == name), "{name}");
        }
        for name in manifest["dev-dependencies"].as_table().unwrap().keys() {
            assert!(name == "tempfile" || parts.iter().all(|part| part.name != name), "{name} is for tests only");
        }
    }

    #[test]
    fn every_part_has_its_licence_with_its_text() {
        let (texts, parts) = (Texts::unpacked().unwrap(), parts());
        assert!(parts.len() > 300, "{}", parts.len());
        for part in &parts {
            assert!(!part.licence.is_empty() && texts.of(part).len() > 200, "{part:?}");
        }
        for name in ["SQLite", "Ubuntu-Light (font)", "Hack-Regular (font)", "NotoEmoji-Regular (font)", "egui"] {
            assert!(parts.iter().any(|part| part.name == name), "{name}");
        }
        assert!(texts.of(parts.iter().find(|part| part.name == "SQLite").unwrap()).contains("blessing"));
    }

    #[test]
    fn the_whole_has_every_part_and_every_text_once() {
        let whole = whole().unwrap();
        for part in parts() {
            assert!(whole.contains(&format!("\n{}: {}\n", part.title(), part.licence)), "{part:?}");
        }
        assert!(whole.contains("Mozilla Public License Version 2.0") && whole.contains("https://crates.io/crates/"));
        assert!(whole.len() < 1_500_000);
    }

    #[test]
    fn parts_are_found_by_name_and_licence() {
        let parts = parts();
        let found = |sought: &str| parts.iter().filter(|part| part.has(sought)).count();
        assert_eq!(found("sqlite public"), 1);
        assert!(found("apache") > 100 && found("") == parts.len() && found("no such thing") == 0);
    }
}
