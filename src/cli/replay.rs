//! `replay`: a capture, decoded again.

mod models;
mod summary;

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use jiff::tz::TimeZone;
use serde::Serialize;

use super::signals::Interrupt;
use super::stop::Stop;
use super::{Outcome, output, session};
use crate::bus::{Direction, Frame, Verdict};
use crate::capture;
use crate::module::{Catalogue, Definition, explain};
use crate::protocol::{Protocol, hex};
use models::Models;
use summary::Summary;

/// Options of `replay`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Decode a capture of the traffic again",
    long_about = "Decode a capture again: each frame with its time, direction, bytes and meaning, and at the end how many \
                  exchanges there were and what went wrong.\n\nCaptures are written by --capture of the commands that open \
                  a line, and by the window (Traffic, Export), as pcapng or as text. Modbus of other programs' pcapng \
                  files is read as well (link types WIRESHARK_UPPER_PDU and USER0). What a frame means depends on the \
                  module's model, which is taken from what the module said in the capture, unless --model names it. If \
                  the file is damaged, what stands before the damage is shown, and the exit code is 1.",
    after_help = "Examples:\n  dcon-bench replay hall.pcapng\n  dcon-bench replay hall.txt --errors\n  dcon-bench replay \
                  hall.pcapng --model pir-234 --json > hall.jsonl"
)]
pub struct ReplayArgs {
    /// The capture, pcapng or text
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Print one object a line, the last with the summary
    #[arg(long)]
    json: bool,
    /// Only exchanges that went wrong
    #[arg(long)]
    errors: bool,
    /// Model of the modules, such as pir-234
    #[arg(long, value_name = "NAME")]
    model: Option<String>,
}

pub fn run(args: &ReplayArgs) -> Outcome {
    let catalogue = session::catalogue();
    let model = args.model.as_deref().map(|name| known(&catalogue, name)).transpose()?;
    let interrupt = Interrupt::catch()?;
    let failed = |error| Stop::failed(format!("{}: {error}", args.file.display()));
    let mut replay = Replay {
        models: Models::new(catalogue, model),
        summary: Summary::default(),
        printer: Printer { json: args.json, zone: TimeZone::system() },
        only_errors: args.errors,
        request: None,
    };
    let mut ended = Ok(());
    for frame in capture::read_file(&args.file).map_err(failed)? {
        match frame {
            Ok(frame) => replay.take(frame)?,
            Err(error) => ended = Err(failed(error)),
        }
        if interrupt.came() {
            break;
        }
    }
    replay.summary.print(args.json)?;
    ended
}

fn known(catalogue: &Catalogue, name: &str) -> Outcome<Arc<Definition>> {
    catalogue.get(&name.to_ascii_lowercase()).ok_or_else(|| {
        let all: Vec<&str> = catalogue.iter().map(|definition| definition.id.as_str()).collect();
        Stop::usage(format!("\"{name}\" is not a known model: use {}", all.join(", ")))
    })
}

/// Goes through the frames in order.
struct Replay {
    models: Models,
    summary: Summary,
    printer: Printer,
    only_errors: bool,
    /// What was sent last, with its meaning, until something came back.
    request: Option<(Frame, String)>,
}

impl Replay {
    fn take(&mut self, frame: Frame) -> Outcome {
        let asked = |(request, _): &(Frame, String)| {
            frame.direction == Direction::Received
                && (request.address, request.protocol) == (frame.address, frame.protocol)
        };
        let request = self.request.take().filter(asked);
        self.summary.take(&frame, request.is_some());
        if let Some((request, _)) = &request {
            self.models.learn(request, &frame);
        }
        let meaning = self.meaning(&frame, request.as_ref().map(|(request, _)| request));
        if !self.only_errors {
            self.printer.print(&frame, &meaning)?;
        } else if is_error(&frame.verdict) {
            if let Some((request, meaning)) = &request {
                self.printer.print(request, meaning)?;
            }
            self.printer.print(&frame, &meaning)?;
        }
        if frame.direction == Direction::Sent {
            self.request = Some((frame, meaning));
        }
        Ok(())
    }

