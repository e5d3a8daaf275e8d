//! What the program is: version, folders, licences.

use std::path::PathBuf;

use eframe::egui::{self, Align, Button, Label, RichText, ScrollArea, Ui};

use super::licence_list::LicenceList;
use crate::help::licences;
use crate::ui::app::Pass;
use crate::ui::recording::Wish;
use crate::ui::{modal, theme, widgets};
use crate::{errors, folders, version};

const WHAT: &str = "A commissioning bench for ICP DAS PIR-130 and PIR-234 modules, and others that a definition file describes, on \
                    RS-485 (DCON, Modbus RTU) and Ethernet (Modbus TCP).";
const INDEPENDENT: &str = "An independent program, not a product of ICP DAS and not endorsed by it. Names of products and companies \
                           belong to their owners.";

#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum Page {
    #[default]
    Program,
    Own,
    Others,
}

/// The box, while it is open.
#[derive(Default)]
pub struct AboutBox {
    open: Option<Open>,
    /// What draws the window.
    renderer: Option<String>,
}

struct Open {
    page: Page,
    folders: Vec<Folder>,
    list: LicenceList,
}

struct Folder {
    name: &'static str,
    path: PathBuf,
    is_there: bool,
}

impl AboutBox {
    pub fn open(&mut self, pass: &Pass<'_>) {
        self.open = Some(Open { page: Page::Program, folders: used(pass), list: LicenceList::default() });
    }

    /// Looks once what draws the window.
    pub fn note_renderer(&mut self, frame: &eframe::Frame) {
        if self.renderer.is_none() {
            let wgpu = frame.wgpu_render_state().map(|state| state.adapter.get_info());
            let wgpu = wgpu.map(|info| format!("wgpu, {} ({})", info.backend, info.name));
            self.renderer = frame.gl().map(|_| "OpenGL (glow)".to_owned()).or(wgpu);
        }
    }

    pub fn show(&mut self, ctx: &egui::Context, pass: &mut Pass<'_>) {
        let Self { open: Some(open), renderer } = self else { return };
        let mut close = false;
        let modal = modal::show(ctx, "about", theme::ABOUT[0], |ui| {
            ui.heading(version::named());
            ui.add_space(theme::UNIT);
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = theme::UNIT;
                let pages = [
                    (Page::Program, "Program", "What it is, and where it keeps its files"),
                    (Page::Own, "Its licence", "What you may do with the program"),
                    (Page::Others, "Parts by others", "What the program is made of, and under which licences"),
                ];
                for (page, name, means) in pages {
                    if widgets::chip(ui, open.page == page, name, name, means) {
                        open.page = page;
                    }
                }
            });
            ui.add_space(theme::GAP);
            let size = egui::vec2(ui.available_width(), theme::ABOUT[1]);
            let layout = egui::Layout::top_down(Align::Min);
            ui.allocate_ui_with_layout(size, layout, |ui| {
                ui.set_min_size(size);
                match open.page {
                    Page::Program => program(ui, &open.folders, renderer.as_deref(), pass),
                    Page::Own => own(ui),
                    Page::Others => open.list.show(ui),
                }
            });
            ui.add_space(theme::GAP);
            widgets::at_right(ui, |ui| close = ui.button("Close").clicked());
        });
        if close || modal.should_close() {
            self.open = None;
        }
    }
}

/// The folders in which the program keeps something.
fn used(pass: &Pass<'_>) -> Vec<Folder> {
    let recordings = pass.recordings.folder(pass.settings).or_else(folders::recordings);
    let all = [("Settings", folders::config()), ("Definitions", folders::definitions()), ("Recordings", recordings)];
    let there = |(name, path): (&'static str, Option<PathBuf>)| {
        let path = path?;
        Some(Folder { name, is_there: path.is_dir(), path })
    };
    all.into_iter().filter_map(there).collect()
}

fn program(ui: &mut Ui, folders: &[Folder], renderer: Option<&str>, pass: &mut Pass<'_>) {
    ui.add(Label::new(WHAT).wrap());
    ui.add_space(theme::GAP);
    let quiet = theme::palette(ui).quiet;
    ui.add(Label::new(RichText::new(INDEPENDENT).color(quiet)).wrap());
    ui.add_space(theme::GAP_SECTION);
    widgets::quiet_small(ui, "Folders");
    for folder in folders {
        line(ui, folder.name, &folder.path.display().to_string(), |ui| {
            let open = ui.add_enabled(folder.is_there, Button::new("Open"));
            widgets::describe(&open, egui::Role::Button, &format!("Open the folder of {}", folder.name.to_lowercase()));
            let open = open.on_hover_text("Shows the folder in the file manager");
            if open.on_disabled_hover_text("It is not there yet: it is made when something is kept in it").clicked() {
                pass.recordings.ask(Wish::ShowFolder(folder.path.clone()));
            }
            let copy = ui.button("Copy");
            widgets::describe(&copy, egui::Role::Button, &format!("Copy the folder of {}", folder.name.to_lowercase()));
            if copy.on_hover_text("Copies its path").clicked() {
                ui.ctx().copy_text(folder.path.display().to_string());
            }
        });
    }
    ui.add_space(theme::GAP);
    widgets::quiet_small(ui, "This run");
    let log = errors::file().map_or_else(|| "Standard error".to_owned(), |path| path.display().to_string());
    line(ui, "Log", &format!("{log}; with RUST_LOG=info it tells more"), |_| {});
    if let Some(renderer) = renderer {
        line(ui, "Drawn by", renderer, |_| {});
    }
    let system = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    line(ui, "System", &system, |_| {});
}

/// A name, what is to be known, and what can be done with it at the right end.
fn line(ui: &mut Ui, name: &str, text: &str, buttons: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        let palette = theme::palette(ui);
        widgets::fixed_coloured(ui, theme::ABOUT_NAME, Align::Min, name, palette.quiet);
        widgets::at_right(ui, |ui| {
            buttons(ui);
            ui.with_layout(egui::Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(text).truncate()).on_hover_text(text);
            });
        });
    });
}

fn own(ui: &mut Ui) {
    ui.label("MIT or Apache-2.0, at your choice.");
    ui.add_space(theme::UNIT);
    ScrollArea::vertical().id_salt("own licences").auto_shrink(false).show(ui, |ui| {
        for (name, text) in licences::own() {
            ui.add_space(theme::GAP);
            widgets::quiet_small(ui, name);
            ui.add(Label::new(RichText::new(text).font(theme::small_mono())).wrap());
        }
    });
}
