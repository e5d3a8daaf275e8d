//! What was read of a recording and is to be added to the history that shows it.

use super::super::history::History;
use super::super::objects::{Event, ModuleId, ModuleInfo, SeriesId, SeriesInfo};
use super::super::trend::{Node, Sample};

/// A piece of a series, in order of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Piece {
    /// A stretch that stays on the disk, and its last sample.
    Stored(SeriesId, Node, Sample),
    Sample(SeriesId, Sample),
}

#[derive(Debug, Clone, Default)]
pub struct News {
    /// New ones and those that have changed.
    pub modules: Vec<(ModuleId, ModuleInfo)>,
    pub series: Vec<SeriesInfo>,
    pub pieces: Vec<Piece>,
    pub events: Vec<Event>,
}

impl News {
    pub fn is_empty(&self) -> bool {
        let Self { modules, series, pieces, events } = self;
        modules.is_empty() && series.is_empty() && pieces.is_empty() && events.is_empty()
    }

    /// Adds it to the history that has all earlier news of the same recording.
    pub fn add_to(self, history: &mut History) {
        for (id, info) in self.modules {
            if history.module_info(id).is_none() {
                // Modules may be described alike; they are two all the same.
                let label = format!("\u{1}{}", id.0);
                history.module(ModuleInfo { label, ..ModuleInfo::default() });
            }
            history.change_module(id, info);
        }
        for info in self.series {
            history.series_for(info);
        }
        for piece in self.pieces {
            match piece {
                Piece::Stored(id, node, last) => {
                    if let Some(trend) = history.trend_mut(id) {
                        trend.push_stored(node, last);
                    }
                }
                Piece::Sample(id, Sample { at, value, gap }) => {
                    if gap {
                        history.mark_gap(id);
                    }
                    history.push(id, at, value);
                }
            }
        }
        self.events.into_iter().for_each(|event| history.add_event(event));
    }
}
