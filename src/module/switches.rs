//! The DIP and rotary switches of a module, and where its settings say that they stand.
//!
//! No protocol reads a switch. But a switch that is in force determines settings, so the settings tell its position,
//! and an address that no switch can give tells that the switches are not in force. What cannot be told so is
//! [`Position::Unknown`]; nothing is guessed. Which switch means what stands in the definition file.

pub mod check;
mod panel;
mod words;

pub use panel::{BankState, Position, PositionState, RotaryState, SwitchPanel};

use super::definition::{Definition, Item};
use super::value::{Fixed, Value};

/// 0 to F.
pub const ROTARY_POSITIONS: u8 = 16;
/// The item of which the caller of [`Definition::switches`] knows the value in force.
const ADDRESS: &str = "address";

/// The switches that a definition file describes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SwitchLayout {
    pub banks: Vec<Bank>,
    pub rotary: Option<Rotary>,
}

/// A bank of DIP switches.
#[derive(Debug, Clone, PartialEq)]
pub struct Bank {
    pub id: String,
    pub label: String,
    /// What comes before a position's number in a sentence, such as `DIP`.
    pub name: String,
    /// 1 to 16.
    pub positions: u8,
    /// Each position is in exactly one; in the order of their positions.
    pub groups: Vec<Group>,
}

/// Positions that mean something together.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    pub first: u8,
    pub last: u8,
    pub label: String,
    pub help: String,
    /// Counts whatever the switch says that tells whether the switches rule.
    pub always: bool,
    pub rows: Vec<Row>,
}

/// One combination of a group's positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// ON is true; the lowest position first.
    pub set: Vec<bool>,
    pub means: String,
    pub factory: bool,
    /// Whether the other switches are in force; `None` for a group that does not tell.
    pub switches_rule: Option<bool>,
    /// What the settings are then, by item id; empty if the manual does not tell.
    pub when: Vec<(String, Condition)>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    Is(Value),
    /// Both ends included.
    Between(Fixed, Fixed),
}

impl Condition {
    fn holds(&self, value: &Value) -> bool {
        match (self, value) {
            (Self::Is(expected), value) => expected == value,
            (Self::Between(low, high), Value::Number(number)) => {
                (low.to_f64()..=high.to_f64()).contains(&number.to_f64())
            }
            (Self::Between(..), _) => false,
        }
    }
}

/// A rotary switch of sixteen positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotary {
    pub label: String,
    pub help: String,
    /// The item that is one of `first` plus the position.
    pub item: String,
    pub first: Vec<i64>,
}

impl Rotary {
    /// The position that gives `value`; `None` if none does.
    fn position(&self, value: &Value) -> Option<u8> {
        let Value::Number(Fixed { raw, decimals: 0 }) = value else { return None };
        let mut offsets = self.first.iter().filter_map(|first| raw.checked_sub(*first));
        offsets.find_map(|offset| u8::try_from(offset).ok().filter(|position| *position < ROTARY_POSITIONS))
    }
}

/// Whether the switches or the written settings are in force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rule {
    Switches,
    Software,
    /// Either is possible.
    Untold,
}

impl Definition {
    /// Where the switches stand, told from the settings.
    ///
    /// `address` is the one at which the module answers on RS-485: `None` where it was reached in another way, as the
    /// switches say nothing about that. `known` gives present values by item id. Empty without described switches.
    pub fn switches(&self, address: impl Into<Option<u8>>, known: &dyn Fn(&str) -> Option<Value>) -> SwitchPanel {
        let address = address.into();
        let value = |id: &str| match address {
            Some(address) if id == ADDRESS => Some(Value::Number(Fixed::new(i64::from(address), 0))),
            _ => known(id),
        };
        Deduction { definition: self, layout: &self.switch_layout, value: &value }.panel()
    }
}

/// What the settings say of the switches.
struct Deduction<'a> {
    definition: &'a Definition,
    layout: &'a SwitchLayout,
    value: &'a dyn Fn(&str) -> Option<Value>,
}

