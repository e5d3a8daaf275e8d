//! The window. It draws what the bench knows and gives back what the user asks for; ports, bytes and files are not
//! its business, but for the file that keeps its own settings.
//!
//! `app` puts the parts together, `theme` holds all colours and sizes, `widgets` and `words` serve every part; each
//! other file is one part of the window.

mod app;
mod commands;
mod connect;
mod dashboard;
mod dashboard_table;
mod diagnosis;
mod dialogs;
mod dropping;
mod empty;
mod faults;
mod guard;
mod help;
mod icon;
mod init_guide;
mod interval;
mod modal;
mod module_list;
mod module_view;
mod notices;
mod pace;
mod pane_tabs;
mod panes;
mod picture;
mod plot;
mod poll_plan;
mod recording;
mod renderer;
mod saving;
mod scan_form;
mod settings;
mod status;
mod tables;
mod theme;
mod traffic;
mod trends;
mod widgets;
mod words;

use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use eframe::egui::ViewportBuilder;

pub use app::{App, Start};
use pace::Pace;
#[doc(hidden)]
pub use trends::measure;

pub use settings::{LineChoice, RecentLine, Settings, SettingsFile, TemperatureUnit, ThemeChoice};

use crate::bench::{Action, Bench, Severity};
use crate::bus::{Bus, LineAddress};
use crate::module::Catalogue;
use crate::renderer::Renderer;
use crate::sim::{Fault, FaultError};
use crate::version::NAME;

/// Shows the window until it is closed, drawn with `renderer`, or as the environment says. The simulated line goes wrong with
/// `faults` from the start.
pub fn run(demo: bool, faults: &[Fault], renderer: Option<Renderer>) -> ExitCode {
    let begin = Instant::now();
    if !has_display() {
        eprintln!(
            "There is no display (neither DISPLAY nor WAYLAND_DISPLAY is set) – use the command line, see {NAME} --help"
        );
        return ExitCode::FAILURE;
    }
    let simulated = match simulated(faults) {
        Ok(line) => line,
        Err(reason) => {
            eprintln!("{reason}");
            return ExitCode::from(2);
        }
    };
    renderer::run(renderer::wanted(renderer), |renderer, first| {
        let simulated = simulated.clone();
        show(renderer, move |creation| {
            first.watch(&creation.egui_ctx, begin);
            start(creation, demo, simulated)
        })
    })
}

/// Whether there is anything to show a window on, as far as that is known beforehand.
fn has_display() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || set("DISPLAY") || set("WAYLAND_DISPLAY")
}

/// The simulated line of this run, with its faults.
fn simulated(faults: &[Fault]) -> Result<LineAddress, FaultError> {
    let line = LineAddress::demo();
    if let LineAddress::Simulated { sim, .. } = &line {
        let mut all = sim.faults();
        faults.iter().try_for_each(|fault| all.set(*fault))?;
        sim.set_faults(all);
    }
    Ok(line)
}

fn show(
    renderer: eframe::Renderer,
    start: impl FnOnce(&eframe::CreationContext<'_>) -> std::io::Result<App>,
) -> eframe::Result {
    let viewport = ViewportBuilder::default()
        .with_title(NAME)
        .with_app_id(NAME)
        .with_icon(icon::window())
        .with_inner_size(theme::WINDOW)
        .with_min_inner_size(theme::WINDOW_LEAST);
    let persistence_path = crate::folders::config().map(|folder| folder.join("window.ron"));
    let options = eframe::NativeOptions { viewport, renderer, persistence_path, ..eframe::NativeOptions::default() };
    eframe::run_native(NAME, options, Box::new(|creation| Ok(Box::new(start(creation)?))))
}

fn start(creation: &eframe::CreationContext<'_>, demo: bool, simulated: LineAddress) -> std::io::Result<App> {
    let (catalogue, faulty) = match crate::folders::definitions() {
        Some(folder) => Catalogue::with_folder(&folder),
        None => Catalogue::built_in(),
    };
    let catalogue = Arc::new(catalogue);
    let pace = Pace::of(&creation.egui_ctx);
    let of_bus = pace.clone();
    let bus = Bus::start(catalogue.clone(), move || of_bus.wake())?;
    let mut bench = Bench::new(bus, catalogue, &faulty).with_wake(move || pace.wake());
    let settings::Opened { settings, file, warnings } = settings::open(crate::folders::config().as_deref());
    warnings.into_iter().for_each(|text| bench.apply(Action::Notify(Severity::Warning, text)));
    let start = Start { simulated, demo, settings };
    let app = App::new(&creation.egui_ctx, bench, start).keeping_settings_in(file);
    Ok(app.recording_in(crate::folders::recordings()))
}
