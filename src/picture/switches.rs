//! The switches on the back of a module: DIP blocks side by side, and the rotary switch as a dial.

use super::{Anchor, Area, HotSpot, Ink, Picture, SMALLEST_TEXT, Shape, Stroke, arc, on_circle};
use crate::module::{BankState, Position, PositionState, RotaryState, SwitchPanel};

const HEIGHT: f32 = 150.0;
const MARGIN: f32 = 4.0;
/// Between two blocks.
const GAP: f32 = 14.0;
/// The middle of the labels above the blocks.
const LABEL_Y: f32 = 10.0;

const BLOCK_TOP: f32 = 24.0;
const BLOCK_HEIGHT: f32 = 112.0;
/// From one position to the next.
const PITCH: f32 = 18.0;
/// Left and right of the sliders.
const SIDE: f32 = 7.0;
const ON_Y: f32 = BLOCK_TOP + 12.0;
const SLOT_TOP: f32 = BLOCK_TOP + 24.0;
const SLOT: [f32; 2] = [12.0, 62.0];
const SLIDER: f32 = 26.0;
/// Between a slider and its slot.
const PLAY: f32 = 2.0;
const NUMBER_Y: f32 = BLOCK_TOP + 96.0;
const BRACKET_Y: f32 = BLOCK_TOP + 105.5;

const DIAL_Y: f32 = BLOCK_TOP + BLOCK_HEIGHT / 2.0;
const DIGITS: f32 = 48.0;
const MARK: [f32; 2] = [35.0, 40.0];
const DISC: f32 = 33.0;
const POINTER: f32 = 26.0;
const DIAL_WIDTH: f32 = 2.0 * (DIGITS + 6.0);

/// Both kinds of switches as they look from behind, about 420 by 150; a slider that is up is ON.
pub fn switch_picture(panel: &SwitchPanel) -> Picture {
    let mut picture = Picture::default();
    let mut left = MARGIN;
    for bank in &panel.banks {
        left += block(&mut picture, bank, left) + GAP;
    }
    if let Some(rotary) = &panel.rotary {
        dial(&mut picture, rotary, left);
        left += DIAL_WIDTH + GAP;
    }
    if !panel.is_empty() {
        picture.size = [left - GAP + MARGIN, HEIGHT];
    }
    picture
}

/// Draws a bank and returns its width.
fn block(picture: &mut Picture, bank: &BankState, left: f32) -> f32 {
    let width = PITCH * bank.positions.len() as f32 + 2.0 * SIDE;
    let body = Area::new([left, BLOCK_TOP], [width, BLOCK_HEIGHT]);
    picture.text([left, LABEL_Y], Anchor::Start, SMALLEST_TEXT, Ink::Quiet, &bank.label);
    picture.shapes.push(Shape::Rect {
        area: body,
        rounding: 3.0,
        fill: Some(Ink::Body),
        outline: Some(Stroke { ink: Ink::Edge, width: 1.0 }),
    });
    on_mark(picture, [left + SIDE + 3.0, ON_Y]);
    for (index, state) in bank.positions.iter().enumerate() {
        let column = Area::new([left + SIDE + PITCH * index as f32, BLOCK_TOP], [PITCH, BLOCK_HEIGHT]);
        position(picture, state, column);
    }
    for group in bank.positions.chunk_by(|one, next| one.group == next.group).filter(|group| group.len() > 1) {
        let column = |number: u8| left + SIDE + PITCH * (f32::from(number) - 0.5);
        if let (Some(first), Some(last)) = (group.first(), group.last()) {
            bracket(picture, column(first.number) - 5.0, column(last.number) + 5.0);
        }
    }
    width
}

/// Joins the numbers of positions that mean something together.
fn bracket(picture: &mut Picture, left: f32, right: f32) {
    let (top, bottom) = (BRACKET_Y - 2.0, BRACKET_Y + 1.0);
    picture.line(vec![[left, top], [left, bottom], [right, bottom], [right, top]], Ink::PrintDim, 1.0);
}

/// The word that is printed on every block, with an arrow in the direction of ON.
fn on_mark(picture: &mut Picture, [x, y]: [f32; 2]) {
    picture.strong([x, y], Anchor::Start, 12.0, Ink::Print, "ON");
    let x = x + 28.0;
    picture.line(vec![[x, y + 4.5], [x, y - 3.0]], Ink::Print, 1.5);
    picture.polygon(vec![[x - 3.5, y - 1.5], [x, y - 6.0], [x + 3.5, y - 1.5]], Ink::Print);
}

