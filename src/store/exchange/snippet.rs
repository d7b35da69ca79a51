//! A function that samples the geometric lobe, in the languages of renderers, with a material's roughness, anisotropy and
//! curve filled in: `optics::lobe::geometric::sample` with the horizon's policy after it, in shading coordinates.

use std::path::Path;

use super::{ExchangeError, Subject, Written, carried, report::Entry, report::MaterialReport};
use crate::{
    document::MaterialSettings,
    optics::{
        curve::{CUSTOM_INTERVALS, Curve},
        lobe::{Horizon, Lobe, stretch_from_anisotropy},
        table::NODE_LENGTH,
    },
};

/// A language of renderers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// OpenGL's and Vulkan's.
    Glsl,
    /// WebGPU's.
    Wgsl,
    /// Direct3D's.
    Hlsl,
    /// Open Shading Language.
    Osl,
    C,
}

impl Language {
    /// The function for a material.
    pub fn write(self, subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
        let material = subject.only(path)?;
        if material.lobe != Lobe::Geometric {
            return Err(ExchangeError::Unsuitable {
                path: path.to_owned(),
                reason: format!(
                    "the function samples the geometric lobe, and {} has {}; set specular.lobe=geometric",
                    material.name,
                    material.lobe.label()
                ),
            });
        }
        let detail = "the function draws directions; multiply by your own Fresnel factor";
        let entries = vec![Entry::all_but_the_lobe(detail), Entry::exact("the lobe's sampling")];
        Ok(Written::text(
            self.function(material),
            vec![MaterialReport::of(material, entries)],
        ))
    }
}

/// What the languages that have C's declarations write for WGSL's; the kind of a vector is still to be written.
const AS_IN_C: [(&str, &str); 8] = [
    ("fn distance(xi: f32) -> f32", "float distance(float xi)"),
    (
        "fn sample(wo: vec3f, xi: vec3f) -> vec3f",
        "vec3f sample(vec3f wo, vec3f xi)",
    ),
    // Constants are not indexed by variables in WGSL.
    ("    var curve = curve_values;\n", ""),
    ("f32(low)", "low"),
    ("var low", "int low"),
    ("let ", "float "),
    ("var ", "float "),
    ("vec3f ", "VECTOR "),
];

/// What C itself writes besides.
const IN_C: [(&str, &str); 12] = [
    ("VECTOR sample", "static inline VECTOR sample"),
    ("float distance(", "static inline float distance("),
    ("⟨", "(vec3){"),
    ("⟩", "}"),
    ("\'", "f"),
    ("sqrt(", "sqrtf("),
    ("pow(", "powf("),
    ("log(", "logf("),
    ("sin(", "sinf("),
    ("cos(", "cosf("),
    ("max(", "fmaxf("),
    ("min(", "fminf("),
];

/// The quantile of a density that is linear between the nodes of a table (`optics::curve::custom_distance`).
const CUSTOM: &str = "    var curve = curve_values;
    var low = 0;
    while (low < LAST && curve[low + 2] <= xi) {
        low = low + 1;
    }
    let width = curve[0] / INTERVALS';
    let left = curve[low + FIRST];
    let right = curve[low + NEXT];
    let missing = max(xi - curve[low + 1], 0.0');
    let root = sqrt(max(left * left + 2.0' * (right - left) / width * missing, 0.0'));
    let step = 2.0' * missing / max(left + root, 1e-12');
    return width * f32(low) + min(step, width);
";

/// A point on the unit sphere, lifted by R.
const SAMPLE: &str = "fn sample(wo: vec3f, xi: vec3f) -> vec3f {
    let ball_x = 2.0' * xi.x - 1.0';
    let ring = sqrt(max(1.0' - ball_x * ball_x, 0.0'));
    let phi = TAU' * xi.y;
    let distance = distance(xi.z);
    let along = ALONG' * ball_x;
    let across = ACROSS' * ring * sin(phi);
    let up = UP' * (ring * cos(phi) + UP');
    let x = distance * TURNED_X - KEEP' * wo.x;
    let y = distance * TURNED_Y - KEEP' * wo.y;
    var z = distance * up + KEEP' * wo.z;
    let size = sqrt(x * x + y * y + z * z);
MIRROR    if (size < 1e-20') {
        return ⟨0.0', 0.0', 1.0'⟩;
    }
    return ⟨x / size, y / size, z / size⟩;
}
";

impl Language {
    /// Code in this language. In `wgsl` a vector stands in angle brackets, and an apostrophe behind a number that is not whole.
    fn translated(self, wgsl: &str) -> String {
        let replaced = |text: String, (from, to): &(&str, &str)| text.replace(from, to);
        let mut text = wgsl.to_owned();
        if self != Self::Wgsl {
            text = AS_IN_C.iter().fold(text, replaced);
        }
        if self == Self::C {
            text = IN_C.iter().fold(text, replaced);
        }
        let vector = match self {
            Self::Glsl | Self::C => "vec3",
            Self::Wgsl => "vec3f",
            Self::Hlsl => "float3",
            Self::Osl => "vector",
        };
        let open = format!("{vector}(");
        let rest = [
            ("VECTOR", vector),
            ("⟨", &open),
            ("⟩", ")"),
            ("\'", ""),
            ("distance(xi", "glossmith_distance(xi"),
            ("distance(float", "glossmith_distance(float"),
            ("sample(", "glossmith_sample("),
            ("curve[", "glossmith_curve["),
            ("var curve = curve", "var glossmith_curve = glossmith_curve"),
        ];
        rest.iter().fold(text, replaced)
    }

