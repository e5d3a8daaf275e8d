//! From a definition file as written to a [`Definition`] that can be relied on.

use std::collections::BTreeMap;

use toml::Spanned;

use super::definition::{
    Access, Action, Bits, Choice, Command, CommandAccess, Definition, FillFrom, Identity, Item, ItemKind, Kind,
    ModbusAccess, ModbusPlace, NameBytes, NameWords, Optional,
};
use super::file;
use super::notation::Template;
use super::switches;
use super::value::Fixed;
use crate::protocol::Protocol;

/// What is wrong, and the byte of the file where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    pub at: usize,
    pub reason: String,
}

pub(super) type Checked<T> = Result<T, Problem>;

/// Says of which entry a reason is.
fn in_entry<T>(id: &Spanned<String>, result: Result<T, String>) -> Checked<T> {
    result.map_err(|reason| Problem { at: id.span().start, reason: format!("{}: {reason}", id.get_ref()) })
}

/// Where the entry stands of which a problem's reason speaks; `None` if `file` has none of that id.
pub fn entry(file: &file::File, reason: &str) -> Option<usize> {
    if let Some(at) = switches::check::entry(file, reason) {
        return Some(at);
    }
    let (id, _) = reason.split_once(": ")?;
    let items = file.parameter.iter().chain(&file.reading).map(|item| &item.id);
    let others = file.command.iter().map(|command| &command.id).chain(file.action.iter().map(|action| &action.id));
    items
        .chain(others)
        .chain(file.optional.iter().map(|part| &part.id))
        .find(|entry| entry.get_ref() == id)
        .map(|entry| entry.span().start)
}

pub fn check(file: &file::File) -> Checked<Definition> {
    if file.manual.is_empty() {
        return in_entry(&file.id, Err("`manual` has to tell what the definition was written from".to_owned()));
    }
    no_id_twice(file)?;
    let commands = file
        .command
        .iter()
        .map(|command| in_entry(&command.id, check_command(command)))
        .collect::<Checked<Vec<Command>>>()?;
    let item = |kind| {
        let commands = &commands;
        move |item: &file::Item| in_entry(&item.id, check_item(item, kind, commands, file))
    };
    let parameters = file.parameter.iter().map(item(ItemKind::Parameter));
    let readings = file.reading.iter().map(item(ItemKind::Reading));
    let items = parameters.chain(readings).collect::<Checked<Vec<Item>>>()?;
    let actions = file
        .action
        .iter()
        .map(|action| in_entry(&action.id, check_action(action, file)))
        .collect::<Checked<Vec<Action>>>()?;
    let optional = file
        .optional
        .iter()
        .map(|part| in_entry(&part.id, check_optional(part)))
        .collect::<Checked<Vec<Optional>>>()?;
    let switch_layout = switches::check::layout(file, &items)?;
    Ok(Definition {
        id: file.id.get_ref().clone(),
        label: file.label.clone(),
        manual: file.manual.clone(),
        identity: identity(&file.identity),
        optional,
        commands,
        items,
        actions,
        switch_layout,
    })
}

fn no_id_twice(file: &file::File) -> Checked<()> {
    let items = file.parameter.iter().chain(&file.reading).map(|item| &item.id);
    let lists: [Vec<&Spanned<String>>; 3] = [
        items.collect(),
        file.command.iter().map(|command| &command.id).collect(),
        file.action.iter().map(|action| &action.id).collect(),
    ];
    for list in lists {
        let mut seen = std::collections::HashSet::new();
        for id in list {
            if !seen.insert(id.get_ref()) {
                return in_entry(id, Err("this id stands twice".to_owned()));
            }
        }
    }
    Ok(())
}

fn identity(file: &file::Identity) -> Identity {
    Identity {
        dcon_names: file.dcon.clone(),
        words: file
            .words
            .iter()
            .map(|w| NameWords { low: w.low, high: w.high, name: w.name.clone(), needs: w.needs.clone() })
            .collect(),
        bytes: file
            .bytes
            .iter()
            .map(|b| NameBytes { bytes: b.bytes.clone(), name: b.name.clone(), needs: b.needs.clone() })
            .collect(),
    }
}