    fn meaning(&self, frame: &Frame, request: Option<&Frame>) -> String {
        let definition = self.models.of(frame);
        let request = request.map_or(&[][..], |request| &request.bytes);
        let explained = match frame.direction {
            Direction::Sent => explain(definition, frame.protocol, frame.checksum, &frame.bytes, None),
            Direction::Received => explain(definition, frame.protocol, frame.checksum, request, Some(&frame.bytes)),
        };
        explained.summary
    }
}

fn is_error(verdict: &Verdict) -> bool {
    !trouble(verdict).is_empty()
}

/// In words for a person; empty where nothing is wrong.
fn trouble(verdict: &Verdict) -> &str {
    match verdict {
        Verdict::Request | Verdict::Answer => "",
        Verdict::Refusal => "refused",
        Verdict::Broken(reason) if reason.is_empty() => "unusable",
        Verdict::Broken(reason) => reason,
        Verdict::Silent => "no answer",
    }
}

struct Printer {
    json: bool,
    zone: TimeZone,
}

impl Printer {
    fn print(&self, frame: &Frame, meaning: &str) -> Outcome {
        if self.json {
            return output::json(&FrameObject::new(frame, meaning));
        }
        let time = frame.at.to_zoned(self.zone.clone()).strftime("%Y-%m-%d %H:%M:%S%.6f");
        let direction = direction(frame);
        let bytes = match frame.protocol {
            Protocol::Dcon => hex::escaped(&frame.bytes),
            _ => hex::spaced(&frame.bytes),
        };
        let trouble = trouble(&frame.verdict);
        // Said by the meaning already.
        let silent = frame.verdict == Verdict::Silent && frame.bytes.is_empty();
        let trouble = if trouble.is_empty() || silent { String::new() } else { format!("  ({trouble})") };
        output::line(&format!("{time}  {direction:8}  {bytes:29}  {meaning}{trouble}"))
    }
}

fn direction(frame: &Frame) -> &'static str {
    if frame.direction == Direction::Sent { "sent" } else { "received" }
}

/// A frame in JSON, by the names of the window's export.
#[derive(Debug, Serialize)]
struct FrameObject<'a> {
    /// UTC, ISO 8601, in nanoseconds.
    time: String,
    direction: &'static str,
    address: Option<u8>,
    protocol: Protocol,
    baud_rate: Option<u32>,
    data_format: Option<&'static str>,
    took_ms: f64,
    first_byte_ms: Option<f64>,
    echo: bool,
    noise: bool,
    verdict: &'static str,
    error: &'a str,
    bytes: String,
    text: String,
    meaning: &'a str,
}

impl<'a> FrameObject<'a> {
    fn new(frame: &'a Frame, meaning: &'a str) -> Self {
        let on_wire = frame.protocol != Protocol::ModbusTcp;
        let milliseconds = |time: std::time::Duration| time.as_secs_f64() * 1000.0;
        Self {
            time: format!("{:.9}", frame.at),
            direction: direction(frame),
            address: frame.address,
            protocol: frame.protocol,
            baud_rate: on_wire.then_some(frame.settings.baud_rate.bps()),
            data_format: on_wire.then_some(frame.settings.data_format.word()),
            took_ms: milliseconds(frame.took),
            first_byte_ms: frame.first_byte.map(milliseconds),
            echo: frame.echo,
            noise: frame.noise,
            verdict: match frame.verdict {
                Verdict::Request => "request",
                Verdict::Answer => "answer",
                Verdict::Refusal => "refusal",
                Verdict::Broken(_) => "broken",
                Verdict::Silent => "silent",
            },
            error: trouble(&frame.verdict),
            bytes: hex::spaced(&frame.bytes),
            text: if frame.protocol == Protocol::Dcon { hex::escaped(&frame.bytes) } else { String::new() },
            meaning,
        }
    }
}
