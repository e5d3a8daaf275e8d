//! The program as a whole: its bench with the bus thread, and its window where there is one.

use std::sync::Arc;
#[cfg(not(feature = "window"))]
use std::time::Instant;

#[cfg(feature = "window")]
use super::window::Window;
use crate::bench::{Action, Bench};
use crate::bus::{Bus, LineAddress};
use crate::module::Catalogue;

/// What draws, or without a window what only takes in.
pub struct Program {
    #[cfg(feature = "window")]
    window: Window,
    #[cfg(not(feature = "window"))]
    bench: Bench,
}

impl Program {
    /// Whether pictures are drawn.
    pub const HAS_WINDOW: bool = cfg!(feature = "window");

    /// # Errors
    /// If the bus thread cannot be started.
    pub fn start(line: LineAddress) -> std::io::Result<Self> {
        let (catalogue, faulty) = Catalogue::built_in();
        let catalogue = Arc::new(catalogue);
        let bus = Bus::start(catalogue.clone(), || {})?;
        let bench = Bench::new(bus, catalogue, &faulty);
        Ok(Self::with(bench, line))
    }

    #[cfg(feature = "window")]
    fn with(bench: Bench, line: LineAddress) -> Self {
        Self { window: Window::new(bench, line) }
    }

    #[cfg(not(feature = "window"))]
    fn with(bench: Bench, _line: LineAddress) -> Self {
        Self { bench }
    }

    /// Takes in what the bus has told, and draws the next picture.
    #[cfg(feature = "window")]
    pub fn frame(&mut self) {
        self.window.draw();
    }

    /// Takes in what the bus has told.
    #[cfg(not(feature = "window"))]
    pub fn frame(&mut self) {
        self.bench.drain();
        self.bench.tick(Instant::now());
    }

    pub fn bench(&self) -> &Bench {
        #[cfg(feature = "window")]
        return self.window.bench();
        #[cfg(not(feature = "window"))]
        return &self.bench;
    }

    /// Carries out what a user asks for.
    pub fn apply(&mut self, action: Action) {
        #[cfg(feature = "window")]
        self.window.apply(action);
        #[cfg(not(feature = "window"))]
        self.bench.apply(action);
    }

    /// Shows something else from the next picture on.
    pub fn look_elsewhere(&mut self) {
        #[cfg(feature = "window")]
        self.window.look_elsewhere();
    }

    /// Writes everything that was measured, as at the end of the program.
    pub fn end_recording(&mut self) {
        #[cfg(feature = "window")]
        self.window.end();
        #[cfg(not(feature = "window"))]
        self.bench.end_recording().into_iter().for_each(|text| log::warn!("{text}"));
    }
}
