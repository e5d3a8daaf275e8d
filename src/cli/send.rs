//! `send`: one raw frame, and what comes back.

use clap::{ArgGroup, Args};

use super::line_args::LineArgs;
use super::session::{self, Session};
use super::stop::Stop;
use super::{Outcome, output};
use crate::bus::{Direction, Frame, RawRequest, Verdict};
use crate::protocol::{Failure, hex, modbus};

/// Options of `send`.
#[derive(Debug, Clone, Args)]
#[group(skip)]
#[command(
    group = ArgGroup::new("frame").required(true),
    about = "Send one raw frame and show both directions",
    long_about = "Send one raw frame as it is, once, and show the bytes of both directions with the time between them, from \
                  the beginning of the question to the end of the answer. Nothing is checked: also a command that changes \
                  the module is sent.\n\nA DCON command gets its carriage return, a Modbus request its CRC, or with --tcp \
                  its header. If nothing answers, the exit code is 1; a broadcast (~**, Modbus address 0) is not answered.",
    after_help = "Examples:\n  dcon-bench send --port /dev/ttyUSB0 '$01M'\n  dcon-bench send --port COM3 --baud-rate 19200 \
                  --checksum '$012'\n  dcon-bench send --port COM3 --modbus '01 03 01 E0 00 04'\n  \
                  dcon-bench send --tcp 192.168.255.1 --modbus '01 04 00 00 00 05'"
)]
pub struct SendArgs {
    /// A DCON command with its address, such as '$01M'; in a shell it needs quotes
    #[arg(group = "frame", value_name = "COMMAND")]
    text: Option<String>,
    /// Add the checksum to the command, and expect it in the answer
    #[arg(long, conflicts_with = "modbus")]
    checksum: bool,
    /// Address, function and data of a Modbus request in hexadecimal instead
    #[arg(long, group = "frame", value_name = "BYTES", value_parser = modbus_frame)]
    modbus: Option<ModbusFrame>,
    #[command(flatten)]
    line: LineArgs,
}

#[derive(Debug, Clone)]
struct ModbusFrame(Vec<u8>);

fn modbus_frame(text: &str) -> Result<ModbusFrame, String> {
    let bytes = hex::parse(text)?;
    if bytes.len() < 2 {
        Err("a frame has at least an address and a function".to_owned())
    } else {
        Ok(ModbusFrame(bytes))
    }
}

pub fn run(args: &SendArgs) -> Outcome {
    if args.line.is_tcp() && args.modbus.is_none() {
        return Err(Stop::usage("DCON commands are for serial lines: use --port or --demo, or send --modbus bytes"));
    }
    let request = match (&args.modbus, &args.text) {
        (Some(ModbusFrame(bytes)), _) => RawRequest::Modbus { bytes: bytes.clone() },
        (None, text) => RawRequest::Dcon { text: text.clone().unwrap_or_default(), checksum: args.checksum },
    };
    let session = Session::open(&args.line, &session::catalogue())?;
    let mut printer = Printer { as_text: args.modbus.is_none(), sent: None, outcome: Ok(()) };
    let answer = session.raw(request, args.line.settings(), |frame| printer.print(&frame))?;
    printer.outcome?;
    match answer {
        Ok(answer) => {
            explain(&answer, args.modbus.is_some());
            Ok(())
        }
        Err(Failure::Silent) => Err(Stop::failed(
            "no answer – check the address, the protocol and the speed, and that the module has power",
        )),
        Err(failure) => Err(Stop::failed(failure.to_string())),
    }
}

/// What a refusal means.
fn explain(answer: &[u8], modbus: bool) {
    match (modbus, answer) {
        (true, [_, function, code, ..]) if function & 0x80 != 0 => {
            output::message(&format!("exception {code}: {}", modbus::exception_text(*code)));
        }
        (false, [b'?', ..]) => output::message("The module understood the command and refused it"),
        (false, b"!") => {
            output::message("The module ignored the command: its host watchdog has tripped (~AA1 clears it)")
        }
        _ => {}
    }
}

/// Prints frames as they pass.
struct Printer {
    as_text: bool,
    sent: Option<jiff::Timestamp>,
    outcome: Outcome,
}

impl Printer {
    fn print(&mut self, frame: &Frame) {
        // Told at the end, with what to do about it.
        if frame.verdict == Verdict::Silent && frame.bytes.is_empty() {
            return;
        }
        let (word, after) = match (frame.direction, self.sent) {
            (Direction::Sent, _) => {
                self.sent = Some(frame.at);
                ("sent    ", String::new())
            }
            (Direction::Received, None) => ("received", String::new()),
            (Direction::Received, Some(sent)) => {
                let milliseconds = frame.at.duration_since(sent).as_secs_f64() * 1000.0;
                ("received", format!("  after {milliseconds:.1} ms"))
            }
        };
        let bytes = hex::spaced(&frame.bytes);
        let shown = if self.as_text { format!("{}  ({bytes})", hex::escaped(&frame.bytes)) } else { bytes };
        if self.outcome.is_ok() {
            self.outcome = output::line(&format!("{word}  {shown}{after}"));
        }
    }
}
