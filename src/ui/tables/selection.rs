//! Which lines are chosen: one, or all between two.

/// Lines by their keys, which grow from line to line.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Selection {
    /// Where the choice began, and where it ends.
    ends: Option<(u64, u64)>,
    /// The user has chosen since this was last asked.
    is_new: bool,
}

impl Selection {
    pub fn choose(&mut self, key: u64) {
        self.ends = Some((key, key));
        self.is_new = true;
    }

    /// Chooses all from where the choice began to `key`.
    pub fn extend(&mut self, key: u64) {
        let start = self.ends.map_or(key, |(start, _)| start);
        self.ends = Some((start, key));
        self.is_new = true;
    }

    pub fn clear(&mut self) {
        self.ends = None;
    }

    /// The line that was chosen last.
    pub fn current(&self) -> Option<u64> {
        self.ends.map(|(_, end)| end)
    }

    /// The line that was chosen since this was last asked, even if it is the same as before.
    pub fn take_new(&mut self) -> Option<u64> {
        std::mem::take(&mut self.is_new).then(|| self.current()).flatten()
    }

    /// The first and the last key.
    pub fn range(&self) -> Option<(u64, u64)> {
        self.ends.map(|(start, end)| (start.min(end), start.max(end)))
    }

    pub fn contains(&self, key: u64) -> bool {
        self.range().is_some_and(|(first, last)| (first..=last).contains(&key))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_is_extended_in_both_directions() {
        let mut selection = Selection::default();
        selection.extend(5);
        assert_eq!(selection.range(), Some((5, 5)));
        selection.extend(3);
        assert_eq!((selection.range(), selection.current()), (Some((3, 5)), Some(3)));
        selection.extend(8);
        assert_eq!(selection.range(), Some((5, 8)));
        assert!(selection.contains(7) && !selection.contains(4));
        selection.choose(1);
        assert_eq!(selection.range(), Some((1, 1)));
    }
}
