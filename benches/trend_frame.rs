//! What one frame of the plots costs in processor time, by the length of the history, while it is moved and zoomed.
//!
//! `cargo bench --bench trend_frame`. Drawing on the screen is the renderer's business and not counted; laying out and
//! cutting everything into triangles is.

use std::hint::black_box;
use std::time::{Duration, Instant};

use dcon_bench::record::{History, ModuleInfo, SeriesInfo, SeriesKind, Trend};
use dcon_bench::ui::measure::Plots;
use eframe::egui::{self, vec2};

const LENGTHS: [i64; 5] = [1_000, 10_000, 100_000, 1_000_000, 10_000_000];
const SERIES: [u8; 2] = [1, 16];
const SIZE: egui::Vec2 = vec2(1_280.0, 800.0);
/// Columns of a plot, about.
const COLUMNS: usize = 1_000;
const WARM_UP: u32 = 20;
const FRAMES: u32 = 300;
/// One sample each second, from 1 January 2026.
const START: i64 = 1_767_225_600;

fn main() {
    println!("processor time of one frame of the plots, moved and zoomed, and of the lines of one series alone:");
    println!(
        "{:>10} {:>7} {:>10} {:>10} {:>12} {:>12}",
        "samples", "series", "median", "99 %", "lines median", "lines 99 %"
    );
    for length in LENGTHS {
        let trend = trend(length);
        let lines = sorted((0..FRAMES).map(|frame| time_lines(&trend, view(length, frame))));
        for count in SERIES {
            let frames = sorted(frames(&trend, length, count));
            let [a, b] = [&frames, &lines].map(|times| [part(times, 0.5), part(times, 0.99)].map(text));
            println!("{length:>10} {count:>7} {:>10} {:>10} {:>12} {:>12}", a[0], a[1], b[0], b[1]);
        }
    }
}

fn text(time: Duration) -> String {
    format!("{:.3} ms", time.as_secs_f64() * 1e3)
}

fn sorted(times: impl IntoIterator<Item = Duration>) -> Vec<Duration> {
    let mut times: Vec<Duration> = times.into_iter().collect();
    times.sort();
    times
}

fn part(times: &[Duration], part: f64) -> Duration {
    times[((times.len() - 1) as f64 * part) as usize]
}

/// Noise on a slow wave, in hundredths, with a gap each hour.
fn trend(length: i64) -> Trend {
    let mut trend = Trend::new(2);
    let mut noise = 1_u64;
    for second in 0..length {
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let wave = (second as f64 / 5_000.0).sin() * 300.0;
        if second % 3_600 == 0 {
            trend.mark_gap();
        }
        trend.push((START + second) * 1_000_000, 2_200 + wave as i64 + (noise >> 60) as i64);
    }
    trend
}

/// From everything to a little of it and back, at another place each time.
fn view(length: i64, frame: u32) -> [f64; 2] {
    let (length, turn) = (length as f64, f64::from(frame) / f64::from(FRAMES));
    let span = (length * 0.5f64.powf(12.0 * (turn * std::f64::consts::PI).sin())).max(100.0).min(length);
    let from = START as f64 + (length - span) * turn;
    [from, from + span]
}

fn time_lines(trend: &Trend, [from, to]: [f64; 2]) -> Duration {
    let start = Instant::now();
    black_box(trend.lines(from, to, COLUMNS));
    start.elapsed()
}

fn frames(trend: &Trend, length: i64, count: u8) -> Vec<Duration> {
    let mut history = History::default();
    for address in 1..=count {
        let module = history.module(ModuleInfo { address, label: "PIR-234".to_owned(), ..ModuleInfo::default() });
        let [item, label, unit] = ["temperature_c", "Temperature", "°C"].map(str::to_owned);
        let id = history.series_for(SeriesInfo { module, item, label, unit, kind: SeriesKind::Number { decimals: 2 } });
        // Its samples are shared by all.
        *history.trend_mut(id).expect("it was added") = trend.clone();
    }
    let ctx = egui::Context::default();
    let mut plots = Plots::default();
    let mut frame = |number: u32| {
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, SIZE);
        let input = egui::RawInput { screen_rect: Some(screen), ..egui::RawInput::default() };
        let start = Instant::now();
        let mut output = ctx.run_ui(input, |ui| plots.show(ui, &history, view(length, number % FRAMES)));
        output.textures_delta.clear();
        let triangles = ctx.tessellate(output.shapes, 1.0);
        let time = start.elapsed();
        assert!(!triangles.is_empty());
        time
    };
    for number in 0..WARM_UP {
        frame(number);
    }
    (0..FRAMES).map(frame).collect()
}
