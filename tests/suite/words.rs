//! What a program can check of docs/STYLE.md: the words of its table, in the pages and in the texts and comments of the
//! sources; the length of sentences, and their mean on each page.

use std::path::{Path, PathBuf};

use super::docs::{pages, root, text_of};

/// Words that a sentence may have, and that those of a page may have in the mean.
const MOST_WORDS: usize = 30;
const MEAN_WORDS: f64 = 20.0;
/// Shorter pieces are labels and cells, which say nothing about how long sentences are.
const LEAST_WORDS: usize = 4;
/// Pages that are not done yet, with how many long sentences and private words they have. These may only become fewer.
const EXEMPT: [(&str, usize, usize); 0] = [];

/// The words not to use: in quotes in the first column of the table of docs/STYLE.md.
fn private_words() -> Vec<String> {
    let style = text_of(Path::new("docs/STYLE.md"));
    let rows = style.lines().filter(|line| line.starts_with("| \""));
    let first = rows.filter_map(|row| row.split('|').nth(1));
    first
        .flat_map(|cell| {
            cell.split('"')
                .skip(1)
                .step_by(2)
                .map(str::to_owned)
                .collect::<Vec<_>>()
        })
        .collect()
}

/// The paragraphs, list items, headings and cells of a page: without code, and without the tables that the program makes.
fn passages(page: &str) -> Vec<String> {
    let mut passages = vec![String::new()];
    let (mut is_code, mut is_made) = (false, false);
    for line in page.lines() {
        let text = line.trim();
        is_made |= text.starts_with("<!-- made from the program");
        is_code ^= text.starts_with("```");
        let is_item = ["- ", "* ", "> ", "#"].iter().any(|mark| text.starts_with(mark))
            || text
                .split_once(". ")
                .is_some_and(|(number, _)| number.parse::<u8>().is_ok());
        if is_made || is_code || text.starts_with("```") || text.is_empty() {
            passages.push(String::new());
        } else if text.starts_with('|') {
            passages.extend(text.replace("\\|", " ").split('|').map(str::to_owned));
            passages.push(String::new());
        } else {
            if is_item {
                passages.push(String::new());
            }
            let passage = passages.last_mut().unwrap();
            *passage += " ";
            *passage += text.trim_start_matches(['#', '>']);
            if text.starts_with('#') {
                passages.push(String::new());
            }
        }
        is_made &= !text.starts_with("<!-- end");
    }
    passages
}

/// A passage as it is read: links by their text, code and names of the window's labels as one word each.
fn read(passage: &str) -> String {
    let mut text = String::new();
    let mut rest = passage;
    while let Some((before, after)) = rest.split_once("](") {
        text += before;
        rest = after.split_once(')').map_or("", |(_, after)| after);
    }
    text += rest;
    let without_code = replaced(&text, '`', "code");
    replaced(&without_code.replace("**", ""), '*', "label").replace(['[', ']', '!'], "")
}

/// The text with each piece between two marks replaced by a word.
fn replaced(text: &str, mark: char, word: &str) -> String {
    let pieces = text.split(mark).enumerate();
    pieces.map(|(i, piece)| if i % 2 == 0 { piece } else { word }).collect()
}

/// The sentences of a passage, in words.
fn sentences(passage: &str) -> Vec<Vec<&str>> {
    let ended = passage
        .split_inclusive(". ")
        .flat_map(|text| text.split_inclusive("? "));
    let words = ended.map(|text| {
        text.split_whitespace()
            .filter(|word| word.chars().any(char::is_alphanumeric))
            .collect()
    });
    words.filter(|words: &Vec<_>| words.len() >= LEAST_WORDS).collect()
}

/// The passage in lower case with single spaces, to look for words in.
fn plain(passage: &str) -> String {
    let is_word = |c: char| c.is_alphanumeric() || matches!(c, '\'' | '-');
    let lower = passage.to_lowercase();
    let words: Vec<_> = lower.split(|c| !is_word(c)).filter(|word| !word.is_empty()).collect();
    format!(" {} ", words.join(" "))
}

