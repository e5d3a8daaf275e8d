//! What every plot of the window is made of: a span of time with its axis, a scale of values, and stretches of time
//! during which a state stood still.

pub mod limit;
mod line;
mod runs;
mod scale;
mod time_view;
mod zone;

pub use line::line;
pub use runs::{Run, runs};
pub use scale::Scale;
pub use time_view::{DAY, MINUTE, TimeView};
pub use zone::Zone;