fn check_optional(part: &file::Optional) -> Result<Optional, String> {
    Ok(Optional { id: part.id.get_ref().clone(), label: part.label.clone(), probe: place(&part.probe)? })
}

fn check_command(command: &file::Command) -> Result<Command, String> {
    let names = || command.fields.keys().map(String::as_str);
    let template = |source: &String| match command.function {
        None => Template::dcon(source, names()),
        Some(_) => Template::bytes(source, names()),
    };
    let checked = Command {
        id: command.id.get_ref().clone(),
        title: command.title.clone(),
        source: command.source.clone(),
        note: command.note.clone(),
        function: command.function,
        read: command.read.as_ref().map(template).transpose()?,
        answers: command.answer.iter().map(template).collect::<Result<_, _>>()?,
        write: command.write.as_ref().map(template).transpose()?,
        fields: command.fields.clone(),
        filled_from: command.filled_from.iter().map(|(name, from)| (name.clone(), fill_from(from))).collect(),
    };
    if checked.read.is_some() && checked.answers.is_empty() {
        return Err("a command that reads needs at least one `answer`".to_owned());
    }
    if checked.read.as_ref().is_some_and(|read| read.field_names().next().is_some()) {
        return Err("`read` contains a letter that is declared as a field: give the field another letter".to_owned());
    }
    let templates = checked.read.iter().chain(&checked.answers).chain(&checked.write);
    for name in templates.flat_map(Template::field_names) {
        if !checked.fields.contains_key(name) {
            return Err(format!("field ({name}) is not declared in `fields`"));
        }
    }
    Ok(checked)
}

fn fill_from(text: &str) -> FillFrom {
    match text.strip_prefix('=') {
        Some(constant) => FillFrom::Text(constant.to_owned()),
        None if text == "address" => FillFrom::Address,
        None => FillFrom::Field(text.to_owned()),
    }
}

/// Refuses the name of a part that the file does not have.
fn known_part(part: Option<&String>, file: &file::File) -> Result<(), String> {
    match part {
        Some(part) if !file.optional.iter().any(|known| known.id.get_ref() == part) => {
            Err(format!("there is no [[optional]] part \"{part}\""))
        }
        _ => Ok(()),
    }
}

fn check_item(item: &file::Item, item_kind: ItemKind, commands: &[Command], file: &file::File) -> Result<Item, String> {
    known_part(item.optional.as_ref(), file)?;
    let dcon = item.dcon.iter().map(|place| command_access(place, commands).map(Access::Command));
    let modbus = item.modbus.iter().map(|place| modbus_access(place, commands));
    let mut checked = Item {
        id: item.id.get_ref().clone(),
        item_kind,
        label: item.label.clone(),
        help: item.help.clone(),
        unit: item.unit.clone(),
        tab: item.tab.clone(),
        kind: kind(item)?,
        applies: item.applies,
        read_only: item.read_only || item_kind == ItemKind::Reading,
        live: item.live,
        on_request: item.on_request,
        secret: item.secret,
        factory: None,
        optional: item.optional.clone(),
        source: item.source.clone(),
        accesses: dcon.chain(modbus).collect::<Result<_, _>>()?,
    };
    if checked.accesses.is_empty() {
        return Err("there is neither a `dcon` nor a `modbus` way to it".to_owned());
    }
    if let Some(factory) = &item.factory {
        let text = plain(factory)?;
        let value = checked.parse_any(&text);
        checked.factory = Some(value.ok_or_else(|| format!("factory = {text} is not {}", checked.allowed()))?);
    }
    Ok(checked)
}

/// A TOML value as the text a user would type.
pub(super) fn plain(value: &toml::Value) -> Result<String, String> {
    match value {
        toml::Value::String(text) => Ok(text.clone()),
        toml::Value::Integer(number) => Ok(number.to_string()),
        toml::Value::Float(number) => Ok(number.to_string()),
        toml::Value::Boolean(on) => Ok(on.to_string()),
        other => Err(format!("{other} is not a value")),
    }
}

