//! The real program, run as a user or a script runs it.

#![allow(dead_code, reason = "each test program uses some of it")]

use std::io::{BufRead, BufReader, Lines};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

pub fn command(config: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dcon-bench"));
    command.args(args).env("DCON_BENCH_CONFIG", config).env_remove("RUST_LOG").stdin(Stdio::null());
    command
}

/// Runs the program to its end.
pub fn bench(args: &[&str]) -> Output {
    let config = TempDir::new().unwrap();
    command(config.path(), args).output().unwrap()
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Standard output of a run that has to succeed.
pub fn good(args: &[&str]) -> String {
    let output = bench(args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Standard error of a run that has to end with this exit code.
pub fn bad(code: i32, args: &[&str]) -> String {
    let output = bench(args);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {}{}", text(&output.stdout), text(&output.stderr));
    text(&output.stderr)
}

pub fn object(args: &[&str]) -> Value {
    serde_json::from_str(&good(args)).unwrap()
}

/// A running program whose lines are read as they come.
pub struct Running {
    pub child: Child,
    pub lines: Lines<BufReader<ChildStdout>>,
    pub _config: TempDir,
}

impl Running {
    pub fn start(args: &[&str]) -> Self {
        let config = TempDir::new().unwrap();
        let mut child = command(config.path(), args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        Self { child, lines, _config: config }
    }

    /// Simulates these modules. Returns also where they are reached.
    pub fn simulate(args: &[&str]) -> (Self, String) {
        let mut running = Self::start(&[&["simulate"], args].concat());
        let place = running.line().split_once(' ').unwrap().1.to_owned();
        (running, place)
    }

    pub fn line(&mut self) -> String {
        self.lines.next().expect("the program ended too soon").unwrap()
    }

    #[cfg(unix)]
    pub fn end_by(&mut self, signal: &str) -> Option<i32> {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
        self.child.wait().unwrap().code()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// `words` split at spaces after `--demo` was put behind the subcommand.
pub fn demo(words: &str) -> Vec<&str> {
    let mut words: Vec<&str> = words.split(' ').collect();
    words.insert(1, "--demo");
    words
}
