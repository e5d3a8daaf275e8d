//! The commands of a module, for looking up and for filling in.

use super::reference_field::{FieldDefault, ReferenceField, fields_of, filled_in};
use crate::module::{Access, Action, Command, Definition, Field, Fields, Template};
use crate::protocol::hex;

/// Which of a command's two texts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    Read,
    Write,
}

/// A command of the manual.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceEntry {
    pub id: String,
    pub title: String,
    /// `None` for DCON, the function code for a Modbus function of the module's own.
    pub function: Option<u8>,
    /// As the manual has it, `$AA2`.
    pub syntax_read: Option<String>,
    /// `%AANNTTCCFF`.
    pub syntax_write: Option<String>,
    /// The shapes of the answer to a read.
    pub answers: Vec<String>,
    /// What a person should know before sending it.
    pub note: String,
    /// Sections of the manual.
    pub source: String,
    pub fields: Vec<ReferenceField>,
    /// Ids of the items and actions that use it.
    pub items: Vec<String>,
    /// It has a text that changes something.
    pub writes: bool,
    /// Every module of the line hears what it writes and none answers.
    pub broadcast: bool,
    read: Option<Template>,
    write: Option<Template>,
    /// What is searched, in small letters.
    words: String,
}

/// The commands of `definition` in its order, then the actions that have a command which is not among them.
pub fn reference(definition: &Definition) -> Vec<ReferenceEntry> {
    let commands = definition.commands.iter().enumerate();
    let commands = commands.map(|(index, command)| ReferenceEntry::of_command(definition, index, command));
    let mut entries: Vec<_> = commands.collect();
    for action in &definition.actions {
        let Some(template) = &action.dcon else { continue };
        if !definition.commands.iter().any(|command| sends(command, template)) {
            entries.push(ReferenceEntry::of_action(action, template));
        }
    }
    entries
}

/// The entries in which every word of `text` is found: in title, syntax, note, section, and the ids and labels of the
/// items that use them. A whole command such as `$01LC700A` finds the entry that it is of.
pub fn search<'a>(entries: &'a [ReferenceEntry], text: &str) -> Vec<&'a ReferenceEntry> {
    let words: Vec<String> = text.split_whitespace().map(str::to_lowercase).collect();
    let found = |entry: &&ReferenceEntry| {
        words.iter().all(|word| entry.words.contains(word.as_str())) || entry.recognises(text.trim()).is_some()
    };
    entries.iter().filter(found).collect()
}

/// Which command a typed DCON command is, in which direction, and what it has in its fields.
pub fn recognise<'a>(entries: &'a [ReferenceEntry], text: &str) -> Option<(&'a ReferenceEntry, Direction, Fields)> {
    let text = text.trim();
    let of = |entry: &'a ReferenceEntry| {
        let (direction, fields) = entry.recognises(text)?;
        Some((entry, direction, fields))
    };
    // A command without fields is meant before one that takes any text.
    entries.iter().filter_map(of).min_by_key(|(_, _, fields)| fields.len())
}

/// Whether `command` can send what `template`, a command without fields, says.
fn sends(command: &Command, template: &Template) -> bool {
    command.read.iter().chain(&command.write).any(|known| {
        known.source() == template.source()
            || known.field_names().next().is_some_and(|name| filled_in(known, template, name).is_some())
    })
}

