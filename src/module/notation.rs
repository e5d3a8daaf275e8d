//! The manuals' notation for commands and answers: `$AALC7C0NN`, `!AATTCCFF`, `>(Data)`, and for non-standard
//! Modbus functions their data bytes, `05 00 CC 00 00 00 PP 00 00`.
//!
//! `AA` behind the delimiter is the module's address. A field is a run of one capital letter that the command
//! declares (`N` for `NN`), or a word in brackets, which takes the rest of the answer.

use std::collections::BTreeMap;

/// Where modules may be asked in INIT mode; they answer with the address that they keep.
pub const INIT_ADDRESS: u8 = 0;
/// The name under which the sender of an answer stands among its fields.
pub const ANSWERED_FROM: &str = "AA";

/// The text of each field of a message, by field name.
pub type Fields = BTreeMap<String, String>;

#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    Literal(String),
    Address,
    Field { name: String, width: Option<usize> },
}

/// One command or answer, with places for the address and for fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Template {
    source: String,
    parts: Vec<Part>,
}

impl Template {
    /// Reads a DCON command or answer; `fields` are the declared names.
    pub fn dcon<'a>(source: &str, fields: impl Iterator<Item = &'a str> + Clone) -> Result<Self, String> {
        let mut characters = source.chars();
        let delimiter = characters.next().filter(|c| "$#%@~!>".contains(*c));
        let delimiter = delimiter.ok_or_else(|| format!("`{source}` must start with one of $ # % @ ~ ! >"))?;
        let rest = characters.as_str();
        let (mut parts, rest) = match rest.strip_prefix("AA") {
            Some(rest) => (vec![Part::Literal(delimiter.into()), Part::Address], rest),
            None => (vec![Part::Literal(delimiter.into())], rest),
        };
        parts.extend(split_fields(source, rest, fields)?);
        Ok(Self { source: source.to_owned(), parts })
    }

    /// Reads the data bytes of a non-standard Modbus function.
    pub fn bytes<'a>(source: &str, fields: impl Iterator<Item = &'a str> + Clone) -> Result<Self, String> {
        let packed: String = source.split_whitespace().collect();
        let parts = split_fields(source, &packed, fields)?;
        for part in &parts {
            if let Part::Literal(text) = part
                && (text.len() % 2 != 0 || !text.bytes().all(|b| b.is_ascii_hexdigit()))
            {
                return Err(format!("`{source}`: `{text}` is neither hexadecimal bytes nor a declared field"));
            }
        }
        Ok(Self { source: source.to_owned(), parts })
    }

    /// As the definition file has it.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Names of the fields, in order.
    pub fn field_names(&self) -> impl Iterator<Item = &str> {
        self.parts
            .iter()
            .filter_map(|part| if let Part::Field { name, .. } = part { Some(name.as_str()) } else { None })
    }

    pub fn has_address(&self) -> bool {
        self.parts.contains(&Part::Address)
    }

    /// Number of characters of field `name`; `None` if it is absent or takes the rest.
    pub fn width(&self, name: &str) -> Option<usize> {
        self.parts.iter().find_map(|part| match part {
            Part::Field { name: found, width } if found == name => *width,
            _ => None,
        })
    }

    /// The message with its address and fields filled in; `Err` names a field without a value or of a wrong width.
    pub fn fill(&self, address: u8, fields: &Fields) -> Result<String, String> {
        let mut text = String::new();
        for part in &self.parts {
            match part {
                Part::Literal(literal) => text.push_str(literal),
                Part::Address => text.push_str(&format!("{address:02X}")),
                Part::Field { name, width } => {
                    let value = fields.get(name).ok_or_else(|| format!("`{}` has no value for {name}", self.source))?;
                    if width.is_some_and(|width| width != value.len()) {
                        return Err(format!("\"{value}\" does not fit field {name} of `{}`", self.source));
                    }
                    text.push_str(value);
                }
            }
        }
        Ok(text)
    }

    /// The fields of `text`, if it has this shape and comes from `address`.
    pub fn read(&self, address: u8, text: &str) -> Option<Fields> {
        let mut rest = text;
        let mut fields = Fields::new();
        for part in &self.parts {
            match part {
                Part::Literal(literal) => rest = rest.strip_prefix(literal.as_str())?,
                Part::Address => {
                    let (sender, after) = rest.split_at_checked(2)?;
                    let known = u8::from_str_radix(sender, 16).ok()?;
                    if known != address && address != INIT_ADDRESS {
                        return None;
                    }
                    fields.insert(ANSWERED_FROM.to_owned(), sender.to_owned());
                    rest = after;
                }
                Part::Field { name, width } => {
                    let (value, after) = rest.split_at_checked(width.unwrap_or(rest.len()))?;
                    if value.is_empty() {
                        return None;
                    }
                    fields.insert(name.clone(), value.to_owned());
                    rest = after;
                }
            }
        }
        rest.is_empty().then_some(fields)
    }
}

