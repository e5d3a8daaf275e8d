//! The summary as one page of HTML that needs nothing else: style and pictures are inside.
//!
//! It is light on paper and by default, and dark where the reader's screen is. The pictures are drawn in light colours,
//! each of them different, so that the style can tell them apart and exchange them for the dark ones.

use std::fmt::Write as _;

use jiff::tz::TimeZone;

use super::text::remark;
use super::{Entry, Group, Summary, address, words};
use crate::picture::{Ink, Picture, escaped, svg};

const STYLE: &str = "
:root { color-scheme: light dark; --ground: #fff; --text: #161b20; --quiet: #525d68; --line: #d8dde3; --accent: #0a5fbf; \
--wash: #eef5fd; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--text); \
font: 14px/1.45 \"Segoe UI\", Ubuntu, \"Helvetica Neue\", Arial, sans-serif; }
main { max-width: 60rem; margin: 0 auto; padding: 2rem 1.5rem; }
h1 { font-size: 1.6rem; font-weight: 600; margin: 0 0 1rem; }
h1 span { color: var(--quiet); font-weight: 400; }
h2 { font-size: 1.05rem; font-weight: 600; margin: 1.75rem 0 .35rem; break-after: avoid; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1.25rem; margin: 0; }
dt, .quiet, figcaption, footer { color: var(--quiet); }
dd { margin: 0; }
.pictures { display: flex; flex-wrap: wrap; gap: 1.5rem 2.5rem; margin: 1.75rem 0 0; break-inside: avoid; }
figure { margin: 0; }
figure svg { display: block; max-width: 100%; height: auto; }
figcaption { max-width: 28rem; font-size: .85rem; margin-top: .4rem; }
figcaption p { margin: 0 0 .25rem; }
table { width: 100%; border-collapse: collapse; font-variant-numeric: tabular-nums; table-layout: fixed; }
thead { display: table-header-group; }
th { font-weight: 400; font-size: .85rem; color: var(--quiet); text-align: left; }
th, td { padding: .2rem .6rem; border-bottom: 1px solid var(--line); vertical-align: baseline; overflow-wrap: anywhere; }
tr { break-inside: avoid; }
col.setting { width: 27%; } col.value { width: 17%; } col.unit { width: 8%; } col.factory { width: 14%; } \
col.read { width: 11%; }
.number { text-align: right; }
.unit { padding-left: 0; }
.differs td { background: var(--wash); }
.differs td:first-child { box-shadow: inset 3px 0 var(--accent); }
.differs .remark { color: var(--accent); }
footer { margin-top: 2rem; font-size: .85rem; }
@page { margin: 15mm; }
@media print { body { font-size: 10pt; } main { max-width: none; padding: 0; } \
* { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
";

/// What the style is on a dark screen, before the colours of the pictures.
const DARK: &str = ":root { --ground: #121519; --text: #e6eaee; --quiet: #9da8b3; --line: #2c323a; --accent: #6cb4ff; \
                    --wash: #182636; }";

/// The colours of a picture in light and in dark; the light ones are all different.
fn inks(ink: Ink) -> ([u8; 3], [u8; 3]) {
    match ink {
        Ink::Ground => ([0xFF, 0xFF, 0xFF], [0x12, 0x15, 0x19]),
        Ink::Body => ([0xB4, 0x33, 0x2A], [0x9A, 0x2C, 0x26]),
        Ink::Housing => ([0xDF, 0xE4, 0xE9], [0x36, 0x3D, 0x46]),
        Ink::Edge => ([0x7C, 0x87, 0x92], [0x72, 0x7C, 0x87]),
        Ink::Slot => ([0x2A, 0x2E, 0x34], [0x14, 0x16, 0x18]),
        Ink::Slider => ([0xFA, 0xFA, 0xF7], [0xF1, 0xEF, 0xE9]),
        Ink::SliderDim => ([0x8C, 0x96, 0xA0], [0x95, 0x9E, 0xA8]),
        Ink::Print => ([0xFF, 0xFF, 0xFE], [0xFA, 0xF4, 0xEE]),
        Ink::PrintDim => ([0xF4, 0xD3, 0xCF], [0xE4, 0xB6, 0xB0]),
        Ink::Text => ([0x16, 0x1B, 0x20], [0xE6, 0xEA, 0xEE]),
        Ink::Quiet => ([0x52, 0x5D, 0x68], [0x9D, 0xA8, 0xB3]),
        Ink::Unknown => ([0xC3, 0xCA, 0xD1], [0xA9, 0xB2, 0xBB]),
        Ink::Lens => ([0xF8, 0xFA, 0xFB], [0x22, 0x27, 0x2D]),
        Ink::Facet => ([0xD3, 0xD9, 0xDF], [0x3A, 0x42, 0x4B]),
        Ink::Motion => ([0xC0, 0x88, 0x00], [0xEE, 0xE1, 0x6A]),
        Ink::OnMotion => ([0x17, 0x12, 0x00], [0x1C, 0x19, 0x05]),
        // Of plots, which no summary has.
        Ink::Grid | Ink::Limit | Ink::Curve(_) => inks(Ink::Text),
    }
}

pub fn html(summary: &Summary, zone: &TimeZone) -> String {
    let address = address(summary.target.address);
    let mut out = String::from("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    out.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    let label = escaped(&summary.label);
    let _ = writeln!(out, "<title>{label} at address {address}</title>");
    let _ = writeln!(out, "<style>{STYLE}{}</style>\n</head>\n<body>\n<main>", dark_style());
    let _ = writeln!(out, "<h1>{label} <span>at address {address}</span></h1>\n<dl>");
    for (name, fact) in summary.facts(zone) {
        let _ = writeln!(out, "<dt>{name}</dt><dd>{}</dd>", escaped(&fact));
    }
    out.push_str("</dl>\n");
    pictures(&mut out, summary);
    for group in &summary.groups {
        table(&mut out, group, summary, zone);
    }
    let made = format!("dcon-bench {}, {}", env!("CARGO_PKG_VERSION"), words::moment(summary.at, zone));
    let _ = writeln!(out, "<footer>{}</footer>\n</main>\n</body>\n</html>", escaped(&made));
    out
}

fn dark_style() -> String {
    let mut out = format!("@media screen and (prefers-color-scheme: dark) {{\n{DARK}\n");
    for (light, dark) in Ink::ALL.map(inks) {
        let (light, dark) = (hex(light), hex(dark));
        let _ =
            writeln!(out, "svg [fill=\"{light}\"] {{ fill: {dark}; }} svg [stroke=\"{light}\"] {{ stroke: {dark}; }}");
    }
    out + "}\n"
}

/// As [`svg`] writes it.
fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

fn pictures(out: &mut String, summary: &Summary) {
    let (switches, face) = (summary.switch_picture(), summary.face_picture());
    if switches.is_none() && face.is_none() {
        return;
    }
    out.push_str("<div class=\"pictures\">\n");
    if let Some(picture) = switches {
        let caption = "Switches as seen from behind, as far as the settings tell".to_owned();
        figure(out, &picture, std::iter::once(&caption).chain(&summary.switches.notes));
    }
    if let Some(picture) = face {
        figure(out, &picture, std::iter::once(&"Sensor as seen from below".to_owned()));
    }
    out.push_str("</div>\n");
}

fn figure<'a>(out: &mut String, picture: &Picture, lines: impl Iterator<Item = &'a String>) {
    // HTML knows the namespace of SVG by itself.
    let image = svg(picture, &|ink| inks(ink).0).replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    let _ = writeln!(out, "<figure>\n{image}<figcaption>");
    for line in lines {
        let _ = writeln!(out, "<p>{}</p>", escaped(line));
    }
    out.push_str("</figcaption>\n</figure>\n");
}

fn table(out: &mut String, group: &Group, summary: &Summary, zone: &TimeZone) {
    let _ = writeln!(out, "<section>\n<h2>{}</h2>\n<table>", escaped(&group.label));
    out.push_str("<colgroup><col class=\"setting\"><col class=\"value\"><col class=\"unit\"><col class=\"factory\">");
    out.push_str("<col class=\"read\"><col></colgroup>\n<thead><tr><th>Name</th><th class=\"number\">Value</th>");
    out.push_str("<th class=\"unit\">Unit</th><th>Factory</th><th>Read</th><th>Remark</th></tr></thead>\n<tbody>\n");
    group.entries.iter().for_each(|entry| row(out, entry, summary, zone));
    out.push_str("</tbody>\n</table>\n</section>\n");
}

fn row(out: &mut String, entry: &Entry, summary: &Summary, zone: &TimeZone) {
    let class = if entry.differs { " class=\"differs\"" } else { "" };
    let read = entry.at.map(|at| words::clock(at, summary.at, zone)).unwrap_or_default();
    let cells = [
        ("", entry.label.as_str()),
        (" class=\"number\"", entry.text.as_str()),
        (" class=\"unit quiet\"", if entry.value.is_some() { entry.unit.as_str() } else { "" }),
        (" class=\"quiet\"", entry.factory_text.as_str()),
        (" class=\"quiet\"", read.as_str()),
        (" class=\"remark\"", &remark(entry)),
    ];
    let _ = write!(out, "<tr{class}>");
    for (class, text) in cells {
        let _ = write!(out, "<td{class}>{}</td>", escaped(text));
    }
    out.push_str("</tr>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_colours_are_all_different_so_that_each_has_its_dark_one() {
        let mut light: Vec<_> = Ink::ALL.map(|ink| inks(ink).0).to_vec();
        light.sort_unstable();
        light.dedup();
        assert_eq!(light.len(), Ink::ALL.len());
    }
}
