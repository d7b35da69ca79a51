//! A render that a signal ends: the picture so far is there, and said to be.
#![cfg(unix)]

use std::{
    io::{BufRead as _, BufReader, Read as _},
    os::unix::process::CommandExt as _,
    process::{Child, Command, Stdio},
};

use super::cli_support::{Workplace, read_exr};

/// More samples than there is time for.
const RENDER: &str =
    "render --engine cpu --model sphere --size 32x32 --samples 4000000000 --output a.exr --report r.json";

/// Starts the program by way of a shell, which does `before` first, and waits until the engine is told: from then on signals
/// are watched.
fn begun(place: &Workplace, before: &str, arguments: &str) -> (Child, BufReader<std::process::ChildStderr>) {
    let mut command = Command::new("sh");
    // SAFETY: between fork and exec only signals are set, which may be done there. A shell in the background has its children
    // ignore SIGINT.
    unsafe {
        command.pre_exec(|| {
            for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP] {
                libc::signal(signal, libc::SIG_DFL);
            }
            Ok(())
        });
    }
    let mut child = command
        .args(["-c", &format!("{before} exec \"$0\" {arguments}"), crate::program()])
        .current_dir(place.path("."))
        .env_remove("RUST_LOG")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut told = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    told.read_line(&mut line).unwrap();
    assert!(line.starts_with("cpu on"), "{line}");
    (child, told)
}

fn send(child: &Child, signal: &str) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(status.unwrap().success());
}

/// The exit code, and what it told on the way.
fn ended(mut child: Child, mut told: BufReader<std::process::ChildStderr>) -> (Option<i32>, String) {
    let mut text = String::new();
    told.read_to_string(&mut text).unwrap();
    (child.wait().unwrap().code(), text)
}

#[test]
fn a_signal_ends_a_render_with_what_there_is() {
    for (signal, name, code) in [
        ("-INT", "SIGINT", 130),
        ("-TERM", "SIGTERM", 143),
        ("-HUP", "SIGHUP", 129),
    ] {
        let place = Workplace::new();
        let (child, told) = begun(&place, "", RENDER);
        send(&child, signal);
        let (found, text) = ended(child, told);
        assert_eq!(found, Some(code), "{text}");
        assert!(
            text.contains("wrote a.exr") && text.contains(&format!("ended early by {name}")),
            "{text}"
        );
        let picture = read_exr(&place.path("a.exr"));
        assert!(picture.pixels.iter().any(|pixel| pixel[0] > 0.0), "{signal}: black");
        let report: serde_json::Value = place.json("r.json");
        assert_eq!(report["stopped_by"], "signal");
        assert!(report["mean_samples_per_pixel"].as_f64().unwrap() > 0.0);
    }
}

/// Both arrive while the program is stopped, so before it has come to save anything.
#[test]
fn a_second_signal_ends_it_at_once() {
    let place = Workplace::new();
    let (child, told) = begun(&place, "", RENDER);
    for signal in ["-STOP", "-INT", "-TERM", "-CONT"] {
        send(&child, signal);
    }
    let (code, text) = ended(child, told);
    assert!(matches!(code, Some(130 | 143)), "{code:?}: {text}");
    assert!(!place.path("a.exr").exists(), "{text}");
}

/// As under `nohup`.
#[test]
fn a_signal_that_is_ignored_stays_ignored() {
    let place = Workplace::new();
    let (child, told) = begun(&place, "trap '' HUP;", RENDER);
    send(&child, "-HUP");
    send(&child, "-INT");
    let (code, text) = ended(child, told);
    assert_eq!(code, Some(130), "{text}");
    assert!(place.path("a.exr").exists(), "{text}");
}
