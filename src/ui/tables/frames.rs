//! How a frame is written in a row.

use eframe::egui::Color32;

use super::table::Cell;
use crate::bench::Bench;
use crate::bench::traffic::{FrameRef, Outcome};
use crate::bus::Direction;
use crate::protocol::{Protocol, hex};
use crate::ui::theme::Palette;
use crate::ui::widgets::Glyph;
use crate::ui::words;

/// Longer frames are cut in a row; the details show all.
const MOST_BYTES: usize = 256;

/// Tells what a frame means in one line.
pub type Meaning<'a> = &'a dyn Fn(&FrameRef<'_>, Option<&FrameRef<'_>>) -> String;

/// Arrow and word of the way that a frame went.
pub fn direction_mark(direction: Direction) -> (Glyph, &'static str) {
    match direction {
        Direction::Sent => (Glyph::Sent, "Sent"),
        Direction::Received => (Glyph::Received, "Received"),
    }
}

/// Mark, colour and word of how it ended.
pub fn state(outcome: Outcome<'_>, palette: &Palette) -> (Option<Glyph>, Color32, &'static str) {
    match outcome {
        Outcome::Request => (None, palette.quiet, ""),
        Outcome::Answer => (None, palette.quiet, "OK"),
        Outcome::Refusal => (Some(Glyph::Triangle), palette.warning, "Refused"),
        Outcome::Broken(_) => (Some(Glyph::Cross), palette.error, "Broken"),
        Outcome::Silent => (Some(Glyph::Dashes), palette.error, "No answer"),
    }
}

/// The text of a DCON frame without its end, else hexadecimal bytes.
pub fn shown_bytes(frame: &FrameRef<'_>) -> String {
    let bytes = frame.bytes.get(..MOST_BYTES).unwrap_or(frame.bytes);
    match frame.protocol {
        Protocol::Dcon => hex::escaped(bytes.strip_suffix(b"\r").unwrap_or(bytes)),
        _ => hex::spaced(bytes),
    }
}

/// What a row says of the frame: its meaning, or why it has none.
fn told(frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>, explain: Meaning<'_>) -> String {
    match frame.outcome {
        Outcome::Broken(reason) => reason.to_owned(),
        Outcome::Silent if frame.bytes.is_empty() => "No answer".to_owned(),
        _ => explain(frame, request),
    }
}

/// Time, direction, address, bytes, meaning, duration and state.
pub fn look(
    frame: &FrameRef<'_>,
    request: Option<&FrameRef<'_>>,
    explain: Meaning<'_>,
    palette: &Palette,
) -> [Cell; 7] {
    let (arrow, way) = direction_mark(frame.direction);
    let way_colour = if frame.direction == Direction::Sent { palette.accent } else { palette.ok };
    let (mark, colour, word) = state(frame.outcome, palette);
    let hover = if frame.protocol == Protocol::Dcon { hex::spaced(frame.bytes) } else { String::new() };
    let text = if frame.outcome.is_error() { colour } else { palette.text };
    let state = Cell::new(word, colour).hover(frame.outcome.trouble());
    [
        Cell::new(words::clock(frame.at), palette.quiet),
        Cell::new(way, palette.text).marked(arrow, way_colour),
        Cell::new(frame.address.map_or_else(String::new, |address| address.to_string()), palette.text)
            .hover(frame.address.map_or_else(|| "To no single module".to_owned(), words::address)),
        Cell::mono(shown_bytes(frame), palette.text).hover(hover),
        Cell::new(told(frame, request, explain), text),
        Cell::new(words::milliseconds(frame.took), palette.quiet),
        match mark {
            Some(mark) => state.marked(mark, colour),
            None => state,
        },
    ]
}

/// What [`as_row`] tells.
pub const HEADER: [&str; 7] = ["Time (UTC)", "Direction", "Address", "Bytes", "Meaning", "Took", "State"];

/// A frame as it is copied, with all of its bytes.
pub fn as_row(bench: &Bench, seq: u64) -> Option<[String; 7]> {
    let frame = bench.traffic().get(seq)?;
    let request = bench.traffic().request_of(seq);
    let explain = |frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>| bench.explain_frame(frame, request).summary;
    Some([
        format!("{:.6}", frame.at),
        direction_mark(frame.direction).1.to_owned(),
        frame.address.map_or_else(String::new, |address| address.to_string()),
        if frame.protocol == Protocol::Dcon { hex::escaped(frame.bytes) } else { hex::spaced(frame.bytes) },
        told(&frame, request.as_ref(), &explain),
        words::milliseconds(frame.took),
        frame.outcome.word().to_owned(),
    ])
}
