//! The window as a whole: takes in events, lets each part draw itself, and carries out what was asked for.

use std::borrow::Cow;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use eframe::egui::{self, CentralPanel, Panel};

use super::commands::{self, Command};
use super::connect::Connect;
use super::connect::recent::{self, Again};
use super::dialogs::Dialogs;
use super::faults::FaultsPanel;
use super::guard::{Confirm, Guard};
use super::init_guide::InitGuide;
use super::notices::Notices;
use super::panes::{Pane, Panes};
use super::poll_plan::PollPlan;
use super::recording::Recordings;
use super::saving::SaveAs;
use super::scan_form::ScanForm;
use super::settings::{LineChoice, Settings, SettingsFile};
use super::trends::export::{self, ExportForm};
use super::{connect, dropping, module_list, notices, scan_form, status, theme};
use crate::bench::{Action, Bench, LineState, Severity};
use crate::bus::{BusEvent, LineAddress};

/// How often ages are written anew while something is polled.
const AGES_EVERY: Duration = Duration::from_secs(1);
/// What was drawn and is on the disk only is asked for in the next frame, soon, but not at once for ever.
const FETCH_AFTER: Duration = Duration::from_millis(100);
/// Batches of events taken in before a frame; more wait for the next one.
const BATCHES: usize = 4;

/// How the window starts.
pub struct Start {
    /// What "Simulated line" opens.
    pub simulated: LineAddress,
    /// Choose the simulated line and scan it at once.
    pub demo: bool,
    pub settings: Settings,
}

/// What every part gets for drawing: the state to show, the window's own choices, and where to put what the user asks.
pub struct Pass<'a> {
    pub bench: &'a Bench,
    pub settings: &'a mut Settings,
    pub connect: &'a mut Connect,
    pub actions: &'a mut Vec<Action>,
    /// A question to be asked before its actions are carried out.
    pub confirm: &'a mut Option<Confirm>,
    /// A file to be written; the user is asked where.
    pub save: &'a mut Option<SaveAs>,
    /// Readings to be taken away; the user is asked which and how.
    pub export: &'a mut Option<export::Wanted>,
    /// What concerns recording.
    pub recordings: &'a mut Recordings,
    /// Panes that the user wants closed.
    pub closing: &'a mut Vec<Pane>,
    /// Commands that were chosen or typed; they are carried out when everything is drawn.
    pub commands: &'a mut Vec<Command>,
    /// Set to show the poll plan.
    pub poll_plan: &'a mut bool,
    /// Set to show the faults of the simulated line.
    pub faults: &'a mut bool,
    /// A line to be connected as last time.
    pub again: &'a mut Option<Again>,
    /// Set to ask for a definition file.
    pub add_definition: &'a mut bool,
    /// The pane that the user works in: commands and keys are meant for it.
    pub active: Pane,
}

pub struct App {
    bench: Bench,
    settings: Settings,
    connect: Connect,
    scan_form: ScanForm,
    panes: Panes,
    guard: Guard,
    notices: Notices,
    dialogs: Dialogs,
    init_guide: InitGuide,
    poll_plan: PollPlan,
    faults: FaultsPanel,
    recordings: Recordings,
    export_form: ExportForm,
    /// A line to be connected as last time, when the ports are known.
    again: Option<Again>,
    /// What was chosen before a demonstration, which is not to be remembered.
    line_before_demo: Option<LineChoice>,
    /// Where the settings are kept; nowhere in tests.
    settings_file: Option<SettingsFile>,
}

impl App {
    pub fn new(ctx: &egui::Context, bench: Bench, start: Start) -> Self {
        let Start { simulated, demo, settings } = start;
        theme::apply(ctx);
        settings.apply(ctx);
        let panes = settings.layout.as_deref().map_or_else(Panes::default, Panes::from_layout);
        let mut app = Self {
            bench,
            settings,
            connect: Connect::new(simulated),
            scan_form: ScanForm::default(),
            panes,
            guard: Guard::default(),
            notices: Notices::default(),
            dialogs: Dialogs::default(),
            init_guide: InitGuide::default(),
            poll_plan: PollPlan::default(),
            faults: FaultsPanel::default(),
            recordings: Recordings::default(),
            export_form: ExportForm::default(),
            again: None,
            line_before_demo: None,
            settings_file: None,
        };
        app.bench.apply(Action::Tune(app.settings.tuning()));
        app.bench.apply(Action::RefreshPorts);
        if demo {
            app.line_before_demo = Some(app.settings.line.clone());
            let action = app.connect.try_simulated(&mut app.settings);
            app.carry_out(action);
        }
        app
    }

    /// Keeps the settings in `file` from now on.
    pub fn keeping_settings_in(mut self, file: Option<SettingsFile>) -> Self {
        self.settings_file = file;
        self
    }

