use std::sync::Arc;
use std::sync::mpsc::Receiver;

use jiff::Timestamp;

use super::super::{Action, EntryKind, ItemState};
use super::*;
use crate::bus::{Answer, Bus, BusEvent};
use crate::module::Catalogue;
use crate::protocol::{BaudRate, LineSettings, Protocol};

const AT: Timestamp = Timestamp::UNIX_EPOCH;

fn at(address: u8, protocol: Protocol) -> Target {
    Target { address, protocol, settings: LineSettings::default(), checksum: false }
}

/// A bench with one PIR-234 over DCON, and the bus, which the test plays.
struct Play {
    bench: Bench,
    commands: Receiver<BusCommand>,
    /// Both ends of the bus have to live.
    _events: std::sync::mpsc::SyncSender<BusEvent>,
}

fn identified(model: &str) -> Identified {
    let definition = Catalogue::built_in().0.get(model);
    Identified { definition, name: model.to_owned(), firmware: String::new(), said: String::new() }
}

impl Play {
    /// At address 1, with these changes.
    fn with(protocol: Protocol, edits: &[(&str, &str)]) -> Self {
        let (bus, commands, events) = Bus::detached();
        let mut bench = Bench::new(bus, Arc::new(Catalogue::built_in().0), &[]).with_clock(|| AT);
        let target = at(1, protocol);
        let line = crate::bus::LineAddress::Serial { port: "a port".to_owned() };
        bench.apply(Action::Connect { line, settings: target.settings });
        let opened = commands.try_iter().find_map(|command| match command {
            BusCommand::Open { id, .. } => Some(BusEvent::Opened { id, line: "a port".to_owned() }),
            _ => None,
        });
        bench.take(opened.expect("a line is asked for"));
        bench.take(BusEvent::Found { id: RequestId(1_000), target, identified: identified("pir-234") });
        for (id, text) in edits {
            bench.apply(Action::Stage(target, (*id).to_owned(), (*text).to_owned()));
        }
        Self { bench, commands, _events: events }
    }

    fn begun(protocol: Protocol, edits: &[(&str, &str)]) -> Self {
        let mut play = Self::with(protocol, edits);
        play.bench.apply(Action::BeginInit(at(1, protocol)));
        play
    }

    fn step(&self) -> Option<InitStep> {
        self.bench.init().map(|init| init.step)
    }

    fn init(&self) -> &InitProcedure {
        self.bench.init().expect("a procedure")
    }

    fn question(&self) -> (RequestId, Target) {
        self.commands
            .try_iter()
            .find_map(|command| match command {
                BusCommand::Identify { id, target } => Some((id, target)),
                _ => None,
            })
            .expect("a question")
    }

    /// Answers the next question as `result` says; where it was asked.
    fn answer(&mut self, result: Result<Identified, Failure>) -> Target {
        let (id, target) = self.question();
        self.bench.take(BusEvent::Identified { id, target, result });
        target
    }

    fn write(&self) -> (RequestId, Target, String, Value) {
        self.commands
            .try_iter()
            .find_map(|command| match command {
                BusCommand::Write { id, target, item, value, .. } => Some((id, target, item, value)),
                _ => None,
            })
            .expect("a write")
    }

    fn take_write(&mut self) -> (Target, String) {
        let (id, target, item, value) = self.write();
        self.bench.take(BusEvent::Written { id, target, item: item.clone(), at: AT, result: Ok(value) });
        (target, item)
    }

    fn refuse_write(&mut self) {
        let (id, target, item, _) = self.write();
        let failure = Failure::Refused { answer: "?01".to_owned() };
        let result = Err(WriteError::Refused { id: item.clone(), failure, hint: " – INIT" });
        self.bench.take(BusEvent::Written { id, target, item, at: AT, result });
    }

    fn go_on(&mut self) {
        self.bench.apply(Action::ContinueInit);
    }

    fn last_notice(&self) -> String {
        self.bench.notices().next_back().map(|notice| notice.text.clone()).unwrap_or_default()
    }
}

