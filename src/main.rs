//! The program: dispatches to the editor or the command line, prints the error chain, sets the exit code.

#![deny(clippy::print_stdout, clippy::print_stderr)]

use std::{io, io::Write as _, process::ExitCode, time::Duration, time::SystemTime};

use anyhow::Context as _;
use glossmith::{cli::Arguments, console};

#[cfg(feature = "window")]
macro_rules! pages {
    ($($path:literal)*) => {
        /// Pages of the manual as they were when the program was built: it needs no network and no files.
        const PAGES: glossmith::app::book::Pages = &[$(($path, include_str!(concat!("../docs/", $path)))),*];
    };
}
#[cfg(feature = "window")]
include!("book_pages.rs");

fn main() -> ExitCode {
    glossmith::render::memory::return_what_is_freed();
    let mut logger = env_logger::Builder::from_env(
        env_logger::Env::default().default_filter_or("warn,wgpu=error,wgpu_hal=off,naga=error"),
    );
    logger.format(log_line);
    logger.init();
    let done = run(glossmith::cli::parse());
    let printed = console::finish().context("standard output could not be written to");
    match done.and(printed) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            console::message_line(format_args!("glossmith: {}", message(&error)));
            ExitCode::from(glossmith::cli::exit_code(&error))
        }
    }
}

/// A line of the log: when (UTC), how grave, from where, what; further lines of it are set in.
fn log_line(out: &mut env_logger::fmt::Formatter, record: &log::Record<'_>) -> io::Result<()> {
    let time = time_text(SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default());
    let (level, style) = (record.level(), out.default_level_style(record.level()));
    let text = record.args().to_string().replace('\n', "\n    ");
    writeln!(out, "[{time} {style}{level:<5}{style:#} {}] {text}", record.target())
}

/// The date and the second in UTC as ISO 8601 writes them, so long after 1970 began.
fn time_text(since_1970: Duration) -> String {
    let (days, second) = (since_1970.as_secs() / 86_400, since_1970.as_secs() % 86_400);
    // Years begin in March here: the leap day is then a year's last, and months are 30.6 days long, rounded.
    let from_march_0 = days + 719_468;
    let (era, day) = (from_march_0 / 146_097, from_march_0 % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (year, month) = if month < 10 {
        (year, month + 3)
    } else {
        (year + 1, month - 9)
    };
    let year = 400 * era + year;
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// An error with its causes, but for those that it quotes already.
fn message(error: &anyhow::Error) -> String {
    error
        .chain()
        .fold(String::new(), |chain, cause| match cause.to_string() {
            cause if chain.is_empty() => cause,
            cause if chain.contains(&cause) => chain,
            cause => format!("{chain}: {cause}"),
        })
}

fn run(arguments: Arguments) -> anyhow::Result<()> {
    arguments.instructions.force()?;
    glossmith::render::MachineOptions::set(arguments.ray_queries, arguments.denoise_device);
    if arguments.allow_outside {
        glossmith::import::limits::allow_everything();
    }
    match arguments.command {
        Some(command) => command.run(),
        None => open_window(arguments),
    }
}

/// Says what this program lacks.
#[cfg(not(feature = "window"))]
fn open_window(_: Arguments) -> anyhow::Result<()> {
    anyhow::bail!(
        "this program was built without the editor (the feature `window`); `glossmith --help` lists what it can do"
    )
}

/// Opens the editor; without a display renders the default scene to an image instead, and says how to go on.
#[cfg(feature = "window")]
fn open_window(arguments: Arguments) -> anyhow::Result<()> {
    if has_display() {
        return glossmith::app::run(arguments.files, arguments.engine, PAGES);
    }
    console::message_line(format_args!(
        "There is no display to open a window on: rendering a quick image to glossmith.png instead."
    ));
    glossmith::cli::render_default_scene(&arguments.files, arguments.engine)?;
    console::message_line(format_args!(
        "Next: `make run ARGS=\"render --help\"` lists what can be rendered; on a desktop the editor opens here."
    ));
    Ok(())
}

/// False on a Unix desktop without X11 and Wayland.
#[cfg(feature = "window")]
fn has_display() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(all(unix, not(target_os = "macos"))) || set("DISPLAY") || set("WAYLAND_DISPLAY")
}
