//! Programs of the system that are asked something, and not waited for without end.

use std::io::{self, Read};
use std::process::{Command, Stdio};
use std::sync::mpsc::sync_channel;
use std::time::Duration;

/// Bytes that are taken of an answer.
const MOST: u64 = 1 << 20;

/// What `command` writes until it ends, for `limit` at most; then it is ended.
///
/// # Errors
/// If it cannot be started or read, or takes longer.
pub fn answer_of(mut command: Command, limit: Duration) -> io::Result<String> {
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn()?;
    let output = child.stdout.take();
    let (told, answer) = sync_channel(1);
    let read = move || {
        let mut bytes = Vec::new();
        let whole = output.map_or(Ok(0), |output| output.take(MOST).read_to_end(&mut bytes));
        // Nobody waits any more if it took too long.
        let _ = told.send(whole.map(|_| bytes));
    };
    let answer = std::thread::Builder::new()
        .name("asked program".to_owned())
        .spawn(read)
        .and_then(|_| answer.recv_timeout(limit).unwrap_or_else(|_| Err(io::ErrorKind::TimedOut.into())));
    // One that has ended cannot be ended, which is as good. It is not waited for, as one that hangs in a driver ends when the
    // driver lets it.
    let _ = child.kill();
    let _ = child.try_wait();
    answer.map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::time::Instant;

    #[test]
    fn what_a_program_writes_is_its_answer() {
        let mut command = Command::new("printf");
        command.arg("USB\\VID_1A86");
        assert!(answer_of(command, Duration::from_secs(30)).unwrap().contains("VID_1A86"));
        assert!(answer_of(Command::new("/nowhere/pnputil"), Duration::from_secs(30)).is_err());
    }

    #[test]
    fn a_program_that_hangs_is_left() {
        let mut command = Command::new("sleep");
        command.arg("600");
        let begin = Instant::now();
        let error = answer_of(command, Duration::from_millis(20)).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::TimedOut);
        assert!(begin.elapsed() < Duration::from_secs(60));
    }
}
