//! Lines that were opened before: what the system says of each now, and connecting again as last time.

use std::slice;

use eframe::egui::{Ui, vec2};

use super::{Ready, TCP, plan_of};
use crate::bench::{Action, Bench};
use crate::bus::LineAddress;
use crate::ui::app::Pass;
use crate::ui::settings::{LineChoice, Now, Place, RecentLine, Settings};
use crate::ui::tables::{Sheet, copied_row};
use crate::ui::theme;
use crate::ui::widgets::{self, Glyph};

/// What is connected as last time once it is known which ports there are: it may have been plugged in since they were looked
/// for, or another adapter may have its name.
pub enum Again {
    /// The line that was opened last of those that are there.
    Latest,
    This(RecentLine),
}

/// The rows of the list of lines; nothing while no line was opened yet.
pub fn rows(ui: &mut Ui, pass: &mut Pass<'_>, shown: &mut Vec<RecentLine>) {
    if shown.is_empty() {
        return;
    }
    widgets::section(ui, "Recent");
    let mut forgotten = None;
    for (index, recent) in shown.iter().enumerate() {
        let row = ui.horizontal(|ui| {
            name(ui, pass, recent);
            widgets::at_right(ui, |ui| {
                let forget = widgets::glyph_button(ui, Glyph::Cross, &format!("Forget {}", recent.name()), true);
                if forget.on_hover_text("Takes it out of this list").clicked() {
                    forgotten = Some(index);
                }
                connect(ui, pass, recent);
            });
        });
        let bench = pass.bench;
        copied_row(ui, row.response.rect, ui.scope_id().with(("recent", index)), |part| {
            sheet(bench, part.of(slice::from_ref(recent), shown.as_slice()))
        });
    }
    if let Some(index) = forgotten {
        let forgotten = shown.remove(index);
        pass.settings.recent_ports.retain(|recent| *recent != forgotten);
    }
}

/// Recent lines as they are copied.
fn sheet(bench: &Bench, lines: &[RecentLine]) -> Sheet {
    let mut sheet = Sheet::new(["Line", "State"]);
    for recent in lines {
        let (name, state) = told(bench, recent);
        sheet.push([name, state]);
    }
    sheet
}

/// A click chooses the line with its speed and format.
fn name(ui: &mut Ui, pass: &mut Pass<'_>, recent: &RecentLine) {
    let bench = pass.bench;
    let chosen = match recent.place() {
        Place::Tcp(host) => pass.settings.line == LineChoice::Tcp && pass.settings.host.trim() == host,
        Place::Port(_) => choice(bench, recent).is_ok_and(|choice| pass.settings.line == choice),
    };
    let possible = choice(bench, recent);
    let (name, state) = told(bench, recent);
    let button = ui.add_enabled(possible.is_ok(), eframe::egui::Button::selectable(chosen, &name));
    widgets::describe(&button, eframe::egui::Role::Button, &format!("Recent {name}"));
    let button = button.on_hover_text("Chooses this line with the speed and format of last time");
    if button.on_disabled_hover_text(possible.err().unwrap_or_default()).clicked() {
        choose(bench, pass.settings, recent);
        ui.close();
    }
    widgets::quiet(ui, &state);
}

/// The name now with what the line is opened with, and what the system says of it.
fn told(bench: &Bench, recent: &RecentLine) -> (String, String) {
    let with = recent.settings.map(|settings| format!("  {settings}")).unwrap_or_default();
    let (name, state) = match (recent.place(), recent.now(bench.ports())) {
        (Place::Tcp(host), _) => (host, TCP.to_owned()),
        (Place::Port(_), Now::There(port)) => (port.name.as_str(), port.description.clone()),
        (Place::Port(name), Now::Absent) => (name, format!("{} – not plugged in", recent.description())),
        (Place::Port(name), Now::Unlisted) => (name, "not listed".to_owned()),
    };
    (format!("{name}{with}"), state)
}

