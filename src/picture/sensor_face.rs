//! A round ceiling sensor as seen from below, with what each of its zones sees.

use super::{Anchor, Area, HotSpot, Ink, Picture, SMALLEST_TEXT, Shape, Stroke, arc, on_circle};

const SIZE: [f32; 2] = [220.0, 220.0];
const CENTRE: [f32; 2] = [110.0, 101.0];
const HOUSING: f32 = 99.0;
const GROOVE: f32 = 94.5;
const LENS: f32 = 78.0;
/// Height of a row of facets; rows lie from the edge of the lens inwards, and inside them words are read.
const FACET: f32 = 8.0;
const FACETS: u8 = 32;
/// The facets in the middle, where several zones meet.
const ROSETTE: f32 = 17.0;
/// Radii of the waves that a zone with motion sends out over the housing.
const WAVES: [f32; 2] = [83.5, 89.0];
const NOTE_Y: f32 = 211.0;
/// From the centre to the words of a zone, where there are several.
const WORDS: f32 = 41.0;
const LABEL_SIZE: f32 = 13.0;
const WORD_SIZE: f32 = 12.0;
/// From a zone's label to its word.
const LINE: f32 = 15.0;
/// Kept free of hatching around the words: half its width and height.
const WORDS_BOX: [f32; 2] = [22.0, 17.0];
/// Between two lines of the hatching, and the length below which a piece of one is left out.
const HATCH: [f32; 2] = [7.0, 4.0];

/// A part of the sensor that sees for itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Zone {
    /// A word or two.
    pub label: String,
    pub state: ZoneState,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ZoneState {
    Motion,
    Quiet,
    /// Does not take part in the detection.
    Disabled,
    Unknown,
}

impl ZoneState {
    /// As it is written into the zone.
    pub fn word(self) -> &'static str {
        match self {
            Self::Motion => "motion",
            Self::Quiet => "quiet",
            Self::Disabled => "off",
            Self::Unknown => "–",
        }
    }

    fn sentence(self) -> &'static str {
        match self {
            Self::Motion => "Detects motion.",
            Self::Quiet => "Detects no motion.",
            Self::Disabled => "Disabled: takes no part in the detection of motion.",
            Self::Unknown => "Not known.",
        }
    }
}

/// One zone fills the lens; several share it clockwise, the first at the upper left. `note` stands below.
///
/// How the zones lie on the module itself is not in the manuals: the picture is a scheme.
pub fn sensor_face(zones: &[Zone], note: &str) -> Picture {
    let mut picture = Picture { size: SIZE, ..Picture::default() };
    housing(&mut picture);
    let sectors = sectors(zones.len());
    for (zone, sector) in zones.iter().zip(&sectors) {
        match zone.state {
            ZoneState::Motion => motion(&mut picture, sector),
            ZoneState::Disabled => hatching(&mut picture, sector),
            ZoneState::Quiet | ZoneState::Unknown => {}
        }
    }
    facets(&mut picture, facet_rows(zones.len()));
    borders(&mut picture, &sectors);
    for (zone, sector) in zones.iter().zip(&sectors) {
        words(&mut picture, zone, sector);
    }
    picture.text([CENTRE[0], NOTE_Y], Anchor::Middle, SMALLEST_TEXT, Ink::Quiet, note);
    picture
}

/// A zone's part of the circle, in turns from the top.
#[derive(Debug, Clone, Copy)]
struct Sector {
    from: f32,
    share: f32,
}

impl Sector {
    fn is_whole(self) -> bool {
        self.share > 0.9
    }

    /// The middle of its words.
    fn middle(self) -> [f32; 2] {
        if self.is_whole() { CENTRE } else { on_circle(CENTRE, WORDS, self.from + self.share / 2.0) }
    }

    /// Whether a line of hatching may pass here.
    fn takes_hatching(self, [x, y]: [f32; 2]) -> bool {
        let [right, up] = [x - CENTRE[0], CENTRE[1] - y];
        let radius = right.hypot(up);
        let turns = (right.atan2(up) / std::f32::consts::TAU - self.from).rem_euclid(1.0);
        // Off the borders by the same distance everywhere.
        let inset = if self.is_whole() { 0.0 } else { 3.0 / (radius.max(1.0) * std::f32::consts::TAU) };
        let inside = (inset..=self.share - inset).contains(&turns);
        let hub = if self.is_whole() { 0.0 } else { ROSETTE + 2.0 };
        let rows = facet_rows(if self.is_whole() { 1 } else { 2 });
        let edge = LENS - FACET * f32::from(rows) - 2.0;
        let [middle_x, middle_y] = self.middle();
        let at_words = (x - middle_x).abs() < WORDS_BOX[0] && (y - middle_y).abs() < WORDS_BOX[1];
        inside && !at_words && (hub..=edge).contains(&radius)
    }
}

