//! The tabs inside a module: those that its definition fills, and those that every module has.

use eframe::egui::{Button, Role, Ui, WidgetInfo, vec2};

use crate::bench::{Module, tab_label, tab_place};
use crate::module::Item;
use crate::ui::settings::Settings;
use crate::ui::theme;

/// A tab of a module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Tab {
    /// What the definition's items and actions name as their tab.
    Of(String),
    Commands,
    Log,
    Summary,
}

impl Tab {
    /// What stands on it; a tab that only its definition knows has the name that it has there.
    pub fn label(&self) -> &str {
        match self {
            Self::Of(id) => tab_label(id),
            Self::Commands => "Commands",
            Self::Log => "Log",
            Self::Summary => "Summary",
        }
    }

    /// Under which the last one is remembered.
    pub fn key(&self) -> &str {
        match self {
            Self::Of(id) => id,
            Self::Commands => "commands",
            Self::Log => "log",
            Self::Summary => "summary",
        }
    }
}

/// The items of a tab that the module has.
pub fn items<'a>(module: &'a Module, tab: &str) -> Vec<&'a Item> {
    let all = module.definition().into_iter().flat_map(|definition| &definition.items);
    all.filter(|item| item.tab == tab && module.has(item)).collect()
}

/// The actions of a tab that the module has.
pub fn actions<'a>(module: &'a Module, tab: &str) -> Vec<&'a crate::module::Action> {
    let there = |part: &String| module.parts.as_ref().is_some_and(|parts| parts.contains(part));
    let all = module.definition().into_iter().flat_map(|definition| &definition.actions);
    all.filter(|action| action.tab == tab && action.is_offered(module.target.protocol))
        .filter(|action| action.optional.as_ref().is_none_or(there))
        .collect()
}

/// The tabs that have something to show.
pub fn of(module: &Module) -> Vec<Tab> {
    let Some(definition) = module.definition() else { return Vec::new() };
    let named =
        definition.items.iter().map(|item| &item.tab).chain(definition.actions.iter().map(|action| &action.tab));
    let mut ids: Vec<&String> = Vec::new();
    for id in named {
        if !ids.contains(&id) {
            ids.push(id);
        }
    }
    ids.sort_by_key(|id| tab_place(id));
    let filled = |id: &&String| !items(module, id).is_empty() || !actions(module, id).is_empty();
    let own = ids.into_iter().filter(filled).map(|id| Tab::Of(id.clone()));
    own.chain([Tab::Commands, Tab::Log, Tab::Summary]).collect()
}

/// Items of other tabs that a tab shows too.
fn guests(tab: &str) -> &'static [&'static str] {
    match tab {
        "pir" => &["do0_safe", "do1_safe", "wdt_tripped"],
        _ => &[],
    }
}

/// Ids that a tab asks for when it comes into view: what it shows, except what is polled anyway and what changes by
/// being read.
pub fn to_read(module: &Module, tab: &Tab) -> Vec<String> {
    let readable = |item: &&Item| !(item.on_request || item.live && module.interval.is_some());
    match tab {
        Tab::Of(id) => {
            let guests = guests(id).iter().filter_map(|id| module.item(id)).filter(|item| module.has(item));
            let shown = items(module, id).into_iter().chain(guests);
            shown.filter(readable).map(|item| item.id.clone()).collect()
        }
        Tab::Summary => {
            let all = module.definition().into_iter().flat_map(|definition| &definition.items);
            all.filter(|item| module.has(item)).filter(readable).map(|item| item.id.clone()).collect()
        }
        Tab::Commands | Tab::Log => Vec::new(),
    }
}

/// The tab that was chosen last, if the module has it; else its readings.
pub fn chosen<'a>(tabs: &'a [Tab], settings: &Settings) -> Option<&'a Tab> {
    let by_key = |key: &str| tabs.iter().find(|tab| tab.key() == key);
    by_key(&settings.tab).or_else(|| by_key("ai")).or(tabs.first())
}

/// Draws the row of tabs; the one that is chosen.
pub fn show(ui: &mut Ui, module: &Module, settings: &mut Settings) -> Tab {
    let tabs = of(module);
    let mut chosen = chosen(&tabs, settings).cloned().unwrap_or(Tab::Summary);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = theme::HAIRLINE;
        for tab in &tabs {
            let on = *tab == chosen;
            let edited = edits_in(module, tab);
            let text = if edited == 0 { tab.label().to_owned() } else { format!("{} ({edited})", tab.label()) };
            let button = Button::selectable(on, text).min_size(vec2(0.0, theme::CONTROL_HEIGHT));
            let response = ui.add(button);
            response.widget_info(|| WidgetInfo::selected(Role::Tab, true, on, tab.label()));
            let response = match edited {
                0 => response,
                1 => response.on_hover_text("1 change is not written"),
                many => response.on_hover_text(format!("{many} changes are not written")),
            };
            if response.clicked() {
                tab.key().clone_into(&mut settings.tab);
                chosen = tab.clone();
            }
        }
    });
    chosen
}

fn edits_in(module: &Module, tab: &Tab) -> usize {
    let Tab::Of(id) = tab else { return 0 };
    module.edits.keys().filter(|edited| module.item(edited).is_some_and(|item| item.tab == *id)).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::Target;
    use crate::module::{Catalogue, Identified};
    use crate::protocol::{LineSettings, Protocol};

    fn labels(model: &str, protocol: Protocol) -> Vec<String> {
        let target = Target { address: 1, protocol, settings: LineSettings::default(), checksum: false };
        let definition = Catalogue::built_in().0.get(model);
        let identified = Identified { definition, name: String::new(), firmware: String::new(), said: String::new() };
        let module = Module::new(crate::bus::RequestId(0), target, identified, jiff::Timestamp::UNIX_EPOCH);
        of(&module).iter().map(|tab| tab.label().to_owned()).collect()
    }

    #[test]
    fn a_tab_without_content_is_not_shown() {
        let common = ["Commands", "Log", "Summary"];
        let serial = ["Configuration", "AI", "PIR / Relay", "Host WDT"];
        assert_eq!(labels("pir-234", Protocol::Dcon), [&serial[..], &common].concat());
        assert_eq!(labels("pir-130", Protocol::Dcon), [&serial[..3], &common].concat());
        let tcp = labels("pir-234", Protocol::ModbusTcp);
        assert!(tcp.contains(&"Network".to_owned()) && !tcp.contains(&"Wi-Fi".to_owned()), "{tcp:?}");
    }
}
