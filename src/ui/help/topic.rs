//! Which article fits what is in front.

use crate::bench::Module;
use crate::help::commands_of;
use crate::ui::app::Pass;
use crate::ui::module_view;
use crate::ui::panes::Pane;

/// The id of the article for the pane that the user works in; none while that is the help itself.
pub fn topic(pass: &Pass<'_>) -> Option<String> {
    let topic = match pass.active {
        Pane::Help => return None,
        Pane::Dashboard if pass.bench.modules().is_empty() => "quick-start",
        Pane::Dashboard => "window",
        Pane::Traffic => "traffic",
        Pane::Trends | Pane::Recording(_) => "trends",
        Pane::Diagnosis => "troubleshooting",
        Pane::Module(target) => {
            return Some(pass.bench.module(&target).map_or("quick-start".into(), |module| of_module(module, pass)));
        }
    };
    Some(topic.to_owned())
}

fn of_module(module: &Module, pass: &Pass<'_>) -> String {
    let Some(definition) = module.definition() else { return "adding-modules".to_owned() };
    let topic = match module_view::page_in_view(module, pass.settings).as_deref() {
        Some("ai") => "readings",
        Some("pir") => "relays",
        Some("wdt") => "watchdog",
        Some("commands") => "commands",
        Some("log" | "summary") => "log-and-summary",
        Some("configuration" | "network" | "wifi") | None => "settings",
        // A page that only its definition knows: what the model has.
        Some(_) => return commands_of(definition),
    };
    topic.to_owned()
}
