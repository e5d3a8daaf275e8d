//! The window on a simulated line, and how the tests drive it by role and label.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use dcon_bench::bench::{Bench, ScanState};
use dcon_bench::bus::{Bus, LineAddress};
use dcon_bench::module::Catalogue;
use dcon_bench::sim::{ModuleSpec, Pace, Sim};
use dcon_bench::ui::{App, LineChoice, Settings, Start};
use eframe::egui::accesskit::Role;
use eframe::egui::{self, DroppedFile, Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

/// Far more than anything here takes; reaching it is a failure.
const LIMIT: Duration = Duration::from_secs(60);
/// Short enough that waiting costs nothing, long enough to leave the processor to the bus thread.
const BREATH: Duration = Duration::from_millis(2);

pub type Window = Harness<'static, App>;

pub fn sim(specs: &[&str], pace: Pace) -> Sim {
    let specs: Vec<ModuleSpec> = specs.iter().map(|spec| spec.parse().unwrap()).collect();
    Sim::new(&specs, pace)
}

pub fn bench(ctx: &egui::Context) -> Bench {
    let (catalogue, faulty) = Catalogue::built_in();
    let catalogue = Arc::new(catalogue);
    let ctx = ctx.clone();
    let bus = Bus::start(catalogue.clone(), move || ctx.request_repaint_after(Duration::from_millis(33))).unwrap();
    Bench::new(bus, catalogue, &faulty)
}

/// A window of the usual size.
pub fn window_of(app: impl FnOnce(&egui::Context) -> App + 'static) -> Window {
    Harness::builder().with_size(vec2(1280.0, 800.0)).build_eframe(move |creation| app(&creation.egui_ctx))
}

/// How a window on the line of `sim` starts.
pub fn start(sim: &Sim, demo: bool, settings: Settings) -> Start {
    let simulated = LineAddress::Simulated { label: "Simulated line".to_owned(), sim: sim.clone() };
    Start { simulated, demo, settings }
}

pub fn window_with(sim: &Sim, demo: bool, settings: Settings) -> Window {
    let start = start(sim, demo, settings);
    window_of(move |ctx| App::new(ctx, bench(ctx), start))
}

/// Settings that stand at the simulated line.
pub fn simulated() -> Settings {
    Settings { line: LineChoice::Simulated, ..Settings::default() }
}

/// A window that stands at the simulated line.
pub fn window(sim: &Sim) -> Window {
    window_with(sim, false, simulated())
}

/// Draws frame after frame until `reached`.
#[track_caller]
pub fn until(window: &mut Window, what: &str, reached: impl Fn(&Window) -> bool) {
    let start = Instant::now();
    loop {
        window.step();
        if reached(window) {
            return;
        }
        assert!(start.elapsed() < LIMIT, "not reached: {what}");
        std::thread::sleep(BREATH);
    }
}

#[track_caller]
pub fn click(window: &mut Window, role: Role, label: &str) {
    until(window, label, |window| window.query_by_role_and_label(role, label).is_some());
    window.get_by_role_and_label(role, label).click();
    window.step();
    window.step();
}

#[track_caller]
pub fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.step();
    window.step();
}

/// Whether a notice says so.
pub fn told(window: &Window, text: &str) -> bool {
    window.state().bench().notices().any(|notice| notice.text.contains(text))
}

/// A file as the system says that it was dropped.
#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("nobody asks".to_owned())
    }
}

pub fn drop_files(window: &mut Window, paths: &[PathBuf]) {
    for path in paths {
        window.input_mut().dropped_files.push(Arc::new(Dropped(path.clone())));
    }
    window.step();
    window.input_mut().dropped_files.clear();
    window.step();
}

pub fn shows(window: &Window, text: &str) -> bool {
    window.query_all_by_label_contains(text).next().is_some()
}

/// What the reading of this name shows, such as `24.99 °C`.
pub fn reading(window: &Window, name: &str) -> Option<String> {
    let start = format!("{name} ");
    let nodes = window.query_all_by_label_contains(&start);
    nodes.filter_map(|node| node.value()).find_map(|text| text.strip_prefix(&start).map(str::to_owned))
}

pub fn scan_ended(window: &Window) -> bool {
    matches!(window.state().bench().scan(), Some(ScanState::Ended(_)))
}

/// Scans with the button and opens the module at `address`.
#[track_caller]
pub fn open(window: &mut Window, module: &str) {
    click(window, Role::Button, "Scan");
    until(window, "the scan ends", scan_ended);
    click(window, Role::ListItem, module);
}
