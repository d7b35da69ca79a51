//! The commands and options that the pages show are ones that the program takes.

use clap::Parser;
use glossmith::cli::Arguments;

use super::docs::{pages, text_of};

/// The command lines of Glossmith in the shell examples of a page, continued lines joined.
pub fn commands(page: &str) -> Vec<String> {
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
pub fn arguments(command: &str) -> Vec<String> {
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
