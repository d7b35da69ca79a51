//! The tables of the book that are made from the registries hold what the program has, to the letter; `UPDATE_DOCS=1 cargo
//! test docs` writes them again.

use std::{fmt::Write as _, path::Path};

use clap::{Arg, ArgAction, Command, CommandFactory};
use glossmith::{
    cli::Arguments,
    document::{Kind, PARAMETERS, Parameter, SETTINGS, TEXTURE_PARAMETERS, effect::EFFECTS, parameter},
    import::{FBX_PARAMETERS, FileParameter, GLTF_PARAMETERS, Goes, MTL_PARAMETERS},
    optics::{
        curve::Curve,
        fresnel::Fresnel,
        lobe::Lobe,
        tone::{ToneCurve, srgb_from_linear},
        vector::Vec3,
    },
    store::{
        PRESETS,
        exchange::{FORMATS, Registered, SURFACES},
        file_kind::FileKind,
        preset::{command_line_name, source_of_values},
    },
};

use super::{
    cli_support::Workplace,
    docs::{pages, root, text_of},
    docs_commands::{arguments, commands},
};

const BEGIN: &str = "<!-- made from the program: ";
const END: &str = "<!-- end -->";

/// Text that may stand in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

pub fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut text = format!("| {} |\n|{}\n", head.join(" | "), " --- |".repeat(head.len()));
    for row in rows {
        let cells: Vec<_> = row.iter().map(|text| cell(text)).collect();
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
    text
}

fn parameters<T: Default>(all: &[Parameter<T>]) -> String {
    let row = |parameter: &Parameter<T>| {
        let expected = parameter.expected();
        let default = parameter.text(&parameter.default_value());
        vec![
            format!("`{}`", parameter.key),
            expected.strip_prefix("give ").unwrap_or(&expected).to_owned(),
            if default.chars().count() > 24 {
                String::new()
            } else {
                format!("`{default}`")
            },
            parameter.help.to_owned(),
        ]
    };
    table(&["key", "takes", "default", "what it does"], all.iter().map(row))
}

fn choices(entries: impl Iterator<Item = (&'static str, &'static str)>) -> String {
    table(
        &["name", "what it is"],
        entries.map(|(name, help)| vec![format!("`{name}`"), help.to_owned()]),
    )
}

fn curves() -> String {
    let row = |curve: &Curve| {
        vec![
            format!("`{}`", curve.name()),
            curve.formula().to_owned(),
            curve.help().to_owned(),
        ]
    };
    table(&["name", "D(ξ)", "what it does"], Curve::ALL.iter().map(row))
}

fn horizons() -> String {
    match &parameter("specular.horizon").unwrap().kind {
        Kind::Choice(all) => choices(all.iter().map(|choice| (choice.name, choice.help))),
        _ => panic!("the horizon is a choice"),
    }
}

fn effects() -> String {
    let row = |effect: &glossmith::document::effect::Effect| {
        vec![
            format!("`{}`", effect.name()),
            effect.help.to_owned(),
            effect
                .id
                .constant()
                .map_or_else(String::new, |constant| format!("`{}`", constant.name)),
            if effect.id.is_needed() { "no" } else { "yes" }.to_owned(),
        ]
    };
    table(
        &["name", "what it is", "constant", "can be removed"],
        EFFECTS.iter().map(row),
    )
}

fn presets() -> String {
    let row = |material: &glossmith::document::MaterialSettings| {
        let text = |key: &str| {
            let parameter = parameter(key).unwrap();
            parameter.text(&parameter.get(material))
        };
        let of_reflection = |key: &str| match material.specular_weight > 0.0 {
            true => text(key),
            false => "–".to_owned(),
        };
        let name = command_line_name(&material.name);
        vec![
            format!("![{name}](../pictures/presets/{name}.png)"),
            format!("`{name}`"),
            hex(material.base_color),
            text("base.metalness"),
            of_reflection("specular.roughness"),
            of_reflection("specular.fresnel"),
            source_of_values(&material.name).unwrap_or_default().to_owned(),
        ]
    };
    table(
        &[
            "look",
            "name",
            "base colour",
            "metalness",
            "roughness",
            "Fresnel",
            "where its values come from",
        ],
        PRESETS.iter().map(row),
    )
}

fn file_kinds() -> String {
    let row = |kind: &FileKind| {
        let endings: Vec<String> = kind.endings().iter().map(|ending| format!("`.{ending}`")).collect();
        vec![kind.label().to_owned(), endings.join(" "), kind.help().to_owned()]
    };
    table(&["kind", "endings", "what it is"], FileKind::ALL.iter().map(row))
}

