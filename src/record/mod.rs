//! Samples over time, in memory, and files that are written beside the work. Knows neither buses nor windows.

mod trend;
mod writer;

pub use trend::Trend;
pub use writer::FileWriter;
