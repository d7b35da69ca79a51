//! Runs a WGSL function and its Rust twin on the same rows of inputs and compares what comes out.

use std::fmt::Write;

use glossmith::{
    gpu::shader::link_with,
    optics::real::Scalar,
    optics::vector::{Vec3, vec3},
};
use rayon::prelude::*;

use super::bench::{Bench, bench};
use crate::shaders::validate;

/// What twins may differ by, relative to the result's size.
const TOLERANCE: f64 = 1e-4;
/// How far inputs are moved to find how well-conditioned a function is: eight roundings of an f32.
const MOVE: f64 = 1.0 / (1 << 21) as f64;
/// How often they are moved.
const MOVES: u64 = 4;
/// Results of moved inputs count this many times: the few that are tried are not the worst ones.
const SAFETY: f64 = 4.0;
/// Rows drawn for each group, and how many of them must be well-conditioned.
const ROWS: usize = if cfg!(feature = "thorough") { 12_000 } else { 3_000 };
const ROWS_STRICT: usize = ROWS / 6 * 5;

/// Random numbers for the tests' inputs (Steele, Lea and Flood's splitmix64): not the code under test.
#[derive(Clone, Debug)]
pub struct Rng(u64);

impl Rng {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x2545_f491_4f6c_dd1d))
    }
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }
    pub fn bits(&mut self) -> u32 {
        (self.next() >> 32) as u32
    }
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }
    pub fn chance(&mut self, probability: f32) -> bool {
        self.unit() < probability
    }
    /// In [0, 1), of 24 bits, as the renderer draws them; its ends more often than by chance.
    pub fn unit(&mut self) -> f32 {
        let bits = self.bits();
        let number = match bits & 0xff {
            0 => 0,
            1 => 0x00ff_ffff,
            _ => self.bits() >> 8,
        };
        number as f32 / 16_777_216.0
    }
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }
    /// Uniform in the logarithm.
    pub fn log_range(&mut self, low: f32, high: f32) -> f32 {
        low * (high / low).powf(self.unit())
    }
    pub fn sign(&mut self) -> f32 {
        if self.bits() & 1 == 0 { 1.0 } else { -1.0 }
    }
    /// Uniform on the sphere; one in 64 along an axis.
    pub fn direction(&mut self) -> Vec3<f32> {
        if self.below(64) == 0 {
            let mut axis = [0.0; 3];
            axis[self.below(3)] = self.sign();
            return Vec3::from_f32(axis);
        }
        loop {
            let v: Vec3<f32> = vec3(self.range(-1.0, 1.0), self.range(-1.0, 1.0), self.range(-1.0, 1.0));
            let length = v.length();
            if length > 0.01 && length < 1.0 {
                return v.normalize();
            }
        }
    }
}

/// An input of a function.
#[derive(Clone, Copy, Debug)]
pub enum Value {
    /// A number whose rounding is relative to it.
    Number(f32),
    /// A number in [0, 1): stays there when it is moved.
    Unit(f32),
    /// A unit direction, or a point in a scene of size 1: the rounding of each component is relative to 1.
    Vector([f32; 3]),
    /// An index, or random bits: exact.
    Bits(u32),
}

impl From<Vec3<f32>> for Value {
    fn from(v: Vec3<f32>) -> Self {
        Self::Vector(v.to_f32())
    }
}
impl From<f32> for Value {
    fn from(x: f32) -> Self {
        Self::Number(x)
    }
}
impl From<u32> for Value {
    fn from(x: u32) -> Self {
        Self::Bits(x)
    }
}

/// The inputs of one call, each `.into()` a [`Value`].
macro_rules! inputs {
    ($($value:expr),* $(,)?) => { vec![$($crate::twins::harness::Value::from($value)),*] };
}
pub(crate) use inputs;

