//! Every colour, size and font of the window. Nothing else in this room names a colour or a length.
//!
//! The colours were chosen after Okabe and Ito, so that they stay apart for colour-blind people, and each is used
//! together with a shape or a word. Text has a contrast of at least 4.5 to 1 on both grounds, marks at least 3 to 1
//! (WCAG 2.2, 1.4.3 and 1.4.11); a test holds them to it.

use crate::bench::SwitchKind;
use crate::picture::Ink;
use eframe::egui::{
    self, Color32, CornerRadius, FontFamily, FontId, Margin, Shadow, Stroke, Style, TextStyle, Theme, Visuals, vec2,
};

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

/// The colours in force where `ui` draws.
pub fn palette(ui: &egui::Ui) -> &'static Palette {
    if ui.visuals().dark_mode { &DARK } else { &LIGHT }
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
    }
}

/// What marks the line under way over its text.
pub fn line_mark(palette: &Palette) -> Color32 {
    palette.accent.gamma_multiply(SELECTION_FILL)
}

/// The type scale.
pub const SMALL: f32 = 11.0;
pub const BODY: f32 = 13.0;
pub const HEADING: f32 = 16.0;
pub const DIGITS: f32 = 28.0;

pub fn small() -> FontId {
    FontId::proportional(SMALL)
}

pub fn body() -> FontId {
    FontId::proportional(BODY)
}

/// For what goes over the wire.
pub fn mono() -> FontId {
    FontId::monospace(BODY)
}

pub fn small_mono() -> FontId {
    FontId::monospace(SMALL)
}

pub fn heading() -> FontId {
    FontId::proportional(HEADING)
}

/// For readings; all ten digits are equally wide in the default font, which a test holds it to.
pub fn digits() -> FontId {
    FontId::proportional(DIGITS)
}

/// The unit of space; every distance is a multiple of it.
pub const UNIT: f32 = 4.0;
pub const GAP: f32 = 2.0 * UNIT;
pub const GAP_SECTION: f32 = 5.0 * UNIT;

pub const WINDOW: [f32; 2] = [1280.0, 800.0];
/// A window of 1024 by 700 still has its title bar to show.
pub const WINDOW_OWN: [f32; 2] = [1000.0, 700.0];
/// Least width and height of a tab's contents.
pub const PANE_LEAST: f32 = 80.0 * UNIT;
/// A module in a narrower pane is scrolled sideways.
pub const MODULE_LEAST: f32 = 170.0 * UNIT;
pub const TAB_HEIGHT: f32 = 7.0 * UNIT;
pub const QUESTION_WIDTH: f32 = 110.0 * UNIT;
pub const WINDOW_LEAST: [f32; 2] = [960.0, 620.0];

pub const CONTROL_HEIGHT: f32 = 6.0 * UNIT;
pub const STATUS_HEIGHT: f32 = 7.0 * UNIT;
pub const LIST_WIDTH: f32 = 60.0 * UNIT;
pub const LIST_WIDTH_RANGE: std::ops::RangeInclusive<f32> = 50.0 * UNIT..=100.0 * UNIT;
pub const LINE_BOX_WIDTH: f32 = 56.0 * UNIT;
pub const LINE_MENU_WIDTH: f32 = 90.0 * UNIT;
pub const HOST_WIDTH: f32 = 38.0 * UNIT;
pub const SPEED_WIDTH: f32 = 18.0 * UNIT;
pub const FORMAT_WIDTH: f32 = 14.0 * UNIT;
pub const PROGRESS_WIDTH: f32 = 32.0 * UNIT;
pub const PROGRESS_HEIGHT: f32 = 2.0 * UNIT;
pub const PERCENT_WIDTH: f32 = 9.0 * UNIT;
pub const TIME_LEFT: f32 = 28.0 * UNIT;
/// Least width of a button whose text changes.
pub const BUTTON_WIDTH: f32 = 20.0 * UNIT;
/// Where a running scan is; with less room it is told on hover only.
pub const PLACE_LEAST: f32 = 40.0 * UNIT;
pub const ROW_NAME: f32 = 18.0 * UNIT;
pub const ADDRESSES_WIDTH: f32 = 50.0 * UNIT;
pub const WINDOW_FIELD_WIDTH: f32 = 16.0 * UNIT;
pub const SCAN_MENU_WIDTH: f32 = 72.0 * UNIT;
pub const INTERVAL_WIDTH: f32 = 48.0 * UNIT;
pub const POLLING_WIDTH: f32 = 28.0 * UNIT;
/// Width of text that is read, not glanced at.
pub const TEXT_WIDTH: f32 = 130.0 * UNIT;
pub const NOTICES_WIDTH: f32 = 140.0 * UNIT;
pub const NOTICES_HEIGHT: f32 = 80.0 * UNIT;
pub const PATH_WIDTH: f32 = 90.0 * UNIT;
pub const RATE_WIDTH: f32 = 29.0 * UNIT;
pub const ERRORS_WIDTH: f32 = 20.0 * UNIT;
pub const ANSWER_WIDTH: f32 = 24.0 * UNIT;