impl ReferenceEntry {
    fn of_command(definition: &Definition, index: usize, command: &Command) -> Self {
        let source = |template: &Option<Template>| template.as_ref().map(|template| template.source().to_owned());
        let used = |access: &Access| matches!(access, Access::Command(access) if access.command == index);
        let items = definition.items.iter().filter(|item| item.accesses.iter().any(used));
        let actions = definition.actions.iter();
        let actions = actions.filter(|action| action.dcon.as_ref().is_some_and(|own| sends(command, own)));
        let names: Vec<(&str, &str)> = items
            .map(|item| (item.id.as_str(), item.label.as_str()))
            .chain(actions.map(|action| (action.id.as_str(), action.label.as_str())))
            .collect();
        let labels: Vec<&str> = names.iter().map(|(_, label)| *label).collect();
        Self {
            id: command.id.clone(),
            title: command.title.clone(),
            function: command.function,
            syntax_read: source(&command.read),
            syntax_write: source(&command.write),
            answers: command.answers.iter().map(|answer| answer.source().to_owned()).collect(),
            note: command.note.clone(),
            source: command.source.clone(),
            fields: fields_of(definition, index, command),
            items: names.iter().map(|(id, _)| (*id).to_owned()).collect(),
            writes: command.write.is_some(),
            broadcast: command.function.is_none() && command.write.as_ref().is_some_and(|write| !write.has_address()),
            read: command.read.clone(),
            write: command.write.clone(),
            words: String::new(),
        }
        .with_words(&labels)
    }

    fn of_action(action: &Action, template: &Template) -> Self {
        Self {
            id: action.id.clone(),
            title: action.label.clone(),
            function: None,
            syntax_read: None,
            syntax_write: Some(template.source().to_owned()),
            answers: Vec::new(),
            note: action.help.clone(),
            source: action.source.clone(),
            fields: Vec::new(),
            items: vec![action.id.clone()],
            writes: true,
            broadcast: action.is_broadcast(),
            read: None,
            write: Some(template.clone()),
            words: String::new(),
        }
        .with_words(&[])
    }

    fn with_words(mut self, labels: &[&str]) -> Self {
        let syntax = self.syntax_read.iter().chain(&self.syntax_write).chain(&self.answers);
        let own = [&self.id, &self.title, &self.note, &self.source].into_iter().chain(syntax).chain(&self.items);
        let all: Vec<&str> = own.map(String::as_str).chain(labels.iter().copied()).collect();
        self.words = all.join("\n").to_lowercase();
        self
    }

    /// The fields that have to be filled in; a read has none.
    pub fn fields_to_fill(&self, direction: Direction) -> impl Iterator<Item = &ReferenceField> {
        self.fields.iter().filter(move |field| direction == Direction::Write && field.in_write)
    }

    /// The line that sends the command: DCON text, or `hex 01 46 05 00` for a Modbus function. Fields that are not given
    /// are completed where they are constant or the address. `Err` says which field is wrong and what form it has.
    pub fn fill(&self, direction: Direction, address: u8, fields: &Fields) -> Result<String, String> {
        let (template, other) = match direction {
            Direction::Read => (&self.read, "read – it can only be written"),
            Direction::Write => (&self.write, "written – it can only be read"),
        };
        let template = template.as_ref().ok_or_else(|| format!("{} cannot be {other}", self.id))?;
        let mut filled = Fields::new();
        for field in self.fields_to_fill(direction) {
            let given = fields.get(&field.name).filter(|text| !text.is_empty()).cloned();
            let completed = || match &field.default {
                Some(FieldDefault::Factory(_)) | None => None,
                Some(default) => Some(default.text(address)),
            };
            let text = given.or_else(completed).unwrap_or_default();
            filled.insert(field.name.clone(), field.check(&text)?);
        }
        let text = template.fill(address, &filled)?;
        match self.function {
            None => Ok(text),
            Some(function) => {
                let bytes = [vec![address, function], hex::parse(&text)?].concat();
                Ok(format!("hex {}", hex::spaced(&bytes)))
            }
        }
    }

