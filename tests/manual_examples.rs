//! The request/answer examples of both manuals, as the program asks and understands them. A scripted module fails the
//! test on any request that the manual does not show.

use std::collections::VecDeque;
use std::sync::Arc;

use dcon_bench::module::{Ask, Catalogue, Definition, read_items, run_action, write_item};
use dcon_bench::protocol::{Failure, Protocol, Query, Reply, dcon};
use jiff::Timestamp;

/// Plays one side of a page of the manual; an empty answer is silence.
struct Script {
    exchanges: VecDeque<(String, String)>,
    /// So often it cannot be told whether the answers belong to their questions.
    uncertain: usize,
}

impl Script {
    fn new(exchanges: &[(&str, &str)]) -> Self {
        let exchanges = exchanges.iter().map(|(q, a)| ((*q).to_owned(), (*a).to_owned())).collect();
        Self { exchanges, uncertain: 0 }
    }
}

impl Ask for Script {
    fn ask(&mut self, query: &Query) -> Result<Reply, Failure> {
        let Query::Dcon { text, .. } = query else { panic!("{query:?} is not DCON") };
        let (request, answer) = self.exchanges.pop_front().unwrap_or_else(|| panic!("unexpected request {text}"));
        assert_eq!(*text, request);
        if answer.is_empty() {
            return Err(Failure::Silent);
        }
        match dcon::decode(answer.as_bytes(), false).expect("an answer") {
            dcon::Answer::Refused { text } => Err(Failure::Refused { answer: format!("?{text}") }),
            dcon::Answer::Ignored => Err(Failure::Ignored),
            answer => Ok(Reply::Text(answer.to_text())),
        }
    }

    fn certain(&mut self) -> Result<(), Failure> {
        let certain = self.uncertain == 0;
        self.uncertain = self.uncertain.saturating_sub(1);
        if certain { Ok(()) } else { Err(Failure::Silent) }
    }

    fn answered_at(&self) -> Timestamp {
        Timestamp::UNIX_EPOCH
    }

    fn follow(&mut self, _address: u8) {}
}

fn definition(id: &str) -> Arc<Definition> {
    Catalogue::built_in().0.get(id).expect("a definition")
}

/// Address, item, request, answer, value. One answer that is the module's saying "no such shape" has no value.
type ReadExample = (u8, &'static str, &'static str, &'static str, Option<&'static str>);

const PIR_130_READS: &[ReadExample] = &[
    (1, "baud_rate", "$012", "!01400600", Some("9600")),
    (1, "data_format", "$012", "!01400600", Some("n81")),
    (1, "checksum", "$012", "!01400600", Some("false")),
    (1, "reset_status", "$015", "!011", Some("true")),
    (1, "reset_status", "$015", "!010", Some("false")),
    (1, "firmware", "$01F", "!0101.00", Some("01.00")),
    (2, "name", "$02M", "!02PIR130", Some("PIR130")),
    (1, "protocol", "$01P", "!0110", Some("dcon")),
    // The example answers address 02 with 01; only the address it was asked at is believed.
    (2, "relay", "@02DI", ">0100101", None),
    (1, "relay", "@01DI", ">0100101", Some("true")),
    (1, "pir", "@01DI", ">0100101", Some("false")),
    (1, "alarm_mode", "@01DI", ">0100101", Some("disabled")),
    (1, "pir_active_delay", "$01LC4C0", "!010BB8", Some("3000")),
    (1, "lux_level", "$01LC6C0", ">011", Some("100")),
    (1, "lux_level", "$01LC6C0", ">0101", Some("100")),
    (1, "pir_on_time", "$01LC8C0", ">0100", Some("2")),
    (1, "pir_on_time", "$01LC8C0", ">0101", Some("4")),
    (1, "buzzer_on_pir", "$01LCAC0", "!0101", Some("true")),
    (1, "buzzer_on_pir", "$01LCAC0", ">0101", Some("true")),
    (1, "sensitivity", "$01LCCC0", "!011", Some("1")),
    (1, "sensitivity", "$01LCCC0", ">0101", Some("1")),
    (2, "output_active_state", "~02D", "!0202", Some("low")),
    (3, "response_delay", "~03RD", "!031E", Some("30")),
    (3, "alarm_limit", "@03RH", "!03+090.50", Some("90.50")),
    // As above: the example for 01 answers with 03.
    (1, "alarm_limit", "@01RH", "!03+086.00", None),
    (3, "alarm_active", "@03RAO", "!030000", Some("false")),
    (3, "alarm_active", "@03RAO", "!030100", Some("true")),
];

