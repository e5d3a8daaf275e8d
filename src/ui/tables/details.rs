//! The part below a list: what the chosen line holds, field by field.

use eframe::egui::{Grid, RichText, ScrollArea, TextEdit, TextStyle, Ui};

use super::frames::{direction_mark, state};
use crate::bench::Bench;
use crate::bench::traffic::{FrameRef, Outcome};
use crate::bus::Direction;
use crate::protocol::{Protocol, hex};
use crate::ui::{theme, widgets, words};

/// A text in full, to be read and copied.
pub fn text(ui: &mut Ui, title: &str, text: &str) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        widgets::quiet(ui, title);
        let mut shown = text;
        let field = ui.add(TextEdit::multiline(&mut shown).desired_rows(1).desired_width(f32::INFINITY));
        widgets::name_field(&field, "Text", text);
    });
}

/// The frame `seq` and its counterpart, request first, side by side.
pub fn frame(ui: &mut Ui, bench: &Bench, seq: u64) {
    let traffic = bench.traffic();
    let Some(frame) = traffic.get(seq) else {
        widgets::quiet(ui, "This frame was forgotten: only the newest are kept.");
        return;
    };
    let answer_of = |seq: u64| {
        let next = seq.saturating_add(1);
        traffic.request_of(next).filter(|request| request.seq == seq).and_then(|_| traffic.get(next))
    };
    let (request, answer) = match frame.direction {
        Direction::Sent => (Some(frame), answer_of(seq)),
        Direction::Received => (traffic.request_of(seq), Some(frame)),
    };
    ui.columns(2, |columns| {
        let sides = [(request, None, "Request"), (answer, request, "Answer")];
        for (ui, (frame, request, title)) in columns.iter_mut().zip(sides) {
            ScrollArea::both().id_salt(title).auto_shrink(false).show(ui, |ui| match frame {
                Some(frame) => side(ui, bench, &frame, request.as_ref(), title),
                None => {
                    ui.label(RichText::new(title).strong());
                    widgets::quiet(ui, if title == "Answer" { "None seen" } else { "Not known" });
                }
            });
        }
    });
}

fn side(ui: &mut Ui, bench: &Bench, frame: &FrameRef<'_>, request: Option<&FrameRef<'_>>, title: &str) {
    let palette = theme::palette(ui);
    let explanation = bench.explain_frame(frame, request);
    ui.spacing_mut().item_spacing.y = theme::UNIT / 2.0;
    ui.horizontal(|ui| {
        ui.label(RichText::new(title).strong());
        let (mark, colour, word) = state(frame.outcome, palette);
        if let Some(mark) = mark {
            widgets::glyph(ui, mark, colour);
        }
        ui.label(RichText::new(word).color(colour));
    });
    let facts = facts(frame);
    Grid::new((title, "fields")).num_columns(3).spacing([theme::GAP, theme::UNIT / 2.0]).min_row_height(0.0).show(
        ui,
        |ui| {
            let fields =
                explanation.fields.iter().map(|field| [field.name.clone(), field.raw.clone(), field.meaning.clone()]);
            for [name, raw, meaning] in facts
                .into_iter()
                .chain([["Meaning".to_owned(), String::new(), explanation.summary.clone()]])
                .chain(fields)
            {
                ui.label(RichText::new(name).color(palette.quiet));
                ui.label(RichText::new(raw).text_style(TextStyle::Monospace).size(theme::SMALL));
                ui.label(meaning);
                ui.end_row();
            }
        },
    );
}

/// What is known of a frame beside its meaning.
fn facts(frame: &FrameRef<'_>) -> Vec<[String; 3]> {
    let mut spoken = frame.protocol.label().to_owned();
    if frame.protocol != Protocol::ModbusTcp {
        spoken = format!("{spoken} {}", frame.settings);
    }
    let (_, way) = direction_mark(frame.direction);
    let bytes = words::counted(frame.bytes.len(), "byte");
    let mut facts = vec![[
        "Frame".to_owned(),
        words::clock(frame.at),
        format!("{way}, {spoken}, {bytes}, {}", words::milliseconds(frame.took)),
    ]];
    if let Outcome::Broken(reason) = frame.outcome {
        facts.push(["Trouble".to_owned(), String::new(), reason.to_owned()]);
    }
    if !frame.bytes.is_empty() {
        let text = if frame.protocol == Protocol::Dcon { hex::escaped(frame.bytes) } else { String::new() };
        facts.push(["Bytes".to_owned(), hex::spaced(frame.bytes), text]);
    }
    facts
}
