//! `simulate`: modules for other programs to talk to.

use std::net::SocketAddr;
#[cfg(unix)]
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use clap::Args;

use super::signals::Interrupt;
use super::stop::Stop;
use super::{Outcome, output, parse, session};
use crate::mimic::{Mimic, MimicSpec, MimicSpecError};
#[cfg(unix)]
use crate::sim::PtyServer;
use crate::sim::{DEMO, Fault, FaultError, FaultKind, Model, ModuleSpec, Pace, Sim, SpecError, TcpServer};

/// Options of `simulate`.
#[derive(Debug, Clone, Args)]
#[command(
    about = "Simulate modules for other programs",
    long_about = long_about(),
    after_help = "Examples:\n  dcon-bench simulate\n  dcon-bench simulate --pty /tmp/line pir-234@1:modbus_rtu:9600 \
                  pir-130@0xA0:dcon:19200:checksum\n  dcon-bench simulate dl-302@0x21:dcon ./my-module.toml@5\n  \
                  dcon-bench simulate --tcp 127.0.0.1:1502 pir-234@1"
)]
pub struct SimulateArgs {
    /// Modules, such as pir-234@1:modbus_rtu:9600 or my-module.toml@0xA0:dcon:19200:checksum
    #[arg(value_name = "MODULE-SPEC")]
    modules: Vec<Simulated>,
    /// Make a serial line, and PATH a link to it; without --tcp there is a serial line anyway
    #[cfg(unix)]
    #[arg(long, value_name = "PATH")]
    pty: Option<PathBuf>,
    /// Serve Modbus TCP here: ADDRESS:PORT, or only PORT for this computer alone; port 0 takes a free one
    #[arg(long, value_name = "ADDRESS:PORT", value_parser = parse::listen)]
    tcp: Option<SocketAddr>,
    /// How long a module takes to answer, to which its response delay is added
    #[arg(long, value_name = "DURATION", default_value = "5ms", value_parser = parse::turnaround)]
    turnaround: Duration,
    /// What goes wrong on the serial line, such as flipped=1%; repeatable, --help lists it all
    #[arg(long, value_name = "KIND[=STRENGTH]", value_parser = terminal_fault)]
    fault: Vec<Fault>,
    /// Lets chance do the same again: with the same number and the same requests, the same goes wrong
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

fn terminal_fault(text: &str) -> Result<Fault, String> {
    let fault: Fault = text.parse().map_err(|error: FaultError| error.to_string())?;
    if NOT_ON_A_TERMINAL.contains(&fault.kind) {
        let word = fault.kind.word();
        return Err(format!("{word} cannot happen on a pseudo-terminal – give it to a subcommand with --demo"));
    }
    Ok(fault)
}

/// What it does.
const ABOUT: &str = "Simulate modules on a serial line, and those with Ethernet over Modbus TCP too, until interrupted.\n\nThe \
                  serial line is a pseudo-terminal that any program can open as a port (not on Windows); it hears only what \
                  is sent at a module's speed, while the data format cannot be seen on it. Where to connect is printed on \
                  standard output: `pty PATH` and `tcp HOST:PORT`.\n\nA module is MODEL@ADDRESS, followed by any of a \
                  protocol (modbus_rtu, dcon), a speed, a data format (n81, n82, e81, o81), checksum, init (DIP 4 ON) and \
                  hardware (DIP 2 OFF), each after a colon. Models are pir-130, pir-230, pir-234, pir-234-wf and unknown, \
                  the id of any other module definition, or the path of a definition file; a module from a definition \
                  has no Ethernet and no DIP switches. What is left out has its factory value: modbus_rtu:9600:n81. Without \
                  any module, those of --demo are simulated.";
/// What only a line within the program can have; nobody sees it through a pseudo-terminal.
const NOT_ON_A_TERMINAL: [FaultKind; 3] = [FaultKind::Renamed, FaultKind::BlockedWrite, FaultKind::ClockJump];

fn long_about() -> String {
    let kinds = FaultKind::ALL.map(|kind| {
        let only = if NOT_ON_A_TERMINAL.contains(&kind) { " (only with --demo)" } else { "" };
        let example = Fault { kind, strength: kind.default_strength() };
        format!("  {example}: {}{only}", kind.explanation())
    });
    format!(
        "{ABOUT}\n\nFaults of the serial line, KIND or KIND=STRENGTH; each is as strong as shown if no strength is \
         given. Shares are chances of each byte (flipped, lost, inserted) or each answer.\n{}",
        kinds.join("\n")
    )
}

/// A module of the simulator, or one from a definition.
#[derive(Debug, Clone)]
enum Simulated {
    Pir(ModuleSpec),
    Mimic(MimicSpec),
}

impl FromStr for Simulated {
    type Err = MimicSpecError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.parse() {
            Ok(spec) => Ok(Self::Pir(spec)),
            // Of a path, what stands before its first colon or `@` may look like anything.
            Err(SpecError::UnknownModel { .. } | SpecError::NoAddress(_)) => text.parse().map(Self::Mimic),
            Err(error) => Err(error.into()),
        }
    }
}