#[test]
fn a_setting_written_at_address_00_is_noted_with_the_module_it_belongs_to() {
    let mut play = Play::begun(Protocol::Dcon, &[("baud_rate", "19200"), ("checksum", "on")]);
    let listed = at(1, Protocol::Dcon);
    assert_eq!(play.step(), Some(InitStep::SwitchOn));
    play.go_on();
    assert_eq!(play.answer(Err(Failure::Silent)), listed);
    assert_eq!(play.answer(Ok(identified("pir-234"))), at(0, Protocol::Dcon));
    assert_eq!(play.step(), Some(InitStep::Writing));
    assert_eq!(play.bench.module(&listed).unwrap().state("baud_rate"), ItemState::BeingWritten);
    assert_eq!(play.take_write(), (at(0, Protocol::Dcon), "baud_rate".to_owned()));
    assert_eq!(play.take_write().1, "checksum");
    assert_eq!(play.step(), Some(InitStep::SwitchOff));
    let module = play.bench.module(&listed).unwrap();
    assert!(module.edits.is_empty());
    let written = module.journal.iter().filter(|entry| entry.kind == EntryKind::Written);
    assert_eq!(written.map(|entry| entry.text.as_str()).next(), Some("Baud rate: not known to 19200 bps"));

    play.go_on();
    let settings = LineSettings { baud_rate: BaudRate::new(19_200).unwrap(), ..LineSettings::default() };
    let wanted = Target { settings, checksum: true, ..listed };
    assert_eq!(play.answer(Err(Failure::Silent)), wanted);
    assert_eq!(play.answer(Err(Failure::Silent)), listed);
    assert_eq!(play.answer(Err(Failure::Silent)), Target { checksum: false, ..wanted });
    assert_eq!(play.answer(Ok(identified("pir-234"))), wanted);
    assert!(play.init().is_as_wanted());
    assert_eq!(play.bench.take_moves(), [(listed, wanted)]);
    assert!(play.bench.module(&wanted).is_some());
    play.go_on();
    assert_eq!(play.step(), None);
}

#[test]
fn a_refusal_leads_back_with_its_reason_and_what_was_taken_is_not_written_again() {
    let mut play = Play::begun(Protocol::Dcon, &[("baud_rate", "19200"), ("checksum", "on")]);
    play.go_on();
    play.answer(Ok(identified("pir-234")));
    play.take_write();
    play.refuse_write();
    assert_eq!(play.step(), Some(InitStep::SwitchOn));
    let refused: Vec<_> = play.init().refused().map(|(id, reason)| (id.to_owned(), reason.to_owned())).collect();
    assert_eq!(refused[0].0, "checksum");
    assert!(refused[0].1.contains("?01") && refused[0].1.contains("INIT"), "{}", refused[0].1);
    let module = play.bench.module(&at(1, Protocol::Dcon)).unwrap();
    assert!(matches!(module.state("checksum"), ItemState::Refused(_)));
    assert_eq!(play.bench.notices().count(), 0);
    play.go_on();
    play.answer(Ok(identified("pir-234")));
    assert_eq!(play.take_write().1, "checksum");
    assert_eq!(play.step(), Some(InitStep::SwitchOff));
}

#[test]
fn another_model_at_the_place_is_not_written_to() {
    let mut play = Play::begun(Protocol::Dcon, &[("checksum", "on")]);
    play.go_on();
    play.answer(Err(Failure::Silent));
    play.answer(Ok(identified("pir-130")));
    assert_eq!(play.step(), Some(InitStep::FindInInit));
    assert!(play.init().problem.as_ref().unwrap().contains("pir-130"));
    assert_eq!(play.init().attempts, 2);
}

#[test]
fn a_module_that_is_in_init_mode_already_is_looked_for_at_once() {
    let mut play = Play::with(Protocol::Dcon, &[("checksum", "on")]);
    let target = at(1, Protocol::Dcon);
    let values = vec![Answer { id: "init_mode".to_owned(), at: AT, result: Ok(Value::Bool(true)) }];
    play.bench.take(BusEvent::Read { id: RequestId(1_001), target, at: AT, values });
    play.bench.apply(Action::BeginInit(target));
    assert_eq!(play.step(), Some(InitStep::FindInInit));
    assert_eq!(play.answer(Ok(identified("pir-234"))), target);
    assert_eq!(play.step(), Some(InitStep::Writing));
}

#[test]
fn a_lost_line_leads_to_the_step_before_with_the_reason() {
    let lost = || Failure::LineLost("unplugged".to_owned());
    let mut play = Play::begun(Protocol::Dcon, &[("checksum", "on")]);
    play.go_on();
    play.answer(Err(lost()));
    assert_eq!(play.step(), Some(InitStep::SwitchOn));
    assert!(play.init().problem.as_ref().unwrap().contains("unplugged"));
    play.go_on();
    play.answer(Ok(identified("pir-234")));
    let (id, target, item, _) = play.write();
    let result = Err(WriteError::ReadFirst { id: item.clone(), failure: lost() });
    play.bench.take(BusEvent::Written { id, target, item, at: AT, result });
    assert_eq!(play.step(), Some(InitStep::SwitchOn));
    assert_eq!(play.init().changes[0].outcome, None);
    play.go_on();
    play.answer(Ok(identified("pir-234")));
    play.take_write();
    play.go_on();
    play.answer(Err(lost()));
    assert_eq!(play.step(), Some(InitStep::SwitchOff));
}

