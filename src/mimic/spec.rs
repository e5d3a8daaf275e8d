//! How a module from a definition is described in one word: `dl-302@5:dcon:9600` or `my.toml@5:modbus_rtu`.

use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use crate::module::{Catalogue, Definition, FileError, load_file};
use crate::sim::{Placing, SpecError};

/// A module from a definition as it is switched on: a definition's id or the path of its file, `@`, and what
/// [`crate::sim::ModuleSpec`] has behind the `@`, without `hardware`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MimicSpec {
    /// An id, or a path: something that ends with `.toml` or names a folder.
    pub model: String,
    pub placing: Placing,
}

/// Why there is no such module.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MimicSpecError {
    #[error(transparent)]
    Spec(#[from] SpecError),
    #[error("\"{0}\" cannot be ruled by DIP switches: leave \"hardware\" out, only the PIR models have it")]
    Hardware(String),
    #[error("\"{model}\" is neither a model nor a definition file: use {known}, or a path such as ./my.toml")]
    UnknownModel { model: String, known: String },
    #[error(transparent)]
    File(#[from] FileError),
}

impl MimicSpec {
    /// The definition, from `catalogue` or from its own file; `others` are the models that need none, for the message.
    pub fn definition(&self, catalogue: &Catalogue, others: &[&str]) -> Result<Arc<Definition>, MimicSpecError> {
        if self.model.ends_with(".toml") || self.model.contains(['/', '\\']) {
            return Ok(load_file(Path::new(&self.model))?);
        }
        catalogue.get(&self.model.to_ascii_lowercase()).ok_or_else(|| {
            let ids = catalogue.iter().map(|definition| definition.id.as_str());
            let mut known: Vec<&str> = others.iter().copied().chain(ids).collect();
            let mut seen = std::collections::HashSet::new();
            known.retain(|model| seen.insert(*model));
            MimicSpecError::UnknownModel { model: self.model.clone(), known: known.join(", ") }
        })
    }
}

impl FromStr for MimicSpec {
    type Err = MimicSpecError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        // The last `@`: a path may have one too.
        let parts = text.trim().rsplit_once('@').filter(|(model, _)| !model.is_empty());
        let (model, placing) = parts.ok_or_else(|| SpecError::NoAddress(text.to_owned()))?;
        let placing: Placing = placing.parse()?;
        if placing.hardware {
            return Err(MimicSpecError::Hardware(model.to_owned()));
        }
        Ok(Self { model: model.to_owned(), placing })
    }
}

impl fmt::Display for MimicSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}@{}", self.model, self.placing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_may_contain_at_signs_and_colons() {
        let spec: MimicSpec = r"C:\defs@home\my.toml@0x21:dcon:19200".parse().unwrap();
        assert_eq!((spec.model.as_str(), spec.placing.address), (r"C:\defs@home\my.toml", 0x21));
        assert_eq!(spec.to_string().parse::<MimicSpec>(), Ok(spec));
    }

    #[test]
    fn a_refusal_says_what_is_allowed() {
        for (text, hint) in [
            ("dl-302", "MODEL@ADDRESS"),
            ("@5", "MODEL@ADDRESS"),
            ("dl-302@300", "0 to 255"),
            ("dl-302@0", "1 to 247"),
            ("dl-302@165:hardware", "DIP"),
        ] {
            let error = text.parse::<MimicSpec>().unwrap_err().to_string();
            assert!(error.contains(hint), "{text}: {error}");
        }
        let unknown: MimicSpec = "dl-999@5".parse().unwrap();
        let error = unknown.definition(&Catalogue::built_in().0, &["unknown"]).unwrap_err().to_string();
        assert!(error.contains("unknown, dl-302, pir-130") && error.contains("my.toml"), "{error}");
        let absent: MimicSpec = "/no/such.toml@5".parse().unwrap();
        assert!(absent.definition(&Catalogue::built_in().0, &[]).unwrap_err().to_string().contains("/no/such.toml"));
    }

    proptest::proptest! {
        #[test]
        fn no_text_makes_the_parser_panic(text: String) {
            let _ = text.parse::<MimicSpec>();
        }
    }
}
