//! Words never decide what becomes of a picture: the program run with an output that is closed, or on a full disk.

use std::{fs::File, io::pipe, process::Command, process::Stdio};

use super::cli_support::Workplace;

/// Where nobody listens.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Deaf {
    /// A pipe whose reader is gone.
    Closed,
    /// A disk without room.
    #[cfg(target_os = "linux")]
    Full,
}

const ALL: &[Deaf] = &[
    Deaf::Closed,
    #[cfg(target_os = "linux")]
    Deaf::Full,
];

impl Deaf {
    fn output(self) -> Stdio {
        match self {
            Self::Closed => pipe().unwrap().1.into(),
            #[cfg(target_os = "linux")]
            Self::Full => File::create("/dev/full").unwrap().into(),
        }
    }

    /// What is to come of an answer that nobody gets.
    fn code(self) -> i32 {
        i32::from(self != Self::Closed)
    }
}

fn program(place: &Workplace, arguments: &str) -> Command {
    let mut command = Command::new(crate::program());
    command.args(arguments.split_whitespace()).current_dir(place.path(""));
    for variable in ["DISPLAY", "WAYLAND_DISPLAY", "RUST_LOG"] {
        command.env_remove(variable);
    }
    command
}

const RENDER: &str = "render --engine cpu --size 16x16 --samples 1 --output a.exr --keep-sums";

#[test]
fn pictures_are_saved_where_nobody_reads_the_words() {
    for &deaf in ALL {
        let place = Workplace::new();
        let merged = "merge a.exr --output merged.png";
        let turned = "turntable --engine cpu --size 16x16 --samples 1 --frames 2";
        for (arguments, file) in [
            (RENDER, "a.exr"),
            (merged, "merged.png"),
            (turned, "turntable/frame-0002.png"),
            ("lobe --plot polar --lobe ggx:0.3 --output lobe.csv", "lobe.csv"),
        ] {
            let status = program(&place, arguments).stderr(deaf.output()).status().unwrap();
            assert_eq!(status.code(), Some(0), "{deaf:?}: {arguments}");
            assert!(place.path(file).is_file(), "{deaf:?}: {arguments}");
        }
    }
}

#[test]
fn an_answer_that_nobody_reads_ends_quietly_and_one_that_has_no_room_is_told() {
    let place = Workplace::new();
    for &deaf in ALL {
        for arguments in [
            "plan --size 16x16",
            "explain --pixel 1,1 --size 16x16",
            "manual",
            "completions bash",
            "lobe --plot polar --lobe ggx:0.3 --output lobe.csv --json -",
            &format!("{RENDER} --report -"),
        ] {
            let output = program(&place, arguments).stdout(deaf.output()).output().unwrap();
            let told = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(deaf.code()), "{deaf:?}: {arguments}\n{told}");
            assert!(!told.contains("panicked"), "{deaf:?}: {arguments}\n{told}");
            let errors = told
                .lines()
                .filter(|line| line.starts_with("glossmith: standard output"));
            assert_eq!(errors.count(), deaf.code() as usize, "{deaf:?}: {arguments}\n{told}");
        }
    }
}