/// A single zone has its words in the middle and room for more facets.
fn facet_rows(zones: usize) -> u8 {
    if zones > 1 { 2 } else { 4 }
}

fn sectors(count: usize) -> Vec<Sector> {
    let share = 1.0 / count.max(1) as f32;
    let start = if count > 1 { -share } else { 0.0 };
    (0..count).map(|index| Sector { from: start + share * index as f32, share }).collect()
}

fn housing(picture: &mut Picture) {
    picture.shapes.push(Shape::Circle {
        centre: CENTRE,
        radius: HOUSING,
        fill: Some(Ink::Housing),
        outline: Some(Stroke { ink: Ink::Edge, width: 1.0 }),
    });
    picture.ring(CENTRE, GROOVE, Ink::Edge, 0.8);
    picture.circle(CENTRE, LENS, Ink::Lens);
}

/// Filled, with waves going out over the housing.
fn motion(picture: &mut Picture, sector: &Sector) {
    let (from, to) = (sector.from, sector.from + sector.share);
    if sector.is_whole() {
        picture.circle(CENTRE, LENS, Ink::Motion);
        for radius in WAVES {
            picture.ring(CENTRE, radius, Ink::Motion, 2.0);
        }
        return;
    }
    let mut points = vec![CENTRE];
    points.extend(arc(CENTRE, LENS, from, to));
    picture.polygon(points, Ink::Motion);
    for (radius, inset) in WAVES.into_iter().zip([0.08, 0.16]) {
        let inset = inset * sector.share;
        picture.line(arc(CENTRE, radius, from + inset, to - inset), Ink::Motion, 2.0);
    }
}

/// Lines from the lower left to the upper right.
fn hatching(picture: &mut Picture, sector: &Sector) {
    let reach = 2.0 * LENS;
    let lines = (2.0 * reach / HATCH[0]) as u32;
    for line in 0..=lines {
        let sum = CENTRE[0] + CENTRE[1] - reach + line as f32 * HATCH[0];
        let mut run: Vec<[f32; 2]> = Vec::new();
        for step in 0..=(reach as u32) {
            let x = CENTRE[0] - LENS + step as f32;
            let point = [x, sum - x];
            if sector.takes_hatching(point) {
                run.push(point);
            } else {
                hatch(picture, &mut run);
            }
        }
        hatch(picture, &mut run);
    }
}

fn hatch(picture: &mut Picture, run: &mut Vec<[f32; 2]>) {
    if let (Some(first), Some(last)) = (run.first(), run.last())
        && last[0] - first[0] >= HATCH[1]
    {
        picture.line(vec![*first, *last], Ink::Edge, 1.0);
    }
    run.clear();
}

fn facets(picture: &mut Picture, rows: u8) {
    for row in 0..rows {
        let outer = LENS - FACET * f32::from(row);
        picture.ring(CENTRE, outer - FACET, Ink::Facet, 0.8);
        // Every other row is set off by half a facet, as bricks are.
        let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
        for facet in 0..FACETS {
            let turns = (f32::from(facet) + shift) / f32::from(FACETS);
            let ends = [outer - FACET, outer].map(|radius| on_circle(CENTRE, radius, turns));
            picture.line(ends.to_vec(), Ink::Facet, 0.8);
        }
    }
    picture.ring(CENTRE, LENS, Ink::Edge, 1.0);
}

/// Lines between zones, and the rosette where they meet.
fn borders(picture: &mut Picture, sectors: &[Sector]) {
    if sectors.len() < 2 {
        return;
    }
    for sector in sectors {
        let ends = [ROSETTE, LENS].map(|radius| on_circle(CENTRE, radius, sector.from));
        picture.line(ends.to_vec(), Ink::Edge, 1.5);
    }
    picture.shapes.push(Shape::Circle {
        centre: CENTRE,
        radius: ROSETTE,
        fill: Some(Ink::Lens),
        outline: Some(Stroke { ink: Ink::Edge, width: 1.5 }),
    });
    picture.ring(CENTRE, ROSETTE / 2.5, Ink::Facet, 0.8);
    for facet in 0..12u8 {
        let ends = [ROSETTE / 2.5, ROSETTE - 1.0].map(|radius| on_circle(CENTRE, radius, f32::from(facet) / 12.0));
        picture.line(ends.to_vec(), Ink::Facet, 0.8);
    }
}

