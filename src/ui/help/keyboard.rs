//! The article on keys: the list of commands, and what belongs to one place of the window.

use std::fmt::Write;

use eframe::egui::Context;

use crate::help::markdown::escaped;
use crate::ui::commands;

const BEGIN: &str = include_str!("../../../assets/help/keyboard.md");

pub fn article(ctx: &Context) -> String {
    let mut text = BEGIN.to_owned();
    for (title, commands) in commands::GROUPS {
        let _ = writeln!(text, "\n## {title}\n\n| Keys | Command | What it does |\n|---|---|---|");
        for command in commands {
            let keys = command.shortcut().map(|shortcut| ctx.format_shortcut(&shortcut)).unwrap_or_default();
            let [keys, name, does] = [keys.as_str(), command.text(), command.explanation()].map(escaped);
            let _ = writeln!(text, "| {keys} | {name} | {does} |");
        }
    }
    text
}