/// The table of all modules: height of a line, and least widths of its columns.
pub const TABLE_ROW: f32 = 7.0 * UNIT;
pub const TABLE_STATE: f32 = 22.0 * UNIT;
pub const TABLE_MODEL: f32 = 14.0 * UNIT;
pub const TABLE_ADDRESS: f32 = 17.0 * UNIT;
pub const TABLE_SPOKEN: f32 = 31.0 * UNIT;
pub const TABLE_NUMBER: f32 = 17.0 * UNIT;
pub const TABLE_SWITCH: f32 = 16.0 * UNIT;
pub const TABLE_OUTPUTS: f32 = 23.0 * UNIT;
pub const TABLE_TIME: f32 = 14.0 * UNIT;
pub const TABLE_LEAST: f32 = 8.0 * UNIT;
/// A column of the menu.
pub const COMMANDS_WIDTH: f32 = 60.0 * UNIT;

/// Marks in text.
pub const GLYPH: f32 = 3.0 * UNIT;
pub const LAMP: f32 = 4.0 * UNIT;
pub const CARET: f32 = 2.0 * UNIT;
pub const SWATCH: [f32; 2] = [3.0 * UNIT, 3.0];

/// The list of modules.
pub const ROW_HEIGHT: f32 = 16.0 * UNIT;
pub const ROW_MARGIN: f32 = 2.0 * UNIT;

/// Long lists. An even number of points, so that the place of the millionth row is exact in 32 bits.
pub const LIST_ROW: f32 = 5.0 * UNIT;
pub const TIME_COLUMN: f32 = 21.0 * UNIT;
pub const DIRECTION_COLUMN: f32 = 20.0 * UNIT;
pub const ADDRESS_COLUMN: f32 = 12.0 * UNIT;
pub const TOOK_COLUMN: f32 = 16.0 * UNIT;
pub const STATE_COLUMN: f32 = 22.0 * UNIT;
/// Bytes take this part of what the other columns leave.
pub const BYTES_PART: f32 = 0.4;
pub const BYTES_RANGE: [f32; 2] = [30.0 * UNIT, 110.0 * UNIT];
pub const SEARCH_WIDTH: f32 = 52.0 * UNIT;
pub const COUNT_WIDTH: f32 = 50.0 * UNIT;
pub const CHOICE_WIDTH: f32 = 30.0 * UNIT;
/// What the chosen line holds, below its list.
pub const DETAILS: f32 = 44.0 * UNIT;
pub const LOG_DETAILS: f32 = 30.0 * UNIT;
pub const DETAILS_RANGE: std::ops::RangeInclusive<f32> = 20.0 * UNIT..=120.0 * UNIT;

/// Readings.
pub const READING: [f32; 2] = [46.0 * UNIT, 18.0 * UNIT];
pub const READING_DIGITS: f32 = 29.0 * UNIT;
/// Least width of a lamp with its name and word; they share what room there is.
pub const LAMP_CELL: [f32; 2] = [47.0 * UNIT, 6.0 * UNIT];
pub const LAMP_GUTTER: f32 = 4.0 * UNIT;