const PIR_234_READS: &[ReadExample] = &[
    (1, "temperature_c", "#01", ">+030.00+086.00+050.00", Some("30.00")),
    (1, "temperature_f", "#01", ">+030.00+086.00+050.00", Some("86.00")),
    (1, "humidity", "#01", ">+030.00+086.00+050.00", Some("50.00")),
    (1, "dew_point_c", "#01", ">+030.00+086.00+050.00+018.40+065.12", Some("18.40")),
    (1, "temperature_c", "#01", ">-012.34+009.79+050.00", Some("-12.34")),
    (1, "baud_rate", "$012", "!01000600", Some("9600")),
    (1, "baud_rate", "$012", "!0101004A00", Some("115200")),
    (1, "data_format", "$012", "!0101004A00", Some("n82")),
    (1, "checksum", "$012", "!01000640", Some("true")),
    (1, "reset_status", "$015", "!011", Some("true")),
    (1, "firmware", "$01F", "!01A1.0", Some("A1.0")),
    (1, "init_mode", "$01I", "!010", Some("true")),
    (1, "pir_active_delay", "$01LC3", "!010BB8", Some("3000")),
    (1, "pir_active_delay", "$01LC3", "!0103E8", Some("1000")),
    (1, "pir_on_time", "$01LC8C0", "!0100", Some("2")),
    (1, "buzzer_on_pir", "$01LCAC0", "!0103", Some("true")),
    (1, "do0_source", "$01LCAC0", "!0103", Some("pir")),
    (1, "do1_source", "$01LCAC0", "!0103", Some("command")),
    (2, "name", "$02M", "!02PIR234E", Some("PIR234E")),
    (1, "protocol", "$01P", "!0110", Some("dcon")),
    (1, "protocol", "$01P", "!0111", Some("modbus_rtu")),
    // Sister modules answer with the second digit alone.
    (1, "protocol", "$01P", "!011", Some("modbus_rtu")),
    (3, "response_delay", "~03RD", "!031E", Some("30")),
    (1, "do0", "@01DI", "!0100100", Some("true")),
    (1, "do1", "@01DI", "!0100100", Some("false")),
    (1, "pir", "@01DI", "!0100100", Some("false")),
    // One character short of the table's shape: shown as it is, never guessed.
    (1, "do0", "@01DI", "!100101", None),
    (2, "output_active_state", "~02D", "!0202", Some("low")),
    (1, "humidity_offset", "@01HO", "!01+001.00", Some("1.00")),
    (1, "temperature_offset", "@01TO", "!01+001.00", Some("1.00")),
    (3, "alarm_limit", "@03RH", "!03+090.50", Some("90.50")),
    (3, "alarm_active", "@03RAO", "!030000", Some("false")),
    (1, "wdt_tripped", "~010", "!0104", Some("true")),
    (1, "wdt_timeout", "~012", "!011FF", Some("25.5")),
    (1, "wdt_enabled", "~012", "!011FF", Some("true")),
    (1, "do0_power_on", "~014", "!010201", Some("false")),
    (1, "do1_power_on", "~014", "!010201", Some("true")),
    (1, "do0_safe", "~014", "!010201", Some("true")),
    (1, "pir3_enabled", "$016", "!0104", Some("true")),
    (1, "pir_off_time_on_start", "$01LCE", "!011E", Some("30")),
];

fn reads_as_printed(model: &str, examples: &[ReadExample]) {
    let definition = definition(model);
    for (address, item, request, answer, value) in examples {
        // A second way to the item may follow an answer that has no known shape; it finds a silent module.
        struct Once(Script);
        impl Ask for Once {
            fn ask(&mut self, query: &Query) -> Result<Reply, Failure> {
                if self.0.exchanges.is_empty() { Err(Failure::Silent) } else { self.0.ask(query) }
            }
            fn answered_at(&self) -> Timestamp {
                Timestamp::UNIX_EPOCH
            }
            fn follow(&mut self, _address: u8) {}
        }
        let mut script = Once(Script::new(&[(request, answer)]));
        let read = read_items(&definition, Protocol::Dcon, *address, [*item], &mut script);
        let read = read.into_iter().next().unwrap_or_else(|| panic!("{item} is not offered")).result;
        match (value, &read) {
            (Some(expected), Ok(found)) => assert_eq!(found.to_string(), *expected, "{item}: {request} {answer}"),
            (None, Err(_)) => {}
            _ => panic!("{model} {item}: {request} {answer} was understood as {read:?}"),
        }
    }
}

#[test]
fn answers_of_the_pir_130_manual_are_understood() {
    reads_as_printed("pir-130", PIR_130_READS);
}

