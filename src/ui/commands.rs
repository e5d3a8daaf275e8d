//! What the user can ask for from anywhere: one list for the menu and the keys. What belongs to one place of the
//! window has its button there.

use eframe::egui::{Context, Key, KeyboardShortcut, Modifiers, ViewportCommand, ViewportId, gui_zoom::kb_shortcuts};

use super::app::Pass;
use super::connect::{self, Ready, recent::Again};
use super::faults;
use super::module_view;
use super::panes::{Pane, Panes};
use super::recording::Wish;
use super::settings;
use crate::bench::{Action, Bench, DEFAULT_INTERVAL, LineState, Module};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    QuickScan,
    FullScan,
    ConnectAgain,
    StopScan,
    CloseLine,
    PollAll,
    PauseAll,
    PollPlan,
    Faults,
    ReadAgain,
    WriteAll,
    RevertAll,
    Undo,
    Redo,
    TogglePolling,
    Remove,
    NextTab,
    PreviousTab,
    NextPane,
    PreviousPane,
    Dashboard,
    Traffic,
    Trends,
    Diagnosis,
    ToggleRecording,
    OpenRecording,
    ExportReadings,
    Beside,
    OwnWindow,
    ClosePane,
    Larger,
    Smaller,
    NormalSize,
    AddDefinition,
    Help,
    About,
    Quit,
}

use Command::*;

/// The menu's groups, in its order.
pub const LINE: &[Command] =
    &[QuickScan, FullScan, ConnectAgain, StopScan, CloseLine, PollAll, PauseAll, PollPlan, Faults];
pub const MODULE: &[Command] =
    &[ReadAgain, WriteAll, RevertAll, Undo, Redo, TogglePolling, NextTab, PreviousTab, Remove];
pub const TABS: &[Command] =
    &[NextPane, PreviousPane, Dashboard, Trends, Traffic, Diagnosis, Beside, OwnWindow, ClosePane];
pub const RECORDING: &[Command] = &[ToggleRecording, OpenRecording, ExportReadings];
pub const SIZE: &[Command] = &[Larger, Smaller, NormalSize];
pub const PROGRAM: &[Command] = &[AddDefinition, Help, About, Quit];

/// All commands with the titles of their groups.
pub const GROUPS: [(&str, &[Command]); 6] = [
    ("Line", LINE),
    ("Module in view", MODULE),
    ("Tabs", TABS),
    ("Recording", RECORDING),
    ("Size", SIZE),
    ("Program and help", PROGRAM),
];

const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Who hears a command's keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum HeardBy {
    /// This list, wherever the focus is.
    Commands,
    /// This list, unless a text field has the focus, which uses these keys itself.
    CommandsOutsideText,
    /// Someone else, who knows them anyway.
    Others,
}

impl Command {
    pub fn all() -> impl Iterator<Item = Self> {
        GROUPS.into_iter().flat_map(|(_, commands)| commands).copied()
    }