fn kind(item: &file::Item) -> Result<Kind, String> {
    Ok(match item.kind {
        file::Kind::Bool => Kind::Bool,
        file::Kind::Number => {
            let [min, max] = item.range.ok_or("a number needs its `range = [lowest, highest]`")?;
            let fixed = |number| Fixed::from_f64(number, item.decimals);
            if item.decimals > 6 || min > max {
                return Err("`range` must be [lowest, highest], with at most 6 `decimals`".to_owned());
            }
            Kind::Number { min: fixed(min), max: fixed(max), also: item.also.iter().copied().map(fixed).collect() }
        }
        file::Kind::Choice => Kind::Choice(choices(item)?),
        file::Kind::Text => Kind::Text { max_length: item.max_length.unwrap_or(64) },
        file::Kind::Ipv4 => Kind::Ipv4,
    })
}

fn choices(item: &file::Item) -> Result<Vec<Choice>, String> {
    if item.choices.is_empty() {
        return Err("a choice needs its `choices`".to_owned());
    }
    item.choices
        .iter()
        .map(|choice| {
            let word = plain(&choice.value)?;
            let codes = |own: &Vec<u32>| if own.is_empty() { choice.code.into_iter().collect() } else { own.clone() };
            let write = choice.dcon_write.as_ref().map(|text| Template::dcon(text, std::iter::empty()));
            Ok(Choice {
                label: choice.label.clone().unwrap_or_else(|| word.clone()),
                word,
                dcon: codes(&choice.dcon),
                modbus: codes(&choice.modbus),
                dcon_write: write.transpose()?,
            })
        })
        .collect()
}

fn command_access(place: &file::Place, commands: &[Command]) -> Result<CommandAccess, String> {
    let (index, command) = find_command(&place.command, commands)?;
    if !command.fields.contains_key(&place.field) {
        return Err(format!("command \"{}\" has no field {}", place.command, place.field));
    }
    let answered = command.answers.iter().any(|answer| answer.field_names().any(|name| name == place.field));
    if command.read.is_some() && !answered && !command.filled_from.contains_key(&place.field) {
        return Err(format!("no `answer` of command \"{}\" has field {}", place.command, place.field));
    }
    Ok(CommandAccess {
        command: index,
        protocol: if command.function.is_some() { Protocol::ModbusRtu } else { Protocol::Dcon },
        field: place.field.clone(),
        index: place.index,
        bits: place.bits.as_deref().map(bits).transpose()?,
        inverted: place.inverted,
        encoding: place.encoding,
    })
}

fn find_command<'a>(id: &str, commands: &'a [Command]) -> Result<(usize, &'a Command), String> {
    let found = commands.iter().enumerate().find(|(_, command)| command.id == id);
    found.ok_or_else(|| format!("there is no [[command]] \"{id}\""))
}

fn modbus_access(place_in_file: &file::Modbus, commands: &[Command]) -> Result<Access, String> {
    if let Some(command) = &place_in_file.command {
        let field = place_in_file.field.clone().ok_or("a `command` needs its `field`")?;
        let place = file::Place {
            command: command.clone(),
            field,
            index: None,
            bits: place_in_file.bits.clone(),
            inverted: place_in_file.inverted,
            encoding: place_in_file.encoding,
        };
        return command_access(&place, commands).map(Access::Command);
    }
    Ok(Access::Modbus(ModbusAccess {
        place: place(place_in_file)?,
        bits: place_in_file.bits.as_deref().map(bits).transpose()?,
        inverted: place_in_file.inverted,
        signed: place_in_file.signed,
        range: place_in_file.range.map(|[low, high]| (low, high)),
        encoding: place_in_file.encoding,
        over_rtu: place_in_file.only != Some(file::Only::Tcp),
        over_tcp: place_in_file.only != Some(file::Only::Rtu),
    }))
}

fn place(modbus: &file::Modbus) -> Result<ModbusPlace, String> {
    let coils = |(first, count)| ModbusPlace::Coils { first, count };
    let registers = |(first, count)| match modbus.input {
        true => ModbusPlace::Input { first, count },
        false => ModbusPlace::Holding { first, count },
    };
    match (modbus.coil, &modbus.coils, modbus.register, &modbus.registers) {
        (Some(number), None, None, None) => span(number, number).map(coils),
        (None, Some(text), None, None) => range(text).and_then(|(low, high)| span(low, high)).map(coils),
        (None, None, Some(number), None) => span(number, number).map(registers),
        (None, None, None, Some(text)) => range(text).and_then(|(low, high)| span(low, high)).map(registers),
        _ => Err("name exactly one of `coil`, `coils`, `register`, `registers` or `command`".to_owned()),
    }
}