#[test]
fn answers_of_the_pir_234_manual_are_understood() {
    reads_as_printed("pir-234", PIR_234_READS);
}

/// Address, item, value, exchanges, whether it is carried out.
type WriteExample = (u8, &'static str, &'static str, &'static [(&'static str, &'static str)], bool);

const PIR_130_WRITES: &[WriteExample] = &[
    (1, "address", "2", &[("$02M", ""), ("$012", "!01400600"), ("%0102400600", "!02"), ("$022", "!02400600")], true),
    (1, "baud_rate", "115200", &[("$012", "!01200600"), ("%0101200A00", "?01")], false),
    (1, "baud_rate", "115200", &[("$012", "!01200600"), ("%0101200A00", "!01"), ("$012", "!01200A00")], true),
    (1, "protocol", "modbus_rtu", &[("$01P1", "!01"), ("$01P", "!0111")], true),
    (1, "protocol", "modbus_rtu", &[("$01P1", "?01")], false),
    // The example acknowledges with > instead of !.
    (1, "pir_active_delay", "1000", &[("$01LC3C003E8", ">01"), ("$01LC4C0", "!0103E8")], true),
    (1, "pir_active_delay", "3000", &[("$01LC3C00BB8", "!01"), ("$01LC4C0", "!010BB8")], true),
    (1, "lux_level", "100", &[("$01LC5C001", "!01"), ("$01LC6C0", ">011")], true),
    (1, "pir_on_time", "2", &[("$01LC7C000", "!01"), ("$01LC8C0", ">0100")], true),
    (1, "buzzer_on_pir", "true", &[("$01LC9C001", "!01"), ("$01LCAC0", "!0101")], true),
    (1, "sensitivity", "1", &[("$01LCBC001", "!01"), ("$01LCCC0", "!011")], true),
    (2, "output_active_state", "low", &[("~02D", "!0200"), ("~02D02", "!02"), ("~02D", "!0202")], true),
    (3, "response_delay", "30", &[("~03RD1E", "!03"), ("~03RD", "!031E")], true),
    (1, "alarm_mode", "momentary", &[("@01EAM", "!01"), ("@01DI", ">0110001")], true),
    (3, "alarm_mode", "disabled", &[("@03DA", "!03"), ("@03DI", "!0300001")], true),
    (3, "alarm_limit", "90.5", &[("@03HI+090.50", "!03"), ("@03RH", "!03+090.50")], true),
];

const PIR_234_WRITES: &[WriteExample] = &[
    (1, "address", "2", &[("$02M", ""), ("$012", "!01400600"), ("%0102400600", "!02"), ("$022", "!02400600")], true),
    (1, "pir_active_delay", "1000", &[("$01LC2C003E8", "!01"), ("$01LC3", "!0103E8")], true),
    // One bit of a shared byte: read, changed, sent back.
    (1, "buzzer_on_pir", "true", &[("$01LCAC0", "!0102"), ("$01LC9C003", "!01"), ("$01LCAC0", "!0103")], true),
    (1, "do0_source", "command", &[("$01LCAC0", "!0103"), ("$01LC9C001", "!01"), ("$01LCAC0", "!0101")], true),
    (1, "do0", "true", &[("@01DI", "!0100000"), ("@01DO01", "?01")], false),
    (1, "do0", "true", &[("@01DI", "!0100000"), ("@01DO01", "!01"), ("@01DI", "!0100100")], true),
    (1, "do0", "true", &[("@01DI", "!0100000"), ("@01DO01", "!")], false),
    (1, "alarm_limit", "86", &[("@01HI+086.00", "!01"), ("@01RH", "!01+086.00")], true),
    (1, "alarm_mode", "latched", &[("@01EAL", "!01"), ("@01DI", "!0120000")], true),
    (1, "humidity_offset", "1", &[("@01HO+001.00", "!01"), ("@01HO", "!01+001.00")], true),
    (1, "temperature_offset", "-1.25", &[("@01TO-001.25", "!01"), ("@01TO", "!01-001.25")], true),
    (1, "wdt_timeout", "25.5", &[("~012", "!01000"), ("~0130FF", "!01"), ("~012", "!010FF")], true),
    (1, "wdt_enabled", "true", &[("~012", "!010FF"), ("~0131FF", "!01"), ("~012", "!011FF")], true),
    (1, "do1_safe", "true", &[("~014", "!010201"), ("~0150203", "!01"), ("~014", "!010203")], true),
    (1, "pir2_enabled", "false", &[("$016", "!010F"), ("$0150D", "!01"), ("$016", "!010D")], true),
    (1, "pir_off_time_on_start", "30", &[("$01LCD1E", "!01"), ("$01LCE", "!011E")], true),
];

fn writes_as_printed(model: &str, examples: &[WriteExample]) {
    let definition = definition(model);
    for (address, item, value, exchanges, carried_out) in examples {
        let mut script = Script::new(exchanges);
        let item = definition.item(item).unwrap_or_else(|| panic!("there is no {item}"));
        let value = item.parse(value).expect("a value");
        let result = write_item(&definition, Protocol::Dcon, *address, item, &value, &mut script);
        assert_eq!(result.is_ok(), *carried_out, "{model} {} = {value}: {result:?}", item.id);
        assert!(script.exchanges.is_empty(), "{:?} were not sent", script.exchanges);
    }
}

#[test]
fn writes_of_the_pir_130_are_sent_as_its_manual_shows() {
    writes_as_printed("pir-130", PIR_130_WRITES);
}

#[test]
fn writes_of_the_pir_234_are_sent_as_its_manual_shows() {
    writes_as_printed("pir-234", PIR_234_WRITES);
}

#[test]
fn a_write_keeps_of_the_others_bits_only_what_was_certainly_read_of_them() {
    let definition = definition("pir-234");
    let item = definition.item("buzzer_on_pir").expect("an item");
    let value = item.parse("true").expect("a value");
    let again = [("$01LCAC0", "!0104"), ("$01LCAC0", "!0102"), ("$01LC9C003", "!01"), ("$01LCAC0", "!0103")];
    let mut script = Script { uncertain: 1, ..Script::new(&again) };
    let result = write_item(&definition, Protocol::Dcon, 1, item, &value, &mut script);
    assert!(result.is_ok() && script.exchanges.is_empty(), "{result:?}, {:?}", script.exchanges);
    let mut script = Script { uncertain: 2, ..Script::new(&again[..2]) };
    let error = write_item(&definition, Protocol::Dcon, 1, item, &value, &mut script).expect_err("nothing is certain");
    assert!(error.to_string().contains("was not written"), "{error}");
    assert!(script.exchanges.is_empty());
}

/// The examples that a module refuses because of the value are refused here before anything is sent.
#[test]
fn values_that_the_manuals_show_as_refused_are_never_sent() {
    let examples = [
        ("pir-130", "pir_active_delay", "3001"),
        ("pir-130", "lux_level", "5"),
        ("pir-130", "response_delay", "31"),
        ("pir-130", "alarm_limit", "1000.00"),
        ("pir-130", "sensitivity", "10"),
        ("pir-234", "pir_active_delay", "3001"),
        ("pir-234", "output_active_state", "7"),
        ("pir-234", "alarm_limit", "-0.01"),
        ("pir-234", "temperature_offset", "100.01"),
        ("pir-234", "wdt_timeout", "25.6"),
    ];
    for (model, item, value) in examples {
        let definition = definition(model);
        let error = definition.item(item).expect("an item").parse(value).expect_err("out of range").to_string();
        assert!(error.contains(item) && error.contains(value) && error.contains("use"), "{error}");
    }
}

#[test]
fn actions_are_sent_as_the_manuals_show() {
    type Example<'a> = (&'a str, &'a str, &'a [(&'a str, &'a str)]);
    let examples: [Example<'_>; 6] = [
        ("pir-130", "clear_alarm", &[("@03CHC0", "!03")]),
        ("pir-234", "clear_alarm", &[("@03CHC0", "!03")]),
        ("pir-234", "clear_watchdog", &[("~031", "!03")]),
        ("pir-234", "clear_high_latch", &[("@03CH", "!03")]),
        ("pir-234", "clear_low_latch:dew_point_c", &[("@03CL3", "!03")]),
        ("pir-234", "clear_high_latch:humidity", &[("@03CH2", "!03")]),
    ];
    for (model, action, exchanges) in examples {
        let definition = definition(model);
        let action = definition.action(action).unwrap_or_else(|| panic!("there is no {action}"));
        let mut script = Script::new(exchanges);
        assert_eq!(run_action(action, Protocol::Dcon, 3, &mut script), Ok(()), "{}", action.id);
        assert!(script.exchanges.is_empty());
    }
}

