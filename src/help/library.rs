//! All articles, in the order of the list of contents.

use super::markdown::{self, Block, Document};
use super::{reference, switches, troubleshooting};
use crate::module::{Catalogue, Definition};

/// Where an article stands in the list of contents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    Start,
    Modules,
    Line,
    Program,
    Reference,
}

impl Group {
    pub fn title(self) -> &'static str {
        match self {
            Self::Start => "Start",
            Self::Modules => "Modules",
            Self::Line => "Line and records",
            Self::Program => "Program",
            Self::Reference => "Command reference",
        }
    }
}

/// One page of the help.
#[derive(Debug, Clone, PartialEq)]
pub struct Article {
    /// What links name.
    pub id: String,
    pub title: String,
    pub group: Group,
    /// As Markdown, for copying.
    pub source: String,
    pub document: Document,
}

impl Article {
    /// The title is the text's first heading.
    fn new(id: &str, group: Group, source: String) -> Self {
        let document = markdown::parse(&source);
        let title = document.blocks.iter().find_map(|block| match block {
            Block::Heading(1, spans) => Some(markdown::plain(spans)),
            _ => None,
        });
        Self { id: id.to_owned(), title: title.unwrap_or_else(|| id.to_owned()), group, source, document }
    }
}

/// The written articles.
const WRITTEN: [(&str, Group, &str); 13] = [
    ("quick-start", Group::Start, include_str!("../../assets/help/quick-start.md")),
    ("wiring", Group::Start, include_str!("../../assets/help/wiring.md")),
    ("init", Group::Start, include_str!("../../assets/help/init.md")),
    ("settings", Group::Modules, include_str!("../../assets/help/settings.md")),
    ("readings", Group::Modules, include_str!("../../assets/help/readings.md")),
    ("relays", Group::Modules, include_str!("../../assets/help/relays.md")),
    ("watchdog", Group::Modules, include_str!("../../assets/help/watchdog.md")),
    ("commands", Group::Modules, include_str!("../../assets/help/commands.md")),
    ("log-and-summary", Group::Modules, include_str!("../../assets/help/log-and-summary.md")),
    ("traffic", Group::Line, include_str!("../../assets/help/traffic.md")),
    ("trends", Group::Line, include_str!("../../assets/help/trends.md")),
    ("window", Group::Program, include_str!("../../assets/help/window.md")),
    ("adding-modules", Group::Program, include_str!("../../assets/help/adding-modules.md")),
];

/// The help as a whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Library {
    articles: Vec<Article>,
}

impl Library {
    /// The articles for the models of `catalogue`. `keyboard` is the article that only the window can write, as Markdown.
    pub fn new(catalogue: &Catalogue, keyboard: Option<String>) -> Self {
        let mut articles: Vec<Article> =
            WRITTEN.into_iter().map(|(id, group, text)| Article::new(id, group, text.to_owned())).collect();
        articles.push(Article::new("switches", Group::Start, switches::article(catalogue)));
        articles.push(Article::new("troubleshooting", Group::Line, troubleshooting::article()));
        articles.extend(keyboard.map(|text| Article::new("keyboard", Group::Program, text)));
        for definition in catalogue.iter() {
            articles.push(Article::new(&commands_of(definition), Group::Reference, reference::commands(definition)));
            articles.push(Article::new(&registers_of(definition), Group::Reference, reference::registers(definition)));
        }
        articles.sort_by_key(|article| article.group);
        Self { articles }
    }

    pub fn articles(&self) -> &[Article] {
        &self.articles
    }

    pub fn article(&self, id: &str) -> Option<&Article> {
        self.articles.iter().find(|article| article.id == id)
    }
}

/// The article with a model's commands.
pub fn commands_of(definition: &Definition) -> String {
    format!("{}-commands", definition.id)
}

/// The article with a model's coils and registers.
pub fn registers_of(definition: &Definition) -> String {
    format!("{}-registers", definition.id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::console::{reference as entries, register_table};
    use crate::protocol::Protocol;

    fn library() -> (Catalogue, Library) {
        let (catalogue, _) = Catalogue::built_in();
        let library = Library::new(&catalogue, Some("# Keyboard\n".to_owned()));
        (catalogue, library)
    }

    #[test]
    fn every_link_leads_somewhere() {
        let (_, library) = library();
        let elsewhere = ["pane:dashboard", "pane:traffic", "pane:trends", "pane:diagnosis", "module:configuration"];
        for article in library.articles() {
            for link in article.document.blocks.iter().flat_map(Block::spans).filter_map(|span| span.link.as_deref()) {
                let known = library.article(link).is_some() || elsewhere.contains(&link);
                assert!(known, "{link} in {}", article.id);
            }
        }
    }

    #[test]
    fn every_article_has_a_title_of_its_own_and_something_to_say() {
        let (_, library) = library();
        let mut titles: Vec<&str> = library.articles().iter().map(|article| article.title.as_str()).collect();
        for article in library.articles() {
            assert_ne!(article.title, article.id);
            assert!(article.id == "keyboard" || article.document.blocks.len() > 3, "{}", article.id);
        }
        let count = titles.len();
        titles.sort_unstable();
        titles.dedup();
        assert_eq!(titles.len(), count);
    }

    #[test]
    fn the_reference_tells_every_command_item_and_register_of_every_model() {
        let (catalogue, library) = library();
        for definition in catalogue.iter() {
            let commands = library.article(&commands_of(definition)).unwrap();
            let registers = library.article(&registers_of(definition)).unwrap();
            let text =
                |article: &Article| article.document.blocks.iter().map(Block::text).collect::<Vec<_>>().join("\n");
            let (commands, registers) = (text(commands), text(registers));
            for entry in entries(definition) {
                let syntax = entry.syntax_read.iter().chain(&entry.syntax_write).chain(&entry.answers);
                for word in syntax.chain([&entry.title, &entry.note, &entry.source]) {
                    assert!(commands.contains(word.as_str()), "{}: {word}", definition.id);
                }
            }
            for protocol in [Protocol::ModbusRtu, Protocol::ModbusTcp] {
                for entry in register_table(definition, protocol) {
                    for id in &entry.items {
                        let row = registers
                            .lines()
                            .find(|row| row.starts_with(&entry.number.to_string()) && row.contains(&format!("({id})")));
                        assert!(row.is_some(), "{}: {} {id}", definition.id, entry.number);
                    }
                }
            }
            for item in &definition.items {
                let told = [&commands, &registers].into_iter().any(|text| {
                    text.contains(&format!("({})", item.id))
                        && text.contains(&item.help)
                        && text.contains(&item.allowed())
                });
                assert!(told, "{}: {}", definition.id, item.id);
            }
        }
    }
}
