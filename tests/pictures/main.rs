//! Pictures of the window, compared with those that were looked at and kept.
//!
//! They need a renderer: without a graphics card that is Mesa's lavapipe (`mesa-vulkan-drivers`). Without one nothing is
//! compared, and `DCON_BENCH_PICTURES=required` makes that a failure. `UPDATE_SNAPSHOTS=1` keeps the present
//! pictures; look at them before they are kept.

// Renderers of other systems draw otherwise.
#![cfg(target_os = "linux")]

#[path = "../common/stage.rs"]
mod stage;

use std::sync::Once;

use dcon_bench::bench::Action;
use dcon_bench::bus::Target;
use dcon_bench::ui::{App, LineChoice, Settings, Start, ThemeChoice};
use eframe::egui::{Theme, vec2};
use egui_kittest::wgpu::WgpuTestRenderer;
use egui_kittest::{Harness, SnapshotOptions, SnapshotResults};
use stage::Stage;

/// By how much a pixel may differ before it counts, and how many may: rasterisers round differently.
const THRESHOLD: f32 = 1.2;
const PIXELS: usize = 100;
/// Frames until everything that was asked for is answered and shown.
const FRAMES: usize = 12;
/// A minute of history, as the plots show it.
const HISTORY_S: u32 = 60;

#[derive(Debug, Clone, Copy)]
struct Look {
    name: &'static str,
    scale: f32,
    theme: ThemeChoice,
}

/// Both themes at both scales, in the smallest window that has to be usable.
const LOOKS: [Look; 4] = [
    Look { name: "dark", scale: 1.0, theme: ThemeChoice::Dark },
    Look { name: "dark-2x", scale: 2.0, theme: ThemeChoice::Dark },
    Look { name: "light", scale: 1.0, theme: ThemeChoice::Light },
    Look { name: "light-2x", scale: 2.0, theme: ThemeChoice::Light },
];
const SIZE: [f32; 2] = [1024.0, 700.0];

/// What to draw with, if there is anything.
fn renderer() -> Option<WgpuTestRenderer> {
    static ZONE: Once = Once::new();
    // Axes and logs show local times. Nothing else reads the environment here.
    ZONE.call_once(|| unsafe { std::env::set_var("TZ", "UTC") });
    let renderer = std::panic::catch_unwind(WgpuTestRenderer::new).ok();
    if renderer.is_none() {
        let required = std::env::var("DCON_BENCH_PICTURES").is_ok_and(|value| value == "required");
        assert!(!required, "there is no renderer: install mesa-vulkan-drivers");
        eprintln!("no renderer, so the pictures are not compared");
    }
    renderer
}

/// Compares the window with the picture of this name, in every look.
fn compare(name: &str, specs: &[&str], tab: &str, shown: usize) {
    compare_after(name, specs, tab, shown, &[]);
}

/// The same after the module that is shown was told to do something.
fn compare_after(name: &str, specs: &[&str], tab: &str, shown: usize, then: &[fn(Target) -> Action]) {
    let mut results = SnapshotResults::new();
    for look in LOOKS {
        let Some(renderer) = renderer() else { return };
        let (mut window, mut stage) = window(specs, tab, shown, look, renderer);
        for _ in 0..FRAMES {
            window.step();
            stage.play_into_window();
        }
        for action in then.iter().filter_map(|action| Some(action(*stage.targets().get(shown)?))) {
            window.state_mut().apply(action);
        }
        (0..FRAMES).for_each(|_| window.step());
        let is_light = !window.ctx.global_style().visuals.dark_mode;
        assert_eq!(is_light, look.theme == ThemeChoice::Light, "the picture has the theme of its name");
        let options =
            SnapshotOptions::new().threshold(THRESHOLD).max_failed_pixels(PIXELS).output_path("tests/pictures/kept");
        window.snapshot_options(format!("{name}-{}", look.name), &options);
        results.extend(window.take_snapshot_results());
    }
    results.unwrap();
}

fn window(
    specs: &[&str],
    tab: &str,
    shown: usize,
    look: Look,
    renderer: WgpuTestRenderer,
) -> (Harness<'static, App>, Stage) {
    let (mut bench, mut stage) = Stage::new(specs);
    let targets = stage.targets();
    for target in &targets {
        stage.live(&mut bench, *target, HISTORY_S);
    }
    let settings =
        Settings { line: LineChoice::Simulated, theme: look.theme, tab: tab.to_owned(), ..Settings::default() };
    let simulated = bench.line().line().cloned().unwrap();
    let mut window = Harness::builder()
        .with_size(vec2(SIZE[0], SIZE[1]))
        .with_pixels_per_point(look.scale)
        .with_theme(if look.theme == ThemeChoice::Light { Theme::Light } else { Theme::Dark })
        .renderer(renderer)
        .build_eframe(move |creation| App::new(&creation.egui_ctx, bench, Start { simulated, demo: false, settings }));
    if let Some(target) = targets.get(shown) {
        window.state_mut().apply(Action::Show(*target));
    }
    (window, stage)
}

const PIR_234: &str = "pir-234@1:modbus_rtu:9600";
const PIR_130: &str = "pir-130@0xA0:modbus_rtu:9600";

#[test]
fn the_configuration_of_a_pir_234() {
    compare("configuration", &[PIR_234, PIR_130], "configuration", 0);
}

#[test]
fn the_guide_through_init_mode() {
    let faster = |target| Action::Stage(target, "baud_rate".to_owned(), "19200".to_owned());
    compare_after("guide", &[PIR_234], "configuration", 0, &[faster, Action::BeginInit]);
}

#[test]
fn the_analog_inputs_of_a_pir_234() {
    compare("ai", &[PIR_234, PIR_130], "ai", 0);
}

#[test]
fn the_sensors_and_relays_of_a_pir_234() {
    compare("pir", &[PIR_234, PIR_130], "pir", 0);
}

#[test]
fn the_sensor_and_relay_of_a_pir_130() {
    compare("pir-130", &[PIR_234, PIR_130], "pir", 1);
}

#[test]
fn the_host_watchdog_over_dcon() {
    compare("wdt", &["pir-234@1:dcon:9600"], "wdt", 0);
}

#[test]
fn the_commands_over_dcon() {
    compare("commands", &["pir-234@1:dcon:9600"], "commands", 0);
}

#[test]
fn the_log_of_a_pir_234() {
    compare("log", &[PIR_234, PIR_130], "log", 0);
}

#[test]
fn the_summary_of_a_pir_234() {
    compare("summary", &[PIR_234, PIR_130], "summary", 0);
}

#[test]
fn the_dashboard() {
    compare("dashboard", &[PIR_234, PIR_130, "pir-234@0xA3:dcon:9600", "unknown@17"], "ai", usize::MAX);
}
