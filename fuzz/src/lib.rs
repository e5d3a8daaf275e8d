//! What the targets share: a module whose answers are the fuzzer's bytes, a line that plays them in virtual time, and
//! check sums written a second time, so that a mistake in the program's own is noticed.

pub mod answers;
pub mod line;
pub mod sums;

/// Takes one byte off the front; 0 when there is none left.
pub fn take_byte(data: &mut &[u8]) -> u8 {
    let Some((first, rest)) = data.split_first() else { return 0 };
    *data = rest;
    *first
}

/// Takes up to `count` bytes off the front.
pub fn take_bytes<'a>(data: &mut &'a [u8], count: usize) -> &'a [u8] {
    let (taken, rest) = data.split_at(count.min(data.len()));
    *data = rest;
    taken
}