    fn recognises(&self, text: &str) -> Option<(Direction, Fields)> {
        if self.function.is_some() {
            return None;
        }
        let address = text.get(1..3).and_then(|digits| u8::from_str_radix(digits, 16).ok()).unwrap_or_default();
        let directions = [(Direction::Read, &self.read), (Direction::Write, &self.write)];
        directions.into_iter().find_map(|(direction, template)| {
            let mut fields = template.as_ref()?.read(address, text)?;
            fields.remove("AA");
            let fits = |(name, text): (&String, &String)| {
                let field = self.fields.iter().find(|field| field.name == *name);
                field.is_none_or(|field| field.kind == Field::Text || field.check(text).is_ok())
            };
            fields.iter().all(fits).then_some((direction, fields))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::console::RawCommand;
    use crate::module::Catalogue;
    use proptest::prelude::*;

    fn entries(model: &str) -> Vec<ReferenceEntry> {
        reference(&Catalogue::built_in().0.get(model).unwrap())
    }

    fn entry(model: &str, id: &str) -> ReferenceEntry {
        entries(model).into_iter().find(|entry| entry.id == id).unwrap()
    }

    fn field(model: &str, id: &str, name: &str) -> ReferenceField {
        entry(model, id).fields.into_iter().find(|field| field.name == name).unwrap()
    }

    fn fields(pairs: &[(&str, &str)]) -> Fields {
        pairs.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
    }

    fn ids(found: &[&ReferenceEntry]) -> Vec<String> {
        found.iter().map(|entry| entry.id.clone()).collect()
    }

    #[test]
    fn every_command_is_listed_once_with_what_is_known_of_it() {
        for definition in Catalogue::built_in().0.iter() {
            let entries = reference(definition);
            assert!(definition.commands.iter().all(|command| entries.iter().any(|entry| entry.id == command.id)));
            for entry in &entries {
                assert_eq!(entry.syntax_write.is_some(), entry.writes, "{}", entry.id);
                assert!(entry.fields.iter().all(|field| !field.hint.is_empty()), "{}", entry.id);
            }
        }
        let entry = entry("pir-234", "configuration");
        assert_eq!(entry.syntax_read.as_deref(), Some("$AA2"));
        assert_eq!(entry.syntax_write.as_deref(), Some("%AANNTTCCFF"));
        assert_eq!(entry.answers, ["!AATTCCFF", "!AANNTTCCFF"]);
        assert_eq!(entry.items, ["address", "baud_rate", "data_format", "checksum"]);
        assert!(entry.writes && !entry.broadcast && entry.note.contains("INIT mode"));
    }

    #[test]
    fn actions_are_listed_only_if_no_command_sends_the_same() {
        let mut definition = (*Catalogue::built_in().0.get("pir-234").unwrap()).clone();
        assert_eq!(reference(&definition).len(), definition.commands.len());
        let mut action = definition.action("clear_alarm").unwrap().clone();
        action.id = "ring".into();
        action.dcon = Some(Template::dcon("~**R", std::iter::empty()).unwrap());
        definition.actions.push(action);
        let entries = reference(&definition);
        let last = entries.last().unwrap();
        assert_eq!((last.id.as_str(), last.broadcast, last.writes), ("ring", true, true));
        assert_eq!(last.fill(Direction::Write, 1, &Fields::new()), Ok("~**R".into()));
    }

    #[test]
    fn a_write_is_filled_with_address_and_constants() {
        let configuration = entry("pir-234", "configuration");
        let given = fields(&[("C", "0a"), ("F", "00")]);
        assert_eq!(configuration.fill(Direction::Write, 0x1F, &given), Ok("%1F1F400A00".into()));
        let moved = fields(&[("N", "02"), ("C", "06"), ("F", "40")]);
        assert_eq!(configuration.fill(Direction::Write, 1, &moved), Ok("%0102400640".into()));
        assert_eq!(configuration.fill(Direction::Read, 1, &Fields::new()), Ok("$012".into()));
        assert_eq!(entry("pir-234", "host_ok").fill(Direction::Write, 1, &Fields::new()), Ok("~**".into()));
    }

    #[test]
    fn a_field_of_wrong_form_is_told_with_the_right_one() {
        let refused = |id: &str, pairs: &[(&str, &str)]| {
            entry("pir-234", id).fill(Direction::Write, 1, &fields(pairs)).unwrap_err()
        };
        assert!(refused("response_delay", &[]).contains("V is missing – write 2 hexadecimal digits such as 0A"));
        assert!(refused("response_delay", &[("V", "1")]).contains("2 hexadecimal digits"));
        assert!(refused("response_delay", &[("V", "0G")]).contains("2 hexadecimal digits"));
        assert!(refused("temperature_offset", &[("Data", "1.5")]).ends_with("write +001.50"));
        assert!(refused("temperature_offset", &[("Data", "+1")]).ends_with("write +001.00"));
        assert!(refused("temperature_offset", &[("Data", "warm")]).contains("such as +025.00"));
        assert!(refused("enable_alarm", &[("T", "MM")]).contains("1 character"));
        assert!(refused("name", &[]).contains("can only be read"));
        let written = entry("pir-234", "clear_alarm").fill(Direction::Read, 1, &Fields::new()).unwrap_err();
        assert!(written.contains("can only be written"), "{written}");
        let right = entry("pir-234", "temperature_offset").fill(Direction::Write, 1, &fields(&[("Data", "-012.50")]));
        assert_eq!(right, Ok("@01TO-012.50".into()));
    }

    #[test]
    fn a_factory_value_is_suggested_but_never_sent_by_itself() {
        let on_time = field("pir-234", "pir_on_time", "N");
        assert_eq!(on_time.default, Some(FieldDefault::Factory("02".into())));
        let refused = entry("pir-234", "pir_on_time").fill(Direction::Write, 1, &Fields::new());
        assert!(refused.unwrap_err().contains("N is missing"));
    }

    #[test]
    fn codes_are_told_with_their_meaning() {
        let on_time = field("pir-234", "pir_on_time", "N");
        assert_eq!(on_time.choices.len(), 16);
        assert_eq!((on_time.choices[10].code.as_str(), on_time.choices[10].meaning.as_str()), ("0A", "393 s"));
        let protocol = field("pir-234", "protocol", "N");
        let codes: Vec<_> =
            protocol.choices.iter().map(|choice| (choice.code.as_str(), choice.meaning.as_str())).collect();
        assert_eq!(codes, [("0", "DCON"), ("1", "Modbus RTU")], "the answer calls it C");
        let alarm = field("pir-234", "enable_alarm", "T");
        let codes: Vec<_> = alarm.choices.iter().map(|choice| choice.code.as_str()).collect();
        assert_eq!(codes, ["M", "L"], "from the commands that the values have of their own");
        let latch = field("pir-234", "clear_high_latch_channel", "N");
        assert_eq!(latch.choices.len(), 5);
        assert!(latch.choices[2].code == "2" && latch.choices[2].meaning.contains("humidity"));
    }

    #[test]
    fn bits_that_several_items_share_can_be_set_one_by_one() {
        let speed_and_format = field("pir-234", "configuration", "C");
        assert!(speed_and_format.hint.contains("bits 0 to 5: Baud rate; bits 6 to 7: Data format"));
        let [speed, format] = speed_and_format.parts.as_slice() else { panic!("{:?}", speed_and_format.parts) };
        assert!(speed.choices.contains(&(0x0A, "115200 bps".to_owned())));
        assert_eq!((speed.take("C6"), format.take("C6")), (Some(6), Some(3)));
        assert_eq!(speed.put("C6", 0x0A).as_deref(), Some("CA"));
        assert_eq!(format.put("06", 1).as_deref(), Some("46"));
        assert_eq!(format.put("", 1), None);
    }

    #[test]
    fn numbers_are_told_with_their_range_and_step() {
        let timeout = field("pir-234", "watchdog", "T");
        assert!(timeout.hint.contains("as a number of 0.1 s") && timeout.hint.contains("2 hexadecimal digits"));
        assert!(field("pir-234", "pir_active_delay", "N").hint.contains("0 to 3000 ms"));
        assert!(field("pir-234", "configuration", "N").hint.contains("address"));
    }

    #[test]
    fn a_modbus_function_of_the_module_is_filled_as_bytes() {
        let settings = entry("pir-130", "communication_settings");
        assert_eq!(settings.function, Some(0x46));
        assert_eq!(settings.fill(Direction::Read, 1, &Fields::new()), Ok("hex 01 46 05 00".into()));
        let line = settings.fill(Direction::Write, 1, &fields(&[("C", "06"), ("P", "01")])).unwrap();
        assert_eq!(line, "hex 01 46 06 00 06 00 00 00 01 00 00");
        assert!(RawCommand::parse(&line, false).is_ok());
        assert!(!settings.broadcast);
    }

    #[test]
    fn entries_are_found_by_words_of_title_syntax_note_and_items() {
        let entries = entries("pir-234");
        assert_eq!(ids(&search(&entries, "$aa2")), ["configuration"]);
        assert_eq!(ids(&search(&entries, "baud_rate")), ["configuration"]);
        assert_eq!(ids(&search(&entries, "Data format")), ["configuration"]);
        assert_eq!(ids(&search(&entries, "overflow")), Vec::<String>::new());
        assert!(ids(&search(&entries, "host watchdog")).len() >= 4);
        assert_eq!(ids(&search(&entries, "$A3LC7C00A")), ["pir_on_time"]);
        assert_eq!(search(&entries, "").len(), entries.len());
    }

    #[test]
    fn a_typed_command_is_recognised() {
        let entries = entries("pir-234");
        let of = |text: &str| recognise(&entries, text).map(|(entry, direction, _)| (entry.id.clone(), direction));
        assert_eq!(of("$012"), Some(("configuration".into(), Direction::Read)));
        assert_eq!(of("%0101400600"), Some(("configuration".into(), Direction::Write)));
        assert_eq!(of("~**"), Some(("host_ok".into(), Direction::Write)));
        assert_eq!(of("@01CH"), Some(("clear_high_latch".into(), Direction::Write)));
        assert_eq!(of("@01CH3"), Some(("clear_high_latch_channel".into(), Direction::Write)));
        assert_eq!(of("@01RH"), Some(("alarm_limit".into(), Direction::Read)));
        assert_eq!(of("$01XYZ"), None);
        let (_, _, told) = recognise(&entries, "$01LC7C00A").unwrap();
        assert_eq!(told, fields(&[("N", "0A")]));
    }

    #[test]
    fn every_filled_command_is_recognised_as_itself() {
        for model in ["pir-130", "pir-234"] {
            let entries = entries(model);
            for entry in entries.iter().filter(|entry| entry.function.is_none()) {
                for direction in [Direction::Read, Direction::Write] {
                    let example = |field: &ReferenceField| {
                        let text = match (field.kind, field.width) {
                            (Field::Decimal, _) => "+001.00".to_owned(),
                            (_, width) => "0".repeat(width.unwrap_or(1)),
                        };
                        (field.name.clone(), text)
                    };
                    let given: Fields = entry.fields_to_fill(direction).map(example).collect();
                    let Ok(text) = entry.fill(direction, 1, &given) else { continue };
                    let (found, way, _) = recognise(&entries, &text).unwrap_or_else(|| panic!("{text}"));
                    assert_eq!((&found.id, way), (&entry.id, direction), "{text}");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text: String, typed in "[$#%@~][0-9A-F]{2}[0-9A-Z+.]{0,8}") {
            let entries = entries("pir-130");
            for text in [text, typed] {
                let _ = search(&entries, &text);
                let _ = recognise(&entries, &text);
                for entry in &entries {
                    let given = entry.fields.iter().map(|field| (field.name.clone(), text.clone())).collect();
                    let _ = entry.fill(Direction::Write, 1, &given);
                }
            }
        }
    }
}