/// First number and count.
fn span(low: u16, high: u16) -> Result<(u16, u16), String> {
    let count = high.checked_sub(low).map(|more| more.saturating_add(1)).filter(|count| low > 0 && *count <= 120);
    count.map(|count| (low, count)).ok_or_else(|| format!("{low}-{high} is not a range of 1-based numbers"))
}

pub(super) fn range<T: std::str::FromStr + Copy>(text: &str) -> Result<(T, T), String> {
    let (low, high) = text.split_once('-').unwrap_or((text, text));
    match (low.trim().parse(), high.trim().parse()) {
        (Ok(low), Ok(high)) => Ok((low, high)),
        _ => Err(format!("\"{text}\" is not a range such as \"0-5\"")),
    }
}

fn bits(text: &str) -> Result<Bits, String> {
    let (low, high) = range(text)?;
    if low <= high && high < 64 { Ok(Bits { low, high }) } else { Err(format!("\"{text}\" is not a range of bits")) }
}

fn check_action(action: &file::Action, file: &file::File) -> Result<Action, String> {
    known_part(action.optional.as_ref(), file)?;
    let only = action.modbus.as_ref().and_then(|modbus| modbus.only);
    let checked = Action {
        id: action.id.get_ref().clone(),
        label: action.label.clone(),
        help: action.help.clone(),
        tab: action.tab.clone(),
        confirm: action.confirm,
        optional: action.optional.clone(),
        dcon: action.dcon.as_ref().map(|text| Template::dcon(text, std::iter::empty())).transpose()?,
        modbus: action.modbus.as_ref().map(place).transpose()?,
        over_rtu: only != Some(file::Only::Tcp),
        over_tcp: only != Some(file::Only::Rtu),
        source: action.source.clone(),
    };
    match (&checked.dcon, &checked.modbus) {
        (None, None) => Err("there is neither a `dcon` nor a `modbus` way to do it".to_owned()),
        _ => Ok(checked),
    }
}

/// `file` completed by what it does not say itself but `base` does.
pub fn complete(file: &file::File, base: &file::File) -> file::File {
    let identity = &file.identity;
    let own_identity = !(identity.dcon.is_empty() && identity.words.is_empty() && identity.bytes.is_empty());
    file::File {
        id: file.id.clone(),
        label: file.label.clone(),
        manual: if file.manual.is_empty() { base.manual.clone() } else { file.manual.clone() },
        based_on: None,
        identity: if own_identity { identity.clone() } else { base.identity.clone() },
        optional: overlay(&base.optional, &file.optional, |part| part.id.get_ref()),
        command: overlay(&base.command, &file.command, |command| command.id.get_ref()),
        parameter: overlay(&base.parameter, &file.parameter, |item| item.id.get_ref()),
        reading: overlay(&base.reading, &file.reading, |item| item.id.get_ref()),
        action: overlay(&base.action, &file.action, |action| action.id.get_ref()),
        dip: overlay(&switches::check::inherited_banks(base), &file.dip, |bank| bank.id.get_ref()),
        rotary: file.rotary.clone().or_else(|| switches::check::inherited_rotary(base)),
    }
}

/// The entries of `base`, those with the id of an entry of `own` replaced by it, then the rest of `own`.
fn overlay<T: Clone>(base: &[T], own: &[T], id: impl Fn(&T) -> &String) -> Vec<T> {
    let mut own_by_id: BTreeMap<&String, &T> = own.iter().map(|entry| (id(entry), entry)).collect();
    let mut all: Vec<T> = base.iter().map(|entry| own_by_id.remove(id(entry)).unwrap_or(entry).clone()).collect();
    all.extend(own.iter().filter(|entry| own_by_id.contains_key(id(entry))).cloned());
    all
}