impl<'a> Deduction<'a> {
    fn panel(&self) -> SwitchPanel {
        let rule = self.rule();
        let bank = |bank: &'a Bank| BankState {
            label: bank.label.clone(),
            positions: bank.groups.iter().flat_map(|group| self.group_states(bank, group, rule)).collect(),
        };
        SwitchPanel {
            banks: self.layout.banks.iter().map(bank).collect(),
            rotary: self.layout.rotary.as_ref().map(|rotary| RotaryState {
                label: rotary.label.clone(),
                position: self.rotary_position(rotary),
                in_force: rule != Rule::Software,
                explanation: self.rotary_words(rotary, rule),
            }),
            notes: self.notes(rule),
        }
    }

    fn group_states(&self, bank: &'a Bank, group: &'a Group, rule: Rule) -> Vec<PositionState> {
        let rows = self.possible_rows(group, rule);
        (group.first..=group.last)
            .enumerate()
            .map(|(index, number)| PositionState {
                number,
                group: group.first,
                position: agreed(&rows, index),
                in_force: group.always || rule != Rule::Software,
                title: format!("{} {number} – {}", bank.name, group.label),
                explanation: self.position_words(bank, group, &rows, index, rule),
            })
            .collect()
    }

    /// The switch that says whether the switches rule.
    fn ruler(&self) -> Option<(&'a Bank, &'a Group)> {
        let groups = self.layout.banks.iter().flat_map(|bank| bank.groups.iter().map(move |group| (bank, group)));
        let mut groups = groups;
        groups.find(|(_, group)| group.rules())
    }

    /// A number that the rotary switch cannot give was written.
    fn rule(&self) -> Rule {
        if self.ruler().is_none() {
            return Rule::Switches;
        }
        let Some(rotary) = &self.layout.rotary else { return Rule::Untold };
        match (self.value)(&rotary.item) {
            Some(value) if rotary.position(&value).is_none() => Rule::Software,
            _ => Rule::Untold,
        }
    }

    fn rotary_position(&self, rotary: &Rotary) -> Option<u8> {
        (self.value)(&rotary.item).and_then(|value| rotary.position(&value))
    }

    /// The rows of `group` that the settings leave open: those that are wholly met, else those that nothing rules out.
    fn possible_rows(&self, group: &'a Group, rule: Rule) -> Vec<&'a Row> {
        if group.rules() {
            let possible = |row: &&Row| rule == Rule::Untold || row.switches_rule == Some(rule == Rule::Switches);
            return group.rows.iter().filter(possible).collect();
        }
        let met: Vec<&Row> = group.rows.iter().filter(|row| self.is_met(row) == Some(true)).collect();
        if !met.is_empty() {
            return met;
        }
        group.rows.iter().filter(|row| self.is_met(row) != Some(false)).collect()
    }

    /// `None` if the settings that are known do not tell.
    fn is_met(&self, row: &Row) -> Option<bool> {
        let conditions = row.when.iter();
        let states: Vec<_> =
            conditions.map(|(id, condition)| (self.value)(id).map(|value| condition.holds(&value))).collect();
        if states.contains(&Some(false)) {
            return Some(false);
        }
        (!states.is_empty() && states.iter().all(Option::is_some)).then_some(true)
    }

    fn item(&self, id: &str) -> Option<&'a Item> {
        self.definition.item(id)
    }
}

impl Group {
    fn rules(&self) -> bool {
        self.rows.iter().any(|row| row.switches_rule.is_some())
    }

    /// Ids of the items that tell its position, each once, in the order of the file.
    fn items(&self) -> Vec<&str> {
        let mut ids: Vec<&str> = Vec::new();
        for (id, _) in self.rows.iter().flat_map(|row| &row.when) {
            if !ids.contains(&id.as_str()) {
                ids.push(id);
            }
        }
        ids
    }
}

