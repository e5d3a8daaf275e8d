//! Every colour of the window, by what it means.
//!
//! They were chosen after Okabe and Ito, so that they stay apart for colour-blind people, and each is used together with
//! a shape or a word.

use eframe::egui::{self, Color32};

use super::SELECTION_FILL;
use crate::bench::SwitchKind;
use crate::picture::Ink;

/// The colours of one theme, by what they mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Palette {
    /// Behind readings and plots.
    pub ground: Color32,
    /// Behind the rows and lists around them.
    pub panel: Color32,
    pub raised: Color32,
    pub raised_hovered: Color32,
    pub raised_pressed: Color32,
    /// Separates areas.
    pub line: Color32,
    pub grid: Color32,
    pub text: Color32,
    /// Units, names, explanations.
    pub quiet: Color32,
    /// A value that is no longer fresh.
    pub old: Color32,
    pub accent: Color32,
    pub selection: Color32,
    pub ok: Color32,
    pub warning: Color32,
    pub error: Color32,
    /// Behind an error that waits to be acknowledged.
    pub error_ground: Color32,
    /// Numbers over time, in the order of the definition.
    pub series: [Color32; 5],
    /// Further numbers, where those of several modules are drawn together.
    pub more_series: [Color32; 5],
    pub motion: Color32,
    pub output: Color32,
    pub sound: Color32,
    pub alarm: Color32,
    pub picture: PictureColours,
}

/// What pictures of a module add to the palette: plastic, switches and lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureColours {
    pub body: Color32,
    pub housing: Color32,
    pub edge: Color32,
    pub slot: Color32,
    pub slider: Color32,
    pub slider_dim: Color32,
    pub print: Color32,
    pub print_dim: Color32,
    pub unknown: Color32,
    pub lens: Color32,
    pub facet: Color32,
    pub motion: Color32,
    pub on_motion: Color32,
}

pub const DARK: Palette = Palette {
    ground: Color32::from_rgb(0x12, 0x15, 0x19),
    panel: Color32::from_rgb(0x1A, 0x1E, 0x23),
    raised: Color32::from_rgb(0x2B, 0x31, 0x39),
    raised_hovered: Color32::from_rgb(0x38, 0x40, 0x4A),
    raised_pressed: Color32::from_rgb(0x45, 0x4F, 0x5B),
    line: Color32::from_rgb(0x2C, 0x32, 0x3A),
    grid: Color32::from_rgb(0x26, 0x2C, 0x33),
    text: Color32::from_rgb(0xE6, 0xEA, 0xEE),
    quiet: Color32::from_rgb(0x9D, 0xA8, 0xB3),
    old: Color32::from_rgb(0x86, 0x90, 0x9B),
    accent: Color32::from_rgb(0x6C, 0xB4, 0xFF),
    selection: Color32::from_rgb(0x1E, 0x40, 0x66),
    ok: Color32::from_rgb(0x35, 0xC4, 0x9C),
    warning: Color32::from_rgb(0xF0, 0xB4, 0x3C),
    error: Color32::from_rgb(0xFF, 0x86, 0x70),
    error_ground: Color32::from_rgb(0x3A, 0x1F, 0x1C),
    series: [
        Color32::from_rgb(0xF2, 0xA0, 0x48),
        Color32::from_rgb(0x30, 0xC5, 0x9B),
        Color32::from_rgb(0x64, 0xB6, 0xF2),
        Color32::from_rgb(0xE3, 0x8B, 0xC4),
        Color32::from_rgb(0xEE, 0xE1, 0x6A),
    ],
    more_series: [
        Color32::from_rgb(0xA9, 0x94, 0xF5),
        Color32::from_rgb(0xF7, 0x7B, 0x7B),
        Color32::from_rgb(0x9C, 0xD8, 0x52),
        Color32::from_rgb(0x5F, 0xDD, 0xE6),
        Color32::from_rgb(0xC8, 0xB0, 0x94),
    ],
    motion: Color32::from_rgb(0xEE, 0xE1, 0x6A),
    output: Color32::from_rgb(0x64, 0xB6, 0xF2),
    sound: Color32::from_rgb(0xE3, 0x8B, 0xC4),
    alarm: Color32::from_rgb(0xFF, 0x86, 0x70),
    picture: PictureColours {
        body: Color32::from_rgb(0x9A, 0x2C, 0x26),
        housing: Color32::from_rgb(0x36, 0x3D, 0x46),
        edge: Color32::from_rgb(0x72, 0x7C, 0x87),
        slot: Color32::from_rgb(0x14, 0x16, 0x19),
        slider: Color32::from_rgb(0xF1, 0xEF, 0xE9),
        slider_dim: Color32::from_rgb(0x95, 0x9E, 0xA8),
        print: Color32::from_rgb(0xFA, 0xF4, 0xEE),
        print_dim: Color32::from_rgb(0xE4, 0xB6, 0xB0),
        unknown: Color32::from_rgb(0xA9, 0xB2, 0xBB),
        lens: Color32::from_rgb(0x22, 0x27, 0x2D),
        facet: Color32::from_rgb(0x3A, 0x42, 0x4B),
        motion: Color32::from_rgb(0xEE, 0xE1, 0x6A),
        on_motion: Color32::from_rgb(0x1C, 0x19, 0x05),
    },
};

