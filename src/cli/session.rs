//! A conversation from beginning to end: opens the line, asks one thing at a time and waits for its answer.

use std::cell::RefCell;
use std::sync::Arc;
use std::time::Duration;

use super::capture::Capture;
use super::line_args::{LineArgs, ModuleArgs};
use super::stop::Stop;
use super::{Outcome, names, output};
use crate::bus::{Bus, BusCommand, BusEvent, ItemSet, LineProblem, RawRequest, RequestId, Target, Values};
use crate::folders;
use crate::module::{Catalogue, Definition, Identified, Item, Value, WriteError};
use crate::protocol::{Failure, LineSettings, Protocol};

/// The bus thread tells of every frame; when it has been quiet for so long, it is stuck.
const LONGEST_QUIET: Duration = Duration::from_secs(60);
/// Events that are still taken at the end.
const MOST_WAITING: usize = 10_000;

/// The definitions built in and the user's own. Faulty files are reported.
pub fn catalogue() -> Arc<Catalogue> {
    let (catalogue, errors) = match folders::definitions() {
        Some(folder) => Catalogue::with_folder(&folder),
        None => Catalogue::built_in(),
    };
    for error in errors {
        output::warning(&error.to_string());
    }
    Arc::new(catalogue)
}

/// An open line.
pub struct Session {
    bus: Bus,
    /// What passes the line, where that was asked for.
    capture: Option<RefCell<Capture>>,
}

impl Session {
    /// Opens the line.
    pub fn open(line: &LineArgs, catalogue: &Arc<Catalogue>) -> Outcome<Self> {
        Ok(Self::try_open(line, catalogue)??)
    }

    /// Opens the line; why it cannot be opened is for the caller to tell.
    pub fn try_open(line: &LineArgs, catalogue: &Arc<Catalogue>) -> Outcome<Result<Self, LineProblem>> {
        let (address, settings) = (line.address(), line.settings());
        let capture = line.capture().map(|file| Capture::begin(file, &address.to_string())).transpose()?;
        let bus = Bus::start(catalogue.clone(), || {});
        let bus = bus.map_err(|error| Stop::failed(format!("the bus thread could not be started: {error}")))?;
        bus.send(BusCommand::Tune(line.tuning()))?;
        let session = Self { bus, capture: capture.map(RefCell::new) };
        let opened = session.ask(
            |id| BusCommand::Open { id, line: address, settings },
            |id, event| match event {
                BusEvent::Opened { id: of, .. } if of == id => Some(Ok(())),
                BusEvent::OpenFailed { id: of, problem, .. } if of == id => Some(Err(problem)),
                _ => None,
            },
        )?;
        Ok(opened.map(|()| session))
    }

    /// Sends the command made with a new id. Returns the id.
    pub fn send(&self, command: impl FnOnce(RequestId) -> BusCommand) -> Outcome<RequestId> {
        let id = self.bus.next_id();
        self.bus.send(command(id))?;
        Ok(id)
    }

    /// The next event; `None` when none came in time.
    pub fn event(&self, limit: Duration) -> Outcome<Option<BusEvent>> {
        let event = self.bus.wait_event(limit)?;
        if let (Some(capture), Some(event)) = (&self.capture, &event) {
            capture.borrow_mut().take(event);
        }
        Ok(event)
    }

    /// Takes events until `pick` makes something of one of them.
    pub fn wait<T>(&self, mut pick: impl FnMut(BusEvent) -> Option<T>) -> Outcome<T> {
        loop {
            let event = self.event(LONGEST_QUIET)?;
            let event = event.ok_or_else(|| Stop::failed("the line's thread does not answer any more"))?;
            if let Some(found) = pick(event) {
                return Ok(found);
            }
        }
    }

    /// Sends a command and takes events until `pick` makes something of one of them.
    pub fn ask<T>(
        &self,
        command: impl FnOnce(RequestId) -> BusCommand,
        mut pick: impl FnMut(RequestId, BusEvent) -> Option<T>,
    ) -> Outcome<T> {
        let id = self.send(command)?;
        self.wait(|event| pick(id, event))
    }

    /// Asks the module what it is.
    pub fn identify(&self, target: Target) -> Outcome<Result<Identified, Failure>> {
        self.ask(
            |id| BusCommand::Identify { id, target },
            |id, event| match event {
                BusEvent::Identified { id: of, result, .. } if of == id => Some(result),
                _ => None,
            },
        )
    }

    pub fn read(&self, target: Target, definition: &Arc<Definition>, items: ItemSet) -> Outcome<Values> {
        let definition = definition.clone();
        self.ask(
            |id| BusCommand::Read { id, target, definition, items },
            |id, event| match event {
                BusEvent::Read { id: of, values, .. } if of == id => Some(values),
                _ => None,
            },
        )
    }