#[test]
fn pages_keep_to_the_style() {
    let private = private_words();
    assert!(private.len() > 20, "docs/STYLE.md has its table of terms");
    for page in pages() {
        let name = page.display().to_string().replace('\\', "/");
        if name == "docs/STYLE.md" {
            continue;
        }
        let passages: Vec<_> = passages(&text_of(&page)).iter().map(|passage| read(passage)).collect();
        let sentences: Vec<_> = passages.iter().flat_map(|passage| sentences(passage)).collect();
        let long: Vec<_> = sentences
            .iter()
            .filter(|words| words.len() > MOST_WORDS)
            .map(|words| words.join(" "))
            .collect();
        let found: Vec<_> = passages
            .iter()
            .map(|passage| plain(passage))
            .flat_map(|text| {
                private
                    .iter()
                    .flat_map(move |word| vec![word; text.matches(&format!(" {word} ")).count()])
            })
            .collect();
        let allowed = EXEMPT.iter().find(|(exempt, ..)| *exempt == name);
        let (long_allowed, words_allowed) = allowed.map_or((0, 0), |(_, long, words)| (*long, *words));
        assert_eq!(
            long.len(),
            long_allowed,
            "{name}, sentences of more than {MOST_WORDS} words: {long:#?}"
        );
        assert_eq!(
            found.len(),
            words_allowed,
            "{name}, words that docs/STYLE.md replaces: {found:?}"
        );
        let mean = sentences.iter().map(Vec::len).sum::<usize>() as f64 / sentences.len().max(1) as f64;
        assert!(
            allowed.is_some() || mean < MEAN_WORDS,
            "{name}: {mean:.1} words a sentence in the mean"
        );
    }
}

/// Names that other programs give their inputs.
const NAMES_OF_OTHERS: [&str; 2] = ["Base Color", "Emission Color"];

/// The sources below a folder.
pub fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => sources(&path, found),
            false if path.extension().is_some_and(|ending| ending == "rs") => found.push(path),
            false => {}
        }
    }
}

/// The texts in quotes of a line of code.
fn quoted(line: &str) -> Vec<String> {
    let line = line.replace("\\\"", "'");
    line.split('"').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The words of a text in lower case; code, options and what formats fill in as they are: `base.color` is one word.
fn whole_words(text: &str) -> String {
    let text = replaced(text, '`', "code").to_lowercase();
    let is_mark = |c: char| !c.is_alphanumeric() && !matches!(c, '-' | '{' | '}');
    let words = text
        .split_whitespace()
        .map(|word| word.trim_matches(is_mark).trim_end_matches("'s"));
    format!(" {} ", words.collect::<Vec<_>>().join(" "))
}

/// Messages, help and labels: text that is no name, which has a blank or begins with a capital letter. Tests are left out.
#[test]
fn texts_and_comments_keep_to_the_table() {
    let private = private_words();
    let mut files = Vec::new();
    sources(&root().join("src"), &mut files);
    let (mut found, mut long) = (Vec::new(), Vec::new());
    for file in files {
        let name = file
            .strip_prefix(root())
            .unwrap()
            .display()
            .to_string()
            .replace('\\', "/");
        let text = std::fs::read_to_string(&file).unwrap();
        // Texts go on behind a backslash at the end of a line.
        let joined = text.replace("\\\n", " ");
        for line in joined.lines().take_while(|line| !line.starts_with("#[cfg(test)]")) {
            let texts = match line.trim_start().strip_prefix("//") {
                Some(comment) => vec![comment.to_owned()],
                None => quoted(line),
            };
            let is_label = |text: &str| text.starts_with(char::is_uppercase) && text.contains(char::is_lowercase);
            let is_said = |text: &&String| !text.starts_with('<') && (text.contains(' ') || is_label(text));
            let said = texts
                .iter()
                .filter(is_said)
                .filter(|text| !NAMES_OF_OTHERS.contains(&text.as_str()));
            let is_generator = name.contains("/generated_");
            for text in said.clone().filter(|_| !is_generator) {
                let sentences = sentences(text).into_iter();
                long.extend(
                    sentences
                        .filter(|words| words.len() > MOST_WORDS)
                        .map(|words| words.join(" ")),
                );
            }
            for text in said.map(|text| whole_words(text)) {
                let words = private.iter().filter(|word| text.contains(&format!(" {word} ")));
                found.extend(words.map(|word| format!("{name}: {word}: {}", text.trim())));
            }
        }
    }
    assert!(found.is_empty(), "words that docs/STYLE.md replaces: {found:#?}");
    assert!(long.is_empty(), "sentences of more than {MOST_WORDS} words: {long:#?}");
}