fn position(picture: &mut Picture, state: &PositionState, column: Area) {
    let middle = (column.min[0] + column.max[0]) / 2.0;
    let slot = Area::new([middle - SLOT[0] / 2.0, SLOT_TOP], SLOT);
    picture.rect(slot, 1.5, Ink::Slot);
    match state.position {
        Position::On => slider(picture, slot, slot.min[1] + PLAY, state.in_force),
        Position::Off => slider(picture, slot, slot.max[1] - PLAY - SLIDER, state.in_force),
        Position::Unknown => hollow_slider(picture, slot, state.in_force),
    }
    let ink = if state.in_force { Ink::Print } else { Ink::PrintDim };
    picture.strong([middle, NUMBER_Y], Anchor::Middle, SMALLEST_TEXT, ink, state.number.to_string());
    let stands = match state.position {
        Position::On => "ON",
        Position::Off => "OFF",
        Position::Unknown => "not known",
    };
    let title = format!("{}: {stands}", state.title);
    picture.hot.push(HotSpot { area: column, title, text: state.explanation.clone() });
}

fn slider(picture: &mut Picture, slot: Area, top: f32, in_force: bool) {
    let area = Area::new([slot.min[0] + PLAY, top], [SLOT[0] - 2.0 * PLAY, SLIDER]);
    let ink = if in_force { Ink::Slider } else { Ink::SliderDim };
    picture.rect(area, 1.0, ink);
    // The ribs on which a finger nail finds hold.
    let middle = (area.min[1] + area.max[1]) / 2.0;
    for offset in [-4.0, 0.0, 4.0] {
        let y = middle + offset;
        picture.line(vec![[area.min[0] + 2.0, y], [area.max[0] - 2.0, y]], Ink::Slot, 0.8);
    }
}

/// An outline in the middle with a dash: it may stand either way.
fn hollow_slider(picture: &mut Picture, slot: Area, in_force: bool) {
    let ink = if in_force { Ink::Unknown } else { Ink::SliderDim };
    let middle = (slot.min[1] + slot.max[1]) / 2.0;
    let left = slot.min[0] + PLAY + 0.5;
    let width = SLOT[0] - 2.0 * PLAY - 1.0;
    picture.shapes.push(Shape::Rect {
        area: Area::new([left, middle - SLIDER / 2.0], [width, SLIDER]),
        rounding: 1.0,
        fill: None,
        outline: Some(Stroke { ink, width: 1.0 }),
    });
    picture.line(vec![[left + 2.0, middle], [left + width - 2.0, middle]], ink, 1.5);
}

fn dial(picture: &mut Picture, rotary: &RotaryState, left: f32) {
    let centre = [left + DIAL_WIDTH / 2.0, DIAL_Y];
    picture.text([centre[0], LABEL_Y], Anchor::Middle, SMALLEST_TEXT, Ink::Quiet, &rotary.label);
    for digit in 0u8..16 {
        scale_mark(picture, centre, digit, rotary.position == Some(digit));
    }
    picture.shapes.push(Shape::Circle {
        centre,
        radius: DISC,
        fill: Some(Ink::Housing),
        outline: Some(Stroke { ink: Ink::Edge, width: 1.0 }),
    });
    pointer(picture, centre, rotary);
    let stands = rotary.position.map_or_else(|| "not known".to_owned(), |position| format!("{position:X}"));
    picture.hot.push(HotSpot {
        area: Area::new([left, BLOCK_TOP], [DIAL_WIDTH, BLOCK_HEIGHT]),
        title: format!("{}: {stands}", rotary.label),
        text: rotary.explanation.clone(),
    });
}

fn scale_mark(picture: &mut Picture, centre: [f32; 2], digit: u8, chosen: bool) {
    let turns = f32::from(digit) / 16.0;
    let ends = MARK.map(|radius| on_circle(centre, radius, turns));
    let at = on_circle(centre, DIGITS, turns);
    let text = format!("{digit:X}");
    if chosen {
        picture.line(ends.to_vec(), Ink::Text, 2.0);
        picture.strong(at, Anchor::Middle, 13.0, Ink::Text, text);
    } else {
        picture.line(ends.to_vec(), Ink::Quiet, 1.0);
        picture.text(at, Anchor::Middle, SMALLEST_TEXT, Ink::Quiet, text);
    }
}