/// The modules from definitions, ready to join a line.
fn mimics(modules: &[Simulated]) -> Outcome<Vec<(&MimicSpec, Mimic)>> {
    let specs = modules.iter().filter_map(|module| if let Simulated::Mimic(spec) = module { Some(spec) } else { None });
    let specs: Vec<&MimicSpec> = specs.collect();
    if specs.is_empty() {
        return Ok(Vec::new());
    }
    let (catalogue, models) = (session::catalogue(), Model::ALL.map(Model::word));
    let made = specs.into_iter().map(|spec| {
        let definition = spec.definition(&catalogue, &models).map_err(|error| Stop::usage(error.to_string()))?;
        Ok((spec, Mimic::new(definition, spec.placing)))
    });
    made.collect()
}

pub fn run(args: &SimulateArgs) -> Outcome {
    // Caught before anyone can know that there is something to end.
    let interrupt = Interrupt::catch()?;
    let specs: Vec<ModuleSpec> = match args.modules.as_slice() {
        [] => DEMO.iter().filter_map(|text| text.parse().ok()).collect(),
        given => {
            let pir = |module: &Simulated| if let Simulated::Pir(spec) = module { Some(spec.clone()) } else { None };
            given.iter().filter_map(pir).collect()
        }
    };
    let mut said: Vec<String> = specs.iter().map(|spec| format!("simulating {spec}")).collect();
    let mimics = mimics(&args.modules)?;
    let sim = Sim::new(&specs, Pace::Real).with_turnaround(args.turnaround).with_seed(args.seed);
    sim.set_faults(args.fault.iter().copied().collect());
    for (spec, mimic) in mimics {
        said.push(format!("simulating {spec}"));
        sim.join(Box::new(mimic));
    }
    let _serial = serve_serial(args, &sim)?;
    let _tcp = args.tcp.map(|address| serve_tcp(&sim, address, &specs)).transpose()?;
    for line in &said {
        output::message(line);
    }
    interrupt.wait();
    Ok(())
}

#[cfg(unix)]
fn serve_serial(args: &SimulateArgs, sim: &Sim) -> Outcome<Option<PtyServer>> {
    if args.pty.is_none() && args.tcp.is_some() {
        return Ok(None);
    }
    let server = PtyServer::open(sim, args.pty.as_deref()).map_err(|error| {
        let link = args.pty.as_ref().map(|path| format!(" {}", path.display())).unwrap_or_default();
        Stop::failed(format!("the serial line{link} could not be made: {error}"))
    })?;
    let path = args.pty.as_deref().unwrap_or(server.path());
    output::line(&format!("pty {}", path.display()))?;
    Ok(Some(server))
}

#[cfg(not(unix))]
fn serve_serial(args: &SimulateArgs, _sim: &Sim) -> Outcome<Option<()>> {
    match args.tcp {
        Some(_) => Ok(None),
        None => Err(Stop::usage(
            "on this system only Modbus TCP can be simulated: give --tcp, such as --tcp 127.0.0.1:1502",
        )),
    }
}

fn serve_tcp(sim: &Sim, address: SocketAddr, specs: &[ModuleSpec]) -> Outcome<TcpServer> {
    if !specs.iter().any(|spec| spec.model.has_ethernet()) {
        output::warning("none of these modules has Ethernet: nobody will answer over TCP");
    }
    let server = TcpServer::bind(sim, address)
        .map_err(|error| Stop::failed(format!("{address} could not be served: {error} – choose another port")))?;
    output::line(&format!("tcp {}", server.address()))?;
    Ok(server)
}
