//! Every length of the window, and the fonts.

use eframe::egui::FontId;

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
/// A module in a lower pane is scrolled as a whole.
pub const MODULE_LOW: f32 = 90.0 * UNIT;
/// A bar of tabs that is narrower has no buttons beside them.
pub const TABS_AND_BUTTONS: f32 = 120.0 * UNIT;
pub const TAB_HEIGHT: f32 = 7.0 * UNIT;
pub const QUESTION_WIDTH: f32 = 110.0 * UNIT;
/// Less than a small screen has at twice the size; what does not fit is scrolled.
pub const WINDOW_LEAST: [f32; 2] = [120.0 * UNIT, 80.0 * UNIT];
/// Around what stands in front of the window, its frame included.
pub const MODAL_MARGIN: f32 = 4.0 * UNIT;

pub const CONTROL_HEIGHT: f32 = 6.0 * UNIT;
pub const STATUS_HEIGHT: f32 = 7.0 * UNIT;
/// In less the choice of the line, and what is done with it, take two rows.
pub const CONNECT_WIDTH: f32 = 200.0 * UNIT;
pub const LIST_WIDTH: f32 = 60.0 * UNIT;
/// In a window that is `width` wide; a narrow one has more to show beside it.
pub fn list_range(width: f32) -> std::ops::RangeInclusive<f32> {
    let [least, most] = [50.0 * UNIT, 100.0 * UNIT];
    least..=(width * 0.33).clamp(least, most)
}
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
/// Height of the list of modules in the poll plan.
pub const PLAN_HEIGHT: f32 = 90.0 * UNIT;
/// What is above and below that list, and its least height.
pub const PLAN_AROUND: f32 = 30.0 * UNIT;
pub const PLAN_LEAST: f32 = 16.0 * UNIT;
/// How far below the window's top the plan opens.
pub const PLAN_BELOW: f32 = 20.0 * UNIT;
/// The panel of faults, and two of its columns.
pub const FAULTS_WIDTH: f32 = 92.0 * UNIT;
/// How far below the top bar it opens: the tabs and the header of a module stay free.
pub const FAULTS_BELOW: f32 = TAB_HEIGHT + 3.0 * CONTROL_HEIGHT;
pub const FAULT_STRENGTH: f32 = 20.0 * UNIT;
pub const FAULT_COUNT: f32 = 14.0 * UNIT;
pub const INTERVAL_WIDTH: f32 = 48.0 * UNIT;
pub const POLLING_WIDTH: f32 = 28.0 * UNIT;
/// Width of text that is read, not glanced at.
pub const TEXT_WIDTH: f32 = 130.0 * UNIT;
pub const NOTICES_WIDTH: f32 = 140.0 * UNIT;
pub const NOTICES_HEIGHT: f32 = 80.0 * UNIT;
pub const PATH_WIDTH: f32 = 90.0 * UNIT;
/// Most room for the name of the line and its state.
pub const LINE_STATE_WIDTH: f32 = 50.0 * UNIT;
/// In less the status bar leaves out the figures of the line.
pub const STATUS_WIDE: f32 = 225.0 * UNIT;
pub const RATE_WIDTH: f32 = 29.0 * UNIT;
pub const ERRORS_WIDTH: f32 = 20.0 * UNIT;
pub const ANSWER_WIDTH: f32 = 24.0 * UNIT;
/// How the recording fares, and what a click there shows.
pub const RECORDING_WIDTH: f32 = 56.0 * UNIT;
pub const RECORDING_MENU: f32 = 90.0 * UNIT;
/// Room for what is known of the recording, and for the newest files; the least is one of them.
pub const RECORDING_FACTS: f32 = 18.0 * UNIT;
pub const RECENT_HEIGHT: f32 = 44.0 * UNIT;
pub const RECENT_LEAST: f32 = 11.0 * UNIT;
/// The dialog that exports readings: its list, a field for a time, and what tells how far a file is.
pub const EXPORT_WIDTH: f32 = 120.0 * UNIT;
pub const EXPORT_LIST: f32 = 40.0 * UNIT;
pub const EXPORT_ROW: f32 = 12.0 * UNIT;
pub const MOMENT_FIELD: f32 = 38.0 * UNIT;

/// The table of all modules: height of a line, and least widths of its columns.
pub const TABLE_ROW: f32 = 7.0 * UNIT;
pub const TABLE_STATE: f32 = 22.0 * UNIT;
pub const TABLE_MODEL: f32 = 14.0 * UNIT;
pub const TABLE_ADDRESS: f32 = 17.0 * UNIT;
pub const TABLE_SPOKEN: f32 = 31.0 * UNIT;
pub const TABLE_NUMBER: f32 = 17.0 * UNIT;
pub const TABLE_SWITCH: f32 = 19.0 * UNIT;
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
/// Date and time of day.
pub const MOMENT_COLUMN: f32 = 48.0 * UNIT;
pub const MODULE_COLUMN: f32 = 32.0 * UNIT;
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
/// Height of the details below a list: the list keeps a part of a low window.
pub fn details_range(room: f32) -> std::ops::RangeInclusive<f32> {
    let most = (room / 2.0).clamp(6.0 * UNIT, 120.0 * UNIT);
    (20.0 * UNIT).min(most)..=most
}

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