/// A round slot for the screwdriver with an arrow; without one if the position is not known.
fn pointer(picture: &mut Picture, centre: [f32; 2], rotary: &RotaryState) {
    picture.circle(centre, DISC - 5.0, Ink::Slot);
    let Some(position) = rotary.position else {
        let ink = if rotary.in_force { Ink::Unknown } else { Ink::SliderDim };
        let circle = arc(centre, DISC - 12.0, 0.0, 1.0);
        // Pieces with a gap after each, so that the ring is dashed.
        for piece in circle.chunks(6).map(|piece| piece.get(..4).unwrap_or(piece)) {
            picture.line(piece.to_vec(), ink, 1.0);
        }
        picture.line(vec![[centre[0] - 7.0, centre[1]], [centre[0] + 7.0, centre[1]]], ink, 2.0);
        return;
    };
    let ink = if rotary.in_force { Ink::Slider } else { Ink::SliderDim };
    let turns = f32::from(position) / 16.0;
    let tip = on_circle(centre, POINTER, turns);
    let neck = on_circle(centre, POINTER - 13.0, turns);
    let tail = on_circle(centre, -POINTER + 5.0, turns);
    let across = |at: [f32; 2], half: f32| [on_circle(at, half, turns - 0.25), on_circle(at, half, turns + 0.25)];
    let ([neck_left, neck_right], [tail_left, tail_right]) = (across(neck, 3.5), across(tail, 3.5));
    picture.polygon(vec![neck_left, neck_right, tail_right, tail_left], ink);
    let [left, right] = across(neck, 9.0);
    picture.polygon(vec![left, tip, right], ink);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position_state(number: u8, position: Position, in_force: bool) -> PositionState {
        let (title, explanation) = (format!("DIP {number} – Test"), "ON: a\nOFF: b".to_owned());
        PositionState { number, group: number.min(5), position, in_force, title, explanation }
    }

    fn panel() -> SwitchPanel {
        let cycle = [Position::On, Position::Off, Position::Unknown];
        let bank = |label: &str, count: u8| BankState {
            label: label.to_owned(),
            positions: (1..=count).zip(cycle.into_iter().cycle()).map(|(n, p)| position_state(n, p, n != 2)).collect(),
        };
        let rotary = RotaryState {
            label: "Rotary switch".to_owned(),
            position: Some(10),
            in_force: true,
            explanation: "Positions 0 to F.".to_owned(),
        };
        SwitchPanel { banks: vec![bank("PIR", 4), bank("All", 10)], rotary: Some(rotary), notes: Vec::new() }
    }

    #[test]
    fn every_switch_has_a_hot_spot_inside_the_picture_that_says_how_it_stands() {
        let picture = switch_picture(&panel());
        let titles: Vec<_> = picture.hot.iter().map(|spot| spot.title.as_str()).collect();
        assert_eq!(titles.len(), 4 + 10 + 1);
        assert_eq!(titles[..3], ["DIP 1 – Test: ON", "DIP 2 – Test: OFF", "DIP 3 – Test: not known"]);
        assert_eq!(titles[14], "Rotary switch: A");
        for spot in &picture.hot {
            assert!(spot.area.min[0] >= 0.0 && spot.area.max[0] <= picture.size[0], "{}", spot.title);
            assert!(spot.area.max[1] <= picture.size[1] && !spot.text.is_empty(), "{}", spot.title);
        }
        let overlap = |a: &Area, b: &Area| a.min[0] + 0.01 < b.max[0] && b.min[0] + 0.01 < a.max[0];
        for (index, spot) in picture.hot.iter().enumerate() {
            assert!(picture.hot[index + 1..].iter().all(|other| !overlap(&spot.area, &other.area)));
        }
    }

    /// Tops of the sliders in force of one bank.
    fn slider_top(position: Position, in_force: bool) -> Option<(f32, Ink)> {
        let bank = BankState { label: String::new(), positions: vec![position_state(1, position, in_force)] };
        let picture = switch_picture(&SwitchPanel { banks: vec![bank], ..SwitchPanel::default() });
        picture.shapes.iter().find_map(|shape| match shape {
            Shape::Rect { area, fill: Some(ink @ (Ink::Slider | Ink::SliderDim)), .. } => Some((area.min[1], *ink)),
            _ => None,
        })
    }

    #[test]
    fn a_slider_is_up_for_on_down_for_off_and_absent_if_unknown() {
        let (on, ink) = slider_top(Position::On, true).expect("a slider");
        let (off, dim) = slider_top(Position::Off, false).expect("a slider");
        assert!(on < off);
        assert_eq!((ink, dim), (Ink::Slider, Ink::SliderDim));
        assert_eq!(slider_top(Position::Unknown, true), None);
    }

    #[test]
    fn the_dial_has_all_hexadecimal_digits_and_no_text_is_too_small() {
        let picture = switch_picture(&panel());
        for digit in 0..16 {
            assert!(picture.words().contains(&format!("{digit:X}").as_str()), "{digit:X}");
        }
        for shape in &picture.shapes {
            if let Shape::Text { size, at, .. } = shape {
                assert!(*size >= SMALLEST_TEXT);
                assert!(at[1] + size / 2.0 <= picture.size[1] && at[1] - size / 2.0 >= 0.0);
            }
        }
    }

    #[test]
    fn a_module_without_switches_has_an_empty_picture() {
        assert_eq!(switch_picture(&SwitchPanel::default()), Picture::default());
    }
}