fn formats() -> String {
    let row = |format: &Registered| {
        let endings: Vec<String> = format.extensions.iter().map(|ending| format!("`.{ending}`")).collect();
        let mark = |is_so: bool| if is_so { "yes" } else { "" }.to_owned();
        vec![
            format!("`{}`", format.name),
            endings.join(" "),
            mark(format.is_read()),
            mark(true),
            format.help.to_owned(),
        ]
    };
    table(
        &["format", "endings", "read", "written", "what it is"],
        FORMATS.iter().map(row),
    )
}

/// `#rrggbb` in sRGB of a linear colour.
fn hex(color: [f32; 3]) -> String {
    let srgb = srgb_from_linear(Vec3::<f32>::from_f32(color)).to_f32();
    let [r, g, b] = srgb.map(|x| (255.0 * x).round() as u8);
    format!("`#{r:02x}{g:02x}{b:02x}`")
}

/// A command by its name; the program itself without one.
fn command(name: &str) -> Command {
    name.split_whitespace().fold(Arguments::command(), |command, word| {
        let found = command.get_subcommands().find(|command| command.get_name() == word);
        found
            .unwrap_or_else(|| panic!("there is no command {word} in '{name}'"))
            .clone()
    })
}

/// The options of a command: option, default, what it does.
fn option_rows(command: &Command) -> Vec<Vec<String>> {
    let is_shown = |argument: &&Arg| !matches!(argument.get_action(), ArgAction::Help | ArgAction::Version);
    let row = |argument: &Arg| {
        let values: Vec<_> = argument
            .get_value_names()
            .into_iter()
            .flatten()
            .map(|name| name.to_string())
            .collect();
        let long = argument.get_long().map_or_else(String::new, |long| format!("--{long}"));
        let values = if argument.get_action().takes_values() {
            values.join(" ")
        } else {
            String::new()
        };
        let defaults: Vec<_> = argument
            .get_default_values()
            .iter()
            .map(|value| value.to_string_lossy())
            .collect();
        let default = defaults.join(" ");
        let is_flag = default.is_empty() || !argument.get_action().takes_values();
        vec![
            format!("`{}`", format!("{long} {values}").trim()),
            if is_flag { String::new() } else { format!("`{default}`") },
            argument.get_help().map(ToString::to_string).unwrap_or_default(),
        ]
    };
    command.get_arguments().filter(is_shown).map(row).collect()
}

/// The options of a subcommand, or what it offers where it has subcommands itself; of the program itself without a name.
/// Those that are the same as render's are named only.
fn options(name: &str) -> String {
    let of = command(name);
    if of.has_subcommands() && !name.is_empty() {
        let row = |command: &Command| {
            let help = command.get_about().map(ToString::to_string).unwrap_or_default();
            vec![format!("`{}`", command.get_name()), help]
        };
        return table(&["command", "what it does"], of.get_subcommands().map(row));
    }
    let of_render = if name == "render" {
        Vec::new()
    } else {
        option_rows(&command("render"))
    };
    let (shared, own): (Vec<_>, Vec<_>) = option_rows(&of).into_iter().partition(|row| of_render.contains(row));
    let mut text = table(&["option", "default", "what it does"], own);
    let rest: Vec<_> = of_render.iter().filter(|row| !shared.contains(row)).cloned().collect();
    let names = |rows: &[Vec<String>]| {
        let names: Vec<_> = rows.iter().map(|row| format!("`{}`", option_name(&row[0]))).collect();
        names.join(", ")
    };
    let _ = match (shared.len(), rest.len()) {
        (0, _) => Ok(()),
        (shared_count, rest_count) if shared_count <= rest_count => {
            writeln!(text, "\nAs for [render](render.md#options): {}.", names(&shared))
        }
        _ => writeln!(
            text,
            "\nAnd all options of [render](render.md#options) but {}.",
            names(&rest)
        ),
    };
    text
}

/// `--size` of "`--size WxH`".
fn option_name(option: &str) -> &str {
    option.trim_matches('`').split(' ').next().unwrap_or_default()
}

fn range(parameter: &FileParameter) -> String {
    parameter
        .range
        .map_or(String::new(), |[least, most]| format!("from {least} to {most}"))
}

fn layer(parameter: &FileParameter) -> String {
    match parameter.layer {
        "" => String::new(),
        layer => format!("part of `{layer}`"),
    }
}

/// What becomes of the inputs of a kind of surface in MaterialX.
fn surface_inputs(name: &str) -> String {
    let kind = SURFACES.iter().find(|kind| kind.name == name);
    file_parameters(kind.expect("a kind of surface").inputs)
}