    /// A constant list of numbers, at the place that the language has for it.
    fn list(self, values: &[f32]) -> String {
        let suffix = if self == Self::C { "f" } else { "" };
        let numbers = crate::named::joined(values.iter().map(|x| format!("{x:?}{suffix}")), ", ");
        let count = values.len();
        match self {
            Self::Glsl => format!("const float glossmith_curve[{count}] = float[{count}]({numbers});\n"),
            Self::Wgsl => format!("const glossmith_curve_values = array<f32, {count}>({numbers});\n"),
            Self::Hlsl | Self::C => format!("static const float glossmith_curve[{count}] = {{{numbers}}};\n"),
            Self::Osl => format!("    float glossmith_curve[{count}] = {{{numbers}}};\n"),
        }
    }

    fn introduction(self, material: &MaterialSettings) -> String {
        let name = material.name.replace(['\n', '\r'], " ");
        let mut text = format!(
            "// {}\n// {name}: a direction drawn from the geometric lobe of Glossmith, R = {}, D(xi) {}.\n// Shading \
             coordinates: x along the tangent, z along the normal. xi: uniform numbers in [0, 1). What is drawn\n// has \
             weight 1 (times Fresnel's factor). ",
            carried::comment(material),
            material.roughness,
            material.curve.name(),
        );
        text += match material.horizon {
            Horizon::Mirror => "What would enter the surface is mirrored at it.\n\n",
            Horizon::Absorb => "What has z < 0 is lost: its weight is 0.\n\n",
            Horizon::None => "What has z < 0 goes through the surface.\n\n",
        };
        if self == Self::C {
            text += "#include <math.h>\n\n#ifndef GLOSSMITH_VEC3\n#define GLOSSMITH_VEC3\ntypedef struct {\n    float x, y, z;\n} \
                     vec3;\n#endif\n\n";
        }
        text
    }

    /// D(ξ) and the sampling.
    fn function(self, material: &MaterialSettings) -> String {
        let (mut before, mut inside) = (String::new(), String::new());
        let distance = match material.curve {
            Curve::Linear => "    return xi;\n".to_owned(),
            Curve::Sqrt => "    return sqrt(xi);\n".to_owned(),
            Curve::Cbrt => format!("    return pow(xi, {:?}');\n", 1.0_f32 / 3.0),
            Curve::Smooth => {
                "    let root = sqrt(xi);\n    return root / (1.0' + sqrt(max(1.0' - root, 0.0')));\n".to_owned()
            }
            // 1 − √ξ without cancellation, and above 0 for the largest number below 1.
            Curve::LongTail => format!(
                "    let root = sqrt(xi);\n    return -log(max((1.0' - xi) / (1.0' + root), {:?}'));\n",
                0.5_f32 / 16_777_216.0
            ),
            Curve::Custom => {
                let list = self.list(&curve_numbers(&material.custom_curve.table()));
                *(if self == Self::Osl { &mut inside } else { &mut before }) = list;
                CUSTOM
                    .replace("LAST", &(CUSTOM_INTERVALS - 1).to_string())
                    .replace("FIRST", &(CUSTOM_INTERVALS + 1).to_string())
                    .replace("NEXT", &(CUSTOM_INTERVALS + 2).to_string())
                    .replace("INTERVALS", &format!("{:?}", CUSTOM_INTERVALS as f32))
            }
        };
        let roughness = f64::from(material.roughness);
        let stretch = stretch_from_anisotropy(f64::from(material.anisotropy));
        let (sin, cos) = f64::from(material.rotation_deg).to_radians().sin_cos();
        let n = |x: f64| format!("{:?}", x as f32);
        let [mut x, mut y] = ["along", "across"].map(str::to_owned);
        if stretch != 1.0 && material.rotation_deg != 0.0 {
            let [sin, cos] = [n(sin), n(cos)];
            x = format!("({cos}' * along - {sin}' * across)");
            y = format!("({sin}' * along + {cos}' * across)");
        }
        let mirror = match (material.horizon, self) {
            (Horizon::Mirror, Self::C) => "    z = fabsf(z);\n",
            (Horizon::Mirror, _) => "    z = abs(z);\n",
            _ => "",
        };
        let values = [
            ("TAU", n(std::f64::consts::TAU)),
            ("ALONG", n(roughness * stretch)),
            ("ACROSS", n(roughness / stretch)),
            ("UP", n(roughness)),
            ("TURNED_X", x),
            ("TURNED_Y", y),
            ("KEEP", n(1.0 - roughness)),
            // R = 1 may leave nothing to normalise.
            ("MIRROR", mirror.to_owned()),
        ];
        let sample = values
            .iter()
            .fold(SAMPLE.to_owned(), |text, (key, value)| text.replace(key, value));
        let head = self.translated("fn distance(xi: f32) -> f32 {\n");
        let (distance, sample) = (self.translated(&distance), self.translated(&sample));
        format!(
            "{}{before}{head}{inside}{distance}}}\n\n{sample}",
            self.introduction(material)
        )
    }
}

/// What [`CUSTOM`] reads, each number once: D's maximum, the distribution where each interval begins, the
/// density at each node. From a table of `optics::curve`.
fn curve_numbers(table: &[f32]) -> Vec<f32> {
    let (intervals, _) = table.as_chunks::<NODE_LENGTH>();
    let mut numbers: Vec<_> = intervals
        .iter()
        .map(|[.., distance_max]| *distance_max)
        .take(1)
        .collect();
    numbers.extend(intervals.iter().map(|[distribution, ..]| distribution));
    numbers.extend(intervals.iter().map(|[_, density, ..]| density));
    numbers.extend(intervals.last().map(|[_, _, density, _]| density));
    numbers
}
