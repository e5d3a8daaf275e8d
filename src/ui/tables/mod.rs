//! Long lists of lines, of which only those in view are laid out: what frames and events have in common.

mod bar;
mod details;
mod events;
mod export;
mod follower;
mod frames;
pub mod meaning;
mod scroll;
mod selection;
mod sheet;
mod table;

pub use bar::{Asked, Wanted, controls, count, search};
pub use details::{frame as frame_details, text as text_details};
pub use events::kind_mark;
pub use export::{CaptureFile, EventsFile, Form, FramesFile};
pub use follower::Follower;
pub use frames::{HEADER as FRAME_HEADER, as_row as frame_row, look as frame_look};
pub use scroll::Scroll;
pub use selection::Selection;
pub use sheet::{Part, Sheet, copied, copied_row};
pub use table::{Act, Cell, Column, Line, Table};

/// Rows put on the clipboard at once; more would hold the window up, and are what exports are for.
pub const MOST_COPIED: usize = 20_000;

/// `12 345`: thousands apart.
pub fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3 + 1);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_stand_apart() {
        let texts = [0, 999, 1_000, 12_345, 1_000_000].map(grouped);
        assert_eq!(texts, ["0", "999", "1 000", "12 345", "1 000 000"]);
    }
}