impl Value {
    fn wgsl_type(self) -> (&'static str, usize) {
        match self {
            Self::Number(_) | Self::Unit(_) => ("f32", 1),
            Self::Vector(_) => ("vec3f", 3),
            Self::Bits(_) => ("u32", 1),
        }
    }
    fn words(self, words: &mut Vec<u32>) {
        match self {
            Self::Number(x) | Self::Unit(x) => words.push(x.to_bits()),
            Self::Vector(v) => words.extend(v.map(f32::to_bits)),
            Self::Bits(x) => words.push(x),
        }
    }
}

/// A call seen from Rust: takes the inputs in their order, moved or as they are, and gives the outputs in theirs.
pub struct Row<'a, T> {
    values: std::slice::Iter<'a, Value>,
    moves: Option<Rng>,
    outputs: Vec<f64>,
    number: std::marker::PhantomData<T>,
}

impl<T: Scalar> Row<'_, T> {
    fn next(&mut self) -> Value {
        *self
            .values
            .next()
            .expect("the Rust twin takes an input more than there are")
    }
    /// ±1 where inputs are moved, else 0.
    fn movement(&mut self) -> f64 {
        self.moves.as_mut().map_or(0.0, |rng| f64::from(rng.sign())) * MOVE
    }
    pub fn number(&mut self) -> T {
        let movement = self.movement();
        match self.next() {
            Value::Number(x) => T::from_f64(f64::from(x) * (1.0 + movement)),
            Value::Unit(x) => T::from_f64((f64::from(x) + movement).clamp(0.0, 16_777_215.0 / 16_777_216.0)),
            other => panic!("the Rust twin takes {other:?} as a number"),
        }
    }
    pub fn numbers<const N: usize>(&mut self) -> [T; N] {
        [(); N].map(|()| self.number())
    }
    pub fn vector(&mut self) -> Vec3<T> {
        match self.next() {
            Value::Vector(v) => {
                let moved = v.map(|x| f64::from(x) + self.movement());
                Vec3::from_f64(moved)
            }
            other => panic!("the Rust twin takes {other:?} as a vector"),
        }
    }
    pub fn bits(&mut self) -> u32 {
        match self.next() {
            Value::Bits(x) => x,
            other => panic!("the Rust twin takes {other:?} as bits"),
        }
    }
    pub fn put(&mut self, x: T) {
        self.outputs.push(x.to_f64());
    }
    pub fn put_vector(&mut self, v: Vec3<T>) {
        self.outputs.extend(v.to_f64());
    }
    pub fn put_numbers<const N: usize>(&mut self, numbers: [T; N]) {
        numbers.into_iter().for_each(|x| self.put(x));
    }
    pub fn put_bits(&mut self, x: u32) {
        self.outputs.push(f64::from(x));
    }
}

/// How an output is compared.
#[derive(Clone, Copy, Debug)]
pub enum Output {
    /// u32: equal to the bit.
    Exact,
    /// f32, with the scale below which differences are absolute.
    Number(f64),
    /// vec3f, by the length of the difference.
    Vector(f64),
}

impl Output {
    fn width(self) -> usize {
        if matches!(self, Self::Vector(_)) { 3 } else { 1 }
    }
}

