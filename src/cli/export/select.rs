//! Which series of a recording are meant: `temperature_c`, `PIR-234@1/temperature_c`, `1/*`.

use std::collections::BTreeMap;

use super::super::names::Refusal;
use crate::protocol::parse_address;
use crate::record::{History, ModuleId, SeriesId, SeriesInfo, module_names};

/// The series that any of `selectors` names, each once, in their order; all if there is none.
///
/// # Errors
/// If a selector names nothing.
pub fn series(history: &History, selectors: &[String]) -> Result<Vec<SeriesId>, Refusal> {
    let names = module_names(history);
    if selectors.is_empty() {
        return Ok(history.series().map(|(id, _)| id).collect());
    }
    let mut all = Vec::new();
    for selector in selectors.iter().map(|selector| selector.trim()) {
        let named = history.series().filter(|(_, series)| is_named(history, &names, selector, &series.info));
        let named: Vec<SeriesId> = named.map(|(id, _)| id).collect();
        if named.is_empty() && history.series().len() == 0 {
            return Err(Refusal::Refused("the recording has no samples yet".to_owned()));
        }
        if named.is_empty() {
            return Err(unknown(history, &names, selector));
        }
        all.extend(named.into_iter().filter(|id| !all.contains(id)).collect::<Vec<_>>());
    }
    Ok(all)
}

fn is_named(history: &History, names: &BTreeMap<ModuleId, String>, selector: &str, series: &SeriesInfo) -> bool {
    // The last slash: a module's name may have the path of its line.
    let (module, item) = selector.rsplit_once('/').unwrap_or(("*", selector));
    let Some(info) = history.module_info(series.module) else { return false };
    let by_name = names.get(&series.module).is_some_and(|name| fits(module, name)) || fits(module, &info.to_string());
    (by_name || parse_address(module) == Ok(info.address)) && fits(item, &series.item)
}

fn unknown(history: &History, names: &BTreeMap<ModuleId, String>, selector: &str) -> Refusal {
    let mut known: Vec<String> = Vec::new();
    for (_, series) in history.series() {
        let item = &series.info.item;
        let name = match names.get(&series.info.module).filter(|_| selector.contains('/')) {
            Some(module) => format!("{module}/{item}"),
            None => item.clone(),
        };
        if !known.contains(&name) {
            known.push(name);
        }
    }
    Refusal::Unknown { what: "series", name: selector.to_owned(), known }
}

/// Whether `pattern`, in which `*` stands for any characters, is `text`.
fn fits(pattern: &str, text: &str) -> bool {
    let (pattern, text) = (pattern.to_lowercase(), text.to_lowercase());
    let mut parts = pattern.split('*');
    let Some(mut rest) = text.strip_prefix(parts.next().unwrap_or_default()) else { return false };
    let mut parts: Vec<&str> = parts.collect();
    let Some(last) = parts.pop() else { return rest.is_empty() };
    for part in parts {
        let Some((_, after)) = rest.split_once(part) else { return false };
        rest = after;
    }
    rest.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::stop::Stop;
    use crate::record::{ModuleInfo, SeriesKind};

    fn history() -> History {
        let mut history = History::default();
        for (address, label, protocol) in
            [(1, "PIR-234", "dcon"), (1, "PIR-234", "modbus_rtu"), (160, "PIR-130", "dcon")]
        {
            let (label, protocol) = (label.to_owned(), protocol.to_owned());
            let module = history.module(ModuleInfo { address, label, protocol, ..ModuleInfo::default() });
            for item in ["temperature_c", "pir"] {
                let (item, label, unit) = (item.to_owned(), item.to_owned(), String::new());
                history.series_for(SeriesInfo { module, item, label, unit, kind: SeriesKind::Switch });
            }
        }
        history
    }

    fn named(selectors: &[&str]) -> Vec<u32> {
        let selectors: Vec<String> = selectors.iter().map(|text| (*text).to_owned()).collect();
        series(&history(), &selectors).unwrap().into_iter().map(|id| id.0).collect()
    }

    #[test]
    fn series_are_named_by_item_module_address_and_wildcards() {
        assert_eq!(named(&[]), [0, 1, 2, 3, 4, 5]);
        assert_eq!(named(&["*"]), [0, 1, 2, 3, 4, 5]);
        assert_eq!(named(&["pir"]), [1, 3, 5]);
        assert_eq!(named(&["PIR-234@1/temp*"]), [0, 2]);
        assert_eq!(named(&["pir-234@1:dcon/*", "1/pir"]), [0, 1, 3]);
        assert_eq!(named(&["0xA0/pir", "160/*"]), [5, 4]);
        assert_eq!(named(&["*@160/*"]), [4, 5]);
    }

    #[test]
    fn an_unknown_name_is_refused_with_those_there_are() {
        let refused = |selector: &str| match series(&history(), &[selector.to_owned()]).map_err(Stop::from) {
            Err(Stop::Usage(reason)) => reason,
            other => panic!("{other:?}"),
        };
        assert!(refused("temprature_c").contains("did you mean temperature_c?\nThere are: temperature_c, pir"));
        assert!(refused("2/pir").contains("PIR-234@1:dcon/temperature_c, PIR-234@1:dcon/pir"));
    }

    #[test]
    fn an_empty_recording_is_told_as_such() {
        let refused = series(&History::default(), &["pir".to_owned()]);
        assert_eq!(refused, Err(Refusal::Refused("the recording has no samples yet".into())));
    }

    #[test]
    fn a_star_stands_for_any_characters() {
        for (pattern, text) in [("*", ""), ("a*", "a"), ("*b", "ab"), ("a*b*c", "aXbYbZc"), ("a", "A")] {
            assert!(fits(pattern, text), "{pattern} {text}");
        }
        for (pattern, text) in [("a", "ab"), ("a*b", "a"), ("a*a", "a"), ("*b*b", "ab"), ("", "a")] {
            assert!(!fits(pattern, text), "{pattern} {text}");
        }
    }

    proptest::proptest! {
        #[test]
        fn no_text_makes_the_choice_panic(text: String) {
            let _ = series(&history(), &[text]);
        }
    }
}
