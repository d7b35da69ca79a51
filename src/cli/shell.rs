//! What a shell knows about the program: `glossmith completions` and `glossmith manual`.

use anyhow::Context;
use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::Arguments;
use crate::console::print_bytes;

/// Arguments of `glossmith completions`.
#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell that reads them.
    #[arg(value_enum)]
    shell: Shell,
}

/// Arguments of `glossmith manual`.
#[derive(Debug, Args)]
pub struct ManualArguments {
    /// The subcommand that the page is about; without one the page of the program itself.
    subcommand: Option<String>,
}

/// Prints a script that completes the program's arguments in a shell.
///
/// # Errors
/// None.
pub fn completions(arguments: &CompletionsArguments) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "glossmith", &mut script);
    print_bytes(&script);
    Ok(())
}

/// Prints a manual page in roff.
///
/// # Errors
/// Where there is no such subcommand.
pub fn manual(arguments: &ManualArguments) -> anyhow::Result<()> {
    let mut command = super::command();
    // Gives subcommands their names in full: glossmith render.
    command.build();
    if let Some(name) = &arguments.subcommand {
        let found = command.find_subcommand(name).cloned();
        command = found.with_context(|| format!("{name}: no such command; {}", super::meant(name)))?;
    }
    let mut page = Vec::new();
    let usage = command.render_usage().to_string();
    let command = command.override_usage(usage.trim_start_matches("Usage: ").to_owned());
    let source = concat!("glossmith ", env!("CARGO_PKG_VERSION"));
    clap_mangen::Man::new(command).source(source).render(&mut page)?;
    print_bytes(&page);
    Ok(())
}