/// The Rust side of a pair of twins.
#[derive(Clone, Copy)]
pub struct Twin {
    single: fn(&mut Row<'_, f32>),
    /// None for functions that exist in f32 only: their own f32 result is moved instead.
    double: Option<fn(&mut Row<'_, f64>)>,
}

impl Twin {
    pub fn generic(single: fn(&mut Row<'_, f32>), double: fn(&mut Row<'_, f64>)) -> Self {
        let double = Some(double);
        Self { single, double }
    }
    pub fn single(single: fn(&mut Row<'_, f32>)) -> Self {
        Self { single, double: None }
    }
    fn in_f32(self, values: &[Value]) -> Vec<f64> {
        call(self.single, values, None)
    }
    /// The outputs of the inputs moved by roundings; as they are for `which` = 0.
    fn moved(self, values: &[Value], which: u64) -> Vec<f64> {
        let moves = (which > 0).then(|| Rng::new(which));
        match self.double {
            Some(double) => call(double, values, moves),
            None => call(self.single, values, moves),
        }
    }
}

fn call<T: Scalar>(function: fn(&mut Row<'_, T>), values: &[Value], moves: Option<Rng>) -> Vec<f64> {
    let mut row = Row {
        values: values.iter(),
        moves,
        outputs: Vec::new(),
        number: std::marker::PhantomData,
    };
    function(&mut row);
    assert_eq!(row.values.len(), 0, "the Rust twin leaves inputs over");
    row.outputs
}

/// A Rust function over `row: &mut Row<'_, T>` for f32 and f64.
macro_rules! twin {
    (|$row:ident| $body:block) => {{
        fn twin<T: glossmith::optics::real::Scalar>($row: &mut $crate::twins::harness::Row<'_, T>) $body
        $crate::twins::harness::Twin::generic(twin::<f32>, twin::<f64>)
    }};
    // What is read, and what is put.
    ($($kind:ident $name:pat_param),+ => $($put:ident($value:expr)),+) => {
        twin!(|row| {
            $(let $name = row.$kind();)+
            $(row.$put($value);)+
        })
    };
}
pub(crate) use twin;

/// Draws the inputs of one call; also told its number.
type Draw = Box<dyn Fn(&mut Rng, usize) -> Vec<Value> + Sync>;

/// A pair of twins with the inputs to compare them on.
pub struct Case {
    name: &'static str,
    inputs: &'static str,
    wgsl: &'static str,
    outputs: Vec<(String, Output)>,
    twin: Twin,
    groups: Vec<(String, usize, Draw)>,
}

impl Case {
    /// `inputs`: names for `wgsl`, WGSL statements before the outputs' expressions.
    pub fn new(name: &'static str, inputs: &'static str, wgsl: &'static str, twin: Twin) -> Self {
        Self {
            name,
            inputs,
            wgsl,
            outputs: Vec::new(),
            twin,
            groups: Vec::new(),
        }
    }
    /// An expression of WGSL that the twin puts next.
    pub fn output(mut self, expression: impl Into<String>, output: Output) -> Self {
        self.outputs.push((expression.into(), output));
        self
    }
    /// A number that may be off by rounding of this scale.
    pub fn number(self, expression: impl Into<String>, scale: f64) -> Self {
        self.output(expression, Output::Number(scale))
    }
    /// Bits that are the same.
    pub fn exact(self, expression: impl Into<String>) -> Self {
        self.output(expression, Output::Exact)
    }
    /// Inputs of their own kind, each kind with enough of them to count by itself.
    pub fn group(self, name: &str, draw: impl Fn(&mut Rng, usize) -> Vec<Value> + Sync + 'static) -> Self {
        self.group_of(name, ROWS, draw)
    }
    /// The same, more of them: where many are ill-conditioned.
    pub fn group_of(
        mut self,
        name: &str,
        rows: usize,
        draw: impl Fn(&mut Rng, usize) -> Vec<Value> + Sync + 'static,
    ) -> Self {
        self.groups.push((name.to_owned(), rows, Box::new(draw)));
        self
    }

    fn output_words(&self) -> usize {
        self.outputs.iter().map(|(_, output)| output.width()).sum()
    }

    /// The entry point that maps rows of inputs to rows of outputs.
    fn entry_point(&self, number: usize) -> String {
        let mut sample = Rng::new(0);
        let values = self.groups[0].2(&mut sample, 0);
        let names: Vec<_> = self.inputs.split_whitespace().collect();
        assert_eq!(names.len(), values.len(), "{}: names of inputs, and inputs", self.name);
        let width: usize = values.iter().map(|value| value.wgsl_type().1).sum();
        let mut text = format!(
            "// {}\n@compute @workgroup_size(64)\nfn case_{number}(@builtin(global_invocation_id) id: vec3u) {{\n    \
             let row_in = id.x * {width}u;\n    if row_in >= arrayLength(&rows_in) {{ return; }}\n",
            self.name
        );
        let mut column = 0;
        for (name, value) in names.iter().zip(&values) {
            let word = |i: usize| format!("rows_in[row_in + {}u]", column + i);
            let _ = match value.wgsl_type() {
                ("u32", _) => writeln!(text, "    let {name} = {};", word(0)),
                ("f32", _) => writeln!(text, "    let {name} = bitcast<f32>({});", word(0)),
                _ => writeln!(
                    text,
                    "    let {name} = bitcast<vec3f>(vec3u({}, {}, {}));",
                    word(0),
                    word(1),
                    word(2)
                ),
            };
            column += value.wgsl_type().1;
        }
        let _ = writeln!(
            text,
            "    {}\n    let row_out = id.x * {}u;",
            self.wgsl,
            self.output_words()
        );
        let mut column = 0;
        for (expression, output) in &self.outputs {
            let _ = match output {
                Output::Exact => writeln!(text, "    rows_out[row_out + {column}u] = {expression};"),
                Output::Number(_) => writeln!(text, "    rows_out[row_out + {column}u] = bitcast<u32>({expression});"),
                Output::Vector(_) => writeln!(
                    text,
                    "    let out_{column} = bitcast<vec3u>({expression});\n    \
                     rows_out[row_out + {column}u] = out_{column}.x;\n    \
                     rows_out[row_out + {}u] = out_{column}.y;\n    rows_out[row_out + {}u] = out_{column}.z;",
                    column + 1,
                    column + 2,
                ),
            };
            column += output.width();
        }
        text + "}\n"
    }
}

/// What the comparison of a row found.
#[derive(Clone, Default)]
struct Found {
    is_strict: bool,
    /// Difference relative to the size; of strict rows.
    difference: f64,
    failure: Option<String>,
}

/// The words of a row as numbers.
fn decode(case: &Case, words: &[u32]) -> Vec<f64> {
    let kinds = case
        .outputs
        .iter()
        .flat_map(|(_, output)| std::iter::repeat_n(output, output.width()));
    let number = |(kind, &word): (&Output, &u32)| match kind {
        Output::Exact => f64::from(word),
        _ => f64::from(f32::from_bits(word)),
    };
    kinds.zip(words).map(number).collect()
}

fn length(a: &[f64]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    // Equal infinities are at distance 0.
    a.iter()
        .zip(b)
        .map(|(a, b)| if a == b { 0.0 } else { (a - b) * (a - b) })
        .sum::<f64>()
        .sqrt()
}

fn compare(case: &Case, values: &[Value], words: &[u32]) -> Found {
    let wgsl = decode(case, words);
    let rust = case.twin.in_f32(values);
    let still = case.twin.moved(values, 0);
    let moved: Vec<_> = (1..=MOVES).map(|which| case.twin.moved(values, which)).collect();
    assert_eq!(
        rust.len(),
        wgsl.len(),
        "{}: numbers from Rust, and from WGSL",
        case.name
    );
    let mut found = Found {
        is_strict: true,
        ..Default::default()
    };
    let mut first = 0;
    for (expression, output) in &case.outputs {
        let part = first..first + output.width();
        first = part.end;
        let (wgsl, rust, still) = (&wgsl[part.clone()], &rust[part.clone()], &still[part.clone()]);
        let difference = distance(wgsl, rust);
        let (allowed, size) = match *output {
            Output::Exact => (0.0, 1.0),
            Output::Number(scale) | Output::Vector(scale) => {
                let size = length(wgsl).max(length(rust)).max(scale);
                let noise = moved.iter().map(|moved| distance(&moved[part.clone()], still));
                // NaN counts as infinite.
                let noise = SAFETY * noise.fold(0.0, |a: f64, b| if a.is_nan() || b <= a { a } else { b });
                found.is_strict &= noise <= TOLERANCE * size;
                // What is moved by nearly as much as is tolerated differs by more now and then.
                let noise = if noise.is_nan() { f64::INFINITY } else { noise };
                (TOLERANCE * size + noise, size)
            }
        };
        if difference > 0.0 {
            found.difference = found.difference.max(difference / size);
        }
        // False for NaN.
        let agrees = difference <= allowed;
        if !agrees && found.failure.is_none() {
            found.failure = Some(format!(
                "{expression}: WGSL {wgsl:?}, Rust {rust:?} ({} {still:?}): differ by {difference:e}, allowed \
                 {allowed:e}\n      at {}",
                if case.twin.double.is_some() { "f64" } else { "again" },
                named(case, values),
            ));
        }
    }
    found
}

fn named(case: &Case, values: &[Value]) -> String {
    let named = case.inputs.split_whitespace().zip(values);
    named
        .map(|(name, value)| format!("{name} {value:?}"))
        .collect::<Vec<_>>()
        .join(", ")
}

/// Compares all cases, which may use the modules' functions; prints a table and fails with all that differ.
pub fn check(modules: &[&str], cases: &[Case]) {
    let bench = bench();
    let mut source = String::from(
        "@group(1) @binding(0) var<storage, read> rows_in: array<u32>;\n\
         @group(1) @binding(1) var<storage, read_write> rows_out: array<u32>;\n",
    );
    for (number, case) in cases.iter().enumerate() {
        source += &case.entry_point(number);
    }
    let linked = link_with(modules, &source).unwrap();
    if let Err(message) = validate(&linked) {
        let numbered: String = (1..)
            .zip(source.lines())
            .map(|(n, line)| format!("{n:4} {line}\n"))
            .collect();
        panic!("{message}\n{numbered}");
    }
    let module = bench.module(&linked.source);
    let mut failures = Vec::new();
    for (number, case) in cases.iter().enumerate() {
        let begun = std::time::Instant::now();
        let pipeline = bench.pipeline(&module, &format!("case_{number}"));
        for (group_number, (group, rows, draw)) in case.groups.iter().enumerate() {
            let mut rng = Rng::new((number * 1000 + group_number) as u64 + 1);
            let rows: Vec<_> = (0..*rows).map(|index| draw(&mut rng, index)).collect();
            compare_group(bench, &pipeline, case, group, &rows, &mut failures);
        }
        println!("{:>70.2} s", begun.elapsed().as_secs_f64());
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn compare_group(
    bench: &Bench,
    pipeline: &wgpu::ComputePipeline,
    case: &Case,
    group: &str,
    rows: &[Vec<Value>],
    failures: &mut Vec<String>,
) {
    let mut words = Vec::new();
    rows.iter().flatten().for_each(|value| value.words(&mut words));
    let width = case.output_words();
    let out = bench.run(pipeline, &words, rows.len(), width);
    let found: Vec<_> = rows
        .par_iter()
        .zip(out.par_chunks(width))
        .map(|(row, words)| compare(case, row, words))
        .collect();
    let strict = found.iter().filter(|row| row.is_strict).count();
    let largest = found
        .iter()
        .filter(|row| row.is_strict)
        .map(|row| row.difference)
        .fold(0.0, f64::max);
    println!(
        "{:24} {:28} {:6} of {:6}  {largest:.1e}",
        case.name,
        group,
        strict,
        rows.len()
    );
    if strict < ROWS_STRICT {
        failures.push(format!(
            "{} ({group}): only {strict} well-conditioned inputs",
            case.name
        ));
    }
    let failed: Vec<_> = found.iter().filter_map(|row| row.failure.as_ref()).collect();
    if !failed.is_empty() {
        failures.push(format!(
            "{} ({group}): {} of {} inputs differ:",
            case.name,
            failed.len(),
            rows.len()
        ));
        failures.extend(failed.iter().take(3).map(|message| format!("    {message}")));
    }
}
