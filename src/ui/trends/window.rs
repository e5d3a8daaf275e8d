//! The span of time in view: it follows the newest sample until it is paused or moved, and remembers what was in view
//! before.

use std::ops::RangeInclusive;

use eframe::egui::Rangef;

use crate::ui::plot::TimeView;

/// Shortest and longest span, in seconds.
pub const SPANS: RangeInclusive<f64> = 0.1..=400.0 * 86_400.0;
/// Spans to choose from, in seconds.
pub const NAMED: [(f64, &str); 12] = [
    (60.0, "1 min"),
    (300.0, "5 min"),
    (900.0, "15 min"),
    (3_600.0, "1 h"),
    (4.0 * 3_600.0, "4 h"),
    (8.0 * 3_600.0, "8 h"),
    (86_400.0, "1 day"),
    (2.0 * 86_400.0, "2 days"),
    (7.0 * 86_400.0, "7 days"),
    (14.0 * 86_400.0, "14 days"),
    (30.0 * 86_400.0, "30 days"),
    (365.0 * 86_400.0, "1 year"),
];
const DEFAULT_SPAN: f64 = 300.0;
/// Views remembered.
const MOST_BACK: usize = 50;
/// Movements that follow each other within this time, in seconds, are one step back.
const ONE_STEP: f64 = 0.8;
/// This part of the span may lie after the newest sample.
const AHEAD: f64 = 0.5;

#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    span: f64,
    /// The right edge; `None` while the newest is followed.
    end: Option<f64>,
    /// Everything there is and that still comes; the span counts when this ends.
    all: bool,
}

#[derive(Debug)]
pub struct Window {
    place: Place,
    back: Vec<Place>,
    /// When it was moved last, in seconds of the window's clock.
    moved: f64,
}

impl Default for Window {
    fn default() -> Self {
        Self { place: Place { span: DEFAULT_SPAN, end: None, all: false }, back: Vec::new(), moved: f64::NEG_INFINITY }
    }
}

impl Window {
    /// The time in view in words.
    pub fn span_text(&self) -> String {
        if self.place.all { "All".to_owned() } else { span_text(self.place.span) }
    }

    pub fn is_following(&self) -> bool {
        self.place.end.is_none()
    }

    /// What is in view; `known` is the first and last time there is something to see.
    pub fn view(&self, known: [f64; 2], columns: Rangef) -> TimeView {
        let [first, last] = known;
        if self.place.all {
            return TimeView { from: last - clamped(last - first), to: last, columns };
        }
        let span = self.place.span;
        let end = self.place.end.map_or(last, |end| end.min(last + span * AHEAD).max(first));
        TimeView { from: end - span, to: end, columns }
    }

    pub fn follow(&mut self) {
        self.remember();
        self.place.end = None;
    }

    pub fn pause(&mut self, [first, last]: [f64; 2]) {
        let span = if self.place.all { clamped(last - first) } else { self.place.span };
        self.place = Place { span, end: Some(last), all: false };
    }

    /// Another span; the right edge stays.
    pub fn set_span(&mut self, span: f64) {
        self.remember();
        self.place = Place { span: clamped(span), all: false, ..self.place };
    }

    pub fn show(&mut self, from: f64, to: f64) {
        self.remember();
        let span = clamped(to - from);
        let middle = f64::midpoint(from, to);
        self.place = Place { span, end: Some(middle + span / 2.0), all: false };
    }

    /// Everything there is; what comes is taken in too while the newest is followed.
    pub fn all(&mut self, [first, last]: [f64; 2]) {
        self.remember();
        self.place = match self.place.end {
            None => Place { all: true, ..self.place },
            Some(_) => Place { span: clamped(last - first), end: Some(last), all: false },
        };
    }

    /// Brings a time into the middle, unless everything is in view.
    pub fn centre(&mut self, at: f64) {
        if !self.place.all {
            self.remember();
            self.place.end = Some(at + self.place.span / 2.0);
        }
    }

    pub fn pan(&mut self, view: &TimeView, seconds: f64, now: f64) {
        self.remember_once(now);
        self.place = Place { span: view.span(), end: Some(view.to + seconds), all: false };
    }

