//! What is printed: results for people and as JSON on standard output, messages on standard error.

use std::io::{self, Write};

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::Outcome;
use super::stop::Stop;
use crate::bus::{Target, Values};
use crate::module::{Definition, Identified, Item, Value};
use crate::protocol::{BaudRate, DataFormat, Protocol};

/// Writes a line to standard output, at once.
pub fn line(text: &str) -> Outcome {
    let mut out = io::stdout().lock();
    writeln!(out, "{text}")?;
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
        let mut widths: Vec<usize> = Vec::new();
        for row in &self.rows {
            widths.resize(widths.len().max(row.len()), 0);
            for (width, cell) in widths.iter_mut().zip(row) {
                *width = (*width).max(cell.chars().count());
            }
        }
        let pad = |row: &Vec<String>| {
            let cells: Vec<String> = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:width$}")).collect();
            cells.join("  ").trim_end().to_owned()
        };
        self.rows.iter().map(pad).collect()
    }
}

/// A found module in JSON.
#[derive(Debug, Serialize)]
pub struct ModuleObject<'a> {
    address: u8,
    protocol: Protocol,
    baud_rate: BaudRate,
    data_format: DataFormat,
    checksum: bool,
    model: &'a str,
    name: &'a str,
    firmware: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    said: Option<&'a str>,
}

impl<'a> ModuleObject<'a> {
    pub fn new(target: &Target, identified: &'a Identified) -> Self {
        Self {
            address: target.address,
            protocol: target.protocol,
            baud_rate: target.settings.baud_rate,
            data_format: target.settings.data_format,
            checksum: target.checksum,
            model: identified.model(),
            name: &identified.name,
            firmware: &identified.firmware,
            said: identified.definition.is_none().then_some(&identified.said),
        }
    }
}

/// Values by name in JSON, in their order; those that could not be read are null.
#[derive(Debug)]
pub struct ValuesObject<'a>(pub Vec<(&'a str, Option<&'a Value>)>);

impl<'a> ValuesObject<'a> {
    pub fn new(values: &'a Values) -> Self {
        Self::of(values, |_| true)
    }

    /// Those with an id that is `wanted`.
    pub fn of(values: &'a Values, wanted: impl Fn(&str) -> bool) -> Self {
        let wanted = values.iter().filter(|(id, _)| wanted(id));
        Self(wanted.map(|(id, result)| (id.as_str(), result.as_ref().ok())).collect())
    }
}

impl Serialize for ValuesObject<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (id, value) in &self.0 {
            map.serialize_entry(id, value)?;
        }
        map.end()
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
    for (id, result) in values {
        let Err(failure) = result else { continue };
        let reason = failure.to_string();
        match reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, ids)) => ids.push(id),
            None => reasons.push((reason, vec![id])),
        }
    }
    let all_fail_alike = reasons.len() == 1 && values.iter().all(|(_, result)| result.is_err());
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

    #[test]
    fn columns_are_as_wide_as_their_widest_cell_and_lines_end_without_spaces() {
        let mut table = Table::default();
        table.row(["a", "22.5", "°C", "x"]);
        table.row(["longer", "1", "", ""]);
        assert_eq!(table.lines(), ["a       22.5  °C  x", "longer  1"]);
    }

    #[test]
    fn missing_values_are_told_once_for_each_reason() {
        let silent = |id: &str| (id.to_owned(), Err(Failure::Silent));
        let good = |id: &str| (id.to_owned(), Ok(Value::Bool(true)));
        assert_eq!(missing(&vec![silent("a"), good("b"), silent("c")]), ["a, c: no answer"]);
        assert_eq!(missing(&vec![silent("a"), silent("c")]), ["no answer"]);
        assert!(missing(&vec![good("b")]).is_empty());
    }

    #[test]
    fn values_keep_their_order_in_json() {
        let values = vec![("b".to_owned(), Ok(Value::Bool(true))), ("a".to_owned(), Err(Failure::Silent))];
        assert_eq!(serde_json::to_string(&ValuesObject::new(&values)).unwrap(), r#"{"b":true,"a":null}"#);
    }
}
