//! Samples over time, in memory. Knows neither buses nor windows.

mod trend;

pub use trend::Trend;
