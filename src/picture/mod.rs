//! Pictures as plain shapes: what a module's switches look like, what its sensor sees, how its values went.
//!
//! A picture knows neither a window nor colours: each shape names the [`Ink`] it is drawn with, and whoever draws it
//! has the colours. Lengths are units of the picture, about a screen point; x grows to the right, y downwards. Every
//! filled polygon is convex. No state is shown by its ink alone: each has a shape, a place or a word of its own.

mod sensor_face;
mod svg;
mod switches;
mod trend;

pub use sensor_face::{Zone, ZoneState, sensor_face};
pub(crate) use svg::escaped;
pub use svg::svg;
pub use switches::switch_picture;
pub use trend::{AxisPart, PlotPart, State, StripPart, TrendPicture, trend_picture};

/// Size of the smallest text in a picture.
pub const SMALLEST_TEXT: f32 = 11.0;

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Picture {
    /// Width and height; everything lies inside.
    pub size: [f32; 2],
    /// From the back to the front.
    pub shapes: Vec<Shape>,
    /// Places that explain themselves when pointed at; none overlaps another.
    pub hot: Vec<HotSpot>,
}

/// What a shape stands for; the drawer gives it a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Ink {
    /// Behind the picture; no shape has it, [`svg`] lays it beneath them.
    Ground,
    /// A DIP block's red plastic. [`Ink::Print`] and [`Ink::Slider`] are read on it.
    Body,
    /// Plastic in a cool tone: the sensor's housing and the dial's disc.
    Housing,
    /// Outlines of bodies, borders and hatching of zones.
    Edge,
    /// Recesses in which sliders run; dark.
    Slot,
    /// Sliders and pointer in force; light.
    Slider,
    /// Sliders and pointer that are not in force, on [`Ink::Slot`] and [`Ink::Housing`].
    SliderDim,
    /// Words on [`Ink::Body`].
    Print,
    /// Words on [`Ink::Body`] of a switch that is not in force.
    PrintDim,
    Text,
    /// Words that explain, marks of a scale.
    Quiet,
    /// Dashes and hollow outlines of what is not known, on [`Ink::Slot`].
    Unknown,
    /// The sensor's lens.
    Lens,
    /// Lines between the facets of the lens, on [`Ink::Lens`] and [`Ink::Motion`].
    Facet,
    /// A zone with motion; [`Ink::OnMotion`] is read on it.
    Motion,
    OnMotion,
    /// Lines of a plot's grid.
    Grid,
    /// The limit of an alarm.
    Limit,
    /// A curve of a plot, by number; only whoever draws the plot knows its colour.
    Curve(u8),
}

impl Ink {
    /// Those of a module's pictures.
    pub const ALL: [Self; 16] = [
        Self::Ground,
        Self::Body,
        Self::Housing,
        Self::Edge,
        Self::Slot,
        Self::Slider,
        Self::SliderDim,
        Self::Print,
        Self::PrintDim,
        Self::Text,
        Self::Quiet,
        Self::Unknown,
        Self::Lens,
        Self::Facet,
        Self::Motion,
        Self::OnMotion,
    ];
}

#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    Rect {
        area: Area,
        /// Radius of the corners.
        rounding: f32,
        fill: Option<Ink>,
        outline: Option<Stroke>,
    },
    Circle {
        centre: [f32; 2],
        radius: f32,
        fill: Option<Ink>,
        outline: Option<Stroke>,
    },
    /// Convex and closed.
    Polygon {
        points: Vec<[f32; 2]>,
        fill: Ink,
    },
    /// Open.
    Line {
        points: Vec<[f32; 2]>,
        stroke: Stroke,
    },
    Text {
        /// The middle of the text's height, and of its width as `anchor` says.
        at: [f32; 2],
        anchor: Anchor,
        /// Height of the font, not of its letters.
        size: f32,
        strong: bool,
        ink: Ink,
        text: String,
    },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    pub ink: Ink,
    pub width: f32,
}

/// Which point of a text lies at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    pub min: [f32; 2],
    pub max: [f32; 2],
}

impl Area {
    /// From its left upper corner.
    pub fn new([x, y]: [f32; 2], [width, height]: [f32; 2]) -> Self {
        Self { min: [x, y], max: [x + width, y + height] }
    }

    pub fn contains(&self, [x, y]: [f32; 2]) -> bool {
        (self.min[0]..=self.max[0]).contains(&x) && (self.min[1]..=self.max[1]).contains(&y)
    }

    pub fn size(&self) -> [f32; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }
}

/// A place that explains itself when pointed at.
#[derive(Debug, Clone, PartialEq)]
pub struct HotSpot {
    pub area: Area,
    pub title: String,
    /// Lines.
    pub text: String,
}

impl Picture {
    fn rect(&mut self, area: Area, rounding: f32, fill: Ink) {
        self.shapes.push(Shape::Rect { area, rounding, fill: Some(fill), outline: None });
    }

    fn circle(&mut self, centre: [f32; 2], radius: f32, fill: Ink) {
        self.shapes.push(Shape::Circle { centre, radius, fill: Some(fill), outline: None });
    }

    fn outline(&mut self, area: Area, ink: Ink, width: f32) {
        self.shapes.push(Shape::Rect { area, rounding: 0.0, fill: None, outline: Some(Stroke { ink, width }) });
    }

    fn ring(&mut self, centre: [f32; 2], radius: f32, ink: Ink, width: f32) {
        self.shapes.push(Shape::Circle { centre, radius, fill: None, outline: Some(Stroke { ink, width }) });
    }

    fn line(&mut self, points: Vec<[f32; 2]>, ink: Ink, width: f32) {
        self.shapes.push(Shape::Line { points, stroke: Stroke { ink, width } });
    }

    fn polygon(&mut self, points: Vec<[f32; 2]>, fill: Ink) {
        self.shapes.push(Shape::Polygon { points, fill });
    }

    fn text(&mut self, at: [f32; 2], anchor: Anchor, size: f32, ink: Ink, text: impl Into<String>) {
        self.shapes.push(Shape::Text { at, anchor, size, strong: false, ink, text: text.into() });
    }

    fn strong(&mut self, at: [f32; 2], anchor: Anchor, size: f32, ink: Ink, text: impl Into<String>) {
        self.shapes.push(Shape::Text { at, anchor, size, strong: true, ink, text: text.into() });
    }

    /// Every word in the picture, in the order in which it is drawn.
    pub fn words(&self) -> Vec<&str> {
        let texts = self.shapes.iter().filter_map(|shape| match shape {
            Shape::Text { text, .. } => Some(text.as_str()),
            _ => None,
        });
        texts.collect()
    }
}

/// The point at `turns` from the top, clockwise, of a circle.
fn on_circle([x, y]: [f32; 2], radius: f32, turns: f32) -> [f32; 2] {
    let angle = turns * std::f32::consts::TAU;
    [x + radius * angle.sin(), y - radius * angle.cos()]
}

/// Points along a circle, both ends included, close enough to look round.
fn arc(centre: [f32; 2], radius: f32, from: f32, to: f32) -> Vec<[f32; 2]> {
    let steps = ((to - from).abs() * 96.0).ceil().max(2.0);
    (0..=steps as u32).map(|step| on_circle(centre, radius, from + (to - from) * step as f32 / steps)).collect()
}
