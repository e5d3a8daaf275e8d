//! The lines that were sent, for taking up again.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// Lines that are kept; the oldest go first.
pub const HISTORY_KEPT: usize = 500;

/// Sent lines, newest first, and where a user who steps through them stands. Saved as a list of lines.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(from = "Vec<String>", into = "Vec<String>")]
pub struct History {
    lines: VecDeque<String>,
    /// Which line is shown; `None` while the user's own draft is.
    shown: Option<usize>,
    /// What was typed before stepping began.
    draft: String,
}

impl From<Vec<String>> for History {
    fn from(lines: Vec<String>) -> Self {
        let mut lines = VecDeque::from(lines);
        lines.truncate(HISTORY_KEPT);
        Self { lines, shown: None, draft: String::new() }
    }
}

impl From<History> for Vec<String> {
    fn from(history: History) -> Self {
        history.lines.into()
    }
}

impl History {
    /// Keeps a line that was sent; not twice in a row, and no empty one. Stepping begins anew.
    pub fn add(&mut self, line: &str) {
        self.shown = None;
        self.draft.clear();
        let line = line.trim();
        if line.is_empty() || self.lines.front().is_some_and(|last| last == line) {
            return;
        }
        self.lines.truncate(HISTORY_KEPT - 1);
        self.lines.push_front(line.to_owned());
    }

    /// The line before the one in view; `typed` is what stands in the field and is kept when stepping begins.
    /// `None` if there is none older.
    pub fn older(&mut self, typed: &str) -> Option<&str> {
        let next = self.shown.map_or(0, |shown| shown.saturating_add(1));
        let line = self.lines.get(next)?;
        if self.shown.is_none() {
            typed.clone_into(&mut self.draft);
        }
        self.shown = Some(next);
        Some(line)
    }

    /// The line after the one in view, at last the draft again. `None` if the draft is in view.
    pub fn newer(&mut self) -> Option<&str> {
        let shown = self.shown?;
        self.shown = shown.checked_sub(1);
        Some(self.shown.and_then(|shown| self.lines.get(shown)).unwrap_or(&self.draft))
    }

    /// The user has edited what stands in the field: it is the draft from now on.
    pub fn edited(&mut self) {
        self.shown = None;
    }

    /// Newest first.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &str> {
        self.lines.iter().map(String::as_str)
    }

    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(lines: &[&str]) -> History {
        let mut history = History::default();
        lines.iter().for_each(|line| history.add(line));
        history
    }

    #[test]
    fn lines_are_kept_newest_first_and_not_twice_in_a_row() {
        let history = history(&["$01M", "$01M ", "$01F", "", "$01M"]);
        assert_eq!(history.iter().collect::<Vec<_>>(), ["$01M", "$01F", "$01M"]);
    }

    #[test]
    fn at_most_five_hundred_lines_are_kept() {
        let mut history = History::default();
        (0..600).for_each(|number| history.add(&format!("$01{number}")));
        assert_eq!((history.iter().len(), history.iter().next()), (HISTORY_KEPT, Some("$01599")));
        let lines: Vec<String> = (0..600).map(|number| number.to_string()).collect();
        assert_eq!(History::from(lines).iter().len(), HISTORY_KEPT);
    }

    #[test]
    fn stepping_up_and_down_comes_back_to_the_draft() {
        let mut history = history(&["$01M", "$01F"]);
        assert_eq!(history.newer(), None);
        assert_eq!(history.older("@01"), Some("$01F"));
        assert_eq!(history.older("$01F"), Some("$01M"));
        assert_eq!(history.older("$01M"), None, "there is none older");
        assert_eq!(history.newer(), Some("$01F"));
        assert_eq!(history.newer(), Some("@01"));
        assert_eq!(history.newer(), None);
    }

    #[test]
    fn an_edited_line_becomes_the_draft() {
        let mut history = history(&["$01M", "$01F"]);
        history.older("");
        history.edited();
        assert_eq!(history.older("$02F"), Some("$01F"));
        assert_eq!(history.newer(), Some("$02F"));
    }

    #[test]
    fn it_is_saved_as_a_list_of_lines() {
        let history = history(&["$01M", "hex 01 03"]);
        let saved = serde_json::to_string(&history).unwrap();
        assert_eq!(saved, r#"["hex 01 03","$01M"]"#);
        assert_eq!(serde_json::from_str::<History>(&saved).unwrap(), history);
    }
}
