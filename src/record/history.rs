//! Everything that was measured and that happened, in order of time: the live one of the bench, or that of a recording.

use super::objects::{Event, ModuleId, ModuleInfo, SeriesId, SeriesInfo};
use super::trend::{Micros, Sample, Trend};

/// Events kept in memory; the oldest are forgotten (a recording has them all).
pub const MOST_EVENTS: usize = 200_000;
/// Samples kept in memory, of all series together: 12 bytes each.
const MOST_RESIDENT: usize = if cfg!(test) { 30_000 } else { 3_000_000 };

/// A piece of news for a recording, in the order in which it came.
#[derive(Debug, Clone, PartialEq)]
pub enum Record {
    /// A new module, or what is known of one has changed.
    Module(ModuleId, ModuleInfo),
    Series(SeriesId, SeriesInfo),
    Sample(SeriesId, Sample),
    Event(Event),
}

/// A series with its samples.
#[derive(Debug, Clone)]
pub struct Series {
    pub info: SeriesInfo,
    pub trend: Trend,
}

/// Modules, their series and what happened. Nothing is taken out of the lists, so that ids are places in them.
#[derive(Debug, Clone, Default)]
pub struct History {
    modules: Vec<ModuleInfo>,
    series: Vec<Series>,
    events: std::collections::VecDeque<Event>,
    /// Events that were forgotten, so that the n-th that ever was is known by its number.
    forgotten: u64,
    /// How often an event was put before others that were there.
    reordered: u64,
    /// What a recording has not been told yet; nothing while nobody records.
    news: Option<Vec<Record>>,
    /// Samples in memory, as it was counted last.
    resident: usize,
    /// Below that there is no use in tidying again.
    tidy_at: usize,
}

impl History {
    /// The module with this description, added if it is not there.
    pub fn module(&mut self, info: ModuleInfo) -> ModuleId {
        if let Some(place) = self.modules.iter().position(|known| *known == info) {
            return module_id(place);
        }
        let id = module_id(self.modules.len());
        self.tell(|| Record::Module(id, info.clone()));
        self.modules.push(info);
        id
    }

    /// The module is described in another way from now on: it was given another address, or told its name.
    pub fn change_module(&mut self, id: ModuleId, info: ModuleInfo) {
        if let Some(known) = self.modules.get_mut(place(id.0)).filter(|known| **known != info) {
            *known = info.clone();
            self.tell(|| Record::Module(id, info));
        }
    }

    /// The series of this item, added if it is not there.
    pub fn series_for(&mut self, info: SeriesInfo) -> SeriesId {
        if let Some(id) = self.series_of(info.module, &info.item) {
            return id;
        }
        let id = series_id(self.series.len());
        self.tell(|| Record::Series(id, info.clone()));
        let trend = Trend::new(info.kind.decimals());
        self.series.push(Series { info, trend });
        id
    }

    /// Adds a sample; one that is not later than the series' last is dropped.
    pub fn push(&mut self, id: SeriesId, at: Micros, value: i64) {
        let Some(series) = self.series.get_mut(place(id.0)) else { return };
        if let Some(sample) = series.trend.push(at, value) {
            self.resident = self.resident.saturating_add(1);
            self.tell(|| Record::Sample(id, sample));
        }
    }

    /// Samples of the series are missing from here on.
    pub fn mark_gap(&mut self, id: SeriesId) {
        if let Some(series) = self.series.get_mut(place(id.0)) {
            series.trend.mark_gap();
        }
    }

    pub fn add_event(&mut self, event: Event) {
        self.tell(|| Record::Event(event.clone()));
        if self.events.len() >= MOST_EVENTS {
            self.events.pop_front();
            self.forgotten = self.forgotten.saturating_add(1);
        }
        let place =
            self.events.iter().rposition(|known| known.at <= event.at).map_or(0, |place| place.saturating_add(1));
        if place < self.events.len() {
            self.reordered = self.reordered.saturating_add(1);
        }
        self.events.insert(place, event);
    }

    /// Whether something that was looked at is on the disk only.
    pub fn is_wanting(&self) -> bool {
        self.series.iter().any(|series| series.trend.is_wanting())
    }

    /// Adds a series' stretch that is on the disk only; for whoever opens a recording.
    pub fn trend_mut(&mut self, id: SeriesId) -> Option<&mut Trend> {
        self.series.get_mut(place(id.0)).map(|series| &mut series.trend)
    }

