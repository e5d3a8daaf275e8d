//! What happened, as marks above the axis of time: notes with their words, and what matters for reading the curves.

use std::collections::VecDeque;

use eframe::egui::{Align, Rect, Role, Sense, Stroke, Ui, pos2, vec2};

use super::scene::Scene;
use crate::record::{Event, EventKind, History};
use crate::ui::plot::TimeView;
use crate::ui::tables::kind_mark;
use crate::ui::words;
use crate::ui::{theme, widgets};

/// Kinds that are marked, the most important first. Motion and relays have strips.
const MARKED: [EventKind; 6] =
    [EventKind::Note, EventKind::Alarm, EventKind::Lost, EventKind::Watchdog, EventKind::Written, EventKind::Found];
/// Events of one mark that are looked at, for its form and for what the pointer is told.
const MOST_TOLD: usize = 8;

/// The marked events of a history in order of time.
#[derive(Debug, Default)]
pub struct Markers {
    /// Time in seconds since 1970, and the event's number since the beginning.
    events: VecDeque<(f64, u64)>,
    /// The number of the next event to be looked at.
    next: u64,
    /// How often the history had put events before others when it was looked at.
    reordered: u64,
}

/// Events that are too near each other to be told apart.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cluster {
    /// Places in the list.
    first: usize,
    end: usize,
}

impl Markers {
    /// Takes in events that are new and forgets those that the history has forgotten.
    fn keep_up(&mut self, history: &History) {
        let forgotten = history.events_forgotten();
        let total = forgotten.saturating_add(history.events().len() as u64);
        let reordered = history.events_reordered();
        if total < self.next || reordered != self.reordered {
            *self = Self { reordered, ..Self::default() };
        }
        let known = usize::try_from(self.next.saturating_sub(forgotten)).unwrap_or(usize::MAX);
        for (event, number) in history.events().iter().skip(known).zip(self.next.max(forgotten)..) {
            if MARKED.contains(&event.kind) {
                self.events.push_back((words::seconds(event.at), number));
            }
        }
        self.next = total;
        while self.events.front().is_some_and(|(_, number)| *number < forgotten) {
            self.events.pop_front();
        }
    }

