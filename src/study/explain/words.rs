//! The account of a path in words, a line an event.

use std::fmt::{self, Display, Formatter};

use serde_json::Value as Json;

use super::PathAccount;
use crate::cpu::recorder::Event;

/// Width of the column of events.
const HEAD: usize = 11;

impl PathAccount {
    /// The account in lines.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![self.title()];
        let mut numbers = Vec::new();
        for event in &self.events {
            if let Event::Number { .. } = event {
                numbers.push(event);
                continue;
            }
            if matches!(event, Event::Camera { .. } | Event::Hit { .. }) {
                lines.push(String::new());
            }
            let (head, text) = self.words(event);
            if !numbers.is_empty() {
                lines.push(line("numbers", &self.drawn(&std::mem::take(&mut numbers))));
            }
            lines.push(line(&head, &text));
        }
        lines.push(String::new());
        lines.push(line("sum", &self.outcome()));
        lines
    }

    fn title(&self) -> String {
        let ([x, y], [width, height]) = (self.pixel, self.image_size);
        format!(
            "Sample {} of pixel {x},{y} of {width} x {height}; seed {}, {} numbers, strategy {}, at most {} bounces. \
             Lengths are in the model's units, densities per steradian.",
            self.sample,
            self.seed,
            self.sequence.name(),
            self.strategy.name(),
            self.bounces
        )
    }

    /// The sample's radiance in full precision.
    fn outcome(&self) -> String {
        let [r, g, b] = self.radiance;
        let count = self.contributions().count();
        let mut text = format!(
            "({r}, {g}, {b}) of {}, {}",
            counted(count, "contribution"),
            counted(self.rays as usize, "ray")
        );
        if self.alpha < 1.0 {
            text += &format!(", alpha {}", self.alpha);
        }
        if self.clamped > 0.0 {
            text += &format!("; limiting fireflies took a luminance of {}", short(self.clamped));
        }
        if self.is_dropped {
            text += "; left out of the image, as it is negative or not finite";
        }
        text
    }

    /// What an event is called, and its words.
    fn words(&self, event: &Event) -> (String, String) {
        let (head, words) = template(event);
        let fields = serde_json::to_value(event).unwrap_or_default();
        let mut pieces = words.split('{');
        let mut text = pieces.next().unwrap_or_default().to_owned();
        for piece in pieces {
            let (field, rest) = piece.split_once('}').unwrap_or_default();
            text += &self.field(field, &fields[field]);
            text += rest;
        }
        (head, text)
    }

    /// Random numbers by what they are drawn for.
    fn drawn(&self, numbers: &[&Event]) -> String {
        let (mut text, mut last) = (String::new(), String::new());
        for event in numbers {
            let Event::Number {
                dimension, half, value, ..
            } = event
            else {
                continue;
            };
            let (_, purpose) = self.words(event);
            if purpose != last {
                let separator = if last.is_empty() { "" } else { "; " };
                text += &format!("{separator}{purpose}");
            }
            text += &format!(" {value:.4} [{dimension}:{half}]");
            last = purpose;
        }
        text
    }

    fn field(&self, name: &str, value: &Json) -> String {
        match value {
            Json::Array(parts) => {
                let parts = parts.iter().map(|part| self.field("", part));
                format!("({})", crate::named::joined(parts, ", "))
            }
            Json::String(word) => {
                let row = WORDS.iter().find(|row| row.0 == name && row.1 == word);
                row.map_or(word.as_str(), |row| row.2).to_owned()
            }
            Json::Number(number) => match (name, number.as_u64()) {
                ("slot", Some(slot)) => self
                    .surfaces
                    .get(slot as usize)
                    .cloned()
                    .unwrap_or("a surface".to_owned()),
                (_, Some(whole)) => whole.to_string(),
                _ => short(number.as_f64().unwrap_or(f64::NAN) as f32),
            },
            // JSON has no other numbers.
            _ => "NaN".to_owned(),
        }
    }
}

impl Display for PathAccount {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.lines().iter().try_for_each(|line| writeln!(f, "{line}"))
    }
}

fn line(head: &str, text: &str) -> String {
    format!("{head:HEAD$} {text}")
}

