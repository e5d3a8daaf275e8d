//! What the parts of a trend view have in common while they are drawn.

use crate::bench::Bench;
use crate::record::History;
use crate::ui::plot::{DAY, TimeView, Zone};

use super::choice::{Choice, Shown};
use super::curve::{Curve, Value};

/// How far from a time a sample may lie that has a gap on one side, in points.
const REACH_POINTS: f64 = 6.0;

pub struct Scene<'a> {
    pub history: &'a History,
    /// What is known beside the history; `None` for a recording.
    pub bench: Option<&'a Bench>,
    pub view: TimeView,
    pub zone: Zone,
    /// The pointer's time, in seconds since 1970 UTC.
    pub pointer: Option<f64>,
}

impl<'a> Scene<'a> {
    pub fn value(&self, curve: &Curve<'_>, at: f64) -> Option<Value> {
        curve.value_at(at, self.view.seconds_per_point() * REACH_POINTS)
    }

    /// What is shown, in its order.
    pub fn curves<'c>(&self, choice: &'c Choice) -> impl Iterator<Item = (Curve<'a>, &'c Shown)> {
        choice.shown().iter().filter_map(|shown| Some((Curve::of(self.history, shown.id)?, shown)))
    }

    /// The time to what can be told apart in this view, with its date where the view has several.
    pub fn clock(&self, seconds: f64) -> String {
        if self.view.span() >= DAY {
            return self.zone.text(seconds, "%-d %b %H:%M:%S");
        }
        let decimals = match self.view.seconds_per_point() {
            ..0.1 => 3,
            ..1.0 => 1,
            _ => 0,
        };
        self.zone.clock(seconds, decimals)
    }
}
