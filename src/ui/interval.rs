//! Choosing how often a module is polled.

use std::time::Duration;

use eframe::egui::{Id, Key, TextEdit, Ui};

use super::{theme, widgets, words};

/// Poll intervals to choose from, in milliseconds; 0 is as fast as the line allows.
const CHOICES: [u64; 8] = [0, 200, 500, 1_000, 2_000, 5_000, 10_000, 60_000];
/// The longest interval that may be typed: a day.
const LONGEST: f64 = 86_400.0;

/// A list of intervals, with a field for others. The interval that was chosen just now.
pub fn selector(ui: &mut Ui, id: &str, name: &str, width: f32, interval: Duration) -> Option<Duration> {
    let text = match interval {
        Duration::ZERO => words::interval(Duration::ZERO),
        interval => format!("every {}", words::interval(interval)),
    };
    let mut chosen = None;
    let combo = widgets::combo(id, width, &text);
    let response = combo.show_ui(ui, |ui| {
        for choice in CHOICES.map(Duration::from_millis) {
            if ui.selectable_label(interval == choice, words::interval(choice)).clicked() {
                chosen = Some(choice);
            }
        }
        chosen = chosen.or_else(|| other(ui, id));
        if chosen.is_some() {
            ui.close();
        }
    });
    widgets::name_combo(&response.response, name, &text);
    response.response.on_hover_text("How often the module is asked for its readings");
    chosen
}

/// A field for seconds; Enter takes it.
fn other(ui: &mut Ui, id: &str) -> Option<Duration> {
    let key = Id::unique(("other interval", id));
    let mut typed: String = ui.data_mut(|data| data.get_temp(key)).unwrap_or_default();
    let mut chosen = None;
    ui.horizontal(|ui| {
        widgets::quiet(ui, "Other");
        let field = ui.add(TextEdit::singleline(&mut typed).desired_width(theme::FORM_UNIT).hint_text("0.25"));
        widgets::name_field(&field, "Other interval in seconds", &typed);
        let field = field.on_hover_text("Seconds from 0 to 86400, such as 0.25; Enter takes it");
        widgets::quiet(ui, "s");
        let parsed = parse(&typed);
        if field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
            chosen = parsed;
        }
    });
    ui.data_mut(|data| data.insert_temp(key, if chosen.is_some() { String::new() } else { typed }));
    chosen
}

fn parse(text: &str) -> Option<Duration> {
    let seconds: f64 = text.trim().replace(',', ".").parse().ok()?;
    if (0.0..=LONGEST).contains(&seconds) { Duration::try_from_secs_f64(seconds).ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_is_a_number_of_seconds_within_a_day() {
        assert_eq!(parse("0.25"), Some(Duration::from_millis(250)));
        assert_eq!(parse(" 1,5 "), Some(Duration::from_millis(1_500)));
        for wrong in ["", "fast", "-1", "1e9", "NaN", "inf"] {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
    }
}
