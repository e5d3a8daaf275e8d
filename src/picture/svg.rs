//! A picture as SVG.

use std::fmt::Write as _;

use super::{Anchor, Area, Ink, Picture, Shape, Stroke};

/// Letters sit this part of their size below the middle of the text.
const BASELINE: f32 = 0.36;

/// One self-contained SVG image; hot spots are its tooltips. It has the ground of `colours` too.
pub fn svg(picture: &Picture, colours: &dyn Fn(Ink) -> [u8; 3]) -> String {
    let [width, height] = picture.size.map(number);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"Ubuntu, DejaVu Sans, sans-serif\" \
         stroke=\"none\">\n"
    );
    let ground = Shape::Rect {
        area: Area { min: [0.0, 0.0], max: picture.size },
        rounding: 0.0,
        fill: Some(Ink::Ground),
        outline: None,
    };
    for shape in std::iter::once(&ground).chain(&picture.shapes) {
        out.push_str(&element(shape, colours));
        out.push('\n');
    }
    for spot in &picture.hot {
        let title = escaped(&format!("{}\n{}", spot.title, spot.text));
        let place = place(&spot.area);
        let _ = writeln!(
            out,
            "<rect {place} fill=\"none\" stroke=\"none\" pointer-events=\"all\"><title>{title}</title></rect>"
        );
    }
    out.push_str("</svg>\n");
    out
}

fn element(shape: &Shape, colours: &dyn Fn(Ink) -> [u8; 3]) -> String {
    let filled = |fill: Option<Ink>| fill.map_or_else(|| "none".to_owned(), |ink| colour(ink, colours));
    let stroked = |stroke: &Stroke| {
        format!("stroke=\"{}\" stroke-width=\"{}\"", colour(stroke.ink, colours), number(stroke.width))
    };
    let outlined = |outline: &Option<Stroke>| outline.as_ref().map_or_else(|| "stroke=\"none\"".to_owned(), stroked);
    match shape {
        Shape::Rect { area, rounding, fill, outline } => format!(
            "<rect {} rx=\"{}\" fill=\"{}\" {}/>",
            place(area),
            number(*rounding),
            filled(*fill),
            outlined(outline)
        ),
        Shape::Circle { centre: [x, y], radius, fill, outline } => format!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" {}/>",
            number(*x),
            number(*y),
            number(*radius),
            filled(*fill),
            outlined(outline)
        ),
        Shape::Polygon { points, fill } => {
            format!("<polygon points=\"{}\" fill=\"{}\"/>", list(points), colour(*fill, colours))
        }
        Shape::Line { points, stroke } => format!(
            "<polyline points=\"{}\" fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" {}/>",
            list(points),
            stroked(stroke)
        ),
        Shape::Text { at: [x, y], anchor, size, strong, ink, text } => format!(
            "<text x=\"{}\" y=\"{}\" text-anchor=\"{}\" font-size=\"{}\"{} fill=\"{}\">{}</text>",
            number(*x),
            number(y + size * BASELINE),
            match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            },
            number(*size),
            if *strong { " font-weight=\"bold\"" } else { "" },
            colour(*ink, colours),
            escaped(text)
        ),
    }
}

fn place(area: &Area) -> String {
    let ([x, y], [width, height]) = (area.min.map(number), area.size().map(number));
    format!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

fn list(points: &[[f32; 2]]) -> String {
    let texts: Vec<_> = points.iter().map(|[x, y]| format!("{},{}", number(*x), number(*y))).collect();
    texts.join(" ")
}

/// At most two decimals.
fn number(value: f32) -> String {
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    (if short == "-0" { "0" } else { short }).to_owned()
}

fn colour(ink: Ink, colours: &dyn Fn(Ink) -> [u8; 3]) -> String {
    let [red, green, blue] = colours(ink);
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// Text as XML takes it; control characters, which it does not take, are left out.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars().filter(|character| *character == '\n' || !character.is_control()) {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\u{FFFE}' | '\u{FFFF}' => {}
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::{Zone, ZoneState, sensor_face};
    use super::*;
    use proptest::prelude::*;

    fn grey(_: Ink) -> [u8; 3] {
        [0x12, 0xAB, 0x00]
    }

    /// Names of the elements that are open at the end; panics where a tag closes another than the last opened.
    fn open_elements(svg: &str) -> Vec<&str> {
        let mut open = Vec::new();
        for tag in svg.split('<').skip(1) {
            let (tag, _) = tag.split_once('>').expect("every < has its >");
            assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
            match tag.strip_prefix('/') {
                Some(name) => assert_eq!(open.pop(), Some(name)),
                None if tag.ends_with('/') => {}
                None => open.push(tag.split(' ').next().expect("a name")),
            }
        }
        open
    }

    #[test]
    fn every_element_is_closed_and_every_hot_spot_has_its_title() {
        let zones = [ZoneState::Motion, ZoneState::Disabled]
            .map(|state| Zone { label: format!("{} & <co>", state.word()), state });
        let svg = svg(&sensor_face(&zones, "a > b"), &grey);
        assert_eq!(open_elements(&svg), Vec::<&str>::new());
        assert_eq!(svg.matches("<title>").count(), 2);
        assert!(svg.contains("<title>motion &amp; &lt;co&gt;\nDetects motion.</title>"), "{svg}");
        assert!(svg.contains(">a &gt; b</text>"));
        assert!(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 220 220\""));
    }

    #[test]
    fn colours_are_those_that_the_caller_gives() {
        let svg = svg(&sensor_face(&[], ""), &grey);
        assert!(svg.contains("fill=\"#12AB00\""));
        assert!(svg.split('#').skip(1).all(|rest| rest.starts_with("12AB00")));
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.0, -0.001, 12.0, 1.5, 1.006, 100.0].map(number), ["0", "0", "12", "1.5", "1.01", "100"]);
    }

    proptest! {
        #[test]
        fn no_label_breaks_the_image(label: String, note: String) {
            let svg = svg(&sensor_face(&[Zone { label, state: ZoneState::Quiet }], &note), &grey);
            prop_assert_eq!(open_elements(&svg), Vec::<&str>::new());
            prop_assert!(svg.chars().all(|c| c == '\n' || !c.is_control()));
        }
    }
}
