//! How often the window is drawn anew for what comes in by itself: what comes within one pause is drawn together.

use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::mutex::Mutex;
use eframe::egui::{Context, Plugin, RawInput};

/// The pause while somebody works with the window: thirty pictures a second are enough for an eye.
const IN_USE: Duration = Duration::from_millis(33);
/// The pause while nobody does: numbers can be read as well, a poll of six questions at 9600 bps comes in one picture instead
/// of three, and without a graphics card each costs some 20 ms of processor time.
const LEFT_ALONE: Duration = Duration::from_millis(200);
/// For so long after the last touch of pointer or keyboard somebody works with it.
const TOUCHED: Duration = Duration::from_secs(2);

/// Wakes the window.
#[derive(Clone)]
pub struct Pace {
    ctx: Context,
    touch: Touch,
}

impl Pace {
    /// Watches who works with the window of `ctx`.
    pub fn of(ctx: &Context) -> Self {
        let touch = Touch::default();
        ctx.add_plugin(touch.clone());
        Self { ctx: ctx.clone(), touch }
    }

    /// Has a picture drawn soon. Whatever else comes in until then is in it.
    pub fn wake(&self) {
        self.ctx.request_repaint_after(self.touch.pause(Instant::now()));
    }
}

/// When pointer or keyboard were last used.
#[derive(Clone, Default)]
struct Touch(Arc<Mutex<Option<Instant>>>);

impl Touch {
    fn pause(&self, now: Instant) -> Duration {
        let used = self.0.lock().is_some_and(|last| now.saturating_duration_since(last) < TOUCHED);
        if used { IN_USE } else { LEFT_ALONE }
    }
}

impl Plugin for Touch {
    fn debug_name(&self) -> &'static str {
        "touch"
    }

    fn input_hook(&mut self, _ctx: &Context, input: &mut RawInput) {
        if !input.events.is_empty() {
            *self.0.lock() = Some(Instant::now());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Event, pos2};

    #[test]
    fn who_moves_the_pointer_sees_what_comes_in_sooner() {
        let ctx = Context::default();
        let pace = Pace::of(&ctx);
        let draw = |events| ctx.run_ui(RawInput { events, ..RawInput::default() }, |_| ()).textures_delta.clear();
        draw(Vec::new());
        assert_eq!(pace.touch.pause(Instant::now()), LEFT_ALONE);
        draw(vec![Event::PointerMoved(pos2(1.0, 1.0))]);
        assert_eq!(pace.touch.pause(Instant::now()), IN_USE);
        assert_eq!(pace.touch.pause(Instant::now() + TOUCHED), LEFT_ALONE);
    }
}
