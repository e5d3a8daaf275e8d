//! From simulated modules over the line into a recording, and out of it again.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Lines};
use std::path::Path;
use std::process::{ChildStderr, Command};
use std::time::Duration;

use dcon_bench::sim::{ModuleSpec, Pace, Sim, TcpServer};
use serde_json::json;
use tempfile::TempDir;

use crate::program::{Running, bench, good, text};
use crate::usage::recording;

/// Frames on the line after which each module that answers was read as a whole.
const SEEN_BY_ALL: u64 = 40;

/// Two modules over TCP, what they are told to measure, and the program that records them.
struct Scene {
    sim: Sim,
    recorder: Running,
    said: Lines<BufReader<ChildStderr>>,
    _server: TcpServer,
    /// What each module measured, in order, by the column of the export.
    courses: BTreeMap<String, Vec<String>>,
}

impl Scene {
    fn new(file: &str) -> Self {
        let specs: Vec<ModuleSpec> = ["pir-234@1", "pir-234@2"].map(|spec| spec.parse().unwrap()).into();
        let sim = Sim::new(&specs, Pace::Real);
        let server = TcpServer::bind(&sim, "127.0.0.1:0".parse().unwrap()).unwrap();
        for address in [1, 2] {
            sim.set_motion(address, 0, false);
        }
        // Visitors of before are forgotten.
        sim.advance(Duration::from_secs(120));
        let place = server.address().to_string();
        let mut courses = BTreeMap::new();
        for (address, celsius) in [(1, 19.5), (2, 20.5)] {
            tell(&sim, &mut courses, address, celsius);
        }
        let mut recorder = Running::start(&["record", "--tcp", &place, "1", "2", "--interval", "0", "--out", file]);
        let said = BufReader::new(recorder.child.stderr.take().unwrap()).lines();
        let scene = Self { sim, recorder, said, _server: server, courses };
        scene.wait();
        scene
    }

    /// Changes what both modules measure, and waits until they were read.
    fn measure(&mut self, celsius: [f64; 2]) {
        for (address, celsius) in [1, 2].into_iter().zip(celsius) {
            tell(&self.sim, &mut self.courses, address, celsius);
        }
        self.wait();
    }

