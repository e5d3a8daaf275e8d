//! Bytes to and from a simulated line, without any of the program's own protocol code.

use std::time::Duration;

use dcon_bench::bus::line::Line;
use dcon_bench::sim::SimLine;

/// The answer to `request`, or nothing.
pub fn exchange(line: &mut SimLine, request: &[u8]) -> Vec<u8> {
    line.send(request).unwrap();
    let mut answer = Vec::new();
    loop {
        let mut buffer = [0; 64];
        let deadline = line.now() + Duration::from_millis(200);
        match line.receive(&mut buffer, deadline).unwrap() {
            0 => return answer,
            count => answer.extend_from_slice(&buffer[..count]),
        }
    }
}

/// A DCON command and its answer, both without CR.
pub fn ask(line: &mut SimLine, command: &str) -> String {
    let answer = exchange(line, format!("{command}\r").as_bytes());
    String::from_utf8(answer).unwrap().trim_end_matches('\r').to_owned()
}
