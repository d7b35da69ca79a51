//! Both engines on the same random numbers, pixel by pixel: they trace the same paths but for rounding, and where they do
//! not, the account of the processor's path says at which event they part.

use crate::renders::adjust;
use std::time::Duration;

use glossmith::{
    cpu::recorder::Event,
    document::{Document, effect::EffectSwitches},
    job::film::Film,
    render::{Assets, EngineChoice, Session},
    scene::{Model, ModelSource},
    study::explain::{PathAccount, explain},
};

/// Radiances that count as the same, relative to the larger one and to the picture's mean.
const SAME: f64 = 0.002;

/// Both engines, side by side.
pub struct Pair {
    assets: Assets,
    cpu: Session,
    gpu: Session,
}

/// How far two engines are apart.
#[derive(Clone, Copy, Debug)]
struct Apart {
    /// The share of pixels that are off.
    pixels: f64,
    /// The whole image, relative.
    whole: f64,
    /// The pixel that is off the most.
    worst: [u32; 2],
}

impl Pair {
    pub fn open() -> Self {
        let assets = Assets::default();
        let open = |choice| Session::open_with(choice, assets.clone()).expect("an engine: install mesa-vulkan-drivers");
        Self {
            cpu: open(EngineChoice::Cpu),
            gpu: open(EngineChoice::Gpu),
            assets,
        }
    }

    /// Makes a model available by a name.
    pub fn keep(&self, source: &ModelSource, model: Option<Model>) {
        if let Some(model) = model {
            self.assets.keep_model(source.clone(), model);
        }
    }

    fn films(&mut self, document: &Document) -> [Film; 2] {
        let mut document = document.clone();
        // One kernel for all documents.
        document.render.effects = EffectSwitches::all_on();
        [&mut self.cpu, &mut self.gpu].map(|session| {
            session.reset();
            session.submit(&document).unwrap();
            while !session.step(Duration::from_secs(1)).unwrap().is_done {}
            session.film().unwrap().clone()
        })
    }

    /// Compares a document's pictures.
    fn compare(&mut self, document: &Document) -> Apart {
        let [cpu, gpu] = self.films(document);
        assert_eq!((cpu.dropped(), gpu.dropped()), (0, 0));
        let pixels = cpu.pixel_count();
        let sum = |film: &Film| -> f64 { (0..pixels).map(|i| film.color(i)[..3].iter().sum::<f64>()).sum() };
        let total = sum(&cpu);
        let mean = total / (3 * pixels) as f64;
        let difference = |i: usize| {
            let channels = cpu.color(i).into_iter().zip(gpu.color(i));
            let relative = channels.map(|(a, b)| (a - b).abs() / a.max(b).max(mean).max(1e-12));
            relative.fold(0.0, f64::max)
        };
        let off: Vec<f64> = (0..pixels).map(difference).collect();
        let worst = (0..pixels)
            .max_by(|a, b| off[*a].total_cmp(&off[*b]))
            .unwrap_or_default() as u32;
        let other = sum(&gpu);
        Apart {
            pixels: off.iter().filter(|off| **off > SAME).count() as f64 / pixels as f64,
            whole: (other / total - 1.0).abs(),
            worst: [worst % cpu.width, worst / cpu.width],
        }
    }

    /// Fails unless at most a share of the pixels is off, and the whole by no more than `whole`; says where the worst
    /// pixel's paths part.
    #[track_caller]
    pub fn assert_same_paths(&mut self, document: &Document, [pixels, whole]: [f64; 2], what: &str) {
        let apart = self.compare(document);
        println!(
            "{what}: {:.2} % of pixels off, the whole by {:.1e}",
            100.0 * apart.pixels,
            apart.whole
        );
        if apart.pixels > pixels || apart.whole > whole {
            panic!(
                "{what}: {:.1} % of pixels are off, the whole by {:.2e}\n{}",
                100.0 * apart.pixels,
                apart.whole,
                self.parting(document, apart.worst)
            );
        }
    }

    /// Where the engines part on the first samples of a pixel: the fewest bounces with which they differ, and what the
    /// processor's path did from there on.
    fn parting(&mut self, document: &Document, pixel: [u32; 2]) -> String {
        let mut document = document.clone();
        let index = (pixel[1] * document.render.width + pixel[0]) as usize;
        let samples = document.render.samples;
        for bounces in 1..=document.render.bounces {
            for count in 1..=samples.min(4) {
                adjust(
                    &mut document,
                    &format!("render.bounces={bounces} render.samples={count}"),
                );
                let [cpu, gpu] = self.films(&document).map(|film| film.color(index));
                let is_same = cpu
                    .iter()
                    .zip(&gpu)
                    .all(|(a, b)| (a - b).abs() <= SAME * a.max(*b).max(1e-6));
                if !is_same {
                    let account = self.account(&document, pixel, count - 1);
                    let from = from_bounce(&account, bounces - 1);
                    return format!(
                        "they part at bounce {} of sample {} of pixel {pixel:?}: {cpu:?} against the GPU's {gpu:?}\n{}",
                        bounces - 1,
                        count - 1,
                        from.join("\n")
                    );
                }
            }
        }
        format!("pixel {pixel:?}: the first samples are the same")
    }

    /// The account of the processor's path.
    fn account(&mut self, document: &Document, pixel: [u32; 2], sample: u32) -> PathAccount {
        self.cpu.submit(document).unwrap();
        let model = self.assets.model(&document.model, &document.import).unwrap();
        explain(document, &model, self.cpu.job().unwrap(), pixel, sample)
    }
}

/// The lines of an account from its hit number `bounce` on; all where there is none.
fn from_bounce(account: &PathAccount, bounce: u32) -> Vec<String> {
    let lines = account.lines();
    let begins = |event: &Event| matches!(event, Event::Hit { bounce: of, .. } if *of == bounce);
    let is_there = account.events.iter().any(begins);
    let head = format!("bounce {bounce} ");
    let first = lines.iter().position(|line| is_there && line.starts_with(&head));
    lines[first.unwrap_or(0)..].to_vec()
}
