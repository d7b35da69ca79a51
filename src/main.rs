//! The program: picks a face, prints the error chain, sets the exit code.

use std::process::ExitCode;

use clap::Parser;
use glossmith::cli::Arguments;

fn main() -> ExitCode {
    env_logger::Builder::from_env(
        env_logger::Env::default().default_filter_or("warn,wgpu=error,wgpu_hal=off,naga=error"),
    )
    .init();
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("glossmith: {}", message(&error));
            ExitCode::from(glossmith::cli::exit_code(&error))
        }
    }
}

/// An error with its causes, but for those that it quotes already.
fn message(error: &anyhow::Error) -> String {
    error
        .chain()
        .fold(String::new(), |told, cause| match cause.to_string() {
            cause if told.is_empty() => cause,
            cause if told.contains(&cause) => told,
            cause => format!("{told}: {cause}"),
        })
}

fn run(arguments: Arguments) -> anyhow::Result<()> {
    arguments.instructions.force()?;
    arguments.ray_queries.choose();
    match arguments.command {
        Some(command) => command.run(),
        None => open_window(arguments),
    }
}

/// Opens the editor; without a display renders the default scene to a picture instead, and says how to go on.
fn open_window(arguments: Arguments) -> anyhow::Result<()> {
    if has_display() {
        return glossmith::app::run(arguments.files, arguments.engine);
    }
    eprintln!("There is no display to open a window on: rendering a quick picture to glossmith.png instead.");
    glossmith::cli::render_default_scene(&arguments.files, arguments.engine)?;
    eprintln!("Next: `glossmith render --help` lists what can be rendered; on a desktop the editor opens here.");
    Ok(())
}

/// False on a Unix desktop without X11 and Wayland.
fn has_display() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(all(unix, not(target_os = "macos"))) || set("DISPLAY") || set("WAYLAND_DISPLAY")
}