    pub fn text(self) -> &'static str {
        match self {
            QuickScan => "Quick scan",
            FullScan => "Full scan",
            ConnectAgain => "Connect as last time",
            StopScan => "Stop the scan",
            CloseLine => "Close line",
            PollAll => "Poll all modules",
            PauseAll => "Pause all polling",
            PollPlan => "Poll plan…",
            Faults => "Faults of the simulated line…",
            ReadAgain => "Read again",
            WriteAll => "Write all changes",
            RevertAll => "Revert all changes",
            Undo => "Undo",
            Redo => "Redo",
            TogglePolling => "Pause or resume polling",
            Remove => "Remove from the list",
            NextTab => "Next page",
            PreviousTab => "Previous page",
            NextPane => "Next tab",
            PreviousPane => "Previous tab",
            Dashboard => "Dashboard",
            Traffic => "Traffic",
            Trends => "Trends",
            Diagnosis => "Diagnosis",
            ToggleRecording => "Start or stop recording",
            OpenRecording => "Open a recording…",
            ExportReadings => "Export readings…",
            Beside => "Show beside",
            OwnWindow => "Own window",
            ClosePane => "Close tab",
            Larger => "Larger",
            Smaller => "Smaller",
            NormalSize => "Normal size",
            AddDefinition => "Add definition file…",
            Help => "Help on this tab",
            About => "About and licences…",
            Quit => "Quit",
        }
    }

    /// What it is called at present: with what it would undo, where it undoes something.
    pub fn text_now(self, pass: &Pass<'_>) -> String {
        let module = in_view(pass.bench, pass.active);
        let what = match self {
            Undo => undoable(module),
            Redo => redoable(module),
            _ => None,
        };
        what.map_or_else(|| self.text().to_owned(), |what| format!("{}: {what}", self.text()))
    }

    pub fn explanation(self) -> &'static str {
        match self {
            QuickScan => "Asks the likely addresses at the chosen speed and format",
            FullScan => "Asks every address at every speed and format, in every protocol",
            ConnectAgain => "Opens the line that was opened last, at its speed and format, and does a quick scan",
            StopScan => "Ends the scan; what it found stays",
            CloseLine => "Gives the port free; the last values stay",
            PollAll => "Polls every module whose model is known",
            PauseAll => "Asks no module any more; the last values stay",
            Faults => "Lets the simulated line go wrong, as real ones do",
            PollPlan => "Which modules are polled, how often, and what of each",
            ReadAgain => "Asks the module in view again for what its page shows",
            WriteAll => "Writes the changes of the module in view",
            RevertAll => "Takes back the changes of the module in view",
            Undo => "One step back through the changes of the module in view that are not written",
            Redo => "One step forth through what was undone",
            TogglePolling => "Of the module in view",
            Remove => "Forgets the module in view until it is found again",
            NextTab => "Of the module in view",
            PreviousTab => "Of the module in view",
            NextPane => "Goes through all tabs and windows",
            PreviousPane => "Goes through all tabs and windows, backwards",
            Dashboard => "All modules in one table",
            Traffic => "Every frame of the line",
            Trends => "Plots of all readings, and what happened",
            Diagnosis => "Answer times, errors, their causes and the next step",
            ToggleRecording => "Everything that is measured goes into a file, or no longer",
            OpenRecording => "Plots and events of an earlier time",
            ExportReadings => "Of the trends in view, as CSV, JSON Lines or Parquet",
            Beside => "Puts the tab beside the others; once more puts it back among them",
            OwnWindow => "Puts the tab into a window of its own, or back",
            ClosePane => "The module stays in the list and goes on being polled",
            Larger | Smaller | NormalSize => "Everything in the window",
            AddDefinition => "Makes a model known that is not built in, as a file dropped onto the window does",
            Help => "How to use it, what goes wrong, and every command and register; works offline",
            About => "Version, folders, and what the program is built from",
            Quit => "Asks first if a change is not written",
        }
    }

    /// Never a key that text fields need everywhere, such as Ctrl+A, C, V, X or Z.
    pub fn shortcut(self) -> Option<KeyboardShortcut> {
        let command = |key| Some(KeyboardShortcut::new(Modifiers::COMMAND, key));
        let shifted = |key| Some(KeyboardShortcut::new(CTRL_SHIFT, key));
        // The key beside Tab is Ctrl on every system, Mac included.
        let ctrl = |modifiers: Modifiers, key| Some(KeyboardShortcut::new(Modifiers::CTRL.plus(modifiers), key));
        match self {
            QuickScan => command(Key::R),
            FullScan => shifted(Key::R),
            ConnectAgain => command(Key::L),
            StopScan => command(Key::Period),
            CloseLine => shifted(Key::L),
            PollAll => command(Key::P),
            PauseAll => shifted(Key::P),
            ReadAgain => Some(KeyboardShortcut::new(Modifiers::NONE, Key::F5)),
            WriteAll => Some(module_view::WRITE_ALL),
            Undo => command(Key::Z),
            Redo => shifted(Key::Z),
            RevertAll | TogglePolling | Remove | PollPlan | Faults | AddDefinition | About => None,
            Help => Some(KeyboardShortcut::new(Modifiers::NONE, Key::F1)),
            NextTab => ctrl(Modifiers::NONE, Key::PageDown),
            PreviousTab => ctrl(Modifiers::NONE, Key::PageUp),
            NextPane => ctrl(Modifiers::NONE, Key::Tab),
            PreviousPane => ctrl(Modifiers::SHIFT, Key::Tab),
            Dashboard => command(Key::D),
            Traffic => command(Key::T),
            Trends => command(Key::G),
            Diagnosis => shifted(Key::D),
            ToggleRecording => shifted(Key::S),
            OpenRecording => command(Key::O),
            ExportReadings => shifted(Key::E),
            Beside => command(Key::B),
            OwnWindow => shifted(Key::N),
            ClosePane => command(Key::W),
            Larger => Some(kb_shortcuts::ZOOM_IN),
            Smaller => Some(kb_shortcuts::ZOOM_OUT),
            NormalSize => Some(kb_shortcuts::ZOOM_RESET),
            Quit => command(Key::Q),
        }
    }

    /// Other keys that do the same.
    fn other_shortcut(self) -> Option<KeyboardShortcut> {
        (self == Redo).then(|| KeyboardShortcut::new(Modifiers::COMMAND, Key::Y))
    }

    fn heard_by(self) -> HeardBy {
        match self {
            // The bar beneath the module, so that a field may take Ctrl+Enter first; and egui.
            WriteAll | Larger | Smaller | NormalSize => HeardBy::Others,
            // On some systems Ctrl with P, B, D and T moves or deletes in a text, which has its own steps back, too.
            Undo | Redo | PollAll | PauseAll | Beside | Dashboard | Traffic | Trends => HeardBy::CommandsOutsideText,
            _ => HeardBy::Commands,
        }
    }

    /// Why it cannot be done now, if so.
    pub fn obstacle(self, pass: &Pass<'_>) -> Option<String> {
        let closed = matches!(pass.bench.line(), LineState::Closed);
        let unless = |possible: bool, reason: &str| (!possible).then(|| reason.to_owned());
        let known = in_view(pass.bench, pass.active).filter(|module| module.definition().is_some());
        let line = || pass.bench.line().obstacle().map(str::to_owned);
        let polls = || unless(!closed, "No line is open: scan to open it");
        let module = || unless(known.is_some(), "No known module is in view");
        match self {
            QuickScan | FullScan if pass.bench.is_scanning() => Some("A scan is running".to_owned()),
            QuickScan | FullScan => pass.connect.obstacle(pass.bench, pass.settings),
            Faults => {
                unless(faults::count(pass).is_some(), "Only the simulated line goes wrong at will: open it first")
            }
            ConnectAgain => connect::recent::obstacle(pass.bench, pass.settings),
            StopScan => unless(pass.bench.is_scanning(), "No scan is running"),
            CloseLine => unless(!closed, "No line is open"),
            PollAll => {
                let mut all = pass.bench.modules().iter().filter(|module| module.definition().is_some()).peekable();
                polls()
                    .or_else(|| unless(all.peek().is_some(), "No module is known"))
                    .or_else(|| unless(all.any(|module| module.interval.is_none()), "All are polled already"))
            }
            PauseAll => unless(pass.bench.modules().iter().any(|module| module.interval.is_some()), "None is polled"),
            ReadAgain => module().or_else(line),
            TogglePolling => module().or_else(polls),
            WriteAll => {
                module().or_else(|| no_edits(known)).or_else(line).or_else(|| known.and_then(Module::unwritable))
            }
            RevertAll => module().or_else(|| no_edits(known)),
            Undo => module().or_else(|| unless(undoable(known).is_some(), "No change of this module can be undone")),
            Redo => module().or_else(|| unless(redoable(known).is_some(), "No change of this module was undone")),
            NextTab | PreviousTab => module(),
            Remove => unless(in_view(pass.bench, pass.active).is_some(), "No module is in view"),
            ToggleRecording if pass.bench.recording().is_some() => None,
            ToggleRecording => pass.recordings.obstacle(pass.settings),
            ExportReadings => {
                let in_view = matches!(pass.active, Pane::Trends | Pane::Recording(_));
                unless(in_view, "No trends are in view: open Trends or a recording")
            }
            ClosePane => unless(pass.active != Pane::Dashboard, "The dashboard stays open"),
            PollPlan | NextPane | PreviousPane | Dashboard | Traffic | Trends | Diagnosis | OpenRecording | Beside
            | OwnWindow | Larger | Smaller | NormalSize | AddDefinition | Help | About | Quit => None,
        }
    }

    /// Does it, unless it cannot be done now.
    pub fn carry_out(self, ctx: &Context, pass: &mut Pass<'_>, panes: &mut Panes) {
        if self.obstacle(pass).is_some() {
            return;
        }
        let bench = pass.bench;
        let module = in_view(bench, pass.active);
        match (self, module) {
            (QuickScan, _) => connect::scan_with(pass, connect::plan_of(Ready::Quick, pass.settings)),
            (FullScan, _) => connect::scan_with(pass, connect::plan_of(Ready::Full, pass.settings)),
            (ConnectAgain, _) => connect::recent::ask(pass, Again::Latest),
            (StopScan, _) => pass.actions.push(Action::CancelScan),
            (CloseLine, _) => pass.actions.push(Action::Disconnect),
            (PollAll, _) => pass.actions.push(Action::PollAll(true)),
            (PauseAll, _) => pass.actions.push(Action::PollAll(false)),
            (PollPlan, _) => *pass.poll_plan = true,
            (Faults, _) => *pass.faults = true,
            (ReadAgain, Some(module)) => panes.read_again(module.target),
            (WriteAll, Some(module)) => module_view::write_all(module, pass),
            (RevertAll, Some(module)) => pass.actions.push(Action::Revert(module.target, None)),
            (Undo, Some(module)) => pass.actions.push(Action::Undo(module.target)),
            (Redo, Some(module)) => pass.actions.push(Action::Redo(module.target)),
            (TogglePolling, Some(module)) => pass.actions.push(toggled_polling(module)),
            (Remove, Some(module)) => pass.actions.push(Action::Remove(module.target)),
            (NextTab, Some(module)) => module_view::turn_page(module, pass.settings, true),
            (PreviousTab, Some(module)) => module_view::turn_page(module, pass.settings, false),
            (NextPane, _) => panes.step(true),
            (PreviousPane, _) => panes.step(false),
            (Dashboard, _) => panes.open(Pane::Dashboard),
            (Traffic, _) => panes.open(Pane::Traffic),
            (Trends, _) => panes.open(Pane::Trends),
            (Diagnosis, _) => panes.open(Pane::Diagnosis),
            (ToggleRecording, _) if bench.recording().is_some() => pass.recordings.ask(Wish::Stop),
            (ToggleRecording, _) => pass.recordings.ask(Wish::Start),
            (OpenRecording, _) => pass.recordings.ask(Wish::Open),
            (ExportReadings, _) => panes.export_readings(pass.active),
            (Beside, _) => panes.toggle_beside(pass.active),
            (OwnWindow, _) => panes.toggle_window(pass.active),
            (ClosePane, _) => pass.closing.push(pass.active),
            (Larger, _) => settings::zoom_by(ctx, 1.0),
            (Smaller, _) => settings::zoom_by(ctx, -1.0),
            (NormalSize, _) => ctx.set_zoom_factor(1.0),
            (AddDefinition, _) => *pass.add_definition = true,
            (Help, _) => panes.show_help(pass),
            (About, _) => panes.views.about.open(pass),
            (Quit, _) => ctx.send_viewport_cmd_to(ViewportId::ROOT, ViewportCommand::Close),
            (ReadAgain | WriteAll | RevertAll | Undo | Redo | TogglePolling | Remove | NextTab | PreviousTab, None) => {
            }
        }
    }
}

