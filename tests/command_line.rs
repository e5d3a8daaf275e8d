//! The command line as a user and a script see it: the real program, its output and its exit codes.

#[path = "common/program.rs"]
mod program;

use std::io::{BufRead, BufReader};
use std::process::{ChildStdout, Command, Output, Stdio};

use program::{Running, bad, bench, command, demo, good, object, text};
use serde_json::{Value, json};
use tempfile::TempDir;

/// A port that no computer has: what is refused with exit code 2 was refused before the line was opened.
const NO_PORT: &str = "no-such-port";

#[test]
fn a_scan_prints_one_object_a_line_for_each_module() {
    let found = good(&demo("scan --addresses 1,17,0xA0,A3h,2 --json"));
    let place = |address: u8, protocol: &str, rest: &str| {
        format!(
            r#"{{"address":{address},"protocol":"{protocol}","baud_rate":9600,"data_format":"n81","checksum":false,{rest}}}"#
        )
    };
    let lines: Vec<&str> = found.lines().collect();
    assert_eq!(lines.len(), 4, "{found}");
    assert_eq!(lines[0], place(1, "modbus_rtu", r#""model":"pir-234","name":"PIR234","firmware":"B2.8""#));
    assert_eq!(lines[1], place(160, "modbus_rtu", r#""model":"pir-130","name":"PIR130","firmware":"1.0""#));
    assert_eq!(lines[2], place(163, "dcon", r#""model":"pir-234","name":"PIR234","firmware":"B2.8""#));
    let stranger: Value = serde_json::from_str(lines[3]).unwrap();
    assert_eq!((&stranger["address"], &stranger["model"]), (&json!(17), &json!("unknown")));
    assert!(stranger["said"].as_str().unwrap().contains("exception"), "{stranger}");
}

#[test]
fn a_scan_looks_where_its_options_say() {
    let at_19200 = object(&demo("scan --addresses 0x12 --baud-rates 19200 --protocols dcon --checksums on --json"));
    assert_eq!((&at_19200["baud_rate"], &at_19200["checksum"]), (&json!(19200), &json!(true)));
    let by_line = object(&demo("scan --addresses 0x12 --baud-rate 19200 --protocols dcon --checksums off,on --json"));
    assert_eq!(by_line, at_19200);
    assert_eq!(good(&demo("scan --addresses 1,0xA0 --first --json")).lines().count(), 1);
    let plain = good(&demo("scan --addresses 1 --protocols modbus_rtu --quick"));
    assert!(plain.starts_with("  1 (01h)  Modbus RTU  9600 N81"), "{plain}");
    assert!(plain.trim_end().ends_with("PIR-234   PIR234  B2.8"), "{plain}");
}

#[test]
fn a_scan_that_finds_nothing_says_what_to_check() {
    let output = bench(&demo("scan --addresses 77 --protocols dcon --json"));
    assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(1), &b""[..]));
    let advice = text(&output.stderr);
    for word in ["power", "D+ and D-", "--protocols modbus_rtu", "--full"] {
        assert!(advice.contains(word), "{word}: {advice}");
    }
}

#[test]
fn show_tells_module_parameters_and_readings() {
    let shown = object(&demo("show --address 1 --json"));
    assert_eq!(shown["module"]["model"], "pir-234");
    let (parameters, readings) = (&shown["parameters"], &shown["readings"]);
    assert_eq!((&parameters["baud_rate"], &parameters["data_format"]), (&json!(9600), &json!("n81")));
    assert_eq!((&parameters["pir1_enabled"], &parameters["alarm_limit"]), (&json!(true), &json!(65.0)));
    assert_eq!((&parameters["do0"], &readings["do0"]), (&json!(false), &json!(false)), "settable and live");
    assert!(readings["temperature_c"].is_number() && readings["humidity_low"].is_number(), "{readings}");
    for absent in ["checksum", "output_active_state", "init_mode", "reset_status", "wifi_ssid", "net_id", "lux_level"] {
        assert!(parameters.get(absent).is_none(), "{absent}");
    }
    let over_dcon = object(&demo("show --address 0xA3 --protocol dcon --json"));
    assert_eq!(over_dcon["parameters"]["checksum"], false);
    assert_eq!(over_dcon["parameters"]["init_mode"], false);
    assert!(over_dcon["readings"].get("pir1").is_none());
}

#[test]
fn show_keeps_the_order_of_the_definition() {
    let shown = good(&demo("show --address 0xA0 --json"));
    let places: Vec<_> = [
        "\"module\":",
        "\"parameters\":",
        "\"name\":\"PIR130\",\"firmware\":\"1.0\",\"address\":",
        "\"alarm_limit\":",
        "\"readings\":",
    ]
    .map(|name| shown.rfind(name).unwrap_or_else(|| panic!("{name} in {shown}")))
    .to_vec();
    assert!(places.is_sorted(), "{places:?} in {shown}");
}

#[test]
fn show_is_a_table_for_people() {
    let shown =
        good(&["show", "--demo", "--address", "12h", "--baud-rate", "19200", "--protocol", "dcon", "--checksum"]);
    assert!(shown.starts_with("PIR-130 at address 18 (12h), DCON 19200 N81, checksum: PIR130"), "{shown}");
    let row = shown.lines().find(|line| line.ends_with("alarm_limit")).unwrap();
    assert_eq!(row.split_whitespace().collect::<Vec<_>>(), ["High", "alarm", "limit", "65.00", "°C", "alarm_limit"]);
    assert!(shown.contains("\nParameters\n") && shown.contains("\nReadings\n"), "{shown}");
}

#[test]
fn get_prints_what_was_asked_for_in_that_order() {
    let values = good(&demo("get --address 1 pir_on_time name do0_source reset_status --json"));
    assert_eq!(values.trim_end(), r#"{"pir_on_time":6,"name":"PIR234","do0_source":"pir","reset_status":true}"#);
    let plain = good(&demo("get --address 1 response_delay"));
    assert_eq!(plain.split_whitespace().collect::<Vec<_>>(), ["Response", "delay", "0", "ms", "response_delay"]);
}

#[test]
fn a_silent_address_ends_with_1_and_advice() {
    for command in ["show", "get pir", "set do0=on", "action clear_alarm", "watch --count 1"] {
        let said = bad(1, &demo(&format!("{command} --address 99")));
        for word in ["address 99 (63h)", "160 to 191", "scan --full", "--protocol dcon", "--baud-rate"] {
            assert!(said.contains(word), "{command}, {word}: {said}");
        }
    }
}

#[test]
fn a_module_that_is_not_known_is_left_alone() {
    for command in ["show", "get pir", "set do0=on", "action clear_alarm", "watch --count 1"] {
        let said = bad(1, &demo(&format!("{command} --address 17")));
        assert!(said.contains("not known") && said.contains("exception 2"), "{command}: {said}");
    }
}

#[test]
fn a_port_that_is_not_there_ends_with_1() {
    for command in [vec!["scan"], vec!["show", "--address", "1"], vec!["send", "$01M"]] {
        let said = bad(1, &[command.as_slice(), &["--port", NO_PORT]].concat());
        assert!(said.contains("There is no port no-such-port"), "{said}");
    }
    let said = bad(1, &["scan", "--tcp", "127.0.0.1:1"]);
    assert!(said.contains("127.0.0.1:1 could not be reached"), "{said}");
}

/// What the program says about wrong usage, with the port that does not exist.
fn wrong(words: &str) -> String {
    let args: Vec<&str> = words.split(' ').chain(["--port", NO_PORT]).collect();
    bad(2, &args)
}

#[test]
fn wrong_names_and_values_are_refused_before_the_line_is_opened() {
    for (words, expected) in [
        ("get --address 1 temprature_c", "did you mean temperature_c"),
        ("get --address 1 nonsense", "There are: name, firmware, address"),
        ("get --address 1 checksum", "checksum is not offered over Modbus RTU"),
        ("get --address 1 --protocol dcon net_id", "net_id is not offered over DCON"),
        ("set --address 1 nonsense=1", "no parameter or reading \"nonsense\""),
        ("set --address 1 pir_on_time=3", "pir_on_time cannot be 3: use 2, 4, 6, 8, 16, 33"),
        ("set --address 1 response_delay=31", "use 0 to 30 ms"),
        ("set --address 1 alarm_mode=loud", "use disabled, momentary, latched"),
        ("set --address 1 buzzer_on_pir=maybe", "use true or false"),
        ("set --address 1 alarm_limit=700", "Modbus RTU carries 0.00 to 655.35 °C"),
        ("set --address 1 address=0", "Modbus RTU carries 1 to 247"),
        ("set --address 1 firmware=1", "firmware can only be read"),
        ("set --address 1 temperature_c=20", "temperature_c can only be read"),
        ("set --address 1 checksum=on", "checksum is not offered over Modbus RTU"),
        ("set --address 1 pir_on_time=33 response_delay=31", "use 0 to 30 ms"),
        ("set --address 1 do0=on do0=off", "do0 is given twice"),
        ("set --address 1 do0", "NAME=VALUE"),
        ("action --address 1 clear_alarms", "did you mean clear_alarm"),
        ("action --address 1 host_ok", "host_ok is not offered over Modbus RTU"),
        ("action --address 1 reboot", "reboot is not offered over Modbus RTU"),
    ] {
        let said = wrong(words);
        assert!(said.contains(expected), "{words}: {said}");
    }
}

#[test]
fn wrong_usage_ends_with_2() {
    for (words, expected) in [
        ("get pir", "--address"),
        ("get --address 256 pir", "use 0 to 255"),
        ("get --address A0 pir", "0xA0 or A0h"),
        ("get --address 0 pir", "use 1 to 247"),
        ("get --address 1", "NAME"),
        ("get --address 1 --protocol modbus_tcp pir", "--tcp"),
        ("get --address 1 --checksum pir", "--protocol dcon"),
        ("get --address 1 --baud-rate 300 pir", "115200"),
        ("get --address 1 --data-format n71 pir", "o81"),
        ("get --address 1 --demo pir", "--demo"),
        ("get --address 1 --tcp localhost pir", "--tcp"),
        ("scan --addresses 1-", "is not an address"),
        ("scan --addresses 5-1", "lower address first"),
        ("scan --addresses 0 --protocols modbus_rtu", "1 to 247"),
        ("scan --baud-rates 9600,300", "115200"),
        ("scan --data-formats x", "n81"),
        ("scan --protocols modbus_tcp", "--tcp"),
        ("scan --checksums perhaps", "off,on"),
        ("scan --window 0", "1ms to 10s"),
        ("scan --quick --full", "--full"),
        ("send", "COMMAND"),
        ("send --modbus 01", "at least an address and a function"),
        ("send --modbus 0x0", "hexadecimal"),
        ("send --modbus 0103 $01M", "cannot be used with"),
        ("watch --address 1 --interval 5", "500ms, 1s"),
        ("watch --address 1 --count 0", "--count"),
        ("dance", "dance"),
    ] {
        let said = wrong(words);
        assert!(said.contains(expected), "{words}: {said}");
    }
    for (args, expected) in [
        (&["scan"][..], "--port"),
        (&["--demo", "scan", "--demo"], "scan"),
        (&["show", "--tcp", "localhost", "--address", "1", "--protocol", "dcon"], "--protocol"),
        (&["show", "--tcp", "localhost", "--address", "1", "--checksum"], "--checksum"),
        (&["show", "--tcp", "localhost", "--address", "1", "--baud-rate", "9600"], "--baud-rate"),
        (&["show", "--tcp", "localhost:x", "--address", "1"], "is not a host"),
        (&["send", "--tcp", "localhost", "$01M"], "serial lines"),
        (&["action", "--tcp", "localhost:1", "--address", "1", "reboot"], "--yes"),
        (&["set", "--tcp", "localhost:1", "--address", "1", "checksum=on"], "not offered over Modbus TCP"),
        (&["simulate", "pir-999@1"], "pir-130, pir-230"),
        (&["simulate", "pir-234"], "MODEL@ADDRESS"),
        (&["simulate", "pir-999@1"], "unknown, dl-302"),
        (&["simulate", "dl-302@165:hardware"], "DIP switches"),
        (&["simulate", "no/such.toml@1"], "no/such.toml"),
        (&["simulate", "--tcp", "nowhere"], "127.0.0.1:1502"),
    ] {
        let said = bad(2, args);
        assert!(said.contains(expected), "{args:?}: {said}");
    }
}

#[test]
fn a_parameter_of_another_model_is_refused_by_name() {
    let said = bad(2, &demo("get --address 1 lux_level"));
    assert!(said.contains("no parameter or reading \"lux_level\"") && said.contains("pir4_enabled"), "{said}");
    let said = bad(2, &demo("set --address 0xA0 lux_level=200 do0=on"));
    assert!(said.contains("\"do0\""), "{said}");
}

#[test]
fn every_subcommand_explains_itself() {
    let reading = ["ports", "scan", "show", "get", "set", "action", "send", "watch", "record", "export", "simulate"];
    for command in reading.into_iter().chain(["completions", "manpage"]) {
        let help = good(&[command, "--help"]);
        assert!(help.contains("Usage:") && help.contains(&format!("\n  dcon-bench {command}")), "{help}");
    }
    assert!(good(&["--help"]).contains("Exit codes"));
    assert!(good(&["--version"]).starts_with(concat!("dcon-bench ", env!("CARGO_PKG_VERSION"))));
}

#[test]
fn shells_learn_commands_and_options() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = good(&["completions", shell]);
        for word in ["dcon-bench", "simulate", "data-format"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    assert!(bad(2, &["completions", "tcsh"]).contains("bash, elvish, fish, powershell, zsh"));
}

#[test]
fn there_is_a_manual_page_of_the_program_and_of_each_command() {
    assert!(good(&["manpage"]).contains(".TH dcon-bench 1 "));
    assert!(good(&["manpage", "scan"]).contains(".TH dcon-bench-scan 1 "));
    assert!(bad(2, &["manpage", "mend"]).contains("no command of this name"));
    let folder = TempDir::new().unwrap();
    good(&["manpage", "--out", folder.path().join("man1").to_str().unwrap()]);
    for name in ["dcon-bench.1", "dcon-bench-scan.1", "dcon-bench-manpage.1"] {
        assert!(folder.path().join("man1").join(name).is_file(), "{name}");
    }
}

#[test]
fn ports_are_listed_as_an_array() {
    let ports = object(&["ports", "--json"]);
    for port in ports.as_array().unwrap() {
        assert!(port["name"].is_string() && port["description"].is_string() && port.get("problem").is_some(), "{port}");
    }
    assert_eq!(good(&["ports"]).lines().count(), ports.as_array().unwrap().len());
}

#[test]
fn the_users_own_definitions_are_used_and_faulty_ones_reported() {
    let config = TempDir::new().unwrap();
    let modules = config.path().join("modules");
    std::fs::create_dir(&modules).unwrap();
    let own =
        include_str!("../assets/modules/pir-230.toml").replace("pir-230", "hall-sensor").replace("PIR230E", "PIR234");
    std::fs::write(modules.join("hall.toml"), own).unwrap();
    std::fs::write(modules.join("faulty.toml"), "id = 5\n").unwrap();
    let output = command(config.path(), &demo("scan --addresses 163 --json")).output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["model"], "hall-sensor");
    let warning = text(&output.stderr);
    assert!(warning.starts_with("warning: ") && warning.contains("faulty.toml, line 1"), "{warning}");
}

#[test]
fn send_shows_both_directions() {
    let shown = good(&demo("send $A3M"));
    let lines: Vec<&str> = shown.lines().collect();
    assert_eq!(lines[0], "sent      $A3M\\r  (24 41 33 4D 0D)");
    assert!(lines[1].starts_with("received  !A3PIR234\\r  (21 41 33 50 49 52 32 33 34 0D)  after "), "{shown}");
    assert!(lines[1].ends_with(" ms"), "{shown}");
    let shown = good(&["send", "--demo", "--modbus", "01 03 01 E0 00 04"]);
    assert!(shown.starts_with("sent      01 03 01 E0 00 04 44 03\nreceived  01 03 08 0B 28 "), "{shown}");
    let shown = good(&demo("send --baud-rate 19200 --checksum $12M"));
    assert!(shown.contains("sent      $12MD4\\r") && shown.contains("received  !12PIR130"), "{shown}");
    assert_eq!(good(&demo("send ~**")), "sent      ~**\\r  (7E 2A 2A 0D)\n", "nobody answers a broadcast");
}

#[test]
fn send_explains_refusals_and_fails_without_an_answer() {
    let output = bench(&["send", "--demo", "--modbus", "01 03 FF 00 00 01"]);
    assert_eq!(output.status.code(), Some(0), "a refusal is an answer");
    assert!(text(&output.stderr).starts_with("exception 2: "));
    let output = bench(&demo("send $99M"));
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(text(&output.stdout), "sent      $99M\\r  (24 39 39 4D 0D)\n");
    assert!(text(&output.stderr).contains("no answer"));
}

#[test]
fn watch_prints_a_line_for_each_set_of_readings() {
    let shown = good(&demo("watch --address 1 --interval 0 --count 3 --json"));
    let sets: Vec<Value> = shown.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(sets.len(), 3);
    let times: Vec<jiff::Timestamp> = sets.iter().map(|set| set["time"].as_str().unwrap().parse().unwrap()).collect();
    assert!(times.is_sorted() && times[0] < times[2], "{times:?}");
    assert!(shown.starts_with("{\"time\":\""), "{shown}");
    assert!(sets[0]["temperature_c"].is_number() && sets[0]["pir"].is_boolean() && sets[0].get("name").is_none());
    let plain = good(&demo("watch --address 1 --interval 50ms --count 2"));
    assert_eq!(plain.lines().filter(|line| line.contains(" °F  humidity=")).count(), 2, "{plain}");
}

#[test]
fn a_refused_write_is_explained_by_what_the_definition_knows_of_it() {
    let output = bench(&demo("set --address 1 do0=on"));
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1));
    assert!(said.contains("do0 was refused") && said.contains("unless its trigger source is command"), "{said}");
}

#[test]
fn the_first_set_that_watch_prints_has_the_modules_optional_parts_too() {
    let set: Value = serde_json::from_str(&good(&demo("watch --address 160 --count 1 --json"))).unwrap();
    assert!(set["temperature_c"].is_number(), "{set}");
}

#[test]
fn actions_are_carried_out() {
    assert_eq!(good(&demo("action --address 1 clear_high_latch:humidity")), "clear_high_latch:humidity: done\n");
    let sent = good(&demo("action --address 0xA3 --protocol dcon host_ok"));
    assert!(sent.starts_with("host_ok: sent to every module"), "{sent}");
}

#[test]
fn over_tcp_the_address_is_the_net_id_and_is_followed_when_it_changes() {
    let (_simulator, place) = Running::simulate(&["--tcp", "127.0.0.1:0", "pir-234@1", "pir-130@2"]);
    assert!(!place.ends_with(":0"), "{place}");
    let found = good(&["scan", "--tcp", &place, "--json"]);
    let expected = r#"{"address":1,"protocol":"modbus_tcp","baud_rate":9600,"data_format":"n81","checksum":false,"#;
    assert!(found.starts_with(expected) && found.lines().count() == 1, "{found}");
    let changed = good(&["set", "--tcp", &place, "--address", "1", "net_id=9", "temperature_offset=-1.25"]);
    assert_eq!(changed, "net_id: 1 -> 9\ntemperature_offset: 0.00 -> -1.25 °C\n");
    let shown = object(&["show", "--tcp", &place, "--address", "9", "--json"]);
    assert_eq!(
        (&shown["parameters"]["net_id"], &shown["parameters"]["temperature_offset"]),
        (&json!(9), &json!(-1.25))
    );
    assert!(shown["parameters"].get("address").is_none());
    assert_eq!(good(&["action", "--tcp", &place, "--address", "9", "reboot", "--yes"]), "reboot: done\n");
    let said = bad(1, &["get", "--tcp", &place, "--address", "1", "pir"]);
    assert!(said.contains("NetID"), "{said}");
}

#[test]
fn watch_goes_on_while_the_module_is_silent() {
    let (_simulator, place) = Running::simulate(&["--tcp", "127.0.0.1:0", "pir-234@1"]);
    let mut watch = Running::start(&["watch", "--tcp", &place, "--address", "1", "--interval", "0", "--json"]);
    let mut wait_for = |answers: bool| {
        while watch.line().contains("\"temperature_c\":null") == answers {}
    };
    wait_for(true);
    good(&["set", "--tcp", &place, "--address", "1", "net_id=2"]);
    wait_for(false);
    good(&["set", "--tcp", &place, "--address", "2", "net_id=1"]);
    wait_for(true);
    // What there was to be said about that set was said before the next one.
    wait_for(true);
    watch.child.kill().unwrap();
    let reasons: Vec<String> =
        BufReader::new(watch.child.stderr.take().unwrap()).lines().map_while(Result::ok).collect();
    assert!(reasons.iter().any(|reason| reason.ends_with("no answer")), "{reasons:?}");
    assert!(reasons.iter().any(|reason| reason.ends_with("  everything answers again")), "{reasons:?}");
}

#[cfg(unix)]
mod on_a_serial_line {
    use super::*;

    /// What the program prints with the simulated line as its port.
    fn on(port: &str, words: &str) -> Output {
        let args: Vec<&str> = words.split(' ').chain(["--port", port]).collect();
        bench(&args)
    }

    fn good_on(port: &str, words: &str) -> String {
        let output = on(port, words);
        assert_eq!(output.status.code(), Some(0), "{words}: {}", text(&output.stderr));
        text(&output.stdout)
    }

    #[test]
    fn modules_are_found_shown_changed_and_watched() {
        let (_simulator, port) = Running::simulate(&["pir-234@1:modbus_rtu:9600", "pir-130@0xA0:dcon:19200:checksum"]);
        let found = good_on(&port, "scan --addresses 1,160 --baud-rates 9600,19200 --checksums on --json");
        let models: Vec<Value> =
            found.lines().map(|line| serde_json::from_str::<Value>(line).unwrap()["model"].clone()).collect();
        assert_eq!(models, ["pir-234", "pir-130"]);
        let there = "--address 160 --baud-rate 19200 --protocol dcon --checksum";
        assert_eq!(
            good_on(&port, &format!("set {there} lux_level=200 sensitivity=3")),
            "lux_level: disabled -> 200 lux\nsensitivity: 0 -> 3\n"
        );
        assert_eq!(good_on(&port, &format!("get {there} lux_level --json")), "{\"lux_level\":200}\n");
        assert_eq!(good_on(&port, "watch --address 1 --interval 0 --count 1").lines().count(), 1);
        assert_eq!(good_on(&port, "action --address 1 clear_alarm"), "clear_alarm: done\n");
        assert!(good_on(&port, "send --modbus 010301E00004").contains("\nreceived  01 03 08 0B 28 "));
    }

    #[test]
    fn a_module_from_a_definition_file_is_simulated_found_and_changed() {
        let config = TempDir::new().unwrap();
        let folder = config.path().join("modules");
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("tm-1.toml");
        std::fs::write(&file, include_str!("vectors/tm-1.toml")).unwrap();
        let by_path = format!("{}@7:modbus_rtu:19200", file.display());
        let (_simulator, port) = Running::simulate(&[&by_path, "dl-302@0x21:dcon:9600"]);
        let run = |words: &str| {
            let args: Vec<&str> = words.split(' ').chain(["--port", &port]).collect();
            let output = command(config.path(), &args).output().unwrap();
            assert_eq!(output.status.code(), Some(0), "{words}: {}", text(&output.stderr));
            text(&output.stdout)
        };
        let found = run("scan --addresses 7,33 --baud-rates 9600,19200 --json");
        let mut models: Vec<String> = found
            .lines()
            .map(|line| serde_json::from_str::<Value>(line).unwrap()["model"].as_str().unwrap().to_owned())
            .collect();
        models.sort();
        assert_eq!(models, ["dl-302", "tm-1"]);
        assert_eq!(run("get --address 7 --baud-rate 19200 gain --json"), "{\"gain\":10}\n");
        assert_eq!(run("set --address 7 --baud-rate 19200 filter=50"), "filter: 60 -> 50\n");
        let there = "--address 33 --protocol dcon";
        let shown: Value = serde_json::from_str(&run(&format!("show {there} --json"))).unwrap();
        assert!(shown["readings"]["co2"].is_number() && shown["readings"]["temperature_c"].is_number(), "{shown}");
        assert_eq!(run(&format!("set {there} co2_alarm=latched")), "co2_alarm: disabled -> latched\n");
    }

    #[test]
    fn a_definition_of_the_users_folder_is_simulated_by_its_id() {
        let config = TempDir::new().unwrap();
        std::fs::create_dir_all(config.path().join("modules")).unwrap();
        std::fs::write(config.path().join("modules/tm-1.toml"), include_str!("vectors/tm-1.toml")).unwrap();
        let mut child = command(config.path(), &["simulate", "tm-1@7"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let mut simulator = Running { child, lines, _config: config };
        let port = simulator.line().split_once(' ').unwrap().1.to_owned();
        assert!(good_on(&port, "send --modbus 0703012C0001").contains("\nreceived  07 03 02 00 0A "));
    }

    #[test]
    fn values_are_written_in_order_read_back_and_kept() {
        let (_simulator, port) = Running::simulate(&["pir-234@1"]);
        let changed = good_on(&port, "set --address 1 do0_source=command do0=on pir_on_time=33 alarm_limit=45.5");
        assert_eq!(
            changed,
            "do0_source: pir -> command\ndo0: false -> true\npir_on_time: 6 -> 33 s\nalarm_limit: 65.00 -> 45.50 °C\n"
        );
        let kept = good_on(&port, "get --address 1 do0 pir_on_time alarm_limit --json");
        assert_eq!(kept, "{\"do0\":true,\"pir_on_time\":33,\"alarm_limit\":45.5}\n");
    }

    #[test]
    fn a_refused_value_ends_with_1_and_the_others_are_written() {
        let (_simulator, port) = Running::simulate(&["pir-234@1"]);
        let output = on(&port, "set --address 1 baud_rate=19200 response_delay=10");
        assert_eq!((output.status.code(), text(&output.stdout).as_str()), (Some(1), "response_delay: 0 -> 10 ms\n"));
        let said = text(&output.stderr);
        assert!(said.contains("baud_rate was refused") && said.contains("INIT mode"), "{said}");
    }

    #[test]
    fn in_init_mode_settings_wait_for_the_next_power_cycle() {
        let (_simulator, port) = Running::simulate(&["pir-234@1:dcon:init"]);
        let changed = good_on(&port, "set --address 1 --protocol dcon baud_rate=19200 checksum=on");
        for line in
            ["baud_rate: 9600 -> 19200 bps  (takes", "checksum: false -> true  (takes effect after a power cycle)"]
        {
            assert!(changed.contains(line), "{changed}");
        }
    }

    #[test]
    fn a_new_address_is_followed() {
        for protocol in ["modbus_rtu", "dcon"] {
            let (_simulator, port) = Running::simulate(&[&format!("pir-234@1:{protocol}")]);
            let changed =
                good_on(&port, &format!("set --address 1 --protocol {protocol} address=0xA5 response_delay=3"));
            assert_eq!(changed, "address: 1 -> 165\nresponse_delay: 0 -> 3 ms\n");
            let there = good_on(&port, &format!("get --address 165 --protocol {protocol} response_delay --json"));
            assert_eq!(there, "{\"response_delay\":3}\n");
        }
    }

    #[test]
    fn an_address_where_something_answers_is_refused() {
        let (_simulator, port) = Running::simulate(&["pir-234@1", "unknown@5"]);
        let output = on(&port, "set --address 1 address=5 response_delay=3");
        assert_eq!((output.status.code(), text(&output.stdout).as_str()), (Some(1), "response_delay: 0 -> 3 ms\n"));
        let said = text(&output.stderr);
        assert!(said.contains("another module answers at address 5 already"), "{said}");
        assert_eq!(good_on(&port, "get --address 1 response_delay --json"), "{\"response_delay\":3}\n");
    }

    #[test]
    fn a_module_whose_switches_rule_its_address_is_found_again() {
        let (_simulator, port) = Running::simulate(&["pir-234@0xB0:hardware"]);
        let output = on(&port, "set --address 176 address=9 response_delay=5");
        assert_eq!((output.status.code(), text(&output.stdout).as_str()), (Some(1), "response_delay: 0 -> 5 ms\n"));
        assert!(text(&output.stderr).contains("The module answers at address 176 (B0h)"));
    }

    #[test]
    fn a_lost_line_ends_a_scan_with_1() {
        let (mut simulator, port) = Running::simulate(&["pir-234@1"]);
        let mut scan = Running::start(&["scan", "--port", &port, "--full", "--json"]);
        assert!(scan.line().contains("pir-234"));
        simulator.child.kill().unwrap();
        assert_eq!(scan.child.wait().unwrap().code(), Some(1));
    }

    #[test]
    fn the_simulator_ends_with_0_and_takes_its_link_away() {
        let folder = TempDir::new().unwrap();
        let link = folder.path().join("line");
        let path = link.to_str().unwrap();
        for signal in ["-INT", "-TERM"] {
            let mut simulator = Running::start(&["simulate", "--pty", path, "--tcp", "127.0.0.1:0"]);
            assert_eq!(simulator.line(), format!("pty {path}"));
            assert!(simulator.line().starts_with("tcp 127.0.0.1:"));
            assert!(link.exists());
            assert_eq!(simulator.end_by(signal), Some(0));
            assert!(!link.is_symlink());
        }
        std::fs::write(&link, "someone's file").unwrap();
        let said = bad(1, &["simulate", "--pty", path]);
        assert!(said.contains(path), "{said}");
    }

    #[test]
    fn an_interrupted_watch_ends_with_0() {
        for signal in ["-INT", "-TERM"] {
            let mut watch = Running::start(&demo("watch --address 1 --interval 0 --json"));
            assert!(watch.line().starts_with("{\"time\":"));
            assert_eq!(watch.end_by(signal), Some(0));
        }
    }

    #[test]
    fn a_closed_pipe_ends_quietly_with_0() {
        let mut watch = Running::start(&demo("watch --address 1 --interval 0"));
        watch.line();
        let closed = std::mem::replace(&mut watch.lines, BufReader::new(empty_output()).lines());
        drop(closed);
        assert_eq!(watch.child.wait().unwrap().code(), Some(0));
        let said = std::io::read_to_string(watch.child.stderr.take().unwrap()).unwrap();
        assert_eq!(said, "");
    }

    /// Standard output of something that prints nothing.
    fn empty_output() -> ChildStdout {
        let mut child = Command::new("true").stdout(Stdio::piped()).spawn().unwrap();
        let output = child.stdout.take().unwrap();
        child.wait().unwrap();
        output
    }
}