/// The trends: the list of what can be shown, names beside the plots, the row of events, and the axis of time with its
/// dates.
pub const CHOOSER: f32 = 54.0 * UNIT;
pub const CHOOSER_RANGE: std::ops::RangeInclusive<f32> = 40.0 * UNIT..=90.0 * UNIT;
/// In a narrower pane the list is closed at first.
pub const CHOOSER_ROOM: f32 = 200.0 * UNIT;
/// Less room than this makes two rows of the buttons above the plots.
pub const TREND_TOOLS: f32 = 170.0 * UNIT;
/// Least and most width of the names beside the plots, and which part of the room they take between.
pub const TREND_NAMES: [f32; 2] = [24.0 * UNIT, 40.0 * UNIT];
pub const TREND_NAMES_PART: f32 = 0.3;
pub const TREND_EVENTS: f32 = 5.0 * UNIT;
pub const TREND_AXIS: f32 = 9.0 * UNIT;
/// What borders between plots can be seized by.
pub const TREND_BORDER: f32 = 2.0 * UNIT;
/// Two events nearer than this are one mark.
pub const EVENT_DISTANCE: f32 = 3.0 * UNIT;
pub const NOTE_NAME: f32 = 30.0 * UNIT;
pub const NOTE_WIDTH: f32 = 64.0 * UNIT;
/// The handle of a time that is held.
pub const CURSOR_HANDLE: [f32; 2] = [4.0 * UNIT, 4.0 * UNIT];
pub const SPAN_WIDTH: f32 = 20.0 * UNIT;
/// The table of values and figures.
pub const VALUES: f32 = 48.0 * UNIT;
pub const VALUES_RANGE: std::ops::RangeInclusive<f32> = 22.0 * UNIT..=120.0 * UNIT;
pub const VALUES_NAME: f32 = 46.0 * UNIT;
pub const VALUES_COLUMN: f32 = 15.0 * UNIT;
pub const VALUES_SPAN: f32 = 18.0 * UNIT;
/// Room for a cursor's name and its time.
pub const VALUES_CURSOR: f32 = 28.0 * UNIT;
/// What a panel below the plots takes of `height`, at first and at most, so that the plots can still be read.
pub fn below_plots(wanted: f32, height: f32) -> [f32; 2] {
    [wanted.min(height * 0.27), (height * 0.4).max(*VALUES_RANGE.start())]
}

pub const EVENTS_PANEL: f32 = 48.0 * UNIT;

/// The diagnosis: its list of modules, width of what was found, its charts, and room for an answer time.
pub const STATIONS: f32 = 48.0 * UNIT;
pub const STATIONS_RANGE: std::ops::RangeInclusive<f32> = 36.0 * UNIT..=80.0 * UNIT;
pub const STATION_ROW: f32 = 11.0 * UNIT;
pub const FINDING_WIDTH: f32 = 170.0 * UNIT;
pub const CHART_HEIGHT: f32 = 28.0 * UNIT;
pub const BAR_MOST: f32 = 12.0 * UNIT;
/// Two marks nearer than this would touch.
pub const MARK_DISTANCE: f32 = 12.0 * UNIT;
pub const ANSWER_TIME: f32 = 18.0 * UNIT;
pub const COUNT_SHORT: f32 = 20.0 * UNIT;

/// The help: its list with one line for an article and three for a place that was found, and the width of its text.
pub const HELP_LIST: f32 = 56.0 * UNIT;
pub const HELP_LIST_RANGE: std::ops::RangeInclusive<f32> = 40.0 * UNIT..=100.0 * UNIT;
/// Less has no room for both the list and what it rules.
pub const HELP_BESIDE: f32 = 120.0 * UNIT;
pub const HELP_ROW: f32 = 5.5 * UNIT;
pub const HELP_HIT: f32 = 14.0 * UNIT;
pub const HELP_TEXT: f32 = 165.0 * UNIT;
pub const HELP_MARK: f32 = 5.0 * UNIT;
pub const HELP_COLUMN_GAP: f32 = 3.0 * UNIT;
/// A character of a table, on average, and the characters of the longest word that widens its column.
pub const HELP_CHARACTER: f32 = 1.6 * UNIT;
pub const HELP_WORD: usize = 18;
/// The box on the program, below its heading; its list of parts, and names before what is told.
pub const ABOUT: [f32; 2] = [185.0 * UNIT, 95.0 * UNIT];
pub const ABOUT_LIST: f32 = 64.0 * UNIT;
pub const ABOUT_NAME: f32 = 24.0 * UNIT;

pub const HAIRLINE: f32 = 1.0;
pub const TRACE: f32 = 1.5;
pub const OUTLINE: f32 = 1.5;
/// How much of the accent covers a selected span.
pub const SELECTION_FILL: f32 = 0.2;
pub const ROUNDING: u8 = 4;
