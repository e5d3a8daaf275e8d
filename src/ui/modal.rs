//! Questions and forms in front of the window, which fit into it however small it is and however large the text.

use eframe::egui::{Context, Id, Modal, ModalResponse, ScrollArea, Ui};

use super::theme;

/// Shows `contents`, as wide as wished where there is room; what is higher than the window is scrolled.
pub fn show<R>(ctx: &Context, id: &str, width: f32, contents: impl FnOnce(&mut Ui) -> R) -> ModalResponse<R> {
    fit(ctx, Modal::new(Id::unique(id)), width, contents)
}

/// The same for a modal with a look of its own.
pub fn fit<R>(ctx: &Context, modal: Modal, width: f32, contents: impl FnOnce(&mut Ui) -> R) -> ModalResponse<R> {
    let room = ctx.content_rect().shrink(theme::MODAL_MARGIN);
    modal.show(ctx, |ui| {
        ui.set_width(width.min(room.width()));
        // Lower only where the contents are: what comes in later does not have to be scrolled to while there is room.
        let height = room.height();
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, contents).inner
    })
}