pub const LIGHT: Palette = Palette {
    ground: Color32::from_rgb(0xFF, 0xFF, 0xFF),
    panel: Color32::from_rgb(0xF2, 0xF4, 0xF6),
    raised: Color32::from_rgb(0xE0, 0xE5, 0xEA),
    raised_hovered: Color32::from_rgb(0xD2, 0xD9, 0xE0),
    raised_pressed: Color32::from_rgb(0xC0, 0xC9, 0xD2),
    line: Color32::from_rgb(0xD3, 0xD9, 0xDF),
    grid: Color32::from_rgb(0xE4, 0xE8, 0xEC),
    text: Color32::from_rgb(0x16, 0x1B, 0x20),
    quiet: Color32::from_rgb(0x52, 0x5D, 0x68),
    old: Color32::from_rgb(0x66, 0x70, 0x7B),
    accent: Color32::from_rgb(0x0A, 0x5F, 0xBF),
    selection: Color32::from_rgb(0xCB, 0xE1, 0xF9),
    ok: Color32::from_rgb(0x00, 0x74, 0x58),
    warning: Color32::from_rgb(0x85, 0x56, 0x00),
    error: Color32::from_rgb(0xB4, 0x2A, 0x14),
    error_ground: Color32::from_rgb(0xFB, 0xE4, 0xDF),
    series: [
        Color32::from_rgb(0xB2, 0x56, 0x00),
        Color32::from_rgb(0x00, 0x7F, 0x60),
        Color32::from_rgb(0x0B, 0x6C, 0xB4),
        Color32::from_rgb(0xA0, 0x32, 0x7A),
        Color32::from_rgb(0x7A, 0x6A, 0x00),
    ],
    more_series: [
        Color32::from_rgb(0x5B, 0x3F, 0xC4),
        Color32::from_rgb(0xC0, 0x1F, 0x45),
        Color32::from_rgb(0x4A, 0x78, 0x00),
        Color32::from_rgb(0x00, 0x7A, 0x8A),
        Color32::from_rgb(0x7A, 0x5B, 0x3E),
    ],
    motion: Color32::from_rgb(0x8A, 0x70, 0x00),
    output: Color32::from_rgb(0x0B, 0x6C, 0xB4),
    sound: Color32::from_rgb(0xA0, 0x32, 0x7A),
    alarm: Color32::from_rgb(0xB4, 0x2A, 0x14),
    picture: PictureColours {
        body: Color32::from_rgb(0xB4, 0x33, 0x2A),
        housing: Color32::from_rgb(0xDF, 0xE4, 0xE9),
        edge: Color32::from_rgb(0x7C, 0x87, 0x92),
        slot: Color32::from_rgb(0x2A, 0x2E, 0x34),
        slider: Color32::from_rgb(0xFA, 0xFA, 0xF7),
        slider_dim: Color32::from_rgb(0x8C, 0x96, 0xA0),
        print: Color32::from_rgb(0xFF, 0xFF, 0xFF),
        print_dim: Color32::from_rgb(0xF4, 0xD3, 0xCF),
        unknown: Color32::from_rgb(0xC3, 0xCA, 0xD1),
        lens: Color32::from_rgb(0xF8, 0xFA, 0xFB),
        facet: Color32::from_rgb(0xD3, 0xD9, 0xDF),
        motion: Color32::from_rgb(0xC0, 0x88, 0x00),
        on_motion: Color32::from_rgb(0x17, 0x12, 0x00),
    },
};

/// Nothing is painted.
pub const NO_COLOUR: Color32 = Color32::TRANSPARENT;

/// The colours in force where `ui` draws.
pub fn palette(ui: &egui::Ui) -> &'static Palette {
    if ui.visuals().dark_mode { &DARK } else { &LIGHT }
}

/// Colours that there are for numbers.
const CURVES: usize = 10;

/// The colour of the number at this place among those that are drawn together.
pub fn curve_colour(palette: &Palette, place: usize) -> Color32 {
    let [first, second, third, fourth, fifth] = palette.series;
    // The fifth is that of motion as well, so it comes last.
    let mut colours = [first, second, third, fourth].into_iter().chain(palette.more_series).chain([fifth]).cycle();
    colours.nth(place % CURVES).unwrap_or(palette.text)
}

/// The colour of a switch, by what it stands for.
pub fn switch_colour(palette: &Palette, kind: SwitchKind) -> Color32 {
    match kind {
        SwitchKind::Motion => palette.motion,
        SwitchKind::Output => palette.output,
        SwitchKind::Sound => palette.sound,
        SwitchKind::Alarm | SwitchKind::Watchdog => palette.alarm,
    }
}

/// The colour of a picture's shape, by what it stands for.
pub fn ink(palette: &Palette, ink: Ink) -> Color32 {
    let picture = &palette.picture;
    match ink {
        Ink::Ground => palette.ground,
        Ink::Body => picture.body,
        Ink::Housing => picture.housing,
        Ink::Edge => picture.edge,
        Ink::Slot => picture.slot,
        Ink::Slider => picture.slider,
        Ink::SliderDim => picture.slider_dim,
        Ink::Print => picture.print,
        Ink::PrintDim => picture.print_dim,
        Ink::Text => palette.text,
        Ink::Quiet => palette.quiet,
        Ink::Unknown => picture.unknown,
        Ink::Lens => picture.lens,
        Ink::Facet => picture.facet,
        Ink::Motion => picture.motion,
        Ink::OnMotion => picture.on_motion,
        Ink::Grid => palette.grid,
        Ink::Limit => palette.alarm,
        Ink::Curve(place) => curve_colour(palette, usize::from(place)),
    }
}

/// What marks the line under way over its text.
pub fn line_mark(palette: &Palette) -> Color32 {
    palette.accent.gamma_multiply(SELECTION_FILL)
}
