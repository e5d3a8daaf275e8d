//! Names of the tabs that definitions sort their items into.

/// Id and label of each, in the order in which an engineer expects them; others follow in the order of the definition.
const KNOWN_TABS: [(&str, &str); 6] = [
    ("configuration", "Configuration"),
    ("ai", "AI"),
    ("pir", "PIR / Relay"),
    ("wdt", "Host WDT"),
    ("network", "Network"),
    ("wifi", "Wi-Fi"),
];

/// What stands on a tab; one that only its definition knows has the name that it has there.
pub fn tab_label(id: &str) -> &str {
    KNOWN_TABS.iter().find(|(known, _)| *known == id).map_or(id, |(_, label)| label)
}

/// Where a tab stands among the others.
pub fn tab_place(id: &str) -> usize {
    KNOWN_TABS.iter().position(|(known, _)| *known == id).unwrap_or(KNOWN_TABS.len())
}