    /// Asks for files in a field of the window from now on, and not with the system's dialog.
    pub fn without_system_dialogs(mut self) -> Self {
        self.dialogs.only_field = true;
        self.recordings.without_file_manager();
        self
    }

    /// Begins to record by itself when the first module is polled: into `folder`, unless the settings name another or want
    /// no recording.
    pub fn recording_in(mut self, folder: Option<PathBuf>) -> Self {
        self.recordings.begin_by_itself(folder);
        self
    }

    pub fn bench(&self) -> &Bench {
        &self.bench
    }

    /// Takes in an event as if the bus had told it.
    pub fn take(&mut self, event: BusEvent) {
        self.bench.take(event);
    }

    /// Carries out an action as if the user had asked for it in the window.
    pub fn apply(&mut self, action: Action) {
        let Some(action) = self.guard.pass(&self.bench, action) else { return };
        self.carry_out(action);
    }

    fn carry_out(&mut self, action: Action) {
        self.connect.note(&action);
        match &action {
            Action::SetFaults(wanted) => {
                let open = self.connect.mended(&self.bench, wanted);
                self.bench.apply(action);
                return open.into_iter().for_each(|open| self.bench.apply(open));
            }
            Action::Show(target) => self.panes.open(Pane::Module(*target)),
            Action::Remove(target) => self.panes.close(Pane::Module(*target)),
            Action::OpenRecording(path) => {
                let path = path.clone();
                self.bench.apply(action);
                let opened = self.bench.opened().find(|(_, viewer)| viewer.path() == path).map(|(id, _)| id);
                return opened.into_iter().for_each(|id| self.panes.open(Pane::Recording(id)));
            }
            _ => {}
        }
        self.bench.apply(action);
    }

