//! The real window, laid out and cut into triangles without a screen.

use std::time::Instant;

use eframe::App as _;
use eframe::egui::{self, Event, Key, Modifiers, RawInput, Rect, pos2, vec2};

use crate::bench::{Action, Bench};
use crate::bus::{LineAddress, Target};
use crate::ui::{App, LineChoice, Settings, Start};

/// In points.
const SIZE: egui::Vec2 = vec2(1_280.0, 800.0);
/// Pages of a module that are looked at before something else is.
const PAGES: usize = 3;

/// The window, and where in it one looks.
pub struct Window {
    app: App,
    ctx: egui::Context,
    frame: eframe::Frame,
    begin: Instant,
    keys: Vec<Event>,
    step: usize,
}

/// What is looked at in turn.
enum Look {
    Module(usize),
    NextPage,
    Keys(Key),
}

impl Window {
    pub fn new(bench: Bench, simulated: LineAddress) -> Self {
        let ctx = egui::Context::default();
        let settings = Settings { line: LineChoice::Simulated, ..Settings::default() };
        let app = App::new(&ctx, bench, Start { simulated, demo: false, settings }).without_system_dialogs();
        let frame = eframe::Frame::_new_kittest();
        Self { app, ctx, frame, begin: Instant::now(), keys: Vec::new(), step: 0 }
    }

    pub fn bench(&self) -> &Bench {
        self.app.bench()
    }

    pub fn apply(&mut self, action: Action) {
        self.app.apply(action);
    }

    /// One picture.
    pub fn draw(&mut self) {
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), SIZE)),
            time: Some(self.begin.elapsed().as_secs_f64()),
            events: std::mem::take(&mut self.keys),
            ..RawInput::default()
        };
        let Self { app, ctx, frame, .. } = self;
        let mut output = ctx.run_ui(input, |ui| {
            app.logic(ui.ctx(), frame);
            app.ui(ui, frame);
        });
        // The renderer's business.
        output.textures_delta.clear();
        let triangles = ctx.tessellate(output.shapes, output.pixels_per_point);
        std::hint::black_box(triangles);
    }

    /// Shows something else from the next picture on: a module, more pages of it, the plots, the traffic, the dashboard.
    pub fn look_elsewhere(&mut self) {
        let look = look(self.step);
        self.step = self.step.wrapping_add(1);
        match look {
            Look::Module(number) => {
                let modules: Vec<Target> = self.bench().modules().iter().map(|module| module.target).collect();
                let place = number.checked_rem(modules.len()).and_then(|place| modules.get(place));
                if let Some(target) = place {
                    self.apply(Action::Show(*target));
                }
            }
            Look::NextPage => self.press(Key::PageDown),
            Look::Keys(key) => self.press(key),
        }
    }

    fn press(&mut self, key: Key) {
        let modifiers = Modifiers::COMMAND | Modifiers::CTRL;
        let event = |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
        self.keys.extend([event(true), event(false)]);
    }

    /// As when the window is closed.
    pub fn end(&mut self) {
        self.app.on_exit(None);
    }
}

fn look(step: usize) -> Look {
    let rest = [Look::Keys(Key::G), Look::Keys(Key::T), Look::Keys(Key::D)];
    let round = PAGES.saturating_add(rest.len());
    let (number, place) = (step / round.max(1), step % round.max(1));
    match place.checked_sub(PAGES) {
        None if place == 0 => Look::Module(number),
        None => Look::NextPage,
        Some(place) => rest.into_iter().nth(place).unwrap_or(Look::NextPage),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_shows_a_module_with_its_pages_and_everything_else() {
        let word = |step| match look(step) {
            Look::Module(number) => format!("module {number}"),
            Look::NextPage => "page".to_owned(),
            Look::Keys(key) => format!("{key:?}"),
        };
        let words: Vec<String> = (0..7).map(word).collect();
        assert_eq!(words, ["module 0", "page", "page", "G", "T", "D", "module 1"]);
    }
}
