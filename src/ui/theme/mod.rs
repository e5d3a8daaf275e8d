//! Every colour, size and font of the window. Nothing else in this room names a colour or a length.
//!
//! Text has a contrast of at least 4.5 to 1 on both grounds, marks at least 3 to 1 (WCAG 2.2, 1.4.3 and 1.4.11); a test
//! holds them to it.

use eframe::egui::{
    self, Color32, CornerRadius, FontFamily, FontId, Margin, Shadow, Stroke, Style, TextStyle, Theme, Visuals, vec2,
};

mod palette;
mod sizes;

pub use palette::*;
pub use sizes::*;

/// The frame of a row or list: its ground and the room around what it holds.
pub fn panel_frame(palette: &Palette) -> egui::Frame {
    egui::Frame::new().fill(palette.panel).inner_margin(Margin::symmetric(8, 8))
}

pub fn bar_frame(palette: &Palette) -> egui::Frame {
    egui::Frame::new().fill(palette.panel).inner_margin(Margin::symmetric(8, 2))
}

pub fn list_frame(palette: &Palette) -> egui::Frame {
    egui::Frame::new().fill(palette.panel)
}

pub fn ground_frame(palette: &Palette) -> egui::Frame {
    egui::Frame::new().fill(palette.ground).inner_margin(Margin { left: 16, right: 16, top: 12, bottom: 8 })
}

/// The part below a list that tells more of its chosen line.
pub fn details_frame() -> egui::Frame {
    egui::Frame::new().inner_margin(Margin { left: 0, right: 0, top: 8, bottom: 0 })
}

/// A list at the left of what it rules.
pub fn beside_frame() -> egui::Frame {
    egui::Frame::new().inner_margin(Margin { left: 0, right: 8, top: 0, bottom: 0 })
}

/// What stands at the right of such a list.
pub fn behind_list_frame() -> egui::Frame {
    egui::Frame::new().inner_margin(Margin { left: 12, right: 8, top: 0, bottom: 0 })
}

/// The column of bytes, of what the fixed columns leave to it and to their meaning.
pub fn bytes_width(room: f32) -> f32 {
    let [least, most] = BYTES_RANGE;
    (room * BYTES_PART).round().clamp(least, most)
}

pub fn guide_frame(palette: &Palette) -> egui::Frame {
    let edge = Stroke::new(HAIRLINE, palette.raised_pressed);
    egui::Frame::new().fill(palette.panel).stroke(edge).corner_radius(ROUNDING).inner_margin(GUIDE_MARGIN)
}

pub fn error_frame(palette: &Palette) -> egui::Frame {
    egui::Frame::new().fill(palette.error_ground).inner_margin(Margin::symmetric(8, 4))
}

/// Gives both themes their looks.
pub fn apply(ctx: &egui::Context) {
    ctx.set_style_of(Theme::Dark, style(&DARK, Visuals::dark()));
    ctx.set_style_of(Theme::Light, style(&LIGHT, Visuals::light()));
}

fn style(palette: &Palette, base: Visuals) -> Style {
    let mut style = Style { animation_time: 0.0, visuals: visuals(palette, base), ..Style::default() };
    style.text_styles = [
        (TextStyle::Small, small()),
        (TextStyle::Body, body()),
        (TextStyle::Button, body()),
        (TextStyle::Heading, heading()),
        (TextStyle::Monospace, FontId::new(BODY, FontFamily::Monospace)),
    ]
    .into();
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(GAP, UNIT);
    spacing.button_padding = vec2(GAP, UNIT);
    spacing.interact_size = vec2(CONTROL_HEIGHT, CONTROL_HEIGHT);
    spacing.menu_margin = Margin::same(8);
    spacing.combo_width = 0.0;
    spacing.combo_height = NOTICES_HEIGHT;
    style
}