/// Analogue inputs: least and most width of a cell, the room of a unit after large digits, of a latch, of the menu
/// that resets latches, and of the words on the alarm.
pub const CHANNEL_WIDTHS: [f32; 2] = [60.0 * UNIT, 84.0 * UNIT];
pub const CHANNEL_UNIT: f32 = 7.0 * UNIT;
pub const LATCH: f32 = 17.0 * UNIT;
pub const LATCH_MENU_WIDTH: f32 = 84.0 * UNIT;
pub const ALARM_PHRASE: f32 = 58.0 * UNIT;
pub const USE_WIDTH: f32 = 12.0 * UNIT;
/// With twice this width settings stand in two columns.
pub const FORM_COLUMN: f32 = 165.0 * UNIT;

/// Lines of a form: name, value, unit, state and its buttons.
pub const FORM_LABEL: f32 = 44.0 * UNIT;
pub const FORM_EDITOR: f32 = 36.0 * UNIT;
pub const FORM_UNIT: f32 = 9.0 * UNIT;
pub const FORM_STATE: f32 = 80.0 * UNIT;
pub const FORM_BUTTONS: f32 = 32.0 * UNIT;
/// For a value with its unit, and what that is in larger units.
pub const FORM_EDITOR_WIDE: f32 = FORM_EDITOR + GAP + FORM_UNIT;
/// What a text field adds left and right of its text.
pub const FIELD_MARGIN: f32 = 2.0 * UNIT;

/// The configuration: its lines, and the picture of the switches beside them.
pub const CONFIGURATION_LABEL: f32 = 31.0 * UNIT;
pub const CONFIGURATION_EDITOR: f32 = 28.0 * UNIT;
pub const CONFIGURATION_UNIT: f32 = 9.0 * UNIT;
pub const CONFIGURATION_FORM_LEAST: f32 = 135.0 * UNIT;
pub const CONFIGURATION_FORM: f32 = 185.0 * UNIT;
pub const SWITCHES_WIDTH: f32 = 92.0 * UNIT;
pub const READ_AND_CLEAR: f32 = 27.0 * UNIT;
pub const CHANGE_IN_INIT: f32 = 38.0 * UNIT;

/// The guided change in INIT mode.
pub const GUIDE_WIDTH: f32 = 172.0 * UNIT;
pub const GUIDE_MARGIN: i8 = 16;
pub const GUIDE_NUMBER: f32 = 5.0 * UNIT;
pub const GUIDE_STEPS: f32 = 100.0 * UNIT;
pub const GUIDE_PICTURE: f32 = 50.0 * UNIT;
/// Room for what is to be known at a step, so that nothing jumps from one to the next.
pub const GUIDE_DETAIL: f32 = 26.0 * UNIT;
pub const GUIDE_LABEL: f32 = 26.0 * UNIT;
pub const GUIDE_VALUE: f32 = 26.0 * UNIT;
pub const GUIDE_ARROW: f32 = 6.0 * UNIT;

/// The watchdog in the header of a module, and what stands beside it.
pub const INDICATOR: f32 = 80.0 * UNIT;
pub const INDICATOR_TEXT: f32 = 60.0 * UNIT;
pub const UNITS_WIDTH: f32 = 18.0 * UNIT;
pub const READ_WIDTH: f32 = 22.0 * UNIT;