#[test]
fn leaving_while_a_setting_is_written_still_notes_what_became_of_it() {
    let mut play = Play::begun(Protocol::Dcon, &[("baud_rate", "19200"), ("checksum", "on")]);
    let listed = at(1, Protocol::Dcon);
    play.go_on();
    play.answer(Ok(identified("pir-234")));
    play.bench.apply(Action::LeaveInit);
    assert_eq!(play.step(), None);
    play.bench.apply(Action::BeginInit(listed));
    assert_eq!(play.step(), None);
    play.take_write();
    let module = play.bench.module(&listed).unwrap();
    assert!(module.edit("baud_rate").is_none() && module.edit("checksum").is_some());
    assert!(play.last_notice().contains("1 setting is written"), "{}", play.last_notice());
    assert!(play.last_notice().contains("19200 N81"), "{}", play.last_notice());
    play.bench.apply(Action::BeginInit(listed));
    assert_eq!(play.init().changes.len(), 1);
}

#[test]
fn leaving_says_what_is_left_to_do_with_switch_and_power() {
    let mut play = Play::begun(Protocol::Dcon, &[("checksum", "on")]);
    play.bench.apply(Action::LeaveInit);
    assert_eq!(play.bench.notices().count(), 0);
    play.bench.apply(Action::BeginInit(at(1, Protocol::Dcon)));
    play.go_on();
    let late = play.question();
    play.bench.apply(Action::BackInInit);
    assert_eq!(play.step(), Some(InitStep::SwitchOn));
    play.bench.take(BusEvent::Identified { id: late.0, target: late.1, result: Ok(identified("pir-234")) });
    assert_eq!(play.step(), Some(InitStep::SwitchOn));
    play.bench.apply(Action::LeaveInit);
    assert!(play.last_notice().contains("nothing was written"), "{}", play.last_notice());
}

#[test]
fn a_module_found_elsewhere_can_be_looked_for_again() {
    let mut play = Play::begun(Protocol::ModbusRtu, &[("protocol", "dcon"), ("baud_rate", "19200")]);
    let listed = at(1, Protocol::ModbusRtu);
    play.go_on();
    play.answer(Ok(identified("pir-234")));
    play.take_write();
    play.take_write();
    play.go_on();
    assert_eq!(play.answer(Err(Failure::Silent)).protocol, Protocol::Dcon);
    assert_eq!(play.answer(Err(Failure::Silent)), listed);
    // DIP 2 OFF: the switches say Modbus RTU, the speed is the written one.
    let elsewhere = play.answer(Ok(identified("pir-234")));
    assert_eq!((elsewhere.protocol, elsewhere.settings.baud_rate.bps()), (Protocol::ModbusRtu, 19_200));
    assert_eq!(play.step(), Some(InitStep::Done));
    assert!(!play.init().is_as_wanted() && play.last_notice().contains("hardware configuration"));
    assert_eq!(play.bench.take_moves(), [(listed, elsewhere)]);
    play.go_on();
    assert_eq!(play.step(), Some(InitStep::FindAgain));
    let wanted = play.answer(Ok(identified("pir-234")));
    assert!(play.init().is_as_wanted());
    assert_eq!(play.bench.take_moves(), [(elsewhere, wanted)]);
}

#[test]
fn a_new_address_given_before_is_where_the_module_is_looked_for() {
    let mut play = Play::with(Protocol::Dcon, &[("checksum", "on"), ("address", "7")]);
    let listed = at(1, Protocol::Dcon);
    play.bench.apply(Action::Write(listed, vec!["address".to_owned()]));
    play.bench.apply(Action::BeginInit(listed));
    play.take_write();
    assert_eq!(play.init().before, at(7, Protocol::Dcon));
    assert_eq!(play.init().after.address, 7);
    play.go_on();
    assert_eq!(play.answer(Ok(identified("pir-234"))), at(7, Protocol::Dcon));
}

#[test]
fn what_was_asked_at_the_old_address_is_asked_at_the_new_one() {
    let mut play = Play::with(Protocol::Dcon, &[("address", "7")]);
    let listed = at(1, Protocol::Dcon);
    play.bench.apply(Action::Read(listed, vec!["response_delay".to_owned()]));
    play.bench.apply(Action::Write(listed, vec!["address".to_owned()]));
    play.take_write();
    let module = play.bench.module(&at(7, Protocol::Dcon)).unwrap();
    assert_eq!(module.state("response_delay"), ItemState::BeingRead);
    let asked = play
        .commands
        .try_iter()
        .any(|command| matches!(command, BusCommand::Read { target, .. } if target == at(7, Protocol::Dcon)));
    assert!(asked);
}

#[test]
fn a_value_that_the_module_does_not_take_does_not_begin_the_procedure() {
    let mut play = Play::begun(Protocol::Dcon, &[("baud_rate", "9601")]);
    assert_eq!(play.step(), None);
    let module = play.bench.module(&at(1, Protocol::Dcon)).unwrap();
    assert!(matches!(module.state("baud_rate"), ItemState::Invalid(_)));
    play.bench.apply(Action::ContinueInit);
    assert!(play.bench.init().is_none());
}