fn visuals(palette: &Palette, base: Visuals) -> Visuals {
    let mut visuals = base;
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.extreme_bg_color = palette.ground;
    visuals.faint_bg_color = palette.panel;
    visuals.code_bg_color = palette.raised;
    visuals.text_edit_bg_color = Some(palette.ground);
    visuals.weak_text_color = Some(palette.quiet);
    visuals.hyperlink_color = palette.accent;
    visuals.warn_fg_color = palette.warning;
    visuals.error_fg_color = palette.error;
    visuals.window_stroke = Stroke::new(HAIRLINE, palette.raised_pressed);
    visuals.window_shadow = Shadow::NONE;
    visuals.popup_shadow = Shadow { offset: [0, 4], blur: 12, spread: 0, color: Color32::from_black_alpha(60) };
    visuals.window_corner_radius = CornerRadius::same(ROUNDING);
    visuals.menu_corner_radius = CornerRadius::same(ROUNDING);
    visuals.selection.bg_fill = palette.selection;
    visuals.selection.stroke = Stroke::new(HAIRLINE, palette.text);
    // A blinking cursor would draw the window anew twice a second.
    visuals.text_cursor.blink = false;
    let widgets = &mut visuals.widgets;
    let states = [
        (&mut widgets.noninteractive, palette.panel, palette.line),
        (&mut widgets.inactive, palette.raised, palette.raised),
        (&mut widgets.hovered, palette.raised_hovered, palette.raised_hovered),
        (&mut widgets.active, palette.raised_pressed, palette.raised_pressed),
        (&mut widgets.open, palette.raised_hovered, palette.raised_hovered),
    ];
    for (state, fill, edge) in states {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.bg_stroke = Stroke::new(HAIRLINE, edge);
        state.fg_stroke = Stroke::new(HAIRLINE, palette.text);
        state.corner_radius = CornerRadius::same(ROUNDING);
        state.expansion = 0.0;
    }
    // The boxes of check marks and radio buttons have no edge; they have to stand out by themselves.
    widgets.inactive.bg_fill = palette.raised_pressed;
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(colour: Color32) -> f64 {
        let linear = |byte: u8| {
            let part = f64::from(byte) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
    }

    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_can_be_read_on_every_ground() {
        for palette in [DARK, LIGHT] {
            let texts =
                [palette.text, palette.quiet, palette.old, palette.accent, palette.ok, palette.warning, palette.error];
            for text in texts {
                for ground in [palette.ground, palette.panel] {
                    assert!(contrast(text, ground) >= 4.5, "{text:?} on {ground:?}: {:.2}", contrast(text, ground));
                }
            }
            for ground in [palette.selection, palette.raised, palette.raised_hovered, palette.error_ground] {
                assert!(contrast(palette.text, ground) >= 4.5);
            }
            assert!(contrast(palette.error, palette.error_ground) >= 4.5);
            assert!(contrast(palette.quiet, palette.selection) >= 4.0);
        }
    }

    #[test]
    fn marks_stand_out_from_the_ground() {
        for palette in [DARK, LIGHT] {
            let marks = [palette.motion, palette.output, palette.sound, palette.alarm];
            for mark in palette.series.into_iter().chain(palette.more_series).chain(marks) {
                assert!(contrast(mark, palette.ground) >= 3.0, "{mark:?}");
            }
        }
    }

    #[test]
    fn words_in_pictures_can_be_read() {
        for palette in [DARK, LIGHT] {
            let picture = &palette.picture;
            for (word, ground) in [
                (picture.print, picture.body),
                (picture.on_motion, picture.motion),
                (palette.text, picture.lens),
                (palette.quiet, picture.lens),
            ] {
                assert!(contrast(word, ground) >= 4.5, "{word:?} on {ground:?}: {:.2}", contrast(word, ground));
            }
            assert!(contrast(picture.motion, picture.lens) >= 2.8);
            assert!(contrast(picture.slider, picture.slot) >= 4.5 && contrast(picture.slider_dim, picture.slot) >= 3.0);
        }
    }

    /// How a red-green blind person sees a colour (Viénot, Brettel and Mollon 1999, in linear light).
    fn without_green(colour: Color32) -> [f64; 3] {
        let linear = |byte: u8| (f64::from(byte) / 255.0).powf(2.2);
        let (r, g, b) = (linear(colour.r()), linear(colour.g()), linear(colour.b()));
        let yellow = 0.29275 * r + 0.70725 * g;
        [yellow, yellow, (b - 0.02234 * r + 0.02234 * g).max(0.0)].map(|part| part.powf(1.0 / 2.2))
    }

    #[test]
    fn series_of_one_plot_differ_for_red_green_blind_people() {
        for palette in [DARK, LIGHT] {
            let [temperature, _, dew_point, ..] = palette.series.map(without_green);
            let distance: f64 = temperature.iter().zip(dew_point).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            assert!(distance > 0.3, "{distance}");
        }
    }

    #[test]
    fn digits_are_equally_wide() {
        let ctx = egui::Context::default();
        ctx.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
        ctx.fonts_mut(|fonts| {
            for font in [small(), body(), digits()] {
                let widths: Vec<f32> = ('0'..='9').map(|digit| fonts.glyph_width(&font, digit)).collect();
                assert!(widths.windows(2).all(|pair| pair[0] == pair[1]), "{widths:?}");
            }
        });
    }
}
