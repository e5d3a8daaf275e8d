//! Samples and events over time, in memory and on the disk, and files that are written beside the work. Knows neither
//! buses nor windows.

mod export;
mod history;
mod objects;
mod store;
mod trend;
mod whole;
mod writer;

pub use export::{
    EventRows, Export, ExportError, ExportJob, Format, Progress, Rows, Source, column_name, module_names,
};
pub use history::{History, MOST_EVENTS, Record, Series};
pub use objects::{
    Change, Event, EventKind, ModuleId, ModuleInfo, SeriesId, SeriesInfo, SeriesKind, micros_of, timestamp,
};
pub use store::{
    Archive, Destination, Fetcher, Files, Keeping, Recorder, Recording, RecordingStatus, StoreError, Viewer,
};
pub use trend::{Around, BLOCK, Block, Columns, Micros, Node, Point, Sample, Statistics, Trend, micros, seconds};
pub(crate) use whole::{check_writable, write_whole};
pub use writer::FileWriter;
