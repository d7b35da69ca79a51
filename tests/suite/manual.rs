//! The manual in the window: F1 and each *?* lead to a page of the book that is there.

use egui::{Key, Vec2};
use egui_kittest::kittest::Queryable as _;
use glossmith::app::{
    book,
    book::{CONTENTS, OF_SHEETS, Pages, Section},
    layout::Pane,
};
use std::{path::Path, sync::LazyLock};

use super::{docs::text_of, ui::Editor, ui::editor};

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
    harness.press("Close window");
    assert!(!harness.has("Contents"));
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

#[test]
fn the_manual_has_the_pages_of_the_book() {
    let summary = text_of(Path::new("docs/SUMMARY.md"));
    let links = summary.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    for link in links.filter(|link| *link != "PANELS.md") {
        assert!(PATHS.contains(&link), "src/book_pages.rs lacks {link}");
    }
}

#[test]
fn f1_opens_the_page_of_the_panel_under_the_pointer() {
    let mut harness = editor();
    for pane in Pane::ALL {
        harness.reveal(pane);
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
