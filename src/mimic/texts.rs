//! Texts as the bytes that stand for them: names, versions and hardware addresses.

use crate::module::definition::{Definition, Encoding};

/// The bytes of `text` in a register or a binary field; the reverse of what the definitions' readers do.
pub(super) fn bytes(definition: &Definition, encoding: Encoding, over_registers: bool, text: &str) -> Vec<u8> {
    match encoding {
        Encoding::Plain => text.as_bytes().to_vec(),
        Encoding::Counted => {
            let length = u8::try_from(text.len()).unwrap_or(u8::MAX);
            std::iter::once(length).chain(text.bytes()).collect()
        }
        Encoding::Mac => text.split('-').filter_map(|pair| u8::from_str_radix(pair, 16).ok()).collect(),
        Encoding::Version => version(text),
        Encoding::Name if over_registers => {
            let words = definition.identity.words.first();
            words.map(|words| [words.low.to_be_bytes(), words.high.to_be_bytes()].concat()).unwrap_or_default()
        }
        Encoding::Name => definition.identity.bytes.first().map(|known| known.bytes.clone()).unwrap_or_default(),
    }
}

/// `1.0` as 01 00; anything else as 00.
fn version(text: &str) -> Vec<u8> {
    text.split('.').map(|part| u8::from_str_radix(part, 16).unwrap_or(0)).collect()
}