/// Words of fields, where they are not the values' own.
const WORDS: [(&str, &str, &str); 8] = [
    ("source", "environment", "the environment"),
    ("source", "surface", "a surface that emits"),
    ("source", "background", "the background"),
    ("why", "left", "met nothing more"),
    ("why", "bounces", "has all the bounces that it may have"),
    ("why", "absorbed", "nothing is reflected into the direction drawn"),
    ("why", "roulette", "Russian roulette"),
    ("purpose", "below", "below the lobe"),
];

/// What an event is called, and its words with its fields in braces.
fn template(event: &Event) -> (String, String) {
    let (name, words) = match event {
        Event::Number { .. } => ("number", "{purpose}"),
        Event::Camera { .. } => ("camera", "from {origin} along {direction}"),
        Event::Passed { .. } => ("passed", "{slot} after {distance}, opacity {opacity}"),
        Event::Hit { bounce, is_inside, .. } => {
            let side = if *is_inside { "back" } else { "front" };
            let end = "of triangle {triangle}, normal {normal}, shading normal {shading_normal}";
            return (
                format!("bounce {bounce}"),
                ["{slot} after {distance} at {position},", side, end].join(" "),
            );
        }
        Event::CatcherHit { is_mirrored: true, .. } => {
            ("caught", "mirrors what is above, or shows the background, {background}")
        }
        Event::CatcherHit { .. } => (
            "caught",
            "shows the background, {background}, as far as light arrives: {light} if nothing stood in its way",
        ),
        Event::Absorption { .. } => ("absorbed", "over {distance} inside: {kept} of the light is left"),
        Event::LightHit { light_density, .. } if *light_density > 0.0 => (
            "met light",
            "{source}, radiance {radiance}, MIS weight {weight}, lobe density {lobe_density} against light density \
             {light_density}",
        ),
        Event::LightHit { .. } => ("met light", "{source}, radiance {radiance}, MIS weight {weight}"),
        Event::Light { weight, visible, .. } => {
            let arrives = match visible {
                _ if *weight == [0.0; 3] => ": nothing is reflected from there",
                0.0 => ", lobe value {value}, MIS weight {weight}: in shadow",
                1.0 => ", lobe value {value}, MIS weight {weight}: radiance {radiance}",
                _ => ", lobe value {value}, MIS weight {weight}: radiance {radiance}, of which {visible} arrives",
            };
            return (
                "to light".to_owned(),
                "{source} along {direction}, density {density}".to_owned() + arrives,
            );
        }
        Event::Scattered {
            layer,
            probabilities,
            density,
            is_mirror,
            ..
        } => {
            let possible = probabilities.iter().filter(|chance| chance.probability > 0.0);
            let choice: Vec<_> = possible
                .map(|chance| format!("{} {}", chance.layer.label(), short(chance.probability)))
                .collect();
            let density = match (is_mirror, *density > 0.0) {
                (true, _) => ", as by a mirror",
                (_, true) => ", density {density}",
                _ => "",
            };
            let start = format!("by the {} (of {}) along ", layer.label(), choice.join(", "));
            let end = ", factor {factor}; throughput {throughput}";
            return ("scattered".to_owned(), [&start, "{direction}", density, end].concat());
        }
        Event::Roulette { .. } => ("roulette", "goes on with probability {survival}: {number} was drawn"),
        Event::Contribution {
            reflections,
            found,
            added,
            ..
        } => {
            let limited = match added {
                _ if found == added => "",
                [0.0, 0.0, 0.0] => ": {found} is not of the light that is shown",
                _ => ", limited from {found}",
            };
            let reflections = counted(*reflections as usize, "reflection");
            return (
                "+".to_owned(),
                ["{added} from {source} after ", &reflections, limited].concat(),
            );
        }
        Event::Ended { .. } => ("end", "{why}"),
    };
    (name.to_owned(), words.to_owned())
}

fn counted(count: usize, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}

/// Four digits, or scientific notation for very small or large numbers.
fn short(value: f32) -> String {
    if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) {
        format!("{value:.3e}")
    } else {
        format!("{value:.4}")
    }
}