    fn event<'a>(&self, history: &'a History, place: usize) -> Option<&'a Event> {
        let (_, number) = self.events.get(place)?;
        let index = usize::try_from(number.checked_sub(history.events_forgotten())?).ok()?;
        history.events().get(index)
    }

    /// What is to be marked in the view: few steps, however many events there are.
    fn clusters(&self, view: &TimeView) -> Vec<Cluster> {
        let reach = view.seconds_per_point() * f64::from(theme::EVENT_DISTANCE);
        let mut clusters = Vec::new();
        let mut first = self.events.partition_point(|(at, _)| *at < view.from);
        while let Some((at, _)) = self.events.get(first).filter(|(at, _)| *at <= view.to) {
            let end = self.events.partition_point(|(other, _)| *other < at + reach).max(first.saturating_add(1));
            clusters.push(Cluster { first, end });
            first = end;
        }
        clusters
    }

    /// Draws the marks into `row`; the time of one that was clicked. `rows` is what a mark's line goes through.
    pub fn show(&mut self, ui: &Ui, row: Rect, rows: Rect, scene: &Scene<'_>) -> Option<f64> {
        self.keep_up(scene.history);
        let clusters = self.clusters(&scene.view);
        let mut clicked = None;
        for (index, cluster) in clusters.iter().enumerate() {
            let next = clusters.get(index.saturating_add(1)).and_then(|next| self.events.get(next.first));
            let end = next.map_or(row.right(), |(at, _)| scene.view.x(*at) - theme::EVENT_DISTANCE);
            clicked = self.mark(ui, row, rows, end, *cluster, scene).or(clicked);
        }
        clicked
    }

    fn mark(&self, ui: &Ui, row: Rect, rows: Rect, end: f32, cluster: Cluster, scene: &Scene<'_>) -> Option<f64> {
        let palette = theme::palette(ui);
        let told: Vec<&Event> = (cluster.first..cluster.end.min(cluster.first.saturating_add(MOST_TOLD)))
            .filter_map(|place| self.event(scene.history, place))
            .collect();
        let rank = |event: &&&Event| MARKED.iter().position(|kind| *kind == event.kind);
        let event = *told.iter().min_by_key(rank)?;
        let (at, _) = *self.events.get(cluster.first)?;
        let centre = pos2(scene.view.x(at), row.center().y);
        let (glyph, colour) = kind_mark(event.kind, palette);
        let is_note = event.kind == EventKind::Note;
        let colour = if is_note { palette.accent } else { colour };
        widgets::paint_glyph(ui.painter(), glyph, centre, theme::GLYPH - theme::OUTLINE, colour);
        let room = Rect::from_x_y_ranges(centre.x + theme::GAP..=end.max(centre.x + theme::GAP), row.y_range());
        if is_note {
            let room = room.with_max_x(room.right().min(room.left() + theme::NOTE_NAME));
            widgets::line_in(ui, room, Align::Min, &event.text, theme::small(), palette.text);
        }
        let place = Rect::from_center_size(centre, vec2(theme::EVENT_DISTANCE, row.height()));
        let (_, number) = *self.events.get(cluster.first)?;
        let response = ui.interact(place, ui.scope_id().with(("event", number)), Sense::click());
        widgets::describe(&response, Role::Button, &format!("{}: {}", event.kind.label(), event.text));
        if response.hovered() || response.has_focus() {
            ui.painter().vline(centre.x, rows.y_range(), Stroke::new(theme::HAIRLINE, colour));
        }
        let clicked = response.clicked();
        let more = cluster.end.saturating_sub(cluster.first).saturating_sub(told.len());
        response.on_hover_ui(|ui| {
            told.iter().for_each(|event| drop(ui.label(line(event, scene))));
            if more > 0 {
                widgets::quiet(ui, &format!("and {more} more – zoom in to see them"));
            }
        });
        clicked.then_some(at)
    }
}

fn line(event: &Event, scene: &Scene<'_>) -> String {
    let module = event.module.and_then(|module| scene.history.module_info(module));
    let module = module.map(|module| format!("{module}  ")).unwrap_or_default();
    format!("{}  {module}{}", scene.zone.clock(words::seconds(event.at), 1), event.text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Rangef;
    use jiff::Timestamp;

    fn event(second: i64, kind: EventKind) -> Event {
        let at = Timestamp::from_second(second).unwrap();
        Event { at, module: None, kind, text: format!("at {second}"), change: None }
    }

    fn texts(markers: &Markers, history: &History, from: f64, to: f64) -> Vec<Vec<String>> {
        let view = TimeView { from, to, columns: Rangef::new(0.0, 600.0) };
        let of =
            |cluster: &Cluster| (cluster.first..cluster.end).map(|at| markers.event(history, at).unwrap().text.clone());
        markers.clusters(&view).iter().map(|cluster| of(cluster).collect()).collect()
    }

    #[test]
    fn marks_stand_in_order_of_time_and_near_ones_are_one() {
        let (mut history, mut markers) = (History::default(), Markers::default());
        for (second, kind) in [(100, EventKind::Alarm), (101, EventKind::Motion), (200, EventKind::Lost)] {
            history.add_event(event(second, kind));
        }
        markers.keep_up(&history);
        history.add_event(event(150, EventKind::Note));
        history.add_event(event(201, EventKind::Found));
        markers.keep_up(&history);
        assert_eq!(texts(&markers, &history, 90.0, 300.0), [vec!["at 100"], vec!["at 150"], vec!["at 200", "at 201"]]);
        assert_eq!(texts(&markers, &history, 120.0, 160.0), [["at 150"]]);
    }

    #[test]
    fn another_history_is_looked_at_anew() {
        let (mut history, mut markers) = (History::default(), Markers::default());
        history.add_event(event(100, EventKind::Alarm));
        markers.keep_up(&history);
        markers.keep_up(&History::default());
        assert!(markers.events.is_empty());
    }
}
