//! What the guide says.

use crate::bench::{InitChange, InitProcedure, InitStep, LineState, Module};
use crate::bus::Target;
use crate::protocol::Protocol;
use crate::ui::words;

/// So often asked in vain, the guide says what to check.
const MANY: u32 = 6;

pub fn steps(switch: &str) -> [String; 5] {
    [
        format!("Set {switch} ON, then switch the power off and on"),
        "Find the module in INIT mode".to_owned(),
        "Write the settings".to_owned(),
        format!("Set {switch} OFF, then switch the power off and on"),
        "Find the module with its new settings".to_owned(),
    ]
}

/// Which of the steps is the present one.
pub fn number(step: InitStep) -> u8 {
    match step {
        InitStep::SwitchOn => 1,
        InitStep::FindInInit => 2,
        InitStep::Writing => 3,
        InitStep::SwitchOff => 4,
        InitStep::FindAgain | InitStep::Done => 5,
    }
}

/// What the button that goes on says; none while the program is at work.
pub fn go_on(init: &InitProcedure) -> Option<&'static str> {
    match init.step {
        InitStep::SwitchOn | InitStep::SwitchOff => Some("Done – look for the module"),
        InitStep::Done if init.is_as_wanted() => Some("Finish"),
        InitStep::Done => Some("Look again"),
        InitStep::FindInInit | InitStep::Writing | InitStep::FindAgain => None,
    }
}

pub fn leaving(init: &InitProcedure) -> &'static str {
    match init.step {
        InitStep::SwitchOn => "The changes stay as they are, not written",
        InitStep::Done => "The module stays where it was found",
        _ => "What was written stays in the module, what was not stays a change",
    }
}

pub fn was(init: &InitProcedure, module: &Module, change: &InitChange) -> String {
    let item = module.item(&change.id);
    match (&change.was, item) {
        (Some(value), Some(item)) => item.text(value),
        (Some(value), None) => value.to_string(),
        (None, _) if change.id == "protocol" => init.before.protocol.label().to_owned(),
        (None, _) => "not known".to_owned(),
    }
}

pub fn becomes(module: &Module, change: &InitChange) -> String {
    module.item(&change.id).map_or_else(|| change.value.to_string(), |item| item.text(&change.value))
}

/// `address 1 (01h), DCON 19200 N81`
fn place(target: &Target) -> String {
    format!("address {}, {}", words::address(target.address), words::spoken(target))
}

/// Where the module is looked for, the likeliest first.
fn places(init: &InitProcedure) -> String {
    let places: Vec<String> = init.places().iter().map(place).collect();
    places.join("; ")
}

pub fn detail(init: &InitProcedure, module: &Module, switch: &str) -> Vec<String> {
    match init.step {
        InitStep::SwitchOn => {
            let refused = refusals(init, module);
            if refused.is_empty() {
                return vec![
                    "The switch counts from power-on. Then the module is looked for, and the settings are written one \
                     after the other. Until then nothing is changed."
                        .to_owned(),
                ];
            }
            let mut lines = vec![format!(
                "Not everything was taken. Check that {switch} is ON and that the power was switched off and on."
            )];
            lines.extend(refused);
            lines
        }
        InitStep::FindInInit => looking(init, &format!("check {switch} (ON), the power and the wires")),
        InitStep::Writing => vec!["Each setting is written once and read back.".to_owned()],
        InitStep::SwitchOff => vec![
            "All settings are written. They are in force after the next power-on.".to_owned(),
            format!("The module is expected at {}.", place(&init.after)),
        ],
        InitStep::FindAgain => looking(init, &format!("check {switch} (OFF), the power and the wires")),
        InitStep::Done if init.is_as_wanted() => {
            vec!["Its tab, its polling and its history go on from here.".to_owned()]
        }
        InitStep::Done => vec![format!(
            "Expected at {}. In hardware configuration the switches rule address and protocol, whatever is written. Or the power \
             was not switched off and on yet: do that, then look again.",
            place(&init.after)
        )],
    }
}

/// The settings that were refused, together where the reason is the same.
fn refusals(init: &InitProcedure, module: &Module) -> Vec<String> {
    let mut by_reason: Vec<(&str, Vec<&str>)> = Vec::new();
    for (id, reason) in init.refused() {
        let label = module.item(id).map_or(id, |item| item.label.as_str());
        let reason = reason.strip_prefix(id).unwrap_or(reason).trim_start_matches([':', ' ']);
        match by_reason.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, labels)) => labels.push(label),
            None => by_reason.push((reason, vec![label])),
        }
    }
    by_reason.into_iter().map(|(reason, labels)| format!("{}: {reason}", labels.join(", "))).collect()
}

fn looking(init: &InitProcedure, check: &str) -> Vec<String> {
    let asked = match init.attempts {
        0 => "Asking for the first time".to_owned(),
        1 => "Asked once, no answer".to_owned(),
        many => format!("Asked {many} times, no answer"),
    };
    let now = init.asked_now().map(|target| format!(", now {}", place(&target))).unwrap_or_default();
    let mut lines = vec![format!("Looked for in turn at {}.", places(init)), format!("{asked}{now}.")];
    if init.attempts >= MANY {
        lines.push(format!("Still looking – {check}."));
    }
    lines
}

pub fn found(init: &InitProcedure) -> String {
    format!("The module answers with its new settings: {}.", place(&init.after))
}

pub fn found_elsewhere(init: &InitProcedure) -> String {
    let at = init.found.as_ref().map_or_else(|| words::UNKNOWN.to_owned(), place);
    match init.found {
        Some(target) if target == init.before => format!("The module answers with its settings of before: {at}."),
        Some(target) if target.protocol == Protocol::Dcon && target.checksum != init.after.checksum => {
            let state = if target.checksum { "on" } else { "off" };
            format!("The module answers, but with checksum {state}: {at}.")
        }
        _ => format!("The module answers, but elsewhere: {at}."),
    }
}

pub fn lost_line(line: &LineState) -> Option<String> {
    match line {
        LineState::Open { .. } => None,
        LineState::Lost { .. } => line.loss(),
        LineState::Opening { line } => Some(format!("{line} is being opened")),
        LineState::Closed => Some("The line is closed".to_owned()),
    }
}