/// What becomes of the parameters of a file.
fn file_parameters(all: &[FileParameter]) -> String {
    let row = |parameter: &FileParameter| {
        let goes = match parameter.goes {
            Goes::To(to) => to.to_owned(),
            Goes::Kept("") => String::new(),
            Goes::Kept(key) => format!("kept as `{key}`, not shown yet"),
            Goes::Nowhere(what) => format!("ignored: {what}"),
        };
        let place = parameter
            .place
            .trim_start_matches("/extensions")
            .trim_start_matches('/');
        vec![
            format!("`{}`", place.replace('/', ".")),
            goes,
            [parameter.note.to_owned(), range(parameter), layer(parameter)]
                .into_iter()
                .filter(|words| !words.is_empty())
                .collect::<Vec<_>>()
                .join("; "),
        ]
    };
    table(&["parameter", "goes to", "report"], all.iter().map(row))
}

/// What the command of the page on a pixel prints: up to the first contribution, and from the last random number on.
fn path_explained() -> String {
    let command = &commands(&text_of(Path::new("docs/how-to/explain.md")))[0];
    let told = Workplace::new().done(&arguments(command)[1..].join(" ")).stdout;
    let (start, rest) = told.split_once("\n+").expect("a contribution");
    let (added, rest) = rest.split_once('\n').expect("more");
    let end = rest.rfind("\nnumbers").expect("a random number");
    format!("```text\n{start}\n+{added}\n…{}\n```\n", rest[end..].trim_end())
}

fn block(name: &str) -> String {
    match name {
        "parameters" => parameters(&PARAMETERS),
        "settings" => parameters(&SETTINGS),
        "texture parameters" => parameters(&TEXTURE_PARAMETERS),
        "lobes" => choices(Lobe::ALL.iter().map(|lobe| (lobe.name(), lobe.help()))),
        "curves" => curves(),
        "fresnel" => choices(Fresnel::ALL.iter().map(|fresnel| (fresnel.name(), fresnel.help()))),
        "horizons" => horizons(),
        "tone curves" => choices(ToneCurve::ALL.iter().map(|tone| (tone.name(), tone.help()))),
        "effects" => effects(),
        "presets" => presets(),
        "formats" => formats(),
        "kinds of files" => file_kinds(),
        "parameters of glTF" => file_parameters(GLTF_PARAMETERS),
        "maps of FBX" => file_parameters(FBX_PARAMETERS),
        "keywords of MTL" => file_parameters(MTL_PARAMETERS),
        "results" => super::docs_results::table_of_results(),
        "a path" => path_explained(),
        name => match (
            name.strip_prefix("inputs of "),
            name.strip_prefix("options of glossmith"),
        ) {
            (Some(kind), _) => surface_inputs(kind),
            (_, Some(command)) => options(command.trim()),
            _ => panic!("the guide asks for '{name}', which nobody makes"),
        },
    }
}

/// A page with its made parts as they should be. The table of hard cases is another test's (`hard`).
fn made_again(page: &str) -> String {
    let mut parts = page.split(BEGIN);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once(" -->").expect("a name ends with -->");
        let (made, rest) = rest.split_once(END).expect("a made part ends with <!-- end -->");
        let _ = match name {
            "hard cases" => write!(text, "{BEGIN}{name} -->{made}{END}{rest}"),
            _ => write!(text, "{BEGIN}{name} -->\n\n{}\n{END}{rest}", block(name)),
        };
    }
    text
}

#[test]
fn the_book_has_what_the_program_has() {
    for page in pages() {
        let found = text_of(&page);
        let expected = made_again(&found);
        if std::env::var_os("UPDATE_DOCS").is_some() {
            if found != expected {
                std::fs::write(root().join(&page), &expected).unwrap();
            }
            continue;
        }
        let differs = found
            .lines()
            .zip(expected.lines())
            .position(|(found, expected)| found != expected);
        assert!(
            found == expected,
            "{}, line {}: run UPDATE_DOCS=1 cargo test --release -p glossmith-tests docs",
            page.display(),
            1 + differs.unwrap_or_default()
        );
    }
}

#[test]
fn the_book_has_every_part() {
    let book: String = pages().iter().map(|page| text_of(page)).collect();
    let mut wanted = Vec::new();
    for command in Arguments::command().get_subcommands() {
        let name = format!("options of glossmith {}", command.get_name());
        wanted.extend(
            command
                .get_subcommands()
                .map(|study| format!("{name} {}", study.get_name())),
        );
        wanted.push(name);
    }
    for name in wanted {
        assert!(
            book.contains(&format!("{BEGIN}{name} -->")),
            "no page of the book has the part '{name}'"
        );
    }
}
