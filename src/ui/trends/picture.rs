//! The plots as a picture: the same pixels into the clipboard or a PNG file, or drawn anew as SVG.

use std::io::{self, Cursor};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use eframe::egui::{ColorImage, Rect, Ui};

use crate::bench::{Action, Bench, Severity};
use crate::ui::app::Pass;
use crate::ui::saving::{Contents, SaveAs, Step};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    Copy,
    Png,
    Svg,
}

impl Wanted {
    pub const ALL: [Self; 3] = [Self::Copy, Self::Png, Self::Svg];

    pub fn text(self) -> &'static str {
        match self {
            Self::Copy => "Copy picture",
            Self::Png => "Save picture as PNG…",
            Self::Svg => "Save picture as SVG…",
        }
    }
}

/// A picture that is asked for, until it is there.
#[derive(Default)]
pub struct Pictures {
    asked: Option<Wanted>,
    /// Frames until the menu, from which it was asked for, is no longer in the picture.
    wait: u8,
    pending: Option<(Wanted, Rect, f32, Receiver<Arc<ColorImage>>)>,
}

impl Pictures {
    pub fn ask(&mut self, wanted: Wanted) {
        (self.asked, self.wait) = (Some(wanted), 2);
    }

    /// Pixels are asked for and not there yet.
    pub fn is_under_way(&self) -> bool {
        self.asked.is_some() || self.pending.is_some()
    }

    /// Asks for pixels and takes them in. `svg` makes the drawing, `rect` is where the plots are, `name` what a file is
    /// called.
    pub fn go_on(
        &mut self,
        ui: &Ui,
        rect: Option<Rect>,
        name: &str,
        pass: &mut Pass<'_>,
        svg: impl FnOnce() -> String,
    ) {
        self.take(ui, name, pass);
        let (Some(wanted), Some(rect)) = (self.asked, rect) else { return };
        if wanted == Wanted::Svg {
            self.asked = None;
            *pass.save = Some(save_as(name, "svg", svg().into_bytes()));
        } else if self.wait > 0 {
            self.wait = self.wait.saturating_sub(1);
            ui.ctx().request_repaint();
        } else {
            self.asked = None;
            let (tell, pixels) = channel();
            let ctx = ui.ctx().clone();
            ui.ctx().request_screenshot(move |image| {
                // Nobody waits any more if the tab was closed meanwhile.
                let _ = tell.send(image);
                ctx.request_repaint();
            });
            self.pending = Some((wanted, rect, ui.ctx().pixels_per_point(), pixels));
        }
    }

    fn take(&mut self, ui: &Ui, name: &str, pass: &mut Pass<'_>) {
        let Some((wanted, rect, scale, pixels)) = self.pending.take() else { return };
        let Ok(image) = pixels.try_recv() else {
            self.pending = Some((wanted, rect, scale, pixels));
            return;
        };
        let Some(image) = cropped(&image, rect, scale) else { return };
        if wanted == Wanted::Copy {
            ui.ctx().copy_image(image);
            pass.actions.push(Action::Notify(Severity::Info, "The picture of the plots was copied".to_owned()));
            return;
        }
        match png(&image) {
            Ok(bytes) => *pass.save = Some(save_as(name, "png", bytes)),
            Err(error) => {
                let text = format!("The picture was not made ({error}) – save it as SVG instead");
                pass.actions.push(Action::Notify(Severity::Error, text));
            }
        }
    }
}

/// What lies in `rect`; nothing if that is outside.
fn cropped(image: &ColorImage, rect: Rect, scale: f32) -> Option<ColorImage> {
    let [width, height] = image.size;
    let pixel = |length: f32, most: usize| ((length * scale).round().max(0.0) as usize).min(most);
    let (left, right) = (pixel(rect.left(), width), pixel(rect.right(), width));
    let (top, bottom) = (pixel(rect.top(), height), pixel(rect.bottom(), height));
    let size = [right.saturating_sub(left), bottom.saturating_sub(top)];
    (size[0] > 0 && size[1] > 0).then(|| image.region_by_pixels([left, top], size))
}

fn png(image: &ColorImage) -> Result<Vec<u8>, image::ImageError> {
    let [width, height] = image.size.map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    let mut bytes = Vec::new();
    let pixels: Vec<u8> = image.pixels.iter().flat_map(|pixel| pixel.to_srgba_unmultiplied()).collect();
    let kind = image::ExtendedColorType::Rgba8;
    image::write_buffer_with_format(
        &mut Cursor::new(&mut bytes),
        &pixels,
        width,
        height,
        kind,
        image::ImageFormat::Png,
    )?;
    Ok(bytes)
}

fn save_as(name: &str, ending: &str, bytes: Vec<u8>) -> SaveAs {
    let contents = Box::new(WholeFile(bytes));
    SaveAs { title: "Save picture".to_owned(), name: format!("{name}.{ending}"), contents }
}

/// Bytes that are there as a whole.
struct WholeFile(Vec<u8>);

impl Contents for WholeFile {
    fn step(&mut self, _bench: &Bench) -> io::Result<Step> {
        Ok(Step { bytes: std::mem::take(&mut self.0), is_last: true })
    }

    fn part(&self) -> f32 {
        1.0
    }

    fn what(&self) -> String {
        "The picture".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Color32, pos2};

    #[test]
    fn the_file_has_the_pixels_of_the_plots() {
        let mut image = ColorImage::filled([20, 10], Color32::BLACK);
        image.pixels[5 * 20 + 10] = Color32::from_rgb(200, 100, 50);
        let rect = Rect::from_min_max(pos2(4.0, 2.0), pos2(8.0, 40.0));
        let part = cropped(&image, rect, 2.0).unwrap();
        assert_eq!(part.size, [8, 6]);
        let bytes = png(&part).unwrap();
        let read = image::load_from_memory(&bytes).unwrap().to_rgba8();
        assert_eq!(read.dimensions(), (8, 6));
        assert_eq!(read.get_pixel(2, 1).0, [200, 100, 50, 255]);
        assert!(cropped(&image, Rect::from_min_max(pos2(90.0, 0.0), pos2(99.0, 9.0)), 2.0).is_none());
    }
}
