//! The built-in help: its contents or what was searched for at the left, an article at the right. What the articles say
//! stands in `crate::help`.

pub mod about;
mod article;
mod contents;
mod keyboard;
mod licence_list;
mod text;
mod topic;

use std::sync::Arc;

use eframe::egui::{Button, Panel, Ui};

use super::app::Pass;
use super::panes::{Pane, Wish};
use super::{theme, widgets};
use crate::bus::Target;
use crate::help::{Hit, Library};
use crate::module::Definition;
use article::ArticleView;
pub use topic::topic;

/// What is shown first.
const FIRST: &str = "quick-start";
/// Pages that **Back** remembers.
const REMEMBERED: usize = 50;

/// Where in the help.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Place {
    article: String,
    /// The block to begin with.
    block: usize,
}

/// What the view remembers between frames.
#[derive(Default)]
pub struct HelpView {
    library: Option<Library>,
    /// The models of which it was made.
    models: Vec<Arc<Definition>>,
    place: Option<Place>,
    before: Vec<Place>,
    sought: String,
    hits: Vec<Hit>,
    /// The module that was in view when help was asked for.
    module: Option<Target>,
    /// The field for searching is to get the focus.
    to_search: bool,
    /// What is shown is to come into view in the contents.
    reveal: bool,
    /// The contents are shown instead of the page, where only one has room.
    in_contents: bool,
    article: ArticleView,
}

impl HelpView {
    /// Shows the article with this id from the next frame on; what is shown stays without one.
    pub fn ask(&mut self, topic: Option<String>, module: Option<Target>) {
        self.module = module.or(self.module);
        self.to_search = topic.is_none();
        self.in_contents = self.to_search;
        self.reveal = true;
        if let Some(article) = topic {
            self.sought.clear();
            self.go(Place { article, block: 0 });
        }
    }

    fn go(&mut self, place: Place) {
        if self.place.as_ref() == Some(&place) {
            return self.article.scroll_to(place.block);
        }
        self.article.scroll_to(place.block);
        let left = self.place.replace(place);
        self.before.extend(left);
        let surplus = self.before.len().saturating_sub(REMEMBERED);
        self.before.drain(..surplus);
    }

    fn back(&mut self) {
        if let Some(place) = self.before.pop() {
            self.article.scroll_to(place.block);
            self.place = Some(place);
        }
    }

    pub fn show(&mut self, ui: &mut Ui, pass: &mut Pass<'_>, wishes: &mut Vec<Wish>) {
        self.keep_library(ui, pass);
        let Some(library) = self.library.take() else { return };
        let both = ui.available_width() >= theme::HELP_BESIDE;
        let chosen = match (both, self.in_contents) {
            (true, _) => {
                let frame = theme::beside_frame();
                let panel = Panel::left("help contents").frame(frame).resizable(true).default_size(theme::HELP_LIST);
                panel.size_range(theme::HELP_LIST_RANGE).show(ui, |ui| self.list(ui, &library)).inner
            }
            (false, true) => self.list(ui, &library),
            (false, false) => None,
        };
        if both || !self.in_contents {
            theme::behind_list_frame().show(ui, |ui| self.page(ui, &library, pass, wishes, both));
        }
        if let Some(place) = chosen {
            self.in_contents = false;
            self.go(place);
        }
        self.library = Some(library);
    }

    /// Makes the library anew when other models are known.
    fn keep_library(&mut self, ui: &Ui, pass: &Pass<'_>) {
        let models = || pass.bench.catalogue().iter();
        let same = self.library.is_some()
            && models().count() == self.models.len()
            && models().zip(&self.models).all(|(one, other)| Arc::ptr_eq(one, other));
        if !same {
            self.models = models().cloned().collect();
            let library = Library::new(pass.bench.catalogue(), Some(keyboard::article(ui.ctx())));
            self.hits = library.search(&self.sought);
            self.article.forget();
            self.library = Some(library);
        }
    }

    fn list(&mut self, ui: &mut Ui, library: &Library) -> Option<Place> {
        if contents::search_field(ui, &mut self.sought, std::mem::take(&mut self.to_search)) {
            self.hits = library.search(&self.sought);
        }
        ui.add_space(theme::UNIT);
        let shown = self.place.as_ref();
        if self.sought.trim().is_empty() {
            let reveal = std::mem::take(&mut self.reveal);
            contents::articles(ui, library, shown.map_or(FIRST, |place| place.article.as_str()), reveal)
        } else {
            contents::hits(ui, library, &self.hits, shown)
        }
    }

    /// The article, `beside` the contents or instead of them.
    fn page(&mut self, ui: &mut Ui, library: &Library, pass: &mut Pass<'_>, wishes: &mut Vec<Wish>, beside: bool) {
        let id = self.place.as_ref().map_or(FIRST, |place| place.article.as_str());
        let Some(article) = library.article(id).or_else(|| library.article(FIRST)) else { return };
        let mut back = false;
        ui.horizontal(|ui| {
            if !beside && ui.button("Contents").on_hover_text("All pages, and what to search in them").clicked() {
                (self.in_contents, self.reveal) = (true, true);
            }
            let button = ui.add_enabled(!self.before.is_empty(), Button::new("Back"));
            let button = button.on_hover_text("To the page that was shown before");
            back = button.on_disabled_hover_text("This is the first page that you opened").clicked();
            widgets::quiet(ui, &format!("{}  ›  {}", article.group.title(), article.title));
            widgets::at_right(ui, |ui| {
                let button = ui.button("Copy page").on_hover_text(
                    "The whole page as text (Markdown). A part of it is copied \
                                                                   with the mouse and Ctrl+C",
                );
                if button.clicked() {
                    ui.ctx().copy_text(article.source.clone());
                }
            });
        });
        ui.add_space(theme::UNIT);
        let words: Vec<String> = self.sought.split_whitespace().map(str::to_ascii_lowercase).collect();
        let link = self.article.show(ui, article, &words);
        if let Some(link) = link {
            self.follow(&link, library, pass, wishes);
        }
        if back {
            self.back();
        }
    }

    /// Goes where a link leads: to another article, or to another tab.
    fn follow(&mut self, link: &str, library: &Library, pass: &mut Pass<'_>, wishes: &mut Vec<Wish>) {
        let pane = match link {
            "pane:dashboard" => Pane::Dashboard,
            "pane:traffic" => Pane::Traffic,
            "pane:trends" => Pane::Trends,
            "pane:diagnosis" => Pane::Diagnosis,
            "module:configuration" => {
                "configuration".clone_into(&mut pass.settings.tab);
                self.known_module(pass).map_or(Pane::Dashboard, Pane::Module)
            }
            article if library.article(article).is_some() => {
                return self.go(Place { article: article.to_owned(), block: 0 });
            }
            _ => return,
        };
        wishes.push(Wish::Open(pane));
    }

    /// The module from which help was asked for, else the first one of a known model.
    fn known_module(&self, pass: &Pass<'_>) -> Option<Target> {
        let known = |target: &Target| pass.bench.module(target).is_some_and(|module| module.definition().is_some());
        let all = pass.bench.modules().iter().map(|module| module.target);
        self.module.into_iter().chain(all).find(known)
    }
}
