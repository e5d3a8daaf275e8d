//! Paints a picture of a module: its shapes in the colours of the theme, and the places that explain themselves.

use eframe::egui::{self, Align2, Color32, FontId, Painter, Pos2, Rect, Response, Role, Sense, Ui, Vec2, vec2};

use super::theme::{self, Palette};
use super::widgets;
use crate::picture::{Anchor, Area, HotSpot, Ink, Picture, Shape, Stroke};

/// How a picture is shown.
pub struct Look<'a> {
    /// Width in points; the height follows from the picture.
    pub width: f32,
    /// What it shows, for those who cannot see it.
    pub name: &'a str,
    /// What it shows is no longer fresh.
    pub faded: bool,
    /// What a click on each hot spot does; one without a text only explains itself.
    pub clicks: &'a [Option<String>],
}

/// Draws the picture; the hot spots in their order.
pub fn show(ui: &mut Ui, picture: &Picture, look: &Look<'_>) -> Vec<Response> {
    let [width, height] = picture.size;
    let scale = if width > 0.0 { look.width / width } else { 1.0 };
    let (rect, response) = ui.allocate_exact_size(vec2(width, height) * scale, Sense::hover());
    let mut painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    if look.faded {
        painter.multiply_opacity(theme::FADED);
    }
    let paint = Paint { painter, origin: rect.min, scale, palette: theme::palette(ui) };
    picture.shapes.iter().for_each(|shape| paint.shape(shape));
    widgets::describe(&response, Role::Image, look.name);
    let spots = picture.hot.iter().enumerate().map(|(index, spot)| {
        let click = look.clicks.get(index).and_then(Option::as_deref);
        hot_spot(ui, paint.area(&spot.area), index, spot, click)
    });
    spots.collect()
}

/// A place that tells what it shows on hover, and can be clicked or reached with Tab where a click does something.
fn hot_spot(ui: &Ui, rect: Rect, index: usize, spot: &HotSpot, click: Option<&str>) -> Response {
    let sense = if click.is_some() { Sense::click() } else { Sense::hover() };
    let response = ui.interact(rect, ui.scope_id().with(("hot spot", index)), sense);
    let role = if click.is_some() { Role::Button } else { Role::Image };
    widgets::describe(&response, role, &format!("{}: {}", spot.title, spot.text.replace('\n', " ")));
    if click.is_some() && (response.hovered() || response.has_focus()) {
        let stroke = egui::Stroke::new(theme::OUTLINE, theme::palette(ui).accent);
        ui.painter().rect_stroke(rect, theme::GAP, stroke, egui::StrokeKind::Inside);
    }
    let click = click.map(|click| format!("\n{click}")).unwrap_or_default();
    response.on_hover_text(format!("{}\n{}{click}", spot.title, spot.text))
}

struct Paint<'a> {
    painter: Painter,
    origin: Pos2,
    scale: f32,
    palette: &'a Palette,
}

impl Paint<'_> {
    fn at(&self, [x, y]: [f32; 2]) -> Pos2 {
        self.origin + vec2(x, y) * self.scale
    }

    fn area(&self, area: &Area) -> Rect {
        Rect::from_min_max(self.at(area.min), self.at(area.max))
    }

    fn ink(&self, ink: Ink) -> Color32 {
        theme::ink(self.palette, ink)
    }

    fn fill(&self, fill: Option<Ink>) -> Color32 {
        fill.map_or(theme::NO_COLOUR, |ink| self.ink(ink))
    }

    fn stroke(&self, stroke: &Stroke) -> egui::Stroke {
        egui::Stroke::new(stroke.width * self.scale, self.ink(stroke.ink))
    }

    fn outline(&self, outline: Option<&Stroke>) -> egui::Stroke {
        outline.map_or(egui::Stroke::NONE, |stroke| self.stroke(stroke))
    }

    fn points(&self, points: &[[f32; 2]]) -> Vec<Pos2> {
        points.iter().map(|point| self.at(*point)).collect()
    }

    fn shape(&self, shape: &Shape) {
        match shape {
            Shape::Rect { area, rounding, fill, outline } => {
                let (rect, outline) = (self.area(area), self.outline(outline.as_ref()));
                let middle = egui::StrokeKind::Middle;
                self.painter.rect(rect, rounding * self.scale, self.fill(*fill), outline, middle);
            }
            Shape::Circle { centre, radius, fill, outline } => {
                let (centre, radius) = (self.at(*centre), radius * self.scale);
                self.painter.circle(centre, radius, self.fill(*fill), self.outline(outline.as_ref()));
            }
            Shape::Polygon { points, fill } => {
                let polygon = egui::Shape::convex_polygon(self.points(points), self.ink(*fill), egui::Stroke::NONE);
                self.painter.add(polygon);
            }
            Shape::Line { points, stroke } => {
                self.painter.add(egui::Shape::line(self.points(points), self.stroke(stroke)));
            }
            Shape::Text { at, anchor, size, strong, ink, text } => {
                let anchor = match anchor {
                    Anchor::Start => Align2::LEFT_CENTER,
                    Anchor::Middle => Align2::CENTER_CENTER,
                    Anchor::End => Align2::RIGHT_CENTER,
                };
                self.text(self.at(*at), anchor, size * self.scale, *strong, self.ink(*ink), text);
            }
        }
    }

    /// The default font has one weight only: strong text is painted twice, a little apart.
    fn text(&self, at: Pos2, anchor: Align2, size: f32, strong: bool, colour: Color32, text: &str) {
        let font = FontId::proportional(size);
        let apart = if strong { vec2(size * theme::STRONG, 0.0) } else { Vec2::ZERO };
        if strong {
            self.painter.text(at + apart / 2.0, anchor, text, font.clone(), colour);
        }
        self.painter.text(at - apart / 2.0, anchor, text, font, colour);
    }
}