fn undoable(module: Option<&Module>) -> Option<&str> {
    module.and_then(Module::undoable)
}

fn redoable(module: Option<&Module>) -> Option<&str> {
    module.and_then(Module::redoable)
}

fn no_edits(module: Option<&Module>) -> Option<String> {
    module.filter(|module| module.edits.is_empty()).map(|_| "No change waits to be written".to_owned())
}

/// The action that pauses the polling of a module, or takes it up.
pub fn toggled_polling(module: &Module) -> Action {
    match module.interval {
        Some(_) => Action::StopPolling(module.target),
        None => Action::SetInterval(module.target, DEFAULT_INTERVAL),
    }
}

fn in_view(bench: &Bench, active: Pane) -> Option<&Module> {
    match active {
        Pane::Module(target) => bench.module(&target),
        Pane::Dashboard | Pane::Traffic | Pane::Trends | Pane::Diagnosis | Pane::Help | Pane::Recording(_) => None,
    }
}

/// Takes the commands whose keys were pressed in the window that `ctx` draws now. Nothing while a question waits.
pub fn take_typed(ctx: &Context, commands: &mut Vec<Command>) {
    if ctx.memory(|memory| memory.top_modal_layer().is_some()) {
        return;
    }
    let in_text = ctx.text_edit_focused();
    // Ctrl+R is heard in Ctrl+Shift+R too, so what needs more keys comes first.
    for shifted in [true, false] {
        for command in Command::all() {
            let keys = [command.shortcut(), command.other_shortcut()].into_iter().flatten();
            let heard = match command.heard_by() {
                HeardBy::Commands => true,
                HeardBy::CommandsOutsideText => !in_text,
                HeardBy::Others => false,
            };
            for keys in keys.filter(|keys| heard && keys.modifiers.shift == shifted) {
                if ctx.input_mut(|input| input.consume_shortcut(&keys)) {
                    commands.push(command);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_commands_have_the_same_keys_and_all_say_what_they_do() {
        let commands: Vec<Command> = Command::all().collect();
        for (index, command) in commands.iter().enumerate() {
            assert!(!command.text().is_empty() && !command.explanation().is_empty());
            for other in commands.iter().skip(index + 1) {
                assert_ne!(command, other, "it stands in the menu twice");
                assert_ne!(command.text(), other.text());
                if let (Some(keys), Some(others)) = (command.shortcut(), other.shortcut()) {
                    let same = keys.logical_key == others.logical_key && keys.modifiers.shift == others.modifiers.shift;
                    assert!(!same, "{command:?} and {other:?}");
                }
            }
        }
    }

    #[test]
    fn no_command_takes_what_text_fields_need_everywhere() {
        let needed = [Key::A, Key::C, Key::V, Key::X, Key::Y, Key::Z, Key::H, Key::K, Key::U];
        for command in Command::all().filter(|command| command.heard_by() == HeardBy::Commands) {
            let shortcut = command.shortcut();
            assert!(shortcut.is_none_or(|keys| !needed.contains(&keys.logical_key)), "{command:?}");
        }
    }
}
