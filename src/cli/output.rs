//! What is printed: results for people and as JSON on standard output, messages on standard error.

use std::io::{self, Write};

use serde::Serialize;

use super::Outcome;
use super::stop::Stop;
pub use crate::bench::objects::{ModuleObject, ValuesObject};
use crate::bench::summary::aligned;
use crate::bus::{Answer, Target, Values};
use crate::module::{Definition, Identified, Item, Value};

/// Writes a line to standard output, at once.
pub fn line(text: &str) -> Outcome {
    let mut out = io::stdout().lock();
    writeln!(out, "{text}")?;
    Ok(out.flush()?)
}

/// Writes a whole text that ends its own lines.
pub fn bytes(text: &[u8]) -> Outcome {
    let mut out = io::stdout().lock();
    out.write_all(text)?;
    Ok(out.flush()?)
}

/// Writes a value as one line of JSON.
pub fn json(value: &impl Serialize) -> Outcome {
    let text = serde_json::to_string(value);
    line(&text.map_err(|error| Stop::failed(format!("the result cannot be written as JSON: {error}")))?)
}

/// Tells the user something; if standard error is closed, nobody wants to know.
pub fn message(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

pub fn warning(text: &str) {
    message(&format!("warning: {text}"));
}

pub fn error(text: &str) {
    message(&format!("error: {text}"));
}

/// Rows with columns of equal width, two spaces between them.
#[derive(Debug, Default)]
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    pub fn row<const N: usize>(&mut self, cells: [&str; N]) {
        self.rows.push(cells.map(str::to_owned).to_vec());
    }

    pub fn print(&self) -> Outcome {
        self.lines().iter().try_for_each(|text| line(text))
    }

    fn lines(&self) -> Vec<String> {
        aligned(&self.rows)
    }
}

/// Adds the row of one value: label, value, unit, id.
pub fn value_row(table: &mut Table, item: &Item, value: Option<&Value>) {
    let value = value.map_or_else(|| "–".to_owned(), ToString::to_string);
    table.row([&item.label, &value, &item.unit, &item.id]);
}

/// Tells why values are missing: one line for each reason, not for each value.
pub fn report_missing(values: &Values) {
    for reason in missing(values) {
        message(&reason);
    }
}

/// Each reason for which values are missing, with the ids that it concerns.
pub fn missing(values: &Values) -> Vec<String> {
    let mut reasons: Vec<(String, Vec<&str>)> = Vec::new();
    for Answer { id, result, .. } in values {
        let Err(failure) = result else { continue };
        let reason = failure.to_string();
        match reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, ids)) => ids.push(id),
            None => reasons.push((reason, vec![id])),
        }
    }
    let all_fail_alike = reasons.len() == 1 && values.iter().all(|answer| answer.result.is_err());
    let text = |(reason, ids): (String, Vec<&str>)| {
        if all_fail_alike && ids.len() > 1 { reason } else { format!("{}: {reason}", ids.join(", ")) }
    };
    reasons.into_iter().map(text).collect()
}

/// Which module it is, in a line.
pub fn module_line(target: &Target, identified: &Identified, definition: &Definition) -> String {
    let firmware = match identified.firmware.as_str() {
        "" => String::new(),
        firmware => format!(", firmware {firmware}"),
    };
    format!("{} at {target}: {}{firmware}", definition.label, identified.name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::Failure;

    fn answer(id: &str, result: Result<Value, Failure>) -> Answer {
        Answer { id: id.to_owned(), at: jiff::Timestamp::UNIX_EPOCH, result }
    }

    #[test]
    fn columns_are_as_wide_as_their_widest_cell_and_lines_end_without_spaces() {
        let mut table = Table::default();
        table.row(["a", "22.5", "°C", "x"]);
        table.row(["longer", "1", "", ""]);
        assert_eq!(table.lines(), ["a       22.5  °C  x", "longer  1"]);
    }

    #[test]
    fn missing_values_are_told_once_for_each_reason() {
        let silent = |id| answer(id, Err(Failure::Silent));
        let good = |id| answer(id, Ok(Value::Bool(true)));
        assert_eq!(missing(&vec![silent("a"), good("b"), silent("c")]), ["a, c: no answer"]);
        assert_eq!(missing(&vec![silent("a"), silent("c")]), ["no answer"]);
        assert!(missing(&vec![good("b")]).is_empty());
    }

    #[test]
    fn values_keep_their_order_in_json() {
        let values = vec![answer("b", Ok(Value::Bool(true))), answer("a", Err(Failure::Silent))];
        assert_eq!(serde_json::to_string(&ValuesObject::new(&values)).unwrap(), r#"{"b":true,"a":null}"#);
    }
}