    /// Writes one value and reads it back.
    pub fn write(
        &self,
        target: Target,
        definition: &Arc<Definition>,
        item: &Item,
        value: Value,
    ) -> Outcome<Result<Value, WriteError>> {
        let (definition, item) = (definition.clone(), item.id.clone());
        self.ask(
            |id| BusCommand::Write { id, target, definition, item, value },
            |id, event| match event {
                BusEvent::Written { id: of, result, .. } if of == id => Some(result),
                _ => None,
            },
        )
    }

    pub fn act(&self, target: Target, definition: &Arc<Definition>, action: &str) -> Outcome<Result<(), WriteError>> {
        let (definition, action) = (definition.clone(), action.to_owned());
        self.ask(
            |id| BusCommand::Act { id, target, definition, action },
            |id, event| match event {
                BusEvent::Acted { id: of, result, .. } if of == id => Some(result),
                _ => None,
            },
        )
    }

    /// Sends bytes as they are; what passes the line meanwhile goes to `traffic`.
    pub fn raw(
        &self,
        request: RawRequest,
        settings: LineSettings,
        mut traffic: impl FnMut(crate::bus::Frame),
    ) -> Outcome<Result<Vec<u8>, Failure>> {
        self.ask(
            |id| BusCommand::Raw { id, request, settings },
            |id, event| match event {
                BusEvent::RawAnswer { id: of, result } if of == id => Some(result),
                BusEvent::Traffic(frame) => {
                    traffic(frame);
                    None
                }
                _ => None,
            },
        )
    }
}

impl Drop for Session {
    /// What passed the line until the end is captured too.
    fn drop(&mut self) {
        let Some(capture) = &self.capture else { return };
        for _ in 0..MOST_WAITING {
            let Some(event) = self.bus.try_event() else { return };
            capture.borrow_mut().take(&event);
        }
    }
}

/// A module that is there and known.
pub struct Module {
    pub session: Session,
    pub target: Target,
    pub identified: Identified,
    pub definition: Arc<Definition>,
}

impl Module {
    /// Opens the line and finds out which module is there. `check` is what is asked of its definition: it is put to all
    /// known definitions before the line is opened, so that what no module has is refused at once, and then to the
    /// module's own.
    pub fn open(
        line: &LineArgs,
        module: &ModuleArgs,
        check: impl Fn(&Definition, Protocol) -> Result<(), names::Refusal>,
    ) -> Outcome<Self> {
        let target = module.target(line)?;
        let catalogue = catalogue();
        names::some_definition(&catalogue, |definition| check(definition, target.protocol))?;
        let session = Session::open(line, &catalogue)?;
        let identified = match session.identify(target)? {
            Ok(identified) => identified,
            Err(failure) => return Err(Stop::failed(not_identified(&target, &failure))),
        };
        let Some(definition) = identified.definition.clone() else {
            return Err(Stop::failed(unknown(&target, &identified)));
        };
        check(&definition, target.protocol)?;
        Ok(Self { session, target, identified, definition })
    }
}

pub fn not_identified(target: &Target, failure: &Failure) -> String {
    match failure {
        Failure::Silent if target.protocol == Protocol::ModbusTcp => {
            format!(
                "no module answers at {target} – check its NetID (--address; 1 unless changed) and that it has power"
            )
        }
        Failure::Silent => {
            let checksum = match (target.protocol, target.checksum) {
                (Protocol::Dcon, true) => ", without --checksum",
                (Protocol::Dcon, false) => ", with --checksum",
                _ => "",
            };
            let other = if target.protocol == Protocol::Dcon { "modbus_rtu" } else { "dcon" };
            format!(
                "no module answers at {target} – check the address (with DIP 2 OFF it is 160 to 191), try the other \
                 protocol (--protocol {other}), other speeds and formats (--baud-rate, --data-format){checksum}; \
                 `dcon-bench scan` finds modules with factory settings, `scan --full` any"
            )
        }
        failure if failure.is_garbage() => {
            format!(
                "what came back from {target} cannot be used: {failure} – if that stays so, try the other speeds and data \
                 formats; `dcon-bench diagnose` tells late, doubled and damaged answers apart"
            )
        }
        failure => format!("{target}: {failure}"),
    }
}

pub fn unknown(target: &Target, identified: &Identified) -> String {
    let said = if identified.said.is_empty() { "nothing about itself" } else { identified.said.as_str() };
    let place = folders::definitions().map(|folder| format!(" (a file in {})", folder.display())).unwrap_or_default();
    format!(
        "the module at {target} is not known, so nothing more was asked of it – it said: {said}; a module definition{place} can describe it"
    )
}
