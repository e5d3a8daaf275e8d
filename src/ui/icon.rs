//! The picture by which the window is found in a row of others. Where desktops take it from the desktop entry (Wayland),
//! they find that by the window's application id.

use eframe::egui::IconData;

/// Written by `.ci/icon`, like the others beside it.
const PICTURE: &[u8] = include_bytes!("../../assets/icon/dcon-bench-64.png");

/// The icon of the window; none if the picture cannot be read.
pub fn window() -> IconData {
    eframe::icon_data::from_png_bytes(PICTURE).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_icon_is_a_picture_with_transparent_corners() {
        let IconData { rgba, width, height } = window();
        assert_eq!((width, height), (64, 64));
        let alpha = |x: usize, y: usize| rgba[(y * 64 + x) * 4 + 3];
        assert_eq!((alpha(0, 0), alpha(32, 32)), (0, 255));
    }
}
