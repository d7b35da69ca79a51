//! The commands and options that the pages show are ones that the program takes.

use std::collections::BTreeSet;

use clap::{Command, CommandFactory, Parser};
use glossmith::cli::Arguments;

use super::docs::{pages, text_of};

/// The command lines of Glossmith in the shell examples of a page, continued lines joined.
pub(super) fn commands(page: &str) -> Vec<String> {
    let examples = page
        .split("```sh\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next());
    let joined: String = examples.collect::<String>().replace("\\\n", " ");
    let lines = joined.lines().map(str::trim);
    lines
        .filter(|line| line.starts_with("glossmith"))
        .map(str::to_owned)
        .collect()
}

/// The arguments of a command as a shell hands them over: up to a comment, a pipe or a redirection, without quotes.
pub(super) fn arguments(command: &str) -> Vec<String> {
    let mut arguments = vec![String::new()];
    let mut quote = None;
    for c in command.chars() {
        match (quote, c) {
            (Some(open), c) if c == open => quote = None,
            (None, '\'' | '"') => quote = Some(c),
            (None, '>' | '|') => break,
            (None, '#') if arguments.last().is_some_and(String::is_empty) => break,
            (None, ' ') => arguments.push(String::new()),
            _ => arguments.last_mut().unwrap().push(c),
        }
    }
    arguments.retain(|argument| !argument.is_empty());
    arguments
}

#[test]
fn commands_that_the_pages_show_are_taken() {
    let mut count = 0;
    for page in pages() {
        for command in commands(&text_of(&page)) {
            let error = Arguments::try_parse_from(arguments(&command))
                .err()
                .map(|error| error.to_string());
            // Textures are looked for as the arguments are read.
            let refusal = error.filter(|error| !error.contains("there is no such file"));
            assert_eq!(refusal, None, "{}: {command}", page.display());
            count += 1;
        }
    }
    assert!(count > 40, "the pages show {count} commands");
}

#[test]
fn a_command_is_split_as_a_shell_does_it() {
    let split = arguments("glossmith render --set \"base.color=#b87333\" 'a b.png' > out # why");
    assert_eq!(split, ["glossmith", "render", "--set", "base.color=#b87333", "a b.png"]);
}

/// Every option that any command has.
fn known_options(command: &Command, found: &mut BTreeSet<String>) {
    for argument in command.get_arguments() {
        let aliases = argument.get_all_aliases().unwrap_or_default();
        let names = argument.get_long().into_iter().chain(aliases);
        found.extend(names.map(str::to_owned));
    }
    for command in command.get_subcommands() {
        known_options(command, found);
    }
}

/// Options of commands that are not Glossmith's, as the pages name them.
const OPTIONS_OF_OTHERS: [&str; 19] = [
    "all-targets",
    "bench",
    "build",
    "dry-run",
    "features",
    "help",
    "locked",
    "no-default-features",
    "no-run",
    "prefix",
    "profile",
    "release",
    "run-dependencies",
    "step",
    "tasks",
    "test",
    "timings",
    "version",
    "yes",
];

#[test]
fn options_that_the_pages_name_exist() {
    let mut known = BTreeSet::new();
    known_options(&Arguments::command(), &mut known);
    for page in pages() {
        let text = text_of(&page);
        for (at, _) in text.match_indices("--") {
            let is_begin = at == 0 || matches!(text.as_bytes()[at - 1], b' ' | b'`' | b'\n' | b'(' | b'[');
            let rest = &text[at + 2..];
            let name: &str = rest
                .split(|c: char| !c.is_ascii_lowercase() && !c.is_ascii_digit() && c != '-')
                .next()
                .unwrap();
            let is_whole = !name.is_empty() && !rest[name.len()..].starts_with('…') && !name.ends_with('-');
            let is_name = is_begin && is_whole && name.starts_with(|c: char| c.is_ascii_lowercase());
            assert!(
                !is_name || known.contains(name) || OPTIONS_OF_OTHERS.contains(&name),
                "{} names --{name}, which no command has",
                page.display()
            );
        }
    }
}
