//! The manual in the window: F1 and each *?* lead to a page of the book that is there.

use egui::accesskit::Role;
use egui::{Key, Vec2};
use egui_kittest::kittest::Queryable as _;
use glossmith::app::actions::{Action, Command};
use glossmith::app::book::{self, CONTENTS, OF_SHEETS, Pages, Section};
use glossmith::app::layout::Pane;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use super::docs::{root, text_of};
use super::ui::{Editor, editor, request};
use super::ui_hands::press;
use super::words::sources;

macro_rules! pages {
    ($($path:literal)*) => {
        const PATHS: &[&str] = &[$($path),*];
    };
}
include!("../../src/book_pages.rs");

/// The pages that the program embeds, read from their files: an edit of a page compiles no test.
pub fn manual_pages() -> Pages {
    static PAGES: LazyLock<Vec<(&'static str, &'static str)>> = LazyLock::new(|| {
        let page = |path: &&'static str| (*path, &*text_of(&Path::new("docs").join(path)).leak());
        PATHS.iter().map(page).collect()
    });
    &PAGES
}

/// The section that an address leads to.
fn section(address: &str) -> Section {
    let (page, anchor) = book::parts(address);
    let found = book::sections(manual_pages(), page)
        .into_iter()
        .find(|section| anchor.is_empty() || section.anchor == anchor);
    found.unwrap_or_else(|| panic!("{address}: the book has no such page or heading"))
}

/// Whether the heading that an address leads to is seen in the manual.
fn shows(harness: &Editor, address: &str) -> bool {
    let window = harness.ctx.content_rect();
    let heading = section(address).heading;
    let mut headings = harness.query_all_by_label(&heading);
    headings.any(|heading| window.contains_rect(heading.rect()))
}

fn close(harness: &mut Editor) {
    press(harness, "Close window");
    assert!(harness.query_by_label("Contents").is_none());
}

#[test]
fn pages_and_headings_that_the_window_leads_to_exist() {
    for address in Pane::ALL
        .into_iter()
        .map(Pane::manual)
        .chain(OF_SHEETS)
        .chain([CONTENTS])
    {
        assert!(!section(address).heading.is_empty(), "{address}");
    }
}

/// All pages but those for contributors are in the program.
#[test]
fn the_manual_has_the_pages_of_the_book() {
    let summary = text_of(Path::new("docs/SUMMARY.md"));
    let (for_users, _) = summary.split_once("# Contributing").expect("pages for contributors");
    let links = for_users.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    for link in links.filter(|link| *link != "PANELS.md") {
        assert!(PATHS.contains(&link), "src/book_pages.rs lacks {link}");
    }
}

/// Pages that the library embedded would compile it and all tests again at every edit of a page.
#[test]
fn the_program_alone_embeds_pages() {
    let mut files = Vec::new();
    sources(&root().join("src"), &mut files);
    let embeds = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).expect("a source");
        text.lines()
            .any(|line| line.contains("include_str!") && line.contains("docs/"))
    };
    files.retain(embeds);
    assert_eq!(files, [root().join("src/main.rs")]);
}

#[test]
fn links_of_the_manual_lead_to_pages_and_headings() {
    let mut count = 0;
    for page in PATHS {
        let text: String = book::sections(manual_pages(), page)
            .into_iter()
            .map(|section| section.text)
            .collect();
        for address in text.split("](book:").skip(1).filter_map(|rest| rest.split(')').next()) {
            section(address);
            count += 1;
        }
    }
    assert!(count > 100, "{count} links");
}

#[test]
fn f1_opens_the_page_of_the_panel_under_the_pointer() {
    let mut harness = editor();
    for pane in Pane::ALL {
        harness.state_mut().reveal(pane);
        harness.run_steps(3);
        let place = match pane {
            Pane::Viewport => harness.get_by_label("Viewport").rect().center(),
            pane => {
                harness
                    .get_by_label(&format!("Manual: {}", pane.title()))
                    .rect()
                    .center()
                    + Vec2::new(-20.0, 60.0)
            }
        };
        harness.hover_at(place);
        harness.run_steps(2);
        harness.key_press(Key::F1);
        harness.run_steps(5);
        assert!(
            shows(&harness, pane.manual()),
            "F1 over {} shows {}",
            pane.title(),
            pane.manual()
        );
        close(&mut harness);
    }
}

#[test]
fn the_question_mark_of_a_panel_opens_its_page() {
    let mut harness = editor();
    for pane in Pane::ALL.into_iter().filter(|pane| *pane != Pane::Viewport) {
        harness.state_mut().reveal(pane);
        harness.run_steps(3);
        press(&mut harness, &format!("Manual: {}", pane.title()));
        harness.run_steps(3);
        assert!(shows(&harness, pane.manual()), "{}", pane.title());
        close(&mut harness);
    }
}

/// The manual lies over a dialog, and its links work there.
#[test]
fn f1_over_a_dialog_opens_its_page() {
    let mut harness = editor();
    request(&mut harness, Action::Do(Command::Turntable));
    harness.key_press(Key::F1);
    harness.run_steps(5);
    assert!(shows(&harness, "how-to/turntable.md"));
    press(&mut harness, "Contents");
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Link, "Use textures").click();
    harness.run_steps(5);
    assert!(shows(&harness, "how-to/textures.md"));
    press(&mut harness, "Back");
    assert!(shows(&harness, CONTENTS));
    close(&mut harness);
    assert!(
        harness.query_by_label("Turntable").is_some(),
        "the dialog is still open"
    );
}

#[test]
fn the_question_mark_of_a_dialog_opens_its_page() {
    let mut harness = editor();
    request(&mut harness, Action::Do(Command::ModelFile));
    harness.run_steps(3);
    press(&mut harness, "Manual: Model file");
    harness.run_steps(3);
    assert!(shows(&harness, "FORMATS.md#models"));
}

#[test]
fn the_help_menu_opens_the_contents() {
    let mut harness = editor();
    harness.get_by_role_and_label(Role::Button, "Help").click();
    harness.run_steps(2);
    // Its keys are part of the entry's name.
    harness.get_by_label("Manual F1").click();
    harness.run_steps(5);
    assert!(shows(&harness, CONTENTS));
    harness.check_accessibility();
}

/// Text that no font of the window has would be empty boxes.
#[test]
fn every_character_of_the_manual_has_a_glyph() {
    let harness = editor();
    let fonts = [egui::FontId::proportional(13.0), egui::FontId::monospace(12.0)];
    let mut lacking = Vec::new();
    for (page, text) in manual_pages() {
        for character in text.chars().filter(|character| !character.is_control()) {
            let is_there = harness
                .ctx
                .fonts_mut(|fonts_of_window| fonts.iter().all(|font| fonts_of_window.has_glyph(font, character)));
            if !is_there {
                lacking.push(format!("{page}: {character} (U+{:04X})", u32::from(character)));
            }
        }
    }
    lacking.sort();
    lacking.dedup();
    assert!(lacking.is_empty(), "{lacking:?}");
}
