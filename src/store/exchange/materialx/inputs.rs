//! The inputs of a surface that a file sets, by the table of its kind, and what becomes of them.

use std::collections::BTreeMap;

use crate::{
    document::parameter,
    import::{FileParameter, Goes},
    store::exchange::{report::Entry, surface::Surface},
};

/// The inputs of a surface that a file sets, and what is lost of them.
pub struct Inputs {
    kind: &'static str,
    rows: &'static [FileParameter],
    values: BTreeMap<String, [f32; 3]>,
    /// What is approximated or left out.
    pub losses: Vec<Entry>,
}

impl Inputs {
    pub fn new(kind: &'static str, rows: &'static [FileParameter]) -> Self {
        Self {
            kind,
            rows,
            values: BTreeMap::new(),
            losses: Vec::new(),
        }
    }

    /// What the table says of an input.
    pub fn row(&self, name: &str) -> Option<&'static FileParameter> {
        self.rows.iter().find(|row| row.place == name)
    }

    pub fn set(&mut self, name: &str, value: [f32; 3]) {
        self.values.insert(name.to_owned(), value);
    }

    /// An input as a colour: the file's, or its default.
    pub fn color(&self, name: &str) -> [f32; 3] {
        let row = self.row(name);
        debug_assert!(row.is_some(), "{} has no {name} in its table", self.kind);
        let set = self.values.get(name).copied();
        set.or_else(|| row?.default_value()).unwrap_or_default()
    }

    /// An input as a number.
    pub fn number(&self, name: &str) -> f32 {
        self.color(name)[0]
    }

    /// A surface with the parameters that inputs are as they are.
    pub fn direct(&self) -> Surface {
        let mut surface = Surface::of_file();
        for row in self.rows.iter().filter(|row| !row.default.is_empty()) {
            if let Ok(parameter) = parameter(row.keys()[0]) {
                parameter.put_rgb(&mut surface, self.color(row.place).map(|x| x * row.per.recip()));
            }
        }
        surface
    }

    /// Brings what is set into its range, and reports that and what goes nowhere.
    pub fn settle(&mut self) {
        let mut entries = Vec::new();
        for (name, value) in self.values.clone() {
            let Some(row) = self.row(&name) else {
                entries.push(Entry::dropped(name, format!("{} has no such input", self.kind)));
                continue;
            };
            if !row.layer.is_empty() && self.color(row.layer) == [0.0; 3] {
                continue;
            }
            if let Goes::Nowhere(why) = row.goes
                && Some(value) != row.default_value()
            {
                entries.push(Entry::dropped(name, why));
            } else if let Some([least, most]) = row.range {
                let within = value.map(|x| x.clamp(least, most));
                if within != value {
                    let detail = format!("it is taken between {least} and {most}");
                    entries.push(Entry::approximated(name.as_str(), detail, None));
                    self.values.insert(name, within);
                }
            }
        }
        self.losses.extend(entries);
    }
}