    fn wait(&self) {
        let until = self.sim.requests() + SEEN_BY_ALL;
        while self.sim.requests() < until {
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Waits until the program says so.
    fn hear(&mut self, word: &str) {
        self.said.by_ref().map_while(Result::ok).find(|line| line.contains(word)).unwrap_or_else(|| panic!("{word}"));
    }
}

fn tell(sim: &Sim, courses: &mut BTreeMap<String, Vec<String>>, address: u8, celsius: f64) {
    sim.set_temperature(address, celsius);
    sim.set_humidity(address, celsius + 50.0);
    for (column, value) in [("temperature_c [°C]", celsius), ("humidity [%]", celsius + 50.0)] {
        courses.entry(format!("PIR-234@{address} {column}")).or_default().push(format!("{value:.2}"));
    }
}

/// The cells of each column of a CSV text without quotes, where they are not empty and differ from the one before.
fn courses_of(csv: &str) -> BTreeMap<String, Vec<String>> {
    let mut lines = csv.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut courses = BTreeMap::<String, Vec<String>>::new();
    for line in lines {
        for (name, cell) in names.iter().zip(line.split(',')).filter(|(_, cell)| !cell.is_empty()) {
            let course = courses.entry((*name).to_owned()).or_default();
            if course.last().is_none_or(|last| last != cell) {
                course.push(cell.to_owned());
            }
        }
    }
    courses
}

/// Everything that can be taken away of a recording, by the names that `check.py` knows.
fn export_all(folder: &Path, file: &str) {
    for (name, words) in [
        ("time.csv", ""),
        ("time.jsonl", ""),
        ("time.parquet", ""),
        ("sample.csv", "--rows sample --utc"),
        ("sample.jsonl", "--rows sample"),
        ("sample.parquet", "--rows sample"),
        ("events.csv", "--events --utc"),
        ("events.jsonl", "--events"),
    ] {
        let out = folder.join(name);
        let args = ["export", file, "--out", out.to_str().unwrap()].into_iter();
        good(&args.chain(words.split_whitespace()).collect::<Vec<_>>());
    }
}

/// Lets Python's own libraries read every format, if they are there.
fn read_by_others(folder: &Path, file: &str, courses: &BTreeMap<String, Vec<String>>) {
    let python = std::env::var("DCON_BENCH_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let required = std::env::var("DCON_BENCH_READERS").is_ok_and(|value| value == "required");
    if Command::new(&python).arg("--version").output().is_err() {
        assert!(!required, "{python} is not there");
        return;
    }
    let expected = folder.join("courses.json");
    std::fs::write(&expected, json!(courses).to_string()).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/export/check.py");
    let output = Command::new(python).arg(script).arg(file).arg(folder).arg(&expected).output().unwrap();
    let said = text(&output.stdout) + &text(&output.stderr);
    println!("{said}");
    assert!(output.status.success(), "{said}");
    assert!(!required || !said.contains("skipped"), "{said}");
}

#[test]
fn exports_agree_with_what_the_modules_were_in_every_format_and_for_other_programs() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("hall.sqlite");
    let file = path.to_str().unwrap();
    let mut scene = Scene::new(file);
    for step in 1..5 {
        scene.measure([20.0 + f64::from(step) * 0.37, 20.0 - f64::from(step) * 1.05]);
    }
    scene.sim.set_motion(1, 3, true);
    scene.wait();
    // It can be taken away while it grows, as soon as the first second is on the disk.
    while bench(&["export", file, "--series", "1/temperature_c"]).status.code() != Some(0) {
        scene.wait();
    }
    scene.sim.set_dead(2, true);
    scene.hear("Lost: no answer");
    // Nobody can know what a dead module measures.
    let known = scene.courses.clone();
    scene.measure([-3.25, 99.0]);
    scene.courses.extend(known.into_iter().filter(|(column, _)| column.contains("@2")));
    scene.sim.set_temperature(2, 25.0);
    scene.sim.set_humidity(2, 75.0);
    scene.sim.set_dead(2, false);
    scene.hear("Answers again");
    scene.measure([-0.05, 25.75]);
    for (column, value) in [("temperature_c [°C]", "25.00"), ("humidity [%]", "75.00")] {
        let course = scene.courses.get_mut(&format!("PIR-234@2 {column}")).unwrap();
        course.insert(course.len() - 1, value.to_owned());
    }
    assert_eq!(scene.recorder.end_by("-TERM"), Some(0));
    let told = scene.recorder.line();
    assert!(told.starts_with(&format!("{file}: ")) && told.contains(" samples in "), "{told}");

    export_all(folder.path(), file);
    let found = courses_of(&std::fs::read_to_string(folder.path().join("time.csv")).unwrap());
    for (column, course) in &scene.courses {
        assert_eq!(found.get(column), Some(course), "{column}");
    }
    assert_eq!(found["PIR-234@1 pir3"], ["false", "true"]);
    let samples = std::fs::read_to_string(folder.path().join("sample.csv")).unwrap();
    let count = samples.lines().count() - 1;
    assert!(told.contains(&format!(": {count} samples")), "{told}, {count} exported");
    let gaps = |row: &&str| row.contains(",PIR-234@2,temperature_c,25.00,°C,true");
    assert_eq!(samples.lines().filter(gaps).count(), 1);
    let events = std::fs::read_to_string(folder.path().join("events.csv")).unwrap();
    for event in [
        "PIR-234@1,found,\"Found at address 1 (01h), Modbus TCP\"",
        "PIR-234@1,motion,",
        "PIR-234@2,lost,Lost: no answer",
        "PIR-234@2,found,Answers again",
    ] {
        assert!(events.contains(event), "{event}: {events}");
    }
    read_by_others(folder.path(), file, &scene.courses);
}

#[test]
fn other_programs_read_long_recordings_too() {
    let folder = TempDir::new().unwrap();
    let file = recording(folder.path(), 3_600);
    export_all(folder.path(), &file);
    let course: Vec<String> = (0..3_600).map(|place| format!("{}.{:02}", 20, place % 100)).collect();
    let courses = [1, 2].map(|address| (format!("PIR-234@{address} temperature_c [°C]"), course.clone()));
    read_by_others(folder.path(), &file, &courses.into());
}

#[test]
fn a_recording_ends_after_its_time_and_is_continued_by_the_next() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("hall.sqlite");
    let file = path.to_str().unwrap();
    let record = |modules: &[&str]| {
        let args = ["record", "--demo", "--interval", "0", "--duration", "3s", "--out", file].into_iter();
        bench(&args.chain(modules.iter().copied()).collect::<Vec<_>>())
    };
    let first = record(&["1", "0xA3:dcon", "99"]);
    let said = text(&first.stderr);
    assert_eq!(first.status.code(), Some(0), "{said}");
    assert_eq!(said.matches("address 99 (63h)").count(), 1, "{said}");
    let second = record(&["--address", "0xA3", "--protocol", "dcon"]);
    assert_eq!(second.status.code(), Some(0), "{}", text(&second.stderr));
    let count = |output: &[u8]| -> usize {
        let told = text(output);
        told.strip_prefix(&format!("{file}: ")).unwrap().split(' ').next().unwrap().parse().unwrap()
    };
    let rows = good(&["export", file, "--rows", "sample"]);
    assert_eq!(rows.lines().count() - 1, count(&first.stdout) + count(&second.stdout));
    let listed = good(&["export", file, "--list"]);
    assert!(listed.contains("PIR-234@1/temperature_c") && listed.contains("PIR-234@163/temperature_c"), "{listed}");
    assert!(listed.contains("dcon 9600 n81"), "{listed}");
    let gaps = rows.lines().filter(|row| row.contains("@163,temperature_c,") && row.ends_with("true")).count();
    assert_eq!(gaps, 1, "nobody measured between the two");
}

#[test]
fn a_recording_of_nobody_ends_with_1() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("hall.sqlite");
    let output = bench(&["record", "--demo", "99", "--duration", "1s", "--out", path.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stdout).contains(": 0 samples"), "{}", text(&output.stdout));
    assert!(text(&output.stderr).contains("scan --full"), "{}", text(&output.stderr));
}

