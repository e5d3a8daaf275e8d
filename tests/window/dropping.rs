//! Files that are dragged onto the window.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use dcon_bench::bench::Presence;
use dcon_bench::bus::LineAddress;
use dcon_bench::mimic::{Mimic, MimicSpec};
use dcon_bench::module::Catalogue;
use dcon_bench::sim::{Pace, Sim};
use dcon_bench::ui::{App, LineChoice, Settings, Start};
use eframe::egui::accesskit::Role;
use eframe::egui::{DroppedFile, HoveredFile, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use crate::harness::*;

const SMALL: &str = include_str!("../vectors/tm-1.toml");

/// A file as the system says that it was dropped.
#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("nobody asks".to_owned())
    }
}

fn window_with_definitions(sim: &Sim, folder: &Path) -> Window {
    let simulated = LineAddress::Simulated { label: "Simulated line".to_owned(), sim: sim.clone() };
    let settings = Settings { line: LineChoice::Simulated, ..Settings::default() };
    let folder = folder.to_owned();
    Harness::builder().with_size(vec2(1280.0, 800.0)).build_eframe(move |creation| {
        let ctx = creation.egui_ctx.clone();
        let bench = bench(&ctx).with_definitions_in(folder);
        App::new(&ctx, bench, Start { simulated, demo: false, settings }).without_system_dialogs()
    })
}

fn drop_files(window: &mut Window, paths: &[PathBuf]) {
    for path in paths {
        window.input_mut().dropped_files.push(Arc::new(Dropped(path.clone())));
    }
    window.step();
    window.input_mut().dropped_files.clear();
    window.step();
}

fn told(window: &Window, text: &str) -> bool {
    window.state().bench().notices().any(|notice| notice.text.contains(text))
}

#[test]
fn a_definition_that_is_dropped_counts_at_once_and_the_unknown_module_gets_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tm-1.toml");
    std::fs::write(&file, SMALL).unwrap();
    let (with_it, _) = Catalogue::from_texts(vec![("tm-1.toml".to_owned(), SMALL.to_owned())]);
    let spec: MimicSpec = "tm-1@1:dcon:9600".parse().unwrap();
    let sim = sim(&[], Pace::Skip);
    sim.join(Box::new(Mimic::new(spec.definition(&with_it, &[]).unwrap(), spec.placing)));
    let mut window = window_with_definitions(&sim, &folder.path().join("modules"));
    open(&mut window, "unknown, address 1");
    drop_files(&mut window, &[file]);
    assert!(told(&window, "was added – 1 module of the list is asked again"), "{:?}", notices(&window));
    until(&mut window, "it is known", |window| {
        let modules = window.state().bench().modules();
        modules.len() == 1 && modules[0].label() == "TM-1" && modules[0].presence == Presence::Found
            || modules.iter().any(|module| module.label() == "TM-1")
    });
    assert!(folder.path().join("modules/tm-1.toml").exists());
}

#[test]
fn a_faulty_definition_and_files_of_other_kinds_are_refused_each_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let faulty = folder.path().join("faulty.toml");
    std::fs::write(&faulty, "id = 5").unwrap();
    let mut window = window_with_definitions(&sim(&[], Pace::Skip), &folder.path().join("modules"));
    drop_files(&mut window, &[faulty, "/tmp/letter.txt".into(), "/tmp/hall.pcapng".into()]);
    assert!(told(&window, "The definition was not added – ") && told(&window, "line 1"), "{:?}", notices(&window));
    assert!(told(&window, "letter.txt was not opened: it is neither"));
    assert!(told(&window, "hall.pcapng is a capture – read it with"));
    assert!(!folder.path().join("modules").exists());
}

#[test]
fn while_files_hover_the_window_says_what_will_become_of_them() {
    let mut window = window(&sim(&[], Pace::Skip));
    for name in ["/tmp/tm-1.toml", "/tmp/hall.sqlite", "/tmp/letter.txt"] {
        let file = HoveredFile { path: Some(name.into()), ..HoveredFile::default() };
        window.input_mut().hovered_files.push(file);
    }
    window.step();
    window.step();
    for text in
        ["tm-1.toml is checked and added", "hall.sqlite is opened as a recording", "letter.txt cannot be opened"]
    {
        assert!(shows(&window, text), "{text}");
    }
    window.input_mut().hovered_files.clear();
    window.step();
    window.step();
    assert!(!shows(&window, "Drop to open"));
}

#[test]
fn another_definition_of_a_model_is_replaced_only_when_that_is_wanted() {
    let folder = tempfile::tempdir().unwrap();
    let (file, kept) = (folder.path().join("module.toml"), folder.path().join("modules/tm-1.toml"));
    let newer = SMALL.replace("label = \"TM-1\"", "label = \"TM-1 new\"");
    std::fs::create_dir(folder.path().join("modules")).unwrap();
    std::fs::write(&kept, SMALL).unwrap();
    std::fs::write(&file, &newer).unwrap();
    let mut window = window_with_definitions(&sim(&[], Pace::Skip), &folder.path().join("modules"));
    drop_files(&mut window, std::slice::from_ref(&file));
    until(&mut window, "the question", |window| shows(window, "Replace a definition?"));
    assert!(shows(&window, "tm-1.toml defines tm-1 in another way"));
    click(&mut window, Role::Button, "Cancel");
    assert_eq!(std::fs::read_to_string(&kept).unwrap(), SMALL);
    // Only one question stands at a time; the other file is refused, with a way out.
    drop_files(&mut window, &[file.clone(), file]);
    assert!(told(&window, "tm-1.toml defines tm-1 in another way – add this file alone"), "{:?}", notices(&window));
    click(&mut window, Role::Button, "Replace");
    until(&mut window, "it is told", |window| told(window, "The definition of TM-1 new was added"));
    assert_eq!(std::fs::read_to_string(&kept).unwrap(), newer);
    let files = std::fs::read_dir(folder.path().join("modules")).unwrap();
    assert_eq!(files.count(), 1, "nothing is left of the writing");
}

#[test]
fn what_the_new_definition_leaves_faulty_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let modules = folder.path().join("modules");
    std::fs::create_dir(&modules).unwrap();
    std::fs::write(modules.join("broken.toml"), "id = 5").unwrap();
    let file = folder.path().join("tm-1.toml");
    std::fs::write(&file, SMALL).unwrap();
    let mut window = window_with_definitions(&sim(&[], Pace::Skip), &modules);
    drop_files(&mut window, &[file]);
    assert!(told(&window, "The definition of TM-1 was added"), "{:?}", notices(&window));
    assert!(told(&window, "broken.toml, line 1"), "{:?}", notices(&window));
}

#[test]
fn the_menu_adds_a_definition_where_nothing_can_be_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tm-1.toml");
    std::fs::write(&file, SMALL).unwrap();
    let mut window = window_with_definitions(&sim(&[], Pace::Skip), &folder.path().join("modules"));
    click(&mut window, Role::Button, "Menu");
    click(&mut window, Role::MenuItem, "Add definition file…");
    until(&mut window, "the field", |window| window.query_by_role_and_label(Role::TextInput, "Path").is_some());
    window.get_by_role_and_label(Role::TextInput, "Path").type_text(&file.display().to_string());
    window.step();
    click(&mut window, Role::Button, "Add");
    until(&mut window, "it is told", |window| told(window, "The definition of TM-1 was added"));
    assert!(folder.path().join("modules/tm-1.toml").exists());
}

fn notices(window: &Window) -> Vec<String> {
    window.state().bench().notices().map(|notice| notice.text.clone()).collect()
}
