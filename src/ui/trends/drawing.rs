//! What is in view as a drawing for a file, in the light palette.

use super::area::Area;
use super::axis;
use super::choice::Side;
use super::curve::Curve;
use super::model::{Axis, PlotModel, traces};
use super::scene::Scene;
use crate::picture::{AxisPart, Ink, PlotPart, State, StripPart, TrendPicture, svg, trend_picture};
use crate::record::EventKind;
use crate::ui::theme;
use crate::ui::words;

/// Width of the drawing, and height of one plot in it.
const WIDTH: f32 = 1_000.0;
const PLOT_HEIGHT: f32 = 200.0;

/// The drawing as SVG.
pub fn drawing(area: &Area, scene: &Scene<'_>, name: &str) -> String {
    let shown = area.choice.shown();
    let number = |curve: &Curve<'_>| {
        let place = shown.iter().position(|shown| shown.id == curve.id);
        place.and_then(|place| u8::try_from(place).ok()).unwrap_or(u8::MAX)
    };
    let part = |seconds: f64| scene.view.part(seconds) as f32;
    let count = area.choice.plots(scene.history);
    let models = (0..count).map(|index| PlotModel::new(scene, &area.choice, index, &area.ranges, PLOT_HEIGHT));
    let plots = models.map(|model| plot_part(&model, scene, &number)).collect();
    let states = scene.curves(&area.choice).filter(|(curve, shown)| !curve.is_number() && !shown.hidden);
    let strips = states.map(|(curve, _)| strip_part(&curve, scene, number(&curve))).collect();
    let axis::Words { times, dates, zone } = axis::words(&scene.view, scene.zone);
    let placed = |words: Vec<(f64, String)>| words.into_iter().map(|(at, text)| (part(at), text)).collect();
    let title = format!("{name}, {}", scene.zone.text(scene.view.from, "%-d %b %Y %H:%M:%S"));
    let picture = trend_picture(&TrendPicture {
        width: WIDTH,
        height: PLOT_HEIGHT,
        title,
        plots,
        strips,
        times: placed(times),
        dates: placed(dates),
        zone,
        marks: notes(scene),
    });
    let palette = &theme::LIGHT;
    let colours = |ink: Ink| {
        let of_curve = |place: u8| {
            let shown = shown.get(usize::from(place))?;
            Some(Curve::of(scene.history, shown.id)?.colour(shown.colour, palette))
        };
        let colour = match ink {
            Ink::Curve(place) => of_curve(place).unwrap_or(palette.text),
            other => theme::ink(palette, other),
        };
        [colour.r(), colour.g(), colour.b()]
    };
    svg(&picture, &colours)
}

fn plot_part(model: &PlotModel<'_>, scene: &Scene<'_>, number: &impl Fn(&Curve<'_>) -> u8) -> PlotPart {
    let mut part = PlotPart::default();
    for (curve, shown) in model.curves.iter().filter(|(_, shown)| !shown.hidden) {
        let place = number(curve);
        part.legend.push((place, curve.name()));
        let Some(axis) = model.axis(shown.side).filter(|axis| !axis.scale.empty) else { continue };
        part.lines.extend(traces(curve, &scene.view, &axis.scale).into_iter().map(|trace| (place, trace)));
    }
    part.left = model.axis(Side::Left).map(axis_part);
    part.right = model.axis(Side::Right).map(axis_part);
    for axis in model.axes.iter().filter(|axis| !axis.scale.empty) {
        let several = axis.limits.len() > 1;
        let limits = axis.limits.iter().filter_map(|limit| Some((limit.last()?, limit.name(several))));
        part.limits.extend(limits.map(|(value, text)| ((1.0 - axis.scale.part(value)) as f32, text)));
    }
    part
}

fn axis_part(axis: &Axis) -> AxisPart {
    let ticks = axis.scale.ticks.iter().map(|tick| ((1.0 - axis.scale.part(*tick)) as f32, axis.scale.label(*tick)));
    AxisPart { unit: axis.unit.clone(), ticks: ticks.collect() }
}

fn strip_part(curve: &Curve<'_>, scene: &Scene<'_>, number: u8) -> StripPart {
    let runs = curve.runs(&scene.view).into_iter().map(|run| {
        let state = match (curve.switch(), run.is_on()) {
            (Some(_), true) => State::On,
            (Some(_), false) => State::Off,
            (None, _) => State::Word(curve.word(run.value)),
        };
        (scene.view.part(run.from) as f32, scene.view.part(run.to) as f32, state)
    });
    StripPart { name: curve.name(), curve: number, runs: runs.collect() }
}

fn notes(scene: &Scene<'_>) -> Vec<(f32, String)> {
    let notes = scene.history.events().iter().filter(|event| event.kind == EventKind::Note);
    let placed = notes.map(|event| (words::seconds(event.at), event.text.clone()));
    placed.filter(|(at, _)| scene.view.contains(*at)).map(|(at, text)| (scene.view.part(at) as f32, text)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;
    use crate::record::{History, SeriesKind};
    use crate::ui::plot::{TimeView, Zone};
    use crate::ui::settings::TemperatureUnit;
    use eframe::egui::Rangef;

    #[test]
    fn the_drawing_has_curves_strips_axes_and_names() {
        let mut history = History::default();
        let number = testing::series(&mut history, 1, "temperature_c", SeriesKind::Number { decimals: 2 });
        let motion = testing::series(&mut history, 1, "pir", SeriesKind::Switch);
        for second in 0..100 {
            history.push(number, second * 1_000_000, 2_000 + second % 7);
            history.push(motion, second * 1_000_000, i64::from(second > 50));
        }
        let mut area = Area::default();
        area.choice.keep_up(&history, TemperatureUnit::Celsius, &[]);
        let view = TimeView { from: 0.0, to: 100.0, columns: Rangef::new(0.0, 600.0) };
        let scene = Scene { history: &history, bench: None, view, zone: Zone::Utc, pointer: None };
        let text = drawing(&area, &scene, "bench");
        for part in [">temperature_c</text>", ">pir</text>", ">°C</text>", ">UTC</text>", "#B25600", "<polyline"] {
            assert!(text.contains(part), "{part} in {text}");
        }
    }
}