/// A module that is silent to one command only; the others are answered as the PIR-234 manual shows.
struct SilentTo(&'static str);

impl Ask for SilentTo {
    fn ask(&mut self, query: &Query) -> Result<Reply, Failure> {
        let Query::Dcon { text, .. } = query else { panic!("{query:?} is not DCON") };
        match text.as_str() {
            silent if silent == self.0 => Err(Failure::Silent),
            "#01" => Ok(Reply::Text(">+030.00+086.00+050.00".into())),
            "@01DI" => Ok(Reply::Text("!0100100".into())),
            "@01RAO" => Ok(Reply::Text("!010000".into())),
            "~010" => Ok(Reply::Text("!0100".into())),
            _ => Err(Failure::Refused { answer: "?01".into() }),
        }
    }

    fn answered_at(&self) -> Timestamp {
        Timestamp::UNIX_EPOCH
    }

    fn follow(&mut self, _address: u8) {}
}

#[test]
fn silence_to_one_command_does_not_hide_what_the_others_tell() {
    use dcon_bench::module::ReadPlan;
    let definition = definition("pir-234");
    for silent in ["#01", "@01DI", "@01RAO", "~010"] {
        let mut plan = ReadPlan::new(&definition, Protocol::Dcon, definition.live_ids(Protocol::Dcon, &[]));
        // Another question comes first after a run in which the first was not answered.
        let mut module = SilentTo(silent);
        plan.run(1, &mut module);
        let mut values = plan.run(1, &mut module);
        // Nothing is lost however often it is asked.
        for _ in 0..5 {
            values = plan.run(1, &mut module);
        }
        let known = |id: &str| values.iter().any(|answer| answer.id == id && answer.result.is_ok());
        assert_eq!(known("temperature_c"), silent != "#01", "{silent}");
        assert_eq!(known("do0"), silent != "@01DI", "{silent}");
        assert_eq!(known("alarm_active"), silent != "@01RAO", "{silent}");
        assert_eq!(known("wdt_tripped"), silent != "~010", "{silent}");
        let all = values.len();
        module.0 = "";
        values = plan.run(1, &mut module);
        for id in ["temperature_c", "do0", "alarm_active", "wdt_tripped"] {
            let back = values.iter().any(|answer| answer.id == id && answer.result.is_ok());
            assert!(back || silent == "#01", "{id} comes back after {silent} is answered again");
        }
        assert_eq!(values.len(), all);
    }
}

#[test]
fn a_dead_module_costs_one_question_a_run() {
    struct Dead(u32);
    impl Ask for Dead {
        fn ask(&mut self, _query: &Query) -> Result<Reply, Failure> {
            self.0 += 1;
            Err(Failure::Silent)
        }
        fn answered_at(&self) -> Timestamp {
            Timestamp::UNIX_EPOCH
        }
        fn follow(&mut self, _address: u8) {}
    }
    let definition = definition("pir-234");
    let mut plan =
        dcon_bench::module::ReadPlan::new(&definition, Protocol::Dcon, definition.live_ids(Protocol::Dcon, &[]));
    let mut module = Dead(0);
    for runs in 1..=5 {
        assert!(plan.run(1, &mut module).iter().all(|answer| answer.result == Err(Failure::Silent)));
        assert_eq!(module.0, runs);
    }
}

/// A PIR-234 that answers its first question, is silent to so many, and answers again.
struct SilentFor {
    silences: usize,
    asked: usize,
}

impl Ask for SilentFor {
    fn ask(&mut self, _query: &Query) -> Result<Reply, Failure> {
        self.asked += 1;
        let is_silent = (2..2 + self.silences).contains(&self.asked);
        if is_silent { Err(Failure::Silent) } else { Err(Failure::Refused { answer: "?01".into() }) }
    }

    fn answered_at(&self) -> Timestamp {
        Timestamp::UNIX_EPOCH
    }

    fn follow(&mut self, _address: u8) {}
}

#[test]
fn some_silences_in_a_row_lose_only_what_was_asked_then_and_many_are_an_absence() {
    let definition = definition("pir-234");
    let ids = || definition.readable_ids(Protocol::Dcon, &[]);
    let run = |silences| {
        let mut module = SilentFor { silences, asked: 0 };
        let values = dcon_bench::module::read_items(&definition, Protocol::Dcon, 1, ids(), &mut module);
        let silent = values.iter().filter(|answer| answer.result == Err(Failure::Silent)).count();
        (module.asked, silent, values.len())
    };
    let (all, ..) = run(0);
    assert!(all > 10, "{all} questions");
    for silences in 1..=7 {
        let (asked, silent, values) = run(silences);
        assert!(asked > all / 2, "what comes later is asked: {asked} of {all}");
        assert!((1..values).contains(&silent), "{silent} of {values} are missing after {silences} silences");
    }
    let (asked, ..) = run(usize::MAX - 2);
    assert_eq!(asked, 9, "it has gone: nothing more is asked");
}
