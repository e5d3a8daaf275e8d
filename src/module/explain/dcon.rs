//! DCON commands and answers.

use super::super::definition::Definition;
use super::super::identify;
use super::commands::{self, Form, address_field, address_of};
use super::{ExplainedField, Explanation, with_details};
use crate::protocol::{Protocol, Query, dcon, hex};

/// A frame's text, and what encloses it.
pub struct Text {
    /// Delimiter first, without checksum and carriage return.
    pub text: String,
    checksum: Option<ExplainedField>,
    checksum_is_right: bool,
}

impl Text {
    /// Takes a frame apart; bytes that are no characters are escaped.
    pub fn of(frame: &[u8], checksum: bool) -> Self {
        let frame = frame.trim_ascii();
        let split = frame.len().checked_sub(2).filter(|_| checksum).and_then(|at| frame.split_at_checked(at));
        let Some((text, found)) = split.filter(|(text, _)| !text.is_empty()) else {
            return Self { text: hex::escaped(frame), checksum: None, checksum_is_right: !checksum };
        };
        let right = format!("{:02X}", dcon::checksum(text));
        let found = hex::escaped(found);
        let checksum_is_right = found == right;
        let meaning = if checksum_is_right { "right".to_owned() } else { format!("wrong: {right} is right") };
        let checksum = Some(ExplainedField::new("checksum", found, meaning));
        Self { text: hex::escaped(text), checksum, checksum_is_right }
    }

    fn delimiter(&self) -> Option<ExplainedField> {
        let first = self.text.chars().next()?;
        let meaning = match first {
            '!' | '>' => "valid answer",
            '?' => "refusal",
            _ => "",
        };
        Some(ExplainedField::new("delimiter", first, meaning))
    }

    /// The frame's parts: what stands between its ends is told by `middle`.
    fn fields(&self, middle: Vec<ExplainedField>) -> Vec<ExplainedField> {
        self.delimiter().into_iter().chain(middle).chain(self.checksum.clone()).collect()
    }

    /// Address and the rest, of a text without a known shape.
    fn unknown_fields(&self) -> Vec<ExplainedField> {
        let (address, rest) = match address_of(&self.text) {
            Some(_) => (self.text.get(1..3), self.text.get(3..)),
            None => (None, self.text.get(1..)),
        };
        let address = address.map(address_field);
        let rest = rest.filter(|rest| !rest.is_empty()).map(|rest| ExplainedField::new("text", rest, ""));
        self.fields(address.into_iter().chain(rest).collect())
    }

    fn flagged(&self, summary: String) -> String {
        if self.checksum_is_right { summary } else { format!("{summary} (wrong checksum)") }
    }
}

/// Whether every module that hears the command is meant.
pub fn is_broadcast(text: &str) -> bool {
    text.get(1..3) == Some("**")
}

/// Whether it is the question that finds out who is there, which every module answers.
pub fn is_identification(text: &str) -> bool {
    let question = address_of(text).map(|address| identify::first_question(Protocol::Dcon, address));
    matches!(question, Some(Query::Dcon { text: question, .. }) if question == text)
}

pub fn request(definition: Option<&Definition>, checksum: bool, frame: &[u8]) -> Explanation {
    let text = Text::of(frame, checksum);
    let known = definition.and_then(|definition| commands::recognise(definition, None, &text.text));
    let (summary, fields) = match known {
        Some(known) => (with_details(&known.title, &known.values), text.fields(known.fields)),
        None if is_identification(&text.text) => ("Ask the module for its name".to_owned(), text.unknown_fields()),
        None if is_broadcast(&text.text) => (format!("Broadcast {}", text.text), text.unknown_fields()),
        None if definition.is_some() => (format!("Unknown command {}", text.text), text.unknown_fields()),
        None => (format!("Command {}", text.text), text.unknown_fields()),
    };
    Explanation { summary: text.flagged(summary), fields, danger: None }
}

pub fn answer(definition: Option<&Definition>, checksum: bool, request: &[u8], received: &[u8]) -> Explanation {
    let asked = Text::of(request, checksum);
    // An adapter's echo comes first, stray bytes before and after.
    let rest = received.strip_prefix(request).filter(|_| !request.is_empty()).unwrap_or(received);
    if rest.is_empty() {
        let field = ExplainedField::new("echo", hex::escaped(received), "the request, as the adapter sent it back");
        return Explanation { summary: "No answer, only the echo".to_owned(), fields: vec![field], danger: None };
    }
    let frame = own_answer(rest, checksum, &asked.text);
    let text = Text::of(frame, checksum);
    let (summary, fields) = match dcon::decode(frame, checksum) {
        Err(error) => (sentence(&error.to_string()), text.unknown_fields()),
        Ok(dcon::Answer::Refused { .. }) => {
            ("Refused: the module understood the command and did not carry it out".to_owned(), text.unknown_fields())
        }
        Ok(dcon::Answer::Ignored) => {
            ("Ignored: the host watchdog of the module has tripped".to_owned(), text.unknown_fields())
        }
        Ok(dcon::Answer::Valid { .. }) => valid(definition, &asked.text, &text),
    };
    Explanation { summary, fields, danger: None }
}

/// The answer among `rest`: that of the module that was asked, if there are several.
fn own_answer<'a>(rest: &'a [u8], checksum: bool, asked: &str) -> &'a [u8] {
    let whole = |frame: &&[u8]| dcon::decode(frame, checksum).is_ok();
    let starts = |at: &usize| rest.get(*at).is_some_and(|byte| dcon::ANSWER_DELIMITERS.contains(byte));
    let candidates = (0..rest.len()).filter(starts).filter_map(|start| {
        let frame = rest.get(start..)?;
        dcon::find_answer(frame).and_then(|range| frame.get(range)).or(Some(frame))
    });
    let candidates: Vec<&[u8]> = candidates.take(16).collect();
    let from_asked = |frame: &&&[u8]| {
        let sender = frame.get(1..3).and_then(|digits| std::str::from_utf8(digits).ok());
        sender.is_some() && sender == asked.get(1..3)
    };
    let asked_one = candidates.iter().filter(|frame| whole(frame)).find(from_asked);
    asked_one.or_else(|| candidates.iter().find(|frame| whole(frame))).or(candidates.first()).copied().unwrap_or(rest)
}

fn valid(definition: Option<&Definition>, asked: &str, text: &Text) -> (String, Vec<ExplainedField>) {
    let raw = |summary: String| (summary, text.unknown_fields());
    let known = definition.and_then(|definition| Some((definition, commands::recognise(definition, None, asked)?)));
    let Some((definition, known)) = known else {
        return raw(format!("Answer {}", text.text));
    };
    if known.form == Form::Write {
        let alone = text.text.len() == 3 && address_of(&text.text).is_some();
        let summary = format!("Confirmed: {}", known.title);
        return raw(if alone { summary } else { format!("{summary} ({})", text.text) });
    }
    let address = address_of(asked).unwrap_or_default();
    let answered = known.command.and_then(|command| commands::answered(definition, command, address, &text.text));
    match answered {
        Some((fields, values)) if values.is_empty() => (format!("Answer {}", text.text), text.fields(fields)),
        Some((fields, values)) => (values.join(", "), text.fields(fields)),
        None => raw(format!("An answer of no known shape: {}", text.text)),
    }
}

/// With a capital at its beginning.
fn sentence(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    first + characters.as_str()
}