    /// Takes in samples that are on the disk and were wanted ([`Trend::fill`]).
    pub fn fill(&mut self, id: SeriesId, samples: &[Sample]) {
        if let Some(series) = self.series.get_mut(place(id.0)) {
            let more = series.trend.fill(samples);
            self.resident = self.resident.saturating_add(more);
        }
    }

    pub fn modules(&self) -> impl ExactSizeIterator<Item = (ModuleId, &ModuleInfo)> {
        self.modules.iter().enumerate().map(|(place, info)| (module_id(place), info))
    }

    pub fn module_info(&self, id: ModuleId) -> Option<&ModuleInfo> {
        self.modules.get(place(id.0))
    }

    /// In the order in which they were read first.
    pub fn series(&self) -> impl ExactSizeIterator<Item = (SeriesId, &Series)> {
        self.series.iter().enumerate().map(|(place, series)| (series_id(place), series))
    }

    pub fn get(&self, id: SeriesId) -> Option<&Series> {
        self.series.get(place(id.0))
    }

    pub fn series_of(&self, module: ModuleId, item: &str) -> Option<SeriesId> {
        let is_it = |series: &Series| series.info.module == module && series.info.item == item;
        self.series.iter().position(is_it).map(series_id)
    }

    /// Oldest first.
    pub fn events(&self) -> &std::collections::VecDeque<Event> {
        &self.events
    }

    /// How many events were forgotten: the number of the oldest that is still there.
    pub fn events_forgotten(&self) -> u64 {
        self.forgotten
    }

    /// Changes when an event was put before others, so that places that were noted are not true any more.
    pub fn events_reordered(&self) -> u64 {
        self.reordered
    }

    /// First and last time of all samples, in microseconds.
    pub fn span(&self) -> Option<[Micros; 2]> {
        let first = |series: &Series| series.trend.blocks().first().map(|block| block.node.first);
        let last = |series: &Series| series.trend.last_sample().map(|sample| sample.at);
        Some([self.series.iter().filter_map(first).min()?, self.series.iter().filter_map(last).max()?])
    }

    /// From now on news are kept for a recording, which gets to know first what there is.
    pub fn begin_news(&mut self) {
        let modules = self.modules().map(|(id, info)| Record::Module(id, info.clone()));
        let series = self.series().map(|(id, series)| Record::Series(id, series.info.clone()));
        self.news = Some(modules.chain(series).collect());
    }

    /// Nobody records any more.
    pub fn end_news(&mut self) {
        self.news = None;
    }

    /// What is new since this was last asked.
    pub fn take_news(&mut self) -> Vec<Record> {
        self.news.as_mut().map(std::mem::take).unwrap_or_default()
    }

    fn tell(&mut self, record: impl FnOnce() -> Record) {
        if let Some(news) = &mut self.news {
            news.push(record());
        }
    }

    /// Keeps the memory bounded: samples that a recording has saved, which is everything before `saved`, are given up and
    /// fetched again when they are looked at. Where that is not enough, because nothing is recorded or the disk cannot be
    /// written for long, the oldest are forgotten.
    pub fn tidy(&mut self, saved: Option<Micros>, recording: bool) {
        if self.resident <= self.tidy_at.max(MOST_RESIDENT) {
            return;
        }
        let wanted = MOST_RESIDENT / 4 * 3;
        self.resident = self.series.iter().map(|series| series.trend.resident()).sum();
        if let Some(saved) = saved {
            self.give_up(saved, wanted);
        }
        // What waits for the disk is also wanted in the plots, for a while.
        let most = if recording { MOST_RESIDENT.saturating_mul(2) } else { MOST_RESIDENT };
        if self.resident > most {
            self.forget(wanted);
        }
        self.tidy_at = self.resident.saturating_add(MOST_RESIDENT / 64);
    }

    /// First what was never looked at since long, then the rest.
    fn give_up(&mut self, saved: Micros, wanted: usize) {
        // What is in view now stays, however much it is: it would only be fetched again.
        for looks in [256, 32, 4] {
            for series in &mut self.series {
                let look = series.trend.looks().saturating_sub(looks);
                let given_up = series.trend.give_up(saved, look);
                self.resident = self.resident.saturating_sub(given_up);
                if self.resident <= wanted {
                    return;
                }
            }
        }
    }

