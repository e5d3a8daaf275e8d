//! Plots over time: curves, strips of states, limits, axes and legend, with room for all words.

use super::{Anchor, Area, Ink, Picture, SMALLEST_TEXT};

const MARGIN: f32 = 16.0;
const TITLE: f32 = 28.0;
const LABELS: f32 = 112.0;
/// At the right there are numbers only, if any.
const RIGHT_LABELS: f32 = 56.0;
const LEGEND_ROW: f32 = 16.0;
const GAP: f32 = 14.0;
const STRIP: f32 = 18.0;
const STRIP_INSET: f32 = 4.0;
const AXIS: f32 = 36.0;
const TICK: f32 = 4.0;
const LINE: f32 = 1.2;
const HAIRLINE: f32 = 0.7;
const DOT: f32 = 1.5;
/// A letter of the smallest text is about so wide, at most.
const LETTER: f32 = 6.2;
const SWATCH: f32 = 14.0;

/// What is drawn. Places across are parts of the width from the left, places in a plot are parts of its height from the
/// top.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrendPicture {
    pub width: f32,
    /// Of one plot.
    pub height: f32,
    pub title: String,
    pub plots: Vec<PlotPart>,
    pub strips: Vec<StripPart>,
    pub times: Vec<(f32, String)>,
    pub dates: Vec<(f32, String)>,
    pub zone: String,
    /// Notes.
    pub marks: Vec<(f32, String)>,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlotPart {
    /// Curves are told apart by number, see [`Ink::Curve`].
    pub legend: Vec<(u8, String)>,
    pub left: Option<AxisPart>,
    pub right: Option<AxisPart>,
    pub lines: Vec<(u8, Vec<[f32; 2]>)>,
    pub limits: Vec<(f32, String)>,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct AxisPart {
    pub unit: String,
    pub ticks: Vec<(f32, String)>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct StripPart {
    pub name: String,
    pub curve: u8,
    /// From, to, and what is drawn.
    pub runs: Vec<(f32, f32, State)>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum State {
    Off,
    On,
    Word(String),
}

/// The rows of names above a plot.
type Legend<'a> = Vec<Vec<(&'a str, u8)>>;

pub fn trend_picture(trend: &TrendPicture) -> Picture {
    let right = if trend.plots.iter().any(|plot| plot.right.is_some()) { RIGHT_LABELS } else { 0.0 };
    let columns = [MARGIN + LABELS, (trend.width - MARGIN - right).max(MARGIN + LABELS + GAP)];
    let mut drawing = Drawing { picture: Picture::default(), columns, top: MARGIN };
    drawing.title(trend);
    for plot in &trend.plots {
        drawing.plot(plot, trend);
    }
    drawing.strips(trend);
    drawing.axis(trend);
    drawing.picture.size = [trend.width, drawing.top + MARGIN];
    drawing.picture
}

struct Drawing {
    picture: Picture,
    /// Left and right end of what has a time.
    columns: [f32; 2],
    /// Where the next part begins.
    top: f32,
}

impl Drawing {
    fn x(&self, part: f32) -> f32 {
        let [left, right] = self.columns;
        left + part * (right - left)
    }

    fn word(&mut self, at: [f32; 2], anchor: Anchor, ink: Ink, text: &str) {
        self.picture.text(at, anchor, SMALLEST_TEXT, ink, text);
    }

    fn title(&mut self, trend: &TrendPicture) {
        let middle = self.top + TITLE / 2.0 - GAP / 2.0;
        self.picture.strong([MARGIN, middle], Anchor::Start, SMALLEST_TEXT + 2.0, Ink::Text, trend.title.as_str());
        self.top += TITLE;
    }

    fn plot(&mut self, plot: &PlotPart, trend: &TrendPicture) {
        for row in legend_rows(&plot.legend, self.columns[1] - self.columns[0]) {
            let (mut x, y) = (self.columns[0], self.top + LEGEND_ROW / 2.0);
            for (name, curve) in row {
                self.picture.line(vec![[x, y], [x + SWATCH, y]], Ink::Curve(curve), 2.0 * LINE);
                self.word([x + SWATCH + TICK, y], Anchor::Start, Ink::Text, name);
                x += entry_width(name);
            }
            self.top += LEGEND_ROW;
        }
        let [left, right] = self.columns;
        let (top, height) = (self.top, trend.height);
        let y = |part: f32| top + part * height;
        for (part, _) in &trend.times {
            let x = self.x(*part);
            self.picture.line(vec![[x, top], [x, y(1.0)]], Ink::Grid, HAIRLINE);
        }
        for (axis, x, anchor) in [(&plot.left, left - TICK, Anchor::End), (&plot.right, right + TICK, Anchor::Start)] {
            let Some(axis) = axis else { continue };
            self.word([x, top + SMALLEST_TEXT / 2.0], anchor, Ink::Quiet, &axis.unit);
            for (part, text) in &axis.ticks {
                if anchor == Anchor::End || plot.left.is_none() {
                    self.picture.line(vec![[left, y(*part)], [right, y(*part)]], Ink::Grid, HAIRLINE);
                }
                if y(*part) > top + 1.5 * SMALLEST_TEXT {
                    self.word([x, y(*part)], anchor, Ink::Quiet, text);
                }
            }
        }
        let area = Area { min: [left, top], max: [right, y(1.0)] };
        self.picture.outline(area, Ink::Grid, HAIRLINE);
        for (curve, line) in &plot.lines {
            let points: Vec<[f32; 2]> = line.iter().map(|[across, down]| [self.x(*across), y(*down)]).collect();
            match points.as_slice() {
                [alone] => self.picture.circle(*alone, DOT, Ink::Curve(*curve)),
                _ => self.picture.line(points, Ink::Curve(*curve), LINE),
            }
        }
        for (part, text) in plot.limits.iter().filter(|(part, _)| (0.0..=1.0).contains(part)) {
            self.picture.line(vec![[left, y(*part)], [right, y(*part)]], Ink::Limit, LINE);
            let above = if *part * height > LEGEND_ROW { -LEGEND_ROW / 2.0 } else { LEGEND_ROW / 2.0 };
            self.word([left + TICK, y(*part) + above], Anchor::Start, Ink::Limit, text);
        }
        self.top = y(1.0) + GAP;
    }

    fn strips(&mut self, trend: &TrendPicture) {
        for strip in &trend.strips {
            let [top, bottom] = [self.top + STRIP_INSET, self.top + STRIP - STRIP_INSET];
            let name_at = [self.columns[0] - TICK, self.top + STRIP / 2.0];
            let longest = (LABELS + MARGIN - TICK) / LETTER;
            self.word(name_at, Anchor::End, Ink::Quiet, &shortened(&strip.name, longest as usize));
            for (from, to, state) in &strip.runs {
                let [left, right] = [self.x(from.clamp(0.0, 1.0)), self.x(to.clamp(0.0, 1.0))];
                let area = Area { min: [left, top], max: [right.max(left + LINE), bottom] };
                let ink = Ink::Curve(strip.curve);
                match state {
                    State::On => self.picture.rect(area, 0.0, ink),
                    State::Off => self.picture.line(vec![[left, bottom], [right, bottom]], ink, HAIRLINE),
                    State::Word(word) => {
                        self.picture.outline(area, ink, HAIRLINE);
                        let room = ((right - left - TICK) / LETTER).max(0.0) as usize;
                        if room >= word.chars().count() {
                            self.word([left + TICK, (top + bottom) / 2.0], Anchor::Start, ink, word);
                        }
                    }
                }
            }
            self.top += STRIP;
        }
    }

    fn axis(&mut self, trend: &TrendPicture) {
        let [left, right] = self.columns;
        if !trend.marks.is_empty() {
            for (part, text) in &trend.marks {
                let at = [self.x(*part), self.top + STRIP / 2.0];
                self.picture.ring(at, TICK, Ink::Text, LINE);
                self.word([at[0] + SWATCH / 1.5, at[1]], Anchor::Start, Ink::Text, text);
            }
            self.top += STRIP;
        }
        self.picture.line(vec![[left, self.top], [right, self.top]], Ink::Quiet, HAIRLINE);
        let (upper, lower) = (self.top + TICK + SMALLEST_TEXT / 2.0 + 2.0, self.top + AXIS - SMALLEST_TEXT / 2.0);
        for (part, text) in &trend.times {
            let x = self.x(*part);
            self.picture.line(vec![[x, self.top], [x, self.top + TICK]], Ink::Quiet, HAIRLINE);
            self.word([x, upper], Anchor::Middle, Ink::Quiet, text);
        }
        let mut end = right - entry_width(&trend.zone);
        for (part, text) in trend.dates.iter().rev() {
            let x = self.x(*part);
            if x + entry_width(text) <= end {
                self.word([x, lower], Anchor::Start, Ink::Quiet, text);
            }
            end = end.min(x);
        }
        self.word([right, lower], Anchor::End, Ink::Quiet, &trend.zone);
        self.top += AXIS;
    }
}

fn entry_width(name: &str) -> f32 {
    name.chars().count() as f32 * LETTER + SWATCH + GAP
}

fn shortened(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most.saturating_sub(1)).chain(['…']).collect()
}

/// As many names in a row as there is room for.
fn legend_rows(legend: &[(u8, String)], room: f32) -> Legend<'_> {
    let mut rows: Legend<'_> = Vec::new();
    let mut used = room;
    for (curve, name) in legend {
        let width = entry_width(name);
        if used + width > room {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += width;
        if let Some(row) = rows.last_mut() {
            row.push((name, *curve));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::super::svg;
    use super::*;

    fn example() -> TrendPicture {
        let axis = AxisPart { unit: "°C".to_owned(), ticks: vec![(0.2, "25".to_owned()), (0.8, "24".to_owned())] };
        let plot = PlotPart {
            legend: vec![(0, "Temperature <1>".to_owned())],
            left: Some(axis),
            right: None,
            lines: vec![(0, vec![[0.0, 0.5], [1.0, 0.25]]), (0, vec![[0.5, 0.5]])],
            limits: vec![(0.1, "High alarm limit 26.00 °C".to_owned()), (-4.0, "out of sight".to_owned())],
        };
        let runs = vec![(-0.1, 0.4, State::Off), (0.4, 0.6, State::On), (0.6, 1.0, State::Word("latched".to_owned()))];
        TrendPicture {
            width: 800.0,
            height: 160.0,
            title: "Trends".to_owned(),
            plots: vec![plot.clone(), plot],
            strips: vec![StripPart { name: "A sensor with a long name".to_owned(), curve: 1, runs }],
            times: vec![(0.25, "09:30".to_owned()), (0.75, "09:40".to_owned())],
            dates: vec![(0.0, "Mon 2 Mar 2026".to_owned())],
            zone: "UTC".to_owned(),
            marks: vec![(0.5, "door opened".to_owned())],
        }
    }

    #[test]
    fn everything_lies_inside_and_words_are_text() {
        let picture = trend_picture(&example());
        let [width, height] = picture.size;
        let inside = |[x, y]: [f32; 2]| (0.0..=width).contains(&x) && (0.0..=height).contains(&y);
        for shape in &picture.shapes {
            match shape {
                super::super::Shape::Line { points, .. } => assert!(points.iter().all(|point| inside(*point))),
                super::super::Shape::Text { at, .. } => assert!(inside(*at), "{shape:?}"),
                super::super::Shape::Rect { area, .. } => assert!(inside(area.min) && inside(area.max)),
                _ => {}
            }
        }
        let words = picture.words();
        for word in ["Temperature <1>", "°C", "09:30", "Mon 2 Mar 2026", "UTC", "latched", "door opened"] {
            assert!(words.contains(&word), "{word} in {words:?}");
        }
        assert!(!words.contains(&"out of sight"));
    }

    #[test]
    fn curves_have_the_colours_that_the_caller_gives_their_numbers() {
        let colours = |ink: Ink| if let Ink::Curve(number) = ink { [number, 0xCC, 0xDD] } else { [0; 3] };
        let text = svg(&trend_picture(&example()), &colours);
        assert!(text.contains("stroke=\"#00CCDD\"") && text.contains("fill=\"#01CCDD\""));
        assert!(text.contains(">Temperature &lt;1&gt;</text>"));
    }

    #[test]
    fn names_wrap_where_the_row_ends() {
        let legend: Vec<(u8, String)> = (0..5).map(|curve| (curve, "Temperature @1".to_owned())).collect();
        assert_eq!(legend_rows(&legend, 300.0).iter().map(Vec::len).collect::<Vec<_>>(), [2, 2, 1]);
    }
}
