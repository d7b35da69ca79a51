//! The options that stand for the settings of a document: one for each line of the table that has a flag.

use std::{iter, sync::LazyLock};

use clap::{Arg, ArgMatches, Args, Command, Error, FromArgMatches, parser::ValueSource};

use crate::document::{Document, Kind, Parameter, SETTINGS, Value};

/// Options that can't be given together.
const CONFLICTS: [[&str; 2]; 1] = [["camera-distance", "camera-position"]];

/// The settings that were given on the command line; those that were not are as the document has them.
#[derive(Clone, Debug, Default)]
pub struct SettingOptions {
    given: Vec<(&'static Parameter<Document>, Value)>,
}

impl SettingOptions {
    /// Sets what was given.
    pub fn apply(&self, document: &mut Document) -> anyhow::Result<()> {
        for (setting, value) in &self.given {
            setting.set(document, value.clone())?;
        }
        Ok(())
    }

    /// Whether the setting of this key was given, and not as what is left to the program.
    pub fn has(&self, key: &str) -> bool {
        let is_it = |(setting, value): &(&Parameter<Document>, Value)| setting.key == key && *value != Value::Absent;
        self.given.iter().any(is_it)
    }
}

impl FromArgMatches for SettingOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut options = Self::default();
        options.update_from_arg_matches(matches)?;
        Ok(options)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        for setting in SETTINGS.iter() {
            let Some(flag) = setting.flag else { continue };
            if matches.value_source(flag) == Some(ValueSource::CommandLine)
                && let Some(value) = matches.get_one::<Value>(flag)
            {
                self.given.push((setting, value.clone()));
            }
        }
        Ok(())
    }
}

impl Args for SettingOptions {
    fn augment_args(command: Command) -> Command {
        let command = command.args(iter::zip(SETTINGS.iter(), TEXTS.iter()).filter_map(option));
        let conflict = |command: Command, [one, other]: [&'static str; 2]| {
            command.mut_arg(one, |option| option.conflicts_with(other))
        };
        CONFLICTS.into_iter().fold(command, conflict)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

/// What stands for the values of each setting, and its default: clap wants texts that live as long as the program.
static TEXTS: LazyLock<Vec<[String; 2]>> = LazyLock::new(|| {
    let texts = |setting: &Parameter<Document>| [setting.kind.placeholder(), setting.text(&setting.default_value())];
    SETTINGS.iter().map(texts).collect()
});

/// The option of a setting, where it has one.
fn option((setting, [placeholder, default]): (&'static Parameter<Document>, &'static [String; 2])) -> Option<Arg> {
    let flag = setting.flag?;
    let parse = |text: &str| setting.parse(text).map_err(|_| setting.expected());
    let option = Arg::new(flag)
        .long(flag)
        .help(setting.help.trim_end_matches('.'))
        .value_name(placeholder.as_str())
        .value_parser(parse)
        .default_value(default.as_str())
        .allow_negative_numbers(true)
        // Coordinates begin with a minus sign but are no number.
        .allow_hyphen_values(placeholder.contains(','));
    Some(match setting.kind {
        // `--ground` alone says on.
        Kind::Toggle => option.num_args(0..=1).require_equals(true).default_missing_value("on"),
        _ => option,
    })
}
