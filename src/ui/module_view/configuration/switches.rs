//! How the module's switches stand, told from its settings.

use eframe::egui::{Align, Label, RichText, Ui};

use super::super::form;
use crate::bench::{Module, Presence};
use crate::module::{SwitchPanel, Value};
use crate::picture::switch_picture;
use crate::protocol::Protocol;
use crate::ui::picture::{self, Look};
use crate::ui::theme;

/// The switches of `module`; empty if its definition describes none.
pub fn panel(module: &Module) -> SwitchPanel {
    let Some(definition) = module.definition() else { return SwitchPanel::default() };
    let spoken = module.target.protocol;
    let serial = spoken != Protocol::ModbusTcp;
    let known = |id: &str| {
        let said = module.known(id).cloned();
        // Where the stored protocol is not known, the one in use stands for it.
        let spoken = (id == "protocol" && serial).then(|| Value::Choice(spoken.word().to_owned()));
        said.or(spoken)
    };
    definition.switches(serial.then_some(module.target.address), &known)
}

pub fn show(ui: &mut Ui, module: &Module, panel: &SwitchPanel) {
    form::heading(ui, "Switches");
    ui.add_space(theme::UNIT);
    let picture = switch_picture(panel);
    let [natural, _] = picture.size;
    let look = Look {
        width: natural.min(theme::SWITCHES_WIDTH),
        name: "DIP and rotary switches, as the settings tell",
        faded: matches!(module.presence, Presence::Silent { .. }),
        clicks: &[],
    };
    picture::show(ui, &picture, &look);
    ui.add_space(theme::UNIT);
    let palette = theme::palette(ui);
    for note in &panel.notes {
        let text = RichText::new(note).color(palette.quiet);
        ui.scope(|ui| {
            ui.set_max_width(ui.available_width().min(theme::TEXT_WIDTH));
            ui.add(Label::new(text).wrap().halign(Align::Min));
        });
    }
}