    fn close(&mut self, pane: Pane) {
        self.panes.close(pane);
        if let Pane::Recording(id) = pane {
            self.panes.forget(id);
            self.bench.apply(Action::CloseRecording(id));
        }
    }

    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What outlives this run: a demonstration's choice of line does not.
    fn lasting_settings(&self) -> Cow<'_, Settings> {
        match (&self.settings.line, &self.line_before_demo) {
            (LineChoice::Simulated, Some(line)) => Cow::Owned(Settings { line: line.clone(), ..self.settings.clone() }),
            _ => Cow::Borrowed(&self.settings),
        }
    }

    /// Looks for changed settings; they are written some seconds later.
    fn keep_settings(&mut self, ctx: &egui::Context) {
        let Some(mut file) = self.settings_file.take() else { return };
        let outcome = file.keep(&self.lasting_settings(), Instant::now());
        self.settings_file = Some(file);
        if let Some(text) = outcome.warning {
            self.bench.apply(Action::Notify(Severity::Warning, text));
            ctx.request_repaint();
        }
        if let Some(wait) = outcome.look_again {
            ctx.request_repaint_after(wait);
        }
    }

    /// Writes changed settings at once; returns what the user has not been told yet.
    fn keep_settings_now(&mut self) -> Option<String> {
        let mut file = self.settings_file.take()?;
        let warning = file.keep_now(&self.lasting_settings());
        self.settings_file = Some(file);
        warning
    }

    fn draw(&mut self, ui: &mut egui::Ui, actions: &mut Vec<Action>) {
        let Self {
            bench,
            settings,
            connect,
            scan_form,
            panes,
            guard,
            notices,
            dialogs,
            init_guide,
            poll_plan,
            faults,
            recordings,
            export_form,
            again,
            ..
        } = self;
        let palette = theme::palette(ui);
        let (mut show_plan, mut show_faults, mut add_definition) = (false, false, false);
        let (mut confirm, mut save, mut export, mut closing, mut commands) = (None, None, None, Vec::new(), Vec::new());
        let mut pass = Pass {
            bench,
            settings,
            connect,
            actions,
            confirm: &mut confirm,
            save: &mut save,
            export: &mut export,
            recordings,
            closing: &mut closing,
            commands: &mut commands,
            poll_plan: &mut show_plan,
            faults: &mut show_faults,
            again,
            add_definition: &mut add_definition,
            active: panes.active(),
        };
        commands::take_typed(ui.ctx(), pass.commands);

        Panel::top("connect").frame(theme::panel_frame(palette)).show(ui, |ui| connect::show(ui, &mut pass, scan_form));
        if scan_form.open {
            let frame = theme::panel_frame(palette);
            Panel::top("scan form").frame(frame).show(ui, |ui| scan_form::show(ui, &mut pass, scan_form));
        }
        Panel::bottom("status")
            .exact_size(theme::STATUS_HEIGHT)
            .frame(theme::bar_frame(palette))
            .show(ui, |ui| status::show(ui, &mut pass, notices));
        notices.look_at_line(bench);
        if notices.waiting(bench).next().is_some() {
            let frame = theme::error_frame(palette);
            Panel::bottom("errors").frame(frame).show(ui, |ui| notices::strip(ui, bench, notices));
        }
        Panel::left("modules")
            .default_size(theme::LIST_WIDTH)
            .size_range(theme::list_range(ui.ctx().content_rect().width()))
            .frame(theme::list_frame(palette))
            .show(ui, |ui| module_list::show(ui, &mut pass));
        let frame = theme::list_frame(palette);
        let middle = CentralPanel::default().frame(frame).show(ui, |ui| panes.show(ui, &mut pass, dialogs)).response;
        init_guide.show(ui.ctx(), &mut pass);
        poll_plan.show(ui.ctx(), &mut pass);
        faults.show(ui.ctx(), &mut pass, middle.rect);
        dialogs.show(ui.ctx(), bench, pass.actions);
        dropping::overlay(ui.ctx());
        pass.active = panes.active();
        for command in std::mem::take(pass.commands) {
            command.carry_out(ui.ctx(), &mut pass, panes);
            ui.ctx().request_repaint();
        }
        poll_plan.open |= show_plan;
        faults.open |= show_faults;
        if add_definition {
            dialogs.ask_for_definition(ui.ctx());
        }
        if let Some(save) = save {
            dialogs.ask_to_save(ui.ctx(), save);
        }
        if let Some(wanted) = export {
            export_form.open(wanted, settings);
        }
        export_form.show(ui.ctx(), bench, dialogs);
        recordings.show(ui.ctx(), bench, settings, dialogs, actions);
        if let Some(confirm) = confirm {
            guard.confirm(confirm);
        }
        let closed: Vec<Pane> = closing.into_iter().filter(|pane| guard.close(bench, *pane)).collect();
        closed.into_iter().for_each(|pane| self.close(pane));
    }

    /// Asks what has to be asked, and does what was decided.
    fn ask(&mut self, ctx: &egui::Context) {
        self.guard.quit(ctx, &self.bench);
        let outcome = self.guard.show(ctx, &self.bench);
        outcome.actions.into_iter().for_each(|action| self.carry_out(action));
        if let Some(pane) = outcome.close {
            self.close(pane);
        }
    }

    /// Connects a line as last time, if one waits for that and the ports are known.
    fn connect_again(&mut self) {
        if self.bench.is_looking_for_ports() {
            return;
        }
        let Some(wanted) = self.again.take() else { return };
        let action = recent::connect_now(wanted, &self.bench, &mut self.settings);
        self.apply(action.unwrap_or_else(|reason| Action::Notify(Severity::Error, reason)));
    }

    /// Opens what was dropped onto the window.
    fn take_dropped(&mut self, ctx: &egui::Context) {
        for action in dropping::dropped(ctx) {
            self.apply(action);
            ctx.request_repaint();
        }
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        let all_taken = (0..BATCHES).any(|_| !self.bench.drain());
        if !all_taken {
            ctx.request_repaint();
        }
        let now = Instant::now();
        if let Some(due) = self.bench.tick(now) {
            ctx.request_repaint_after(due.saturating_duration_since(now));
        }
        for (from, to) in self.bench.take_moves() {
            self.panes.follow(from, to);
        }
        for (before, now) in self.bench.take_renamed() {
            self.connect.follow(&now);
            self.settings.follow_line(&before, &now);
        }
        // Ports that are being looked for may be others than those that are known.
        if let LineState::Open { line } = self.bench.line()
            && !self.bench.is_looking_for_ports()
        {
            self.settings.note_line(line, self.bench.settings(), self.bench.ports());
        }
        self.connect_again();
        if let Some(action) = self.recordings.begin(&self.bench, &self.settings) {
            self.bench.apply(action);
        }
        if self.bench.modules().iter().any(|module| module.interval.is_some()) {
            ctx.request_repaint_after(AGES_EVERY);
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        self.panes.views.about.note_renderer(frame);
        let mut actions = Vec::new();
        self.draw(ui, &mut actions);
        self.settings.note_zoom(ui.ctx());
        if !actions.is_empty() {
            // What was asked for shows in the next frame.
            ui.ctx().request_repaint();
        }
        if self.bench.is_fetching() {
            ui.ctx().request_repaint_after(FETCH_AFTER);
        }
        actions.into_iter().for_each(|action| self.apply(action));
        self.ask(ui.ctx());
        self.take_dropped(ui.ctx());
        self.keep_settings(ui.ctx());
    }

    /// The storage is for the window's geometry, which eframe keeps itself.
    fn save(&mut self, _storage: &mut dyn eframe::Storage) {
        self.settings.layout = self.panes.layout();
        if let Some(text) = self.keep_settings_now() {
            self.bench.apply(Action::Notify(Severity::Warning, text));
        }
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        self.settings.layout = self.panes.layout();
        if let Some(text) = self.keep_settings_now() {
            log::warn!("{text}");
        }
        self.bench.end_recording().into_iter().for_each(|text| log::warn!("{text}"));
    }
}
