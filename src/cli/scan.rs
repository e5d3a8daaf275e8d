//! `scan`: where modules answer.

mod progress;

use std::time::Duration;

use clap::Args;

use super::Outcome;
use super::line_args::LineArgs;
use super::output::{self, ModuleObject};
use super::parse::{self, List};
use super::session::{self, Session};
use super::stop::Stop;
use crate::bus::{BusCommand, BusEvent, ScanPlan, ScanSummary, Target};
use crate::module::Identified;
use crate::protocol::{BaudRate, DataFormat, Protocol};
use progress::Progress;

/// Options of `scan`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Search a line for modules",
    long_about = "Search a line for modules, with questions that change nothing.\n\nThe quick scan asks where modules are \
                  out of the box: address 1 and those that the DIP and rotary switches give (160 to 191), in both \
                  protocols at 9600 N81. The full scan asks at every address, speed, data format, protocol and checksum, \
                  which takes half an hour and more. The other options replace parts of the plan. Over TCP, NetID 1 is asked unless \
                  --addresses names others.\n\nModules are printed as they are found. If none is, the exit code is 1.",
    after_help = "Examples:\n  dcon-bench scan --port /dev/ttyUSB0\n  dcon-bench scan --port COM3 --addresses 1,160-191 \
                  --baud-rates all --first\n  dcon-bench scan --port COM3 --full --protocols dcon --json\n  dcon-bench scan \
                  --tcp 192.168.255.1 --addresses 1-10"
)]
pub struct ScanArgs {
    /// Addresses to ask: numbers and ranges, decimal or hexadecimal as 0xA0 or A0h
    #[arg(long, value_name = "1,160-191", value_parser = parse::addresses)]
    addresses: Option<List<u8>>,
    /// Speeds to try
    #[arg(long, value_name = "9600,19200|all", value_parser = parse::baud_rates, conflicts_with = "tcp")]
    baud_rates: Option<List<BaudRate>>,
    /// Data formats to try
    #[arg(long, value_name = "n81,e81|all", value_parser = parse::data_formats, conflicts_with = "tcp")]
    data_formats: Option<List<DataFormat>>,
    /// Protocols to try
    #[arg(long, value_name = "modbus_rtu,dcon|all", value_parser = parse::protocols, conflicts_with = "tcp")]
    protocols: Option<List<Protocol>>,
    /// DCON with or without checksums
    #[arg(long, value_name = "off,on", value_parser = parse::checksums, conflicts_with = "tcp")]
    checksums: Option<List<bool>>,
    /// Ask where modules are out of the box (this is the default)
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Ask everywhere
    #[arg(long)]
    full: bool,
    /// Stop at the first module found
    #[arg(long)]
    first: bool,
    /// How long to listen at an address [default: 60ms]
    #[arg(long, value_name = "DURATION", value_parser = parse::window)]
    window: Option<Duration>,
    /// Print one object a line for each module, as it is found
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    line: LineArgs,
}

impl ScanArgs {
    fn plan(&self) -> ScanPlan {
        let base = match (self.line.is_tcp(), self.full) {
            (true, true) => ScanPlan { addresses: (1..=247).collect(), ..ScanPlan::tcp() },
            (true, false) => ScanPlan::tcp(),
            (false, true) => ScanPlan::full(),
            (false, false) => ScanPlan::quick(),
        };
        let given_baud_rate = self.line.given_baud_rate().map(|rate| vec![rate]);
        let given_data_format = self.line.given_data_format().map(|format| vec![format]);
        ScanPlan {
            addresses: values(&self.addresses).unwrap_or(base.addresses),
            baud_rates: values(&self.baud_rates).or(given_baud_rate).unwrap_or(base.baud_rates),
            data_formats: values(&self.data_formats).or(given_data_format).unwrap_or(base.data_formats),
            protocols: values(&self.protocols).unwrap_or(base.protocols),
            checksums: values(&self.checksums).unwrap_or(base.checksums),
            window: self.window.unwrap_or(base.window),
            stop_at_first: self.first,
        }
    }
}

fn values<T: Clone>(list: &Option<List<T>>) -> Option<Vec<T>> {
    list.as_ref().map(|list| list.0.clone())
}

pub fn run(args: &ScanArgs) -> Outcome {
    let plan = args.plan();
    if plan.targets().is_empty() {
        return Err(Stop::usage("there is nothing to ask: with Modbus use addresses 1 to 247"));
    }
    let session = Session::open(&args.line, &session::catalogue())?;
    let summary = follow(&session, plan, args.json)?;
    report(&summary);
    match &summary.lost {
        Some(reason) => Err(Stop::failed(format!("the line was lost, the scan is not complete: {reason}"))),
        None if summary.found == 0 => Err(Stop::failed(nothing_found(args))),
        None => Ok(()),
    }
}

/// Scans and prints what is found, until the end.
fn follow(session: &Session, plan: ScanPlan, json: bool) -> Outcome<ScanSummary> {
    let mut progress = Progress::new();
    let ended = session.ask(
        |id| BusCommand::Scan { id, plan },
        |id, event| match event {
            BusEvent::ScanProgress { id: of, progress: now } if of == id => {
                progress.show(&now);
                None
            }
            BusEvent::Found { id: of, target, identified } if of == id => {
                progress.clear();
                print_found(&target, &identified, json).err().map(Err)
            }
            BusEvent::ScanEnded { id: of, summary } if of == id => Some(Ok(summary)),
            _ => None,
        },
    );
    progress.clear();
    ended?
}

fn print_found(target: &Target, identified: &Identified, json: bool) -> Outcome {
    if json {
        return output::json(&ModuleObject::new(target, identified));
    }
    let Target { address, protocol, settings, checksum } = target;
    let line = if *protocol == Protocol::ModbusTcp { String::new() } else { settings.to_string() };
    let checksum = if *checksum { "checksum" } else { "" };
    let Identified { name, firmware, said, definition } = identified;
    let model = definition.as_ref().map_or("unknown", |definition| definition.label.as_str());
    let name = if definition.is_none() { said } else { name };
    let protocol = protocol.label();
    let text =
        format!("{address:>3} ({address:02X}h)  {protocol:10}  {line:10}  {checksum:8}  {model:8}  {name}  {firmware}");
    output::line(text.trim_end())
}

/// Places that deserve a look.
fn report(summary: &ScanSummary) {
    for (target, reason) in &summary.unreadable {
        output::message(&format!("{target}: {reason}"));
    }
    if !summary.unreadable.is_empty() {
        output::message(
            "Bytes came back there that are no answer: another speed, data format or protocol, two modules at one \
             address, or a line without termination",
        );
    }
}

fn nothing_found(args: &ScanArgs) -> String {
    if args.line.is_tcp() {
        return "no module answered – check the NetID (--addresses 1-247 asks all) and that the module has power"
            .to_owned();
    }
    let mut advice = vec![
        "no module answered. Check that".to_owned(),
        "  – the module has power and this is its port".to_owned(),
        "  – D+ and D- are not swapped".to_owned(),
    ];
    match args.protocols.as_ref().map(|list| list.0.as_slice()) {
        Some([Protocol::Dcon]) => {
            advice.push("  – it does not speak the other protocol: --protocols modbus_rtu".to_owned())
        }
        Some([Protocol::ModbusRtu]) => {
            advice.push("  – it does not speak the other protocol: --protocols dcon".to_owned())
        }
        _ => {}
    }
    if !args.full {
        advice.push(
            "  – it does not have another address, speed, data format or checksum: --full asks everywhere".to_owned(),
        );
    }
    advice.join("\n")
}
