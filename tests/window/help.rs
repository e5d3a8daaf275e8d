//! The built-in help and the box about the program.

use dcon_bench::help::Library;
use dcon_bench::module::Catalogue;
use dcon_bench::sim::Pace;
use eframe::egui::accesskit::{Role, Toggled};
use eframe::egui::{self, Key};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::harness::*;

fn help(window: &mut Window) {
    window.key_press(Key::F1);
    window.step();
    window.step();
}

/// The article whose line in the contents is chosen.
fn shown(window: &Window) -> Option<String> {
    let rows = window.query_all_by_role(Role::ListItem);
    let chosen = rows.filter(|row| row.accesskit_node().toggled() == Some(Toggled::True));
    chosen.filter_map(|row| row.accesskit_node().label()).next_back()
}

fn seek(window: &mut Window, text: &str) {
    window.get_by_role_and_label(Role::TextInput, "Search the help").focus();
    window.step();
    window.get_by_role_and_label(Role::TextInput, "Search the help").type_text(text);
    window.step();
    window.step();
}

#[test]
fn f1_opens_the_article_that_fits_what_is_in_front() {
    let mut window = window(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip));
    help(&mut window);
    assert_eq!(shown(&window).as_deref(), Some("Five-minute tour"));
    open(&mut window, "PIR-234, address 1");
    for (page, article) in [
        ("Configuration", "Changing settings"),
        ("AI", "Readings, offsets and alarm"),
        ("PIR / Relay", "Sensors and relays"),
        ("Host WDT", "Host watchdog"),
        ("Commands", "Sending commands"),
        ("Summary", "Log and summary"),
    ] {
        click(&mut window, Role::ListItem, "PIR-234, address 1");
        click(&mut window, Role::Tab, page);
        help(&mut window);
        assert_eq!(shown(&window).as_deref(), Some(article), "{page}");
    }
    for (command, article) in [("Trends", "Trends and recordings"), ("Diagnosis", "Troubleshooting")] {
        click(&mut window, Role::Button, command);
        help(&mut window);
        assert_eq!(shown(&window).as_deref(), Some(article));
    }
}

#[test]
fn search_finds_a_command_and_shows_what_the_manual_says_of_it() {
    let mut window = window(&sim(&[], Pace::Skip));
    help(&mut window);
    seek(&mut window, "$AALC8C0");
    let hit = "PIR-234: commands – Read or set the PIR output ON time";
    click(&mut window, Role::ListItem, hit);
    until(&mut window, "the command", |window| shows(window, "$AALC7C0NN"));
    assert!(shows(&window, "Manual: 5.14, 5.15") && shows(&window, "How long the PIR output stays ON"));
    seek(&mut window, " nosuchword");
    assert!(shows(&window, "Nothing has all of these words"));
}

#[test]
fn a_link_leads_to_another_article_and_back_returns() {
    let mut window = window(&sim(&[], Pace::Skip));
    help(&mut window);
    click(&mut window, Role::Link, "wiring");
    assert_eq!(shown(&window).as_deref(), Some("Wiring"));
    assert!(shows(&window, "Termination"));
    click(&mut window, Role::Button, "Back");
    assert_eq!(shown(&window).as_deref(), Some("Five-minute tour"));
}

#[test]
fn a_link_to_another_tab_opens_it() {
    let mut window = window(&sim(&["pir-234@1:modbus_rtu:9600"], Pace::Skip));
    open(&mut window, "PIR-234, address 1");
    help(&mut window);
    click(&mut window, Role::ListItem, "INIT mode");
    click(&mut window, Role::Link, "Configuration");
    until(&mut window, "the page", |window| window.query_by_role_and_label(Role::Tab, "Configuration").is_some());
    assert_eq!(window.state().settings().tab, "configuration");
}

#[test]
fn the_page_is_copied_as_text() {
    let mut window = window(&sim(&[], Pace::Skip));
    help(&mut window);
    window.get_by_role_and_label(Role::Button, "Copy page").click();
    window.step();
    let commands = &window.output().platform_output.commands;
    let copied = commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    assert!(copied.is_some_and(|text| text.starts_with("# Five-minute tour")));
}

#[test]
fn about_shows_version_folders_and_the_licence_of_every_part() {
    let mut window = window(&sim(&[], Pace::Skip));
    click(&mut window, Role::Button, "Menu");
    click(&mut window, Role::MenuItem, "About and licences…");
    until(&mut window, "the version", |window| shows(window, &dcon_bench::version::named()));
    assert!(shows(&window, "not a product of ICP DAS") && shows(&window, "Recordings"));
    click(&mut window, Role::CheckBox, "Its licence");
    assert!(shows(&window, "MIT or Apache-2.0"));
    click(&mut window, Role::CheckBox, "Parts by others");
    window.get_by_role_and_label(Role::TextInput, "Search name or licence").focus();
    window.step();
    window.get_by_role_and_label(Role::TextInput, "Search name or licence").type_text("tokio-modbus");
    window.step();
    window.step();
    let rows = window.query_all_by_label_contains("tokio-modbus 0.");
    let row =
        rows.filter_map(|row| row.accesskit_node().label()).find(|label| label.ends_with("MIT OR Apache-2.0")).unwrap();
    click(&mut window, Role::ListItem, &row);
    assert!(shows(&window, "Apache License"));
    window.key_press(Key::Escape);
    window.step();
    window.step();
    assert!(!shows(&window, "not a product of ICP DAS") && !shows(&window, "Apache License"));
}

#[test]
fn every_character_of_the_help_has_its_glyph() {
    let library = Library::new(&Catalogue::built_in().0, None);
    let texts = library.articles().iter().map(|article| article.source.as_str());
    let characters: std::collections::BTreeSet<char> = texts.flat_map(str::chars).filter(|c| !c.is_ascii()).collect();
    let ctx = egui::Context::default();
    ctx.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
    let font = egui::FontId::proportional(13.0);
    let missing: Vec<char> =
        characters.into_iter().filter(|c| !ctx.fonts_mut(|fonts| fonts.has_glyph(&font, *c))).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
