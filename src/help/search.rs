//! Finds places of the help by words.

use super::library::{Article, Library};
use super::markdown::Block;

/// More places are not told.
pub const MOST_HITS: usize = 100;
/// Characters of the text that is shown of a place.
const SNIPPET: usize = 90;

/// A place where all words were found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hit {
    /// The article's id.
    pub article: String,
    /// The block to show.
    pub block: usize,
    /// The heading above it, or the article's title.
    pub heading: String,
    /// What stands there, around the first word.
    pub snippet: String,
}

/// What belongs to one heading.
struct Section<'a> {
    article: &'a Article,
    first: usize,
    heading: String,
    blocks: &'a [Block],
}

impl Library {
    /// The places that have every word of `sought`, those with a word in their heading first; at most [`MOST_HITS`].
    /// Rows of a table are places of their own.
    pub fn search(&self, sought: &str) -> Vec<Hit> {
        let words: Vec<String> = sought.split_whitespace().map(str::to_lowercase).collect();
        if words.is_empty() {
            return Vec::new();
        }
        let mut hits: Vec<(usize, Hit)> =
            self.articles().iter().flat_map(sections).flat_map(|section| section.hits(&words)).collect();
        hits.sort_by_key(|(rank, _)| *rank);
        hits.truncate(MOST_HITS);
        hits.into_iter().map(|(_, hit)| hit).collect()
    }
}

fn sections(article: &Article) -> Vec<Section<'_>> {
    let blocks = &article.document.blocks;
    let heads = blocks.iter().enumerate().filter(|(_, block)| matches!(block, Block::Heading(..)));
    let mut starts: Vec<usize> = heads.map(|(index, _)| index).collect();
    if starts.first() != Some(&0) {
        starts.insert(0, 0);
    }
    let ends = starts.iter().skip(1).copied().chain([blocks.len()]);
    let section = |(first, end): (usize, usize)| {
        let own = blocks.get(first..end)?;
        let heading = own.first().filter(|block| matches!(block, Block::Heading(..))).map(Block::text);
        Some(Section { article, first, heading: heading.unwrap_or_else(|| article.title.clone()), blocks: own })
    };
    starts.iter().copied().zip(ends).filter_map(section).collect()
}

impl Section<'_> {
    /// The rows that have all words, else the section if it has them all.
    fn hits(&self, words: &[String]) -> Vec<(usize, Hit)> {
        let heading = format!("{} {}", self.article.title, self.heading).to_lowercase();
        let missing: Vec<&String> = words.iter().filter(|word| !heading.contains(word.as_str())).collect();
        if missing.is_empty() {
            return vec![(0, self.hit(0, words))];
        }
        let rank = if missing.len() < words.len() { 1 } else { 2 };
        let texts: Vec<String> = self.blocks.iter().map(|block| block.text().to_lowercase()).collect();
        let has_all = |text: &String| missing.iter().all(|word| text.contains(word.as_str()));
        let rows = self
            .blocks
            .iter()
            .zip(&texts)
            .enumerate()
            .filter(|(_, (block, text))| matches!(block, Block::Row { head: false, .. }) && has_all(text));
        let rows: Vec<(usize, Hit)> = rows.map(|(index, _)| (rank, self.hit(index, words))).collect();
        if !rows.is_empty() {
            return rows;
        }
        if !has_all(&texts.join("\n")) {
            return Vec::new();
        }
        let first = texts.iter().position(|text| missing.iter().any(|word| text.contains(word.as_str())));
        let hit = self.hit(first.unwrap_or_default(), words);
        vec![(rank, Hit { block: self.first, ..hit })]
    }

    fn hit(&self, index: usize, words: &[String]) -> Hit {
        let text = match self.blocks.get(index) {
            Some(Block::Heading(..)) => self.blocks.get(index.saturating_add(1)),
            block => block,
        };
        let text = text.map(Block::text).unwrap_or_default();
        Hit {
            article: self.article.id.clone(),
            block: self.first.saturating_add(index),
            heading: self.heading.clone(),
            snippet: around(&text, words),
        }
    }
}

/// A part of `text` that has the first of `words` in it.
fn around(text: &str, words: &[String]) -> String {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    // Lower case may be longer or shorter, so a place there is only about the same here.
    let lower = text.to_lowercase();
    let place = words.iter().filter_map(|word| lower.find(word.as_str())).min().unwrap_or_default();
    let begin = if place < SNIPPET / 2 { 0 } else { place.saturating_sub(SNIPPET / 3) };
    let begin = text.floor_char_boundary(begin.min(text.len()));
    let begin = if begin == 0 {
        0
    } else {
        text.get(begin..)
            .and_then(|rest| rest.find(' '))
            .map_or(begin, |gap| begin.saturating_add(gap).saturating_add(1))
    };
    let rest = text.get(begin..).unwrap_or_default();
    let shown: String = rest.chars().take(SNIPPET).collect();
    let (before, behind) = (if begin > 0 { "… " } else { "" }, if shown.len() < rest.len() { "…" } else { "" });
    format!("{before}{shown}{behind}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::module::Catalogue;
    use proptest::prelude::*;

    fn search(sought: &str) -> Vec<Hit> {
        Library::new(&Catalogue::built_in().0, None).search(sought)
    }

    #[test]
    fn a_command_is_found_by_its_title_its_syntax_and_what_it_sets() {
        for sought in ["temperature offset", "@AATO", "temperature_offset", "PIR-234 temp OFFSET read"] {
            let hits = search(sought);
            assert!(
                hits.iter().any(|hit| hit.article == "pir-234-commands" && hit.heading.contains("temperature offset")),
                "{sought}"
            );
        }
    }

    #[test]
    fn a_register_is_found_by_its_number_as_a_row() {
        let hits = search("513 on time");
        let row = hits.iter().find(|hit| hit.article == "pir-234-registers").unwrap();
        assert!(row.snippet.starts_with("513 0200 PIR output ON time"), "{row:?}");
    }

    #[test]
    fn words_in_a_heading_count_more_and_nothing_is_found_for_nothing() {
        let hits = search("wiring");
        assert_eq!((hits[0].article.as_str(), hits[0].block), ("wiring", 0));
        assert!(search("").is_empty() && search("   ").is_empty() && search("xyzzy").is_empty());
        assert_eq!(search("e").len(), MOST_HITS);
    }

    proptest! {
        #[test]
        fn a_snippet_is_a_short_part_of_its_text(text: String, word: String) {
            let snippet = around(&text, &[word.to_lowercase()]);
            prop_assert!(snippet.chars().count() <= SNIPPET + 3);
        }
    }
}