fn words(picture: &mut Picture, zone: &Zone, sector: &Sector) {
    let [x, y] = sector.middle();
    let (label, word) = match zone.state {
        ZoneState::Motion => (Ink::OnMotion, Ink::OnMotion),
        ZoneState::Quiet => (Ink::Text, Ink::Quiet),
        ZoneState::Disabled | ZoneState::Unknown => (Ink::Quiet, Ink::Quiet),
    };
    picture.strong([x, y - LINE / 2.0], Anchor::Middle, LABEL_SIZE, label, &zone.label);
    picture.text([x, y + LINE / 2.0], Anchor::Middle, WORD_SIZE, word, zone.state.word());
    picture.hot.push(HotSpot {
        area: hot_area(sector),
        title: zone.label.clone(),
        text: zone.state.sentence().to_owned(),
    });
}

/// A square around the words that leaves room for the neighbours'; the whole lens for a single zone.
fn hot_area(sector: &Sector) -> Area {
    let half = match sector.share {
        share if share > 0.9 => LENS,
        share if share > 0.24 => 28.5,
        share => 0.67 * WORDS * (share * std::f32::consts::PI).sin(),
    };
    let [x, y] = sector.middle();
    Area::new([x - half, y - half], [2.0 * half, 2.0 * half])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zones(states: &[ZoneState]) -> Vec<Zone> {
        let zone = |(index, state): (usize, &ZoneState)| Zone { label: format!("PIR {}", index + 1), state: *state };
        states.iter().enumerate().map(zone).collect()
    }

    const ALL: [ZoneState; 4] = [ZoneState::Motion, ZoneState::Quiet, ZoneState::Disabled, ZoneState::Unknown];

    #[test]
    fn each_zone_tells_its_state_in_words_beside_its_label() {
        let picture = sensor_face(&zones(&ALL), "a note");
        let words = picture.words();
        let pairs = ["PIR 1", "motion", "PIR 2", "quiet", "PIR 3", "off", "PIR 4", "–"];
        assert!(words.windows(pairs.len()).any(|part| part == pairs), "{words:?}");
        assert_eq!(words.last(), Some(&"a note"));
    }

    #[test]
    fn four_zones_lie_clockwise_from_the_upper_left_and_each_explains_itself() {
        let picture = sensor_face(&zones(&ALL), "");
        let corners = [[75.0, 65.0], [145.0, 65.0], [145.0, 135.0], [75.0, 135.0]];
        assert_eq!(picture.hot.len(), 4);
        for (index, corner) in corners.into_iter().enumerate() {
            let found: Vec<_> = picture.hot.iter().filter(|spot| spot.area.contains(corner)).collect();
            assert_eq!(found.len(), 1, "{corner:?}");
            assert_eq!(found[0].title, format!("PIR {}", index + 1));
            assert!(!found[0].text.is_empty());
        }
    }

    #[test]
    fn motion_has_waves_and_disabled_has_hatching_which_quiet_has_not() {
        let lines = |state| {
            let picture = sensor_face(&zones(&[state; 4]), "");
            picture.shapes.iter().filter(|shape| matches!(shape, Shape::Line { .. })).count()
        };
        assert_eq!(lines(ZoneState::Motion), lines(ZoneState::Quiet) + 4 * WAVES.len());
        assert!(lines(ZoneState::Disabled) > lines(ZoneState::Quiet) + 4);
        assert_eq!(lines(ZoneState::Unknown), lines(ZoneState::Quiet));
    }

    #[test]
    fn a_single_zone_fills_the_lens() {
        let picture = sensor_face(&zones(&[ZoneState::Motion]), "");
        let whole = |shape: &Shape| matches!(shape, Shape::Circle { radius, fill: Some(Ink::Motion), .. } if (radius - LENS).abs() < 0.1);
        assert!(picture.shapes.iter().any(whole));
        assert!(picture.hot[0].area.contains(CENTRE));
    }

    #[test]
    fn no_hot_spot_lies_on_another_for_any_number_of_zones() {
        let apart = |a: &Area, b: &Area| (0..2).any(|axis| a.min[axis] >= b.max[axis] || b.min[axis] >= a.max[axis]);
        for count in 0..9 {
            let hot = sensor_face(&zones(&vec![ZoneState::Quiet; count]), "").hot;
            assert_eq!(hot.len(), count);
            for (index, spot) in hot.iter().enumerate() {
                assert!(hot[index + 1..].iter().all(|other| apart(&spot.area, &other.area)), "{count} zones");
            }
        }
    }

    #[test]
    fn every_filled_polygon_is_convex_for_any_number_of_zones() {
        for count in 0..9 {
            let picture = sensor_face(&zones(&vec![ZoneState::Motion; count]), "");
            for shape in &picture.shapes {
                let Shape::Polygon { points, .. } = shape else { continue };
                let turn = |index: usize| {
                    let [a, b, c] = [0, 1, 2].map(|step| points[(index + step) % points.len()]);
                    (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
                };
                assert!((0..points.len()).all(|index| turn(index) > -0.01), "{count} zones");
            }
        }
    }
}
