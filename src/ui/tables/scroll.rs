//! Whether a list goes on, and whether its end stays in view.

/// Follows the end until the user looks elsewhere.
#[derive(Debug, Clone)]
pub struct Scroll {
    /// New lines are not taken in.
    pub paused: bool,
    /// The newest line stays in view.
    pub at_end: bool,
    /// A row that is to be brought into view.
    pub reveal: Option<usize>,
}

impl Default for Scroll {
    fn default() -> Self {
        Self { paused: false, at_end: true, reveal: None }
    }
}

impl Scroll {
    /// Takes lines in again and shows the newest.
    pub fn follow(&mut self) {
        *self = Self::default();
    }

    pub fn is_following(&self) -> bool {
        self.at_end && !self.paused
    }
}
