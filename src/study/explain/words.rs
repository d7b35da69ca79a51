//! The account of a path in words, a line an event.

use std::fmt::{self, Display, Formatter};

use super::PathAccount;
use crate::cpu::recorder::{End, Event, Purpose, Source};

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
            let [head, text] = self.words(event);
            if !numbers.is_empty() {
                lines.push(line("numbers", &drawn(&std::mem::take(&mut numbers))));
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

    fn surface(&self, slot: u32) -> &str {
        self.surfaces.get(slot as usize).map_or("a surface", String::as_str)
    }

    fn words(&self, event: &Event) -> [String; 2] {
        match event {
            Event::Number { .. } => ["number".into(), drawn(&[event])],
            Event::Camera { origin, direction } => [
                "camera".into(),
                format!("from {} along {}", vector(origin), vector(direction)),
            ],
            Event::Passed {
                slot,
                distance,
                opacity,
            } => [
                "passed".into(),
                format!(
                    "{} after {}, opacity {}",
                    self.surface(*slot),
                    short(*distance),
                    short(*opacity)
                ),
            ],
            Event::Hit { .. } => self.hit(event),
            Event::CatcherHit {
                is_mirrored,
                background,
                light,
                ..
            } => [
                "caught".into(),
                if *is_mirrored {
                    format!("mirrors what is above, or shows the background, {}", vector(background))
                } else {
                    format!(
                        "shows the background, {}, as far as light arrives: {} if nothing stood in its way",
                        vector(background),
                        vector(light)
                    )
                },
            ],
            Event::Absorption { distance, kept } => [
                "absorbed".into(),
                format!(
                    "over {} inside: {} of the light is left",
                    short(*distance),
                    vector(kept)
                ),
            ],
            Event::LightHit { .. } => found(event),
            Event::Light { .. } => light(event),
            Event::Scattered { .. } => scattered(event),
            Event::Roulette { survival, number } => [
                "roulette".into(),
                format!(
                    "goes on with probability {}: {} was drawn",
                    short(*survival),
                    short(*number)
                ),
            ],
            Event::Contribution { .. } => added(event),
            Event::Ended { why } => ["end".into(), end(*why).into()],
        }
    }

    fn hit(&self, event: &Event) -> [String; 2] {
        let Event::Hit {
            bounce,
            triangle,
            slot,
            distance,
            position,
            normal,
            shading_normal,
            is_inside,
        } = event
        else {
            return Default::default();
        };
        let side = if *is_inside { "back" } else { "front" };
        [
            format!("bounce {bounce}"),
            format!(
                "{} after {} at {}, {side} of triangle {triangle}, normal {}, shading normal {}",
                self.surface(*slot),
                short(*distance),
                vector(position),
                vector(normal),
                vector(shading_normal)
            ),
        ]
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

/// Numbers by purpose, each with its pair and half.
fn drawn(numbers: &[&Event]) -> String {
    let mut text = String::new();
    let mut last = None;
    for event in numbers {
        let Event::Number {
            dimension,
            half,
            value,
            purpose,
        } = event
        else {
            continue;
        };
        if last != Some(*purpose) {
            let separator = if last.is_some() { "; " } else { "" };
            text += &format!("{separator}{}", name(*purpose));
        }
        text += &format!(" {value:.4} [{dimension}:{half}]");
        last = Some(*purpose);
    }
    text
}

fn name(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Pixel => "pixel",
        Purpose::Lens => "lens",
        Purpose::Opacity => "opacity",
        Purpose::Lobe => "lobe",
        Purpose::Layer => "layer",
        Purpose::Below => "below the lobe",
        Purpose::Light => "light",
        Purpose::Roulette => "roulette",
        Purpose::Catcher => "catcher",
        Purpose::Blur => "blur",
        Purpose::Unused => "unused",
    }
}

fn of(source: Source) -> &'static str {
    match source {
        Source::Environment => "the environment",
        Source::Surface => "a surface that emits",
        Source::Background => "the background",
    }
}

fn end(why: End) -> &'static str {
    match why {
        End::Escaped => "met nothing more",
        End::Bounces => "has all the bounces that it may have",
        End::Absorbed => "nothing is reflected into the direction drawn",
        End::Roulette => "Russian roulette",
    }
}

fn found(event: &Event) -> [String; 2] {
    let Event::LightHit {
        source,
        radiance,
        lobe_density,
        light_density,
        weight,
    } = event
    else {
        return Default::default();
    };
    let competition = if *light_density > 0.0 {
        format!(
            ", lobe density {} against light density {}",
            short(*lobe_density),
            short(*light_density)
        )
    } else {
        String::new()
    };
    [
        "met light".into(),
        format!(
            "{}, radiance {}, MIS weight {}{competition}",
            of(*source),
            vector(radiance),
            short(*weight)
        ),
    ]
}

fn light(event: &Event) -> [String; 2] {
    let Event::Light {
        source,
        direction,
        density,
        value,
        weight,
        visible,
        radiance,
    } = event
    else {
        return Default::default();
    };
    let start = format!(
        "{} along {}, density {}",
        of(*source),
        vector(direction),
        short(*density)
    );
    let text = if *weight == [0.0; 3] {
        format!("{start}: nothing is reflected from there")
    } else {
        let arrives = match visible {
            0.0 => "in shadow".to_owned(),
            1.0 => format!("radiance {}", vector(radiance)),
            share => format!("radiance {}, of which {} arrives", vector(radiance), short(*share)),
        };
        format!(
            "{start}, lobe value {}, MIS weight {}: {arrives}",
            vector(value),
            vector(weight)
        )
    };
    ["to light".into(), text]
}

fn scattered(event: &Event) -> [String; 2] {
    let Event::Scattered {
        layer,
        probabilities,
        direction,
        factor,
        density,
        is_mirror,
        throughput,
    } = event
    else {
        return Default::default();
    };
    let possible = probabilities.iter().filter(|chance| chance.probability > 0.0);
    let choice: Vec<_> = possible
        .map(|chance| format!("{} {}", chance.layer.label(), short(chance.probability)))
        .collect();
    let density = match (is_mirror, *density > 0.0) {
        (true, _) => ", as by a mirror".to_owned(),
        (_, true) => format!(", density {}", short(*density)),
        _ => String::new(),
    };
    [
        "scattered".into(),
        format!(
            "by the {} (of {}) along {}{density}, factor {}; throughput {}",
            layer.label(),
            choice.join(", "),
            vector(direction),
            vector(factor),
            vector(throughput)
        ),
    ]
}

fn added(event: &Event) -> [String; 2] {
    let Event::Contribution {
        source,
        reflections,
        found,
        added,
    } = event
    else {
        return Default::default();
    };
    let limited = match added {
        _ if found == added => String::new(),
        // The firefly clamp never removes everything.
        [0.0, 0.0, 0.0] => format!(": {} is not of the light that is shown", vector(found)),
        _ => format!(", limited from {}", vector(found)),
    };
    [
        "+".into(),
        format!(
            "{} from {} after {}{limited}",
            vector(added),
            of(*source),
            counted(*reflections as usize, "reflection")
        ),
    ]
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

fn vector(value: &[f32; 3]) -> String {
    let [x, y, z] = value.map(short);
    format!("({x}, {y}, {z})")
}