fn split_fields<'a>(
    source: &str,
    text: &str,
    fields: impl Iterator<Item = &'a str> + Clone,
) -> Result<Vec<Part>, String> {
    let mut parts = Vec::new();
    let mut literal = String::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let (length, part) = match bracketed(rest) {
            Some(name) => (name.len().saturating_add(2), Some((name.to_owned(), None))),
            None => {
                let run = rest.len() - rest.trim_start_matches(first).len();
                let name = first.to_string();
                let declared = fields.clone().any(|field| field == name);
                (run, declared.then_some((name, Some(run))))
            }
        };
        let (taken, after) = rest.split_at_checked(length).ok_or_else(|| format!("`{source}` cannot be read"))?;
        match part {
            None => literal.push_str(taken),
            Some((name, width)) => {
                if !literal.is_empty() {
                    parts.push(Part::Literal(std::mem::take(&mut literal)));
                }
                if parts.iter().any(|part| matches!(part, Part::Field { name: earlier, .. } if *earlier == name)) {
                    return Err(format!("`{source}`: field {name} stands twice"));
                }
                if width.is_none() && !after.is_empty() {
                    return Err(format!("`{source}`: ({name}) has to be the end"));
                }
                parts.push(Part::Field { name, width });
            }
        }
        rest = after;
    }
    if !literal.is_empty() {
        parts.push(Part::Literal(literal));
    }
    Ok(parts)
}

fn bracketed(text: &str) -> Option<&str> {
    text.strip_prefix('(')?.split_once(')').map(|(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn template(source: &str, fields: &[&str]) -> Template {
        Template::dcon(source, fields.iter().copied()).unwrap()
    }

    fn fields(pairs: &[(&str, &str)]) -> Fields {
        pairs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn a_command_of_the_manual_is_filled_with_address_and_value() {
        let set = template("$AALC7C0NN", &["N"]);
        assert_eq!(set.fill(1, &fields(&[("N", "0A")])), Ok("$01LC7C00A".into()));
        assert!(set.fill(1, &fields(&[("N", "A")])).unwrap_err().contains('N'));
    }

    #[test]
    fn answers_are_told_apart_by_their_length() {
        let short = template("!AATTCCFF", &["N", "T", "C", "F"]);
        let long = template("!AANNTTCCFF", &["N", "T", "C", "F"]);
        let read = fields(&[("AA", "01"), ("T", "40"), ("C", "06"), ("F", "00")]);
        assert_eq!(short.read(1, "!01400600"), Some(read));
        assert_eq!(long.read(1, "!01400600"), None);
        assert_eq!(long.read(1, "!0101400600").unwrap().get("N").map(String::as_str), Some("01"));
    }

    #[test]
    fn an_answer_from_another_address_is_not_read() {
        assert_eq!(template("!AANN", &["N"]).read(2, "!0100"), None);
    }

    #[test]
    fn at_00_a_module_in_init_mode_may_answer_with_the_address_it_keeps() {
        let name = template("!AA(Data)", &[]);
        assert_eq!(name.read(0, "!2APIR234"), Some(fields(&[("AA", "2A"), ("Data", "PIR234")])));
        assert_eq!(name.read(1, "!2APIR234"), None);
    }

    #[test]
    fn bracketed_data_takes_the_rest() {
        let data = template(">(Data)", &[]);
        assert_eq!(data.read(1, ">+030.00+086.00"), Some(fields(&[("Data", "+030.00+086.00")])));
        assert_eq!(data.read(1, ">"), None);
    }

    #[test]
    fn bytes_may_contain_fields_that_look_like_hexadecimal() {
        let write = Template::bytes("06 00 CC 00 00 00 PP 00 00", ["C", "P"].into_iter()).unwrap();
        assert_eq!(write.fill(1, &fields(&[("C", "06"), ("P", "01")])), Ok("060006000000010000".into()));
        assert!(Template::bytes("05 0X", std::iter::empty()).is_err());
    }

    #[test]
    fn a_field_that_stands_twice_is_refused() {
        assert!(Template::dcon("$AANN0NN", ["N"].into_iter()).unwrap_err().contains("twice"));
    }

    proptest! {
        #[test]
        fn no_answer_makes_a_template_panic(source in "[!>$]A{0,2}[NTCF0]{0,6}(\\(Data\\))?", text: String, address: u8) {
            if let Ok(template) = Template::dcon(&source, ["N", "T"].into_iter()) {
                let _ = template.read(address, &text);
            }
        }
    }
}
