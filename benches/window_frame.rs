//! What one frame of the window costs in processor time, with sixteen modules open and a history of ten minutes each.
//!
//! `cargo bench --bench window_frame`. Drawing on the screen is the renderer's business and not counted; laying out and
//! cutting everything into triangles is.

#[allow(dead_code)]
#[path = "../tests/common/stage.rs"]
mod stage;

use std::time::{Duration, Instant};

use dcon_bench::bench::Action;
use dcon_bench::ui::{App, LineChoice, Settings, Start};
use eframe::egui::vec2;
use egui_kittest::Harness;
use stage::Stage;

const MODULES: u8 = 16;
const HISTORY_S: u32 = 600;
const WARM_UP: usize = 20;
const FRAMES: usize = 300;
const TABS: [&str; 7] = ["configuration", "ai", "pir", "wdt", "commands", "log", "summary"];

fn main() {
    println!("{MODULES} modules open, processor time of one frame:");
    println!("{:16} {:>10} {:>10}", "tab", "median", "99 %");
    for tab in TABS {
        let times = measure(tab);
        let at = |part: f64| times[((times.len() - 1) as f64 * part) as usize];
        println!("{tab:16} {:>10} {:>10}", text(at(0.5)), text(at(0.99)));
    }
}

fn text(time: Duration) -> String {
    format!("{:.2} ms", time.as_secs_f64() * 1e3)
}

fn measure(tab: &str) -> Vec<Duration> {
    let specs: Vec<String> = (1..=MODULES).map(|address| format!("pir-234@{address}:modbus_rtu:9600")).collect();
    let specs: Vec<&str> = specs.iter().map(String::as_str).collect();
    let (mut bench, mut stage) = Stage::new(&specs);
    let targets = stage.targets();
    for target in &targets {
        stage.live(&mut bench, *target, HISTORY_S);
    }
    let settings = Settings { line: LineChoice::Simulated, tab: tab.to_owned(), ..Settings::default() };
    let simulated = bench.line().line().cloned().expect("the line is open");
    let mut window = Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        .build_eframe(move |creation| App::new(&creation.egui_ctx, bench, Start { simulated, demo: false, settings }));
    for target in targets {
        window.state_mut().apply(Action::Show(target));
        window.step();
        stage.play_into_window();
    }
    (0..WARM_UP).for_each(|_| window.step());
    let mut times: Vec<Duration> = (0..FRAMES).map(|_| frame(&mut window)).collect();
    times.sort();
    times
}

fn frame(window: &mut Harness<'_, App>) -> Duration {
    let start = Instant::now();
    window.step();
    let shapes = window.output().shapes.clone();
    let triangles = window.ctx.tessellate(shapes, 1.0);
    let time = start.elapsed();
    assert!(!triangles.is_empty());
    time
}