    /// The time `fixed` stays where it is; while the newest is followed, the right edge does.
    pub fn zoom(&mut self, view: &TimeView, fixed: f64, factor: f64, now: f64) {
        self.remember_once(now);
        let span = clamped(view.span() * factor);
        if self.place.end.is_some() {
            let part = (view.to - fixed) / view.span();
            self.place.end = Some(fixed + part * span);
        }
        (self.place.span, self.place.all) = (span, false);
    }

    /// How many views there are to go back to.
    pub fn steps_back(&self) -> usize {
        self.back.len()
    }

    pub fn back(&mut self) {
        if let Some(place) = self.back.pop() {
            self.place = place;
        }
    }

    fn remember(&mut self) {
        if self.back.last() != Some(&self.place) {
            self.back.push(self.place);
            if self.back.len() > MOST_BACK {
                self.back.remove(0);
            }
        }
    }

    /// A movement goes on in many small steps.
    fn remember_once(&mut self, now: f64) {
        if now - self.moved > ONE_STEP {
            self.remember();
        }
        self.moved = now;
    }
}

fn clamped(span: f64) -> f64 {
    if span.is_finite() { span.clamp(*SPANS.start(), *SPANS.end()) } else { DEFAULT_SPAN }
}

/// `5 min`, `2 h`, `3.5 days`, `250 ms`: a span as people say it.
pub fn span_text(seconds: f64) -> String {
    if let Some((_, name)) = NAMED.iter().find(|(span, _)| (seconds - span).abs() < span * 1e-6) {
        return (*name).to_owned();
    }
    let (value, unit) = match seconds {
        ..1.0 => (seconds * 1e3, "ms"),
        ..120.0 => (seconds, "s"),
        ..7_200.0 => (seconds / 60.0, "min"),
        ..172_800.0 => (seconds / 3_600.0, "h"),
        _ => (seconds / 86_400.0, "days"),
    };
    let text = if value >= 100.0 { format!("{value:.0}") } else { format!("{value:.1}") };
    format!("{} {unit}", text.strip_suffix(".0").unwrap_or(&text))
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: [f64; 2] = [1_000.0, 5_000.0];

    fn view(window: &Window) -> TimeView {
        window.view(KNOWN, Rangef::new(0.0, 600.0))
    }

    #[test]
    fn it_follows_the_newest_until_it_is_moved() {
        let mut window = Window::default();
        assert_eq!((view(&window).from, view(&window).to), (4_700.0, 5_000.0));
        window.zoom(&view(&window), 4_800.0, 0.5, 1.0);
        assert!(window.is_following());
        assert_eq!(view(&window).from, 4_850.0);
        window.pan(&view(&window), -1_000.0, 1.1);
        assert_eq!((window.is_following(), view(&window).to), (false, 4_000.0));
        window.zoom(&view(&window), 3_950.0, 2.0, 1.2);
        assert_eq!((view(&window).from, view(&window).to), (3_750.0, 4_050.0));
        assert_eq!(window.steps_back(), 1, "movements in a row are one step");
        window.back();
        assert_eq!((window.is_following(), window.span_text()), (true, "5 min".to_owned()));
    }

    #[test]
    fn it_stays_where_there_is_something_to_see() {
        let mut window = Window::default();
        window.show(8_000.0, 9_000.0);
        assert_eq!(view(&window).to, 5_500.0);
        window.show(-9_000.0, -8_000.0);
        assert_eq!(view(&window).to, 1_000.0);
        window.all(KNOWN);
        assert_eq!((view(&window).from, view(&window).to), (1_000.0, 5_000.0));
        window.show(3_000.0, 3_000.0);
        assert_eq!(window.span_text(), "100 ms");
    }

    #[test]
    fn everything_grows_with_what_comes_while_it_is_followed() {
        let mut window = Window::default();
        window.all(KNOWN);
        let later = window.view([1_000.0, 6_000.0], Rangef::new(0.0, 600.0));
        assert_eq!((later.from, later.to, window.is_following()), (1_000.0, 6_000.0, true));
        assert_eq!(window.span_text(), "All");
        window.pause([1_000.0, 6_000.0]);
        assert_eq!((window.is_following(), window.view([1_000.0, 7_000.0], later.columns)), (false, later));
    }

    #[test]
    fn spans_are_said_as_people_say_them() {
        let texts = [0.25, 45.0, 300.0, 5_400.0, 86_400.0, 302_400.0].map(span_text);
        assert_eq!(texts, ["250 ms", "45 s", "5 min", "90 min", "1 day", "3.5 days"]);
    }
}