    fn forget(&mut self, wanted: usize) {
        let share = wanted.checked_div(self.series.len()).unwrap_or(wanted);
        for series in &mut self.series {
            let surplus = series.trend.resident().saturating_sub(share);
            if surplus > 0 {
                series.trend.forget_oldest(surplus);
            }
        }
        self.resident = self.series.iter().map(|series| series.trend.resident()).sum();
    }
}

fn place(id: u32) -> usize {
    usize::try_from(id).unwrap_or(usize::MAX)
}

fn module_id(place: usize) -> ModuleId {
    ModuleId(u32::try_from(place).unwrap_or(u32::MAX))
}

fn series_id(place: usize) -> SeriesId {
    SeriesId(u32::try_from(place).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::SeriesKind;

    fn history() -> (History, SeriesId) {
        let mut history = History::default();
        let module = history.module(ModuleInfo { address: 1, label: "PIR-234".into(), ..ModuleInfo::default() });
        let (item, label, unit) = ("temperature_c".into(), "Temperature".into(), "°C".into());
        let id = history.series_for(SeriesInfo { module, item, label, unit, kind: SeriesKind::Number { decimals: 2 } });
        (history, id)
    }

    #[test]
    fn the_same_module_and_item_are_known_again() {
        let (mut history, id) = history();
        let (module, info) = history.modules().next().map(|(id, info)| (id, info.clone())).unwrap();
        assert_eq!(history.module(info), module);
        let info = history.get(id).unwrap().info.clone();
        assert_eq!(history.series_for(info), id);
        assert_eq!(history.series().len(), 1);
    }

    #[test]
    fn a_note_about_an_earlier_time_stands_among_the_events_of_that_time() {
        let mut history = History::default();
        for (second, text) in [(10, "a"), (20, "b"), (15, "note"), (20, "c")] {
            let (module, kind, change) = (None, crate::record::EventKind::Note, None);
            let at = crate::record::timestamp(second * 1_000_000);
            history.add_event(Event { at, module, kind, text: text.into(), change });
        }
        let texts: Vec<&str> = history.events().iter().map(|event| event.text.as_str()).collect();
        assert_eq!(texts, ["a", "note", "b", "c"]);
        assert_eq!(history.events_reordered(), 1);
    }

    #[test]
    fn a_recording_that_begins_later_gets_to_know_what_there_is() {
        let (mut history, id) = history();
        history.push(id, 1, 2_499);
        assert!(history.take_news().is_empty());
        history.begin_news();
        history.push(id, 2, 2_500);
        let news = history.take_news();
        assert!(matches!(news.as_slice(), [Record::Module(..), Record::Series(..), Record::Sample(of, sample)]
            if *of == id && sample.value == 2_500));
        assert!(history.take_news().is_empty());
    }

    #[test]
    fn without_a_recording_the_memory_is_bounded_and_the_newest_stay() {
        let (mut history, id) = history();
        for at in 0..310_000 {
            history.push(id, at, at);
            history.tidy(None, false);
        }
        let trend = &history.get(id).unwrap().trend;
        assert!(trend.resident() <= MOST_RESIDENT + MOST_RESIDENT / 32);
        assert_eq!(trend.last_sample().unwrap().at, 309_999);
        assert_eq!(trend.len(), trend.resident() as u64);
    }

    #[test]
    fn a_disk_that_cannot_be_written_for_long_does_not_fill_the_memory() {
        let (mut history, id) = history();
        for at in 0..310_000 {
            history.push(id, at, at);
            history.tidy(Some(0), true);
        }
        let trend = &history.get(id).unwrap().trend;
        assert!(trend.resident() <= 2 * MOST_RESIDENT + MOST_RESIDENT / 32);
        assert_eq!(trend.last_sample().unwrap().at, 309_999);
    }

    #[test]
    fn with_a_recording_nothing_is_forgotten() {
        let (mut history, id) = history();
        for at in 0..310_000 {
            history.push(id, at, at);
            history.tidy(Some(at), true);
        }
        let trend = &history.get(id).unwrap().trend;
        assert!(trend.resident() <= MOST_RESIDENT + MOST_RESIDENT / 32);
        assert_eq!(trend.len(), 310_000);
    }
}