#[test]
fn an_interrupted_recording_ends_with_0_and_has_everything() {
    for signal in ["-INT", "-TERM"] {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("hall.sqlite");
        let file = path.to_str().unwrap();
        let mut recorder = Running::start(&["record", "--demo", "1", "--interval", "0", "--out", file]);
        while !path.exists() {
            std::thread::sleep(Duration::from_millis(2));
        }
        assert_eq!(recorder.end_by(signal), Some(0));
        let told = recorder.line();
        let rows = good(&["export", file, "--rows", "sample"]).lines().count() - 1;
        assert!(told.starts_with(&format!("{file}: {rows} samples in ")), "{told}: {rows}");
    }
}

#[test]
fn an_interrupted_export_ends_with_1_and_leaves_the_old_file() {
    let folder = TempDir::new().unwrap();
    let file = recording(folder.path(), 150_000);
    let (out, part) = (folder.path().join("hall.csv"), folder.path().join("hall.csv.part"));
    std::fs::write(&out, "old").unwrap();
    let args = ["export", &file, "--rows", "sample", "--out", out.to_str().unwrap()];
    let mut export = Running::start(&args);
    while !part.exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(export.end_by("-TERM"), Some(1));
    assert!(!part.exists());
    assert_eq!(std::fs::read_to_string(&out).unwrap(), "old");

    let mut export = Running::start(&["export", &file]);
    assert!(export.line().starts_with("time,"));
    export.lines = BufReader::new(closed()).lines();
    assert_eq!(export.child.wait().unwrap().code(), Some(0), "nobody listens any more");
    assert_eq!(std::io::read_to_string(export.child.stderr.take().unwrap()).unwrap(), "");
}

/// Standard output of something that prints nothing.
fn closed() -> std::process::ChildStdout {
    let mut child = Command::new("true").stdout(std::process::Stdio::piped()).spawn().unwrap();
    let output = child.stdout.take().unwrap();
    child.wait().unwrap();
    output
}