fn connect(ui: &mut Ui, pass: &mut Pass<'_>, recent: &RecentLine) {
    let action = again(pass.bench, pass.settings, recent);
    let action = action.and_then(|action| match pass.bench.is_scanning() {
        true => Err("A scan is running".to_owned()),
        false => Ok(action),
    });
    let button = eframe::egui::Button::new("Connect").min_size(vec2(0.0, theme::CONTROL_HEIGHT));
    let button = ui.add_enabled(action.is_ok(), button);
    let name = format!("Connect {}", recent.name());
    button.widget_info(|| eframe::egui::WidgetInfo::labeled(eframe::egui::Role::Button, action.is_ok(), &name));
    let button = button.on_disabled_hover_text(action.as_ref().err().cloned().unwrap_or_default());
    if button.on_hover_text("Opens it as last time and does a quick scan").clicked()
        && let Ok(action) = action
    {
        choose(pass.bench, pass.settings, recent);
        pass.actions.push(action);
        ui.close();
    }
}

/// How the line is chosen now, or why it cannot be.
fn choice(bench: &Bench, recent: &RecentLine) -> Result<LineChoice, String> {
    match (recent.place(), recent.now(bench.ports())) {
        (Place::Tcp(_), _) => Ok(LineChoice::Tcp),
        (Place::Port(_), Now::There(port)) => Ok(LineChoice::Port(port.name.clone())),
        (Place::Port(name), Now::Unlisted) => Ok(LineChoice::Port(name.to_owned())),
        (Place::Port(_), Now::Absent) => {
            Err(format!("{} is not plugged in – plug it in and open this list again", recent.description()))
        }
    }
}

/// Chooses a line as it was opened last.
fn choose(bench: &Bench, settings: &mut Settings, recent: &RecentLine) {
    let Ok(choice) = choice(bench, recent) else { return };
    if let Place::Tcp(host) = recent.place() {
        host.clone_into(&mut settings.host);
    }
    settings.line_settings = recent.settings.unwrap_or(settings.line_settings);
    settings.line = choice;
}

/// What opens a line as last time and searches it.
fn again(bench: &Bench, settings: &Settings, recent: &RecentLine) -> Result<Action, String> {
    let mut as_then = settings.clone();
    choose(bench, &mut as_then, recent);
    let line = match choice(bench, recent)? {
        LineChoice::Port(port) => LineAddress::Serial { port },
        _ => LineAddress::tcp(recent.name())?,
    };
    Ok(Action::Scan { line, settings: as_then.line_settings, plan: plan_of(Ready::Quick, &as_then) })
}

/// The line that was opened last of those that can be opened now.
pub fn latest<'a>(bench: &Bench, settings: &'a Settings) -> Option<&'a RecentLine> {
    settings.recent_ports.iter().find(|recent| choice(bench, recent).is_ok())
}

/// Why nothing can be connected as last time, if so.
pub fn obstacle(bench: &Bench, settings: &Settings) -> Option<String> {
    match settings.recent_ports.is_empty() {
        _ if bench.is_scanning() => Some("A scan is running".to_owned()),
        true => Some("No line was opened yet: choose one and scan".to_owned()),
        false => None,
    }
}

/// Looks for the ports, and wants a line connected when they are known.
pub fn ask(pass: &mut Pass<'_>, wanted: Again) {
    *pass.again = Some(wanted);
    pass.actions.push(Action::RefreshPorts);
}

/// Chooses the line that is `wanted`, as it was opened last; the action opens and searches it.
///
/// # Errors
/// Why it cannot be opened.
pub fn connect_now(wanted: Again, bench: &Bench, settings: &mut Settings) -> Result<Action, String> {
    if let Some(reason) = obstacle(bench, settings) {
        return Err(reason);
    }
    let recent = match wanted {
        Again::This(recent) => Some(recent),
        Again::Latest => latest(bench, settings).cloned(),
    };
    let recent = recent.ok_or("None of the recent lines is there – plug the adapter in and connect again")?;
    let action = again(bench, settings, &recent)?;
    choose(bench, settings, &recent);
    Ok(action)
}

/// A button for that, where there is nothing else to see yet.
pub fn offer(ui: &mut Ui, pass: &mut Pass<'_>) {
    let Some(recent) = latest(pass.bench, pass.settings).cloned() else { return };
    let (name, state) = told(pass.bench, &recent);
    let button = ui.add_enabled(!pass.bench.is_scanning(), eframe::egui::Button::new(format!("Connect {name}")));
    if button.on_hover_text(format!("{state}\nOpens it as last time and does a quick scan")).clicked() {
        ask(pass, Again::This(recent));
    }
}
