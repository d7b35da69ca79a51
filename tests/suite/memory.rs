//! Pictures that do not fit the memory are refused before they are begun; the one before goes on.

use std::process::Command;

use glossmith::{
    document::{Background, Denoise, Document},
    render::{EngineChoice, Session, SessionError},
    store::project::document_text,
};

use crate::{cli_support::Workplace, renders::adjust, worker::small_document};

const MIB: u64 = 1 << 20;

fn of_size(side: u32) -> Document {
    let mut document = small_document();
    adjust(
        &mut document,
        &format!("render.width={side} render.height={side} render.samples=1"),
    );
    document
}

#[test]
fn what_does_not_fit_is_refused_and_the_old_picture_goes_on() {
    for engine in [EngineChoice::Cpu, EngineChoice::Gpu] {
        let mut session = Session::open(engine).unwrap();
        session.memory_limit = Some(30 * MIB);
        let document = of_size(64);
        session.submit(&document).unwrap();
        while !session.step(std::time::Duration::from_secs(1)).unwrap().is_done {}
        let picture = session.image().unwrap();
        let refused = session.submit(&of_size(8000)).unwrap_err();
        assert!(matches!(refused, SessionError::TooLarge(_)), "{refused}");
        let text = refused.to_string();
        for words in ["8000 x 8000", "MiB", "30 MiB", "at most about", "close other programs"] {
            assert!(text.contains(words), "{text}");
        }
        assert_eq!(session.image().unwrap(), picture);
        // As large as it says fits; a transparent or denoised one takes more.
        let mut document = of_size(told_side(&text));
        session.submit(&document).unwrap();
        session.submit(&of_size(told_side(&text) + 2)).unwrap_err();
        document.lighting.background = Background::Transparent;
        session.submit(&document).unwrap_err();
        document.lighting.background = Background::Environment;
        document.view.denoise = Denoise::Fast;
        let text = session.submit(&document).unwrap_err().to_string();
        assert!(text.contains("switch denoising off"), "{text}");
        (document.render.width, document.render.height) = (told_side(&text), told_side(&text));
        session.submit(&document).unwrap();
    }
}

/// The side of the largest square picture that a refusal tells.
fn told_side(text: &str) -> u32 {
    let after = text.split("about ").nth(1).unwrap();
    after.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn command_line_and_project_files_refuse_alike() {
    let place = Workplace::new();
    let mut project = of_size(8000);
    project.render.samples = 1;
    place.write(
        "large.json",
        document_text(&place.path("large.json"), &project).unwrap(),
    );
    for arguments in ["render --engine cpu --size 8000x8000 --output a.png", "large.json"] {
        let output = Command::new(crate::program())
            .args(arguments.split(' '))
            .current_dir(place.path("."))
            .env("GLOSSMITH_MEMORY", "1000")
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .output()
            .unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments}: {text}");
        let line = text
            .lines()
            .find(|line| line.contains("8000 x 8000"))
            .unwrap_or_else(|| panic!("{text}"));
        assert!(
            line.contains("1000 MiB are free") && line.contains("Make it smaller"),
            "{line}"
        );
        assert!(!place.path("a.png").exists() && !place.path("glossmith.png").exists());
    }
}
