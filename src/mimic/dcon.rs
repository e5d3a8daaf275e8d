//! DCON as the module hears it: frames, whose turn it is, and how it says yes and no.

use super::fields::{self, Heard};
use super::store::{Change, Refusal, Store};
use crate::module::notation::{Fields, Template};
use crate::module::{Kind, Value};
use crate::protocol::dcon;

/// The whole answer to a whole frame; `address` is that of the module, which a write may change.
pub(super) fn hear(store: &mut Store, address: &mut u8, checksum: bool, frame: &[u8]) -> Option<Vec<u8>> {
    let text = body(frame, checksum)?;
    let asked = text.get(1..3).filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()))?;
    // A broadcast has no address, and no answer.
    if u8::from_str_radix(asked, 16).ok()? != *address {
        return None;
    }
    let answer = match execute(store, *address, text)? {
        Heard::Answer(answer) => answer,
        Heard::Write(Ok(changes)) => {
            store.apply(changes);
            // After `%` the answer carries the new address.
            *address = address_in(store).unwrap_or(*address);
            format!("!{:02X}", *address)
        }
        Heard::Write(Err(_)) => format!("?{:02X}", *address),
    };
    Some(dcon::encode(&answer, checksum))
}

/// The address that a write has put into the store.
pub(super) fn address_in(store: &Store) -> Option<u8> {
    match store.value_of("address")? {
        Value::Number(number) => u8::try_from(number.raw).ok(),
        _ => None,
    }
}

fn execute(store: &mut Store, address: u8, text: &str) -> Option<Heard> {
    let definition = store.definition.clone();
    let is = |template: &Template| template.fill(address, &Fields::new()).is_ok_and(|command| command == text);
    if let Some(change) = own_command(store, is) {
        return Some(Heard::Write(change));
    }
    if let Some(heard) = fields::hear(store, None, address, text) {
        return Some(heard);
    }
    if definition.actions.iter().any(|action| action.dcon.as_ref().is_some_and(is)) {
        return Some(Heard::Write(Ok(Vec::new())));
    }
    let name =
        definition.identity.dcon_names.first().filter(|_| text.starts_with('$') && text.get(3..) == Some("M"))?;
    Some(Heard::Answer(format!("!{address:02X}{name}")))
}

/// The value that a command of its own sets (`@AADA`).
fn own_command(store: &Store, is: impl Fn(&Template) -> bool) -> Option<Result<Vec<Change>, Refusal>> {
    for item in &store.definition.items {
        let Kind::Choice(choices) = &item.kind else { continue };
        if let Some(choice) = choices.iter().find(|choice| choice.dcon_write.as_ref().is_some_and(&is)) {
            let value = Value::Choice(choice.word.clone());
            return Some(store.judge(item, &value).map(|()| vec![(item.id.clone(), value)]));
        }
    }
    None
}

/// What stands before the checksum and the end, if both are right.
fn body(frame: &[u8], checksum: bool) -> Option<&str> {
    let text = std::str::from_utf8(frame.strip_suffix(&[dcon::CR])?).ok()?;
    let text = if checksum {
        let (text, digits) = text.split_at_checked(text.len().checked_sub(2)?)?;
        (digits == format!("{:02X}", dcon::checksum(text.as_bytes()))).then_some(text)?
    } else {
        text
    };
    text.bytes().all(|byte| (b' '..=b'~').contains(&byte)).then_some(text)
}