/// Sensor and relays.
pub const FACE_WIDTH: f32 = 55.0 * UNIT;
pub const RELAY: [f32; 2] = [60.0 * UNIT, 36.0 * UNIT];
pub const SWITCH: [f32; 2] = [18.0 * UNIT, 8.0 * UNIT];
pub const CONTACT: [f32; 2] = [12.0 * UNIT, 8.0 * UNIT];
pub const CONTACT_POINT: f32 = 3.0;
/// How far an open contact lifts its lever, as a part of its length.
pub const CONTACT_LIFT: f32 = 0.55;
pub const RELAY_REASON: f32 = 8.0 * UNIT;
pub const HISTORY_NAME: f32 = 28.0 * UNIT;
pub const HISTORY_WORDS: f32 = 44.0 * UNIT;
/// Summary: facts in two columns, and its table.
pub const SUMMARY_ROW: f32 = 5.0 * UNIT;
pub const SUMMARY_NAME: f32 = 22.0 * UNIT;
pub const SUMMARY_FACT: f32 = 46.0 * UNIT;
pub const SUMMARY_NOTES: f32 = 90.0 * UNIT;
pub const SUMMARY_LABEL: f32 = 48.0 * UNIT;
pub const SUMMARY_VALUE: f32 = 32.0 * UNIT;
pub const SUMMARY_FACTORY: f32 = 28.0 * UNIT;
pub const SUMMARY_REMARK: f32 = 36.0 * UNIT;
/// A picture of what is no longer fresh.
pub const FADED: f32 = 0.45;
/// How far the two prints of strong text lie apart, as a part of its size.
pub const STRONG: f32 = 0.04;
/// Wider than this, lines are hard to follow.
pub const TAB_WIDTH: f32 = 300.0 * UNIT;
pub const COUNTDOWN_TEXT: f32 = 90.0 * UNIT;

/// The tab of commands: from this width on reference, Modbus and scripts stand beside the console.
pub const COMMANDS_WIDE: f32 = 225.0 * UNIT;
pub const COMMANDS_SIDE: f32 = 108.0 * UNIT;
/// The exchanges beneath another page, where there is no room beside it.
pub const COMMANDS_BELOW: f32 = 28.0 * UNIT;
pub const EXCHANGE_TIME: f32 = 20.0 * UNIT;
/// A closed exchange, before its height is known.
pub const EXCHANGE_HEIGHT: f32 = 12.0 * UNIT;
/// Lines of explained fields: name, and as it is in the frame.
pub const EXPLAINED_NAME: f32 = 40.0 * UNIT;
pub const EXPLAINED_RAW: f32 = 24.0 * UNIT;
pub const PERIOD_WIDTH: f32 = 22.0 * UNIT;
/// Counts of a repeated command.
pub const COUNTS_WIDTH: f32 = 46.0 * UNIT;
/// Names before the fields of a command's form.
pub const FIELD_NAME: f32 = 26.0 * UNIT;
pub const NUMBER_FIELD: f32 = 20.0 * UNIT;
pub const REGISTER_NUMBERS: f32 = 44.0 * UNIT;
/// Line numbers of a script, and what is said beneath it.
pub const GUTTER: f32 = 9.0 * UNIT;
pub const SCRIPT_STATE: f32 = 13.0 * UNIT;

/// The plot.
pub const PLOT_HEIGHT: f32 = 70.0 * UNIT;
pub const LEGEND_WIDTH: f32 = 44.0 * UNIT;
pub const Y_LABELS: f32 = 12.0 * UNIT;
pub const LEGEND_ROW: f32 = 5.0 * UNIT;
pub const PLOT_LEAST: f32 = 15.0 * UNIT;
pub const STRIP: f32 = 4.5 * UNIT;
/// Where the window is low, rather than that the time axis is cut off.
pub const STRIP_LEAST: f32 = 3.0 * UNIT;
pub const STRIP_INSET: f32 = UNIT;
pub const TIME_AXIS: f32 = 5.0 * UNIT;
/// Least distance between two ticks, across and upwards.
pub const TICK_DISTANCE: [f32; 2] = [20.0 * UNIT, 6.0 * UNIT];
pub const SAMPLE_MARK: f32 = 3.0;
/// Strokes and gaps of a limit's line.
pub const DASH: [f32; 2] = [6.0, 4.0];

pub const HAIRLINE: f32 = 1.0;
pub const TRACE: f32 = 1.5;
pub const OUTLINE: f32 = 1.5;
/// How much of the accent covers a selected span.
pub const SELECTION_FILL: f32 = 0.2;
const ROUNDING: u8 = 4;

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
            for mark in palette.series.into_iter().chain(marks) {
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
