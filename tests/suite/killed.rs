//! A process that is killed while it saves leaves the old file or the new one.

use std::{path::Path, process::Command, process::Stdio, time::Duration, time::Instant};

use glossmith::{document::Bookmark, document::Document, store::load_document, store::save_document};

use super::{cli_support::Workplace, support::Random};

/// Where the child saves to.
const FILE: &str = "GLOSSMITH_TEST_SAVES_TO";

/// Two documents of different size, both large: most of a round is spent writing.
fn documents() -> [Document; 2] {
    [200, 900].map(|count| Document {
        bookmarks: (0..count)
            .map(|number| Bookmark {
                name: format!("View {number}"),
                ..Bookmark::default()
            })
            .collect(),
        ..Document::default()
    })
}

#[test]
#[ignore = "the child of the test below: saves until it is killed"]
fn saves_until_it_is_killed() {
    let path = std::env::var_os(FILE).expect("only the test below starts this");
    let documents = documents();
    for document in documents.iter().cycle() {
        save_document(Path::new(&path), document).expect("a temporary file");
    }
}

#[test]
fn a_kill_while_saving_leaves_the_old_file_or_the_new_one() {
    let folder = Workplace::new();
    let path = folder.path("project.json");
    let documents = documents();
    let mut random = Random::new(7);
    let mut found = [0, 0];
    for _ in 0..20 {
        save_document(&path, &Document::default()).expect("a temporary file");
        let mut child = Command::new(std::env::current_exe().expect("a path"))
            .args(["--ignored", "--exact", "killed::saves_until_it_is_killed"])
            .env(FILE, &path)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("this very program");
        let begun = Instant::now();
        let small = std::fs::metadata(&path).expect("it is there").len();
        while std::fs::metadata(&path).expect("never gone").len() == small {
            assert!(begun.elapsed() < Duration::from_secs(60), "nothing is saved");
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_micros(u64::from(random.bits() as u32 % 60_000)));
        child.kill().expect("it runs");
        child.wait().expect("it ends");
        let left = load_document(&path).expect("a whole file").value;
        let which = documents.iter().position(|document| *document == left);
        found[which.expect("the one or the other")] += 1;
    }
    assert!(
        found.iter().all(|count| *count > 0),
        "both were left at times: {found:?}"
    );
}