/// How a position stands in all of `rows`.
fn agreed(rows: &[&Row], index: usize) -> Position {
    let mut states = rows.iter().filter_map(|row| row.set.get(index).copied());
    match states.next() {
        Some(first) if states.all(|state| state == first) => {
            if first {
                Position::On
            } else {
                Position::Off
            }
        }
        _ => Position::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::Catalogue;
    use super::*;

    /// A switch that rules, one that always counts, a pair with a step that no number tells, and a rotary switch.
    const BENCH: &str = r##"
id = "tm-1"
label = "TM-1"
manual = "none"

[[parameter]]
id = "address"
label = "Address"
help = "Its address."
tab = "configuration"
type = "number"
range = [0, 255]
modbus = [{ register = 1 }]

[[parameter]]
id = "level"
label = "Level"
help = "Its level."
tab = "configuration"
type = "choice"
unit = "V"
choices = [{ value = 1, code = 1 }, { value = 2, code = 2 }, { value = 3, code = 3 }, { value = 9, code = 9 }]
modbus = [{ register = 2 }]

[[dip]]
id = "main"
label = "Main"
name = "SW"
positions = 4

[[dip.group]]
positions = "1"
label = "Rule"
help = "Who rules."
rows = [
    { set = "off", means = "software", switches_rule = false },
    { set = "on", means = "hardware", factory = true, switches_rule = true },
]

[[dip.group]]
positions = "2-3"
label = "Level"
help = "Which level."
rows = [
    { set = "off off", means = "1 V", when = { level = 1 } },
    { set = "off on", means = "2 V", when = { level = 2 } },
    { set = "on off", means = "some V" },
]

[[dip.group]]
positions = "4"
label = "Test"
help = "A test."
always = true
rows = [{ set = "on", means = "testing" }, { set = "off", means = "not testing" }]

[rotary]
label = "Dial"
help = "Its address."
item = "address"
first = [16]
"##;

    fn definition(text: &str) -> std::sync::Arc<Definition> {
        let (catalogue, errors) = Catalogue::from_texts(vec![("tm-1.toml".to_owned(), text.to_owned())]);
        assert_eq!(errors, []);
        catalogue.get("tm-1").expect("a definition")
    }

    fn panel(address: Option<u8>, level: Option<&str>) -> SwitchPanel {
        let level = |id: &str| level.filter(|_| id == "level").map(|word| Value::Choice(word.to_owned()));
        definition(BENCH).switches(address, &level)
    }

    fn positions(panel: &SwitchPanel) -> Vec<(Position, bool)> {
        panel.banks[0].positions.iter().map(|state| (state.position, state.in_force)).collect()
    }

    use Position::{Off, On, Unknown};

    #[test]
    fn an_address_that_no_switch_gives_tells_that_the_written_settings_count() {
        let panel = panel(Some(40), Some("2"));
        assert_eq!(positions(&panel), [(Off, true), (Off, false), (On, false), (Unknown, true)]);
        assert!(panel.notes[0].starts_with("Address 40 cannot come from the switches, so SW 1 is OFF."));
        let rotary = panel.rotary.expect("a dial");
        assert_eq!((rotary.position, rotary.in_force), (None, false));
        assert!(rotary.explanation.contains("No position gives Address 40."));
    }

    #[test]
    fn an_address_that_the_switches_could_give_leaves_open_who_rules() {
        let panel = panel(Some(31), Some("1"));
        assert_eq!(positions(&panel), [(Unknown, true), (Off, true), (Off, true), (Unknown, true)]);
        assert!(panel.notes[0].starts_with("SW 1 is not told by the settings: Address 31 can come"));
        assert_eq!(panel.rotary.expect("a dial").position, Some(15));
    }

    #[test]
    fn without_an_address_on_the_line_nothing_is_concluded_from_one() {
        let panel = panel(None, None);
        assert!(positions(&panel).iter().all(|state| *state == (Unknown, true)));
        assert!(panel.notes[0].contains("Address is not known"), "{:?}", panel.notes);
        assert_eq!(panel.rotary.expect("a dial").position, None);
    }

    #[test]
    fn a_value_of_no_row_leaves_the_rows_that_no_value_tells() {
        let panel = panel(Some(16), Some("9"));
        assert_eq!(positions(&panel)[1..3], [(On, true), (Off, true)]);
    }

    #[test]
    fn a_value_that_no_position_gives_is_pointed_out() {
        let text = BENCH.replace(
            "{ set = \"on off\", means = \"some V\" },",
            "{ set = \"on off\", means = \"3 V\", when = { level = 3 } },",
        );
        let panel = definition(&text).switches(16u8, &|id| (id == "level").then(|| Value::Choice("9".to_owned())));
        assert_eq!(positions(&panel)[1..3], [(Unknown, true), (Unknown, true)]);
        assert_eq!(panel.notes[1], "No position of SW 2 and 3 gives Level = 9 V. SW 1 is probably OFF.");
    }

    #[test]
    fn every_position_explains_on_and_off_with_the_others_as_they_stand() {
        let panel = panel(Some(16), Some("2"));
        for state in &panel.banks[0].positions {
            assert!(state.explanation.contains("\nON: ") && state.explanation.contains("\nOFF: "), "{state:?}");
        }
        let second = &panel.banks[0].positions[1];
        assert_eq!(second.title, "SW 2 – Level");
        assert!(second.explanation.contains("ON: not in the manual\nOFF: 2 V\nOFF follows from Level = 2 V."));
        let first = &panel.banks[0].positions[0];
        assert!(first.explanation.contains("ON: hardware (factory setting)"));
    }

    #[test]
    fn a_definition_without_switches_has_an_empty_panel() {
        let text = &BENCH[..BENCH.find("[[dip]]").expect("a bank")];
        let panel = definition(text).switches(1u8, &|_| None);
        assert!(panel.is_empty());
        assert_eq!(panel, SwitchPanel::default());
    }

    #[test]
    fn switches_that_nothing_overrules_are_all_in_force() {
        let start = BENCH.find("[[dip.group]]").expect("a group");
        let end = BENCH.find("[[dip.group]]\npositions = \"2-3\"").expect("another");
        let rest = BENCH[end..].replace("2-3", "1-2").replace("positions = \"4\"", "positions = \"3\"");
        let text = format!("{}{rest}", BENCH[..start].replace("positions = 4", "positions = 3"));
        let panel = definition(&text).switches(40u8, &|_| None);
        assert!(positions(&panel).iter().all(|(_, in_force)| *in_force));
        assert_eq!(panel.notes, [""; 0]);
    }

    #[test]
    fn faulty_switches_are_refused_with_their_line_and_reason() {
        let line_of = |part: &str| BENCH[..BENCH.find(part).expect("a part")].matches('\n').count() + 1;
        for (from, to, at, reason) in [
            ("when = { level = 1 }", "when = { lefel = 1 }", "{ set = \"off off\"", "\"lefel\""),
            ("when = { level = 1 }", "when = { level = 7 }", "{ set = \"off off\"", "level cannot be 7: use 1, 2"),
            ("when = { level = 1 }", "when = { address = \"250-260\" }", "{ set = \"off off\"", "use 0 to 255"),
            ("set = \"off on\"", "set = \"off\"", "{ set = \"off on\"", "has 2 positions, the row 1"),
            ("set = \"off on\"", "set = \"off up\"", "{ set = \"off on\"", "up is neither"),
            ("set = \"off on\"", "set = \"off off\"", "{ set = \"off on\"", "stands twice"),
            ("set = \"on off\"", "set = \"off on\"", "{ set = \"on off\"", "stands twice"),
            ("{ set = \"on off\", means = \"some V\" },", "", "positions = \"2-3\"", "position 2 needs a row with ON"),
            ("\"2-3\"", "\"2-5\"", "positions = \"2-3\"", "not in a bank of 1 to 4"),
            ("\"2-3\"", "\"1-2\"", "positions = \"2-3\"", "position 1 is in two groups"),
            ("positions = 4", "positions = 5", "id = \"main\"", "position 5 is in no"),
            ("positions = 4", "positions = 0", "id = \"main\"", "1 to 16"),
            (", switches_rule = false", "", "positions = \"1\"", "`switches_rule` belongs"),
            (
                "switches_rule = false",
                "switches_rule = false, when = { level = 1 }",
                "{ set = \"off\", means",
                "no `when`",
            ),
            ("item = \"address\"", "item = \"adress\"", "label = \"Dial\"", "\"adress\""),
            ("item = \"address\"", "item = \"level\"", "label = \"Dial\"", "level is not a number"),
            ("first = [16]", "first = [241]", "label = \"Dial\"", "address cannot be 241 to 256"),
        ] {
            assert!(BENCH.contains(from), "{from}");
            let text = BENCH.replacen(from, to, 1);
            let (catalogue, errors) = Catalogue::from_texts(vec![("tm-1.toml".to_owned(), text)]);
            assert_eq!(errors.len(), 1, "{to}: {errors:?}");
            assert_eq!(errors[0].line, Some(line_of(at)), "{to}: {}", errors[0]);
            assert!(errors[0].reason.contains(reason), "{to}: {}", errors[0]);
            assert!(catalogue.get("tm-1").is_none());
        }
    }
}
