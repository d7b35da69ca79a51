//! A function that samples the geometric lobe, in the languages of renderers, with a material's roughness, anisotropy and
//! curve filled in: `optics::lobe::geometric::sample` with the horizon's policy after it, in shading coordinates.

use std::path::Path;

use super::report::{Entry, MaterialReport};
use super::{ExchangeError, Format, Subject, Written, carried};
use crate::document::MaterialSettings;
use crate::optics::curve::{CUSTOM_INTERVALS, Curve};
use crate::optics::lobe::{Horizon, Lobe, stretch_from_anisotropy};
use crate::optics::table::NODE_LENGTH;

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

impl Format for Language {
    fn write(&self, subject: &Subject, path: &Path) -> Result<Written, ExchangeError> {
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
        let entries = vec![
            Entry::dropped("colours, base, coat, refraction", detail),
            Entry::exact("the lobe's sampling"),
        ];
        Ok(Written::text(
            self.function(material),
            vec![MaterialReport::of(material, entries)],
        ))
    }
}

impl Language {
    fn vector(self) -> &'static str {
        match self {
            Self::Glsl | Self::C => "vec3",
            Self::Wgsl => "vec3f",
            Self::Hlsl => "float3",
            Self::Osl => "vector",
        }
    }

    /// A vector of three numbers.
    fn vector_of(self, numbers: [&str; 3]) -> String {
        let numbers = numbers.join(", ");
        match self {
            Self::C => format!("(vec3){{{numbers}}}"),
            _ => format!("{}({numbers})", self.vector()),
        }
    }

    /// A number as it is written in code.
    fn number(self, x: f64) -> String {
        let text = format!("{:?}", x as f32);
        match self {
            Self::C => format!("{text}f"),
            _ => text,
        }
    }

    /// The name of a function of C's library.
    fn of_library(self, name: &str) -> String {
        match self {
            Self::C => format!("{name}f"),
            _ => name.to_owned(),
        }
    }

    /// A line that names a number; one that is assigned again where `is_variable`.
    fn named(self, name: &str, value: &str, is_variable: bool) -> String {
        match self {
            Self::Wgsl if is_variable => format!("    var {name} = {value};\n"),
            Self::Wgsl => format!("    let {name} = {value};\n"),
            _ => format!("    float {name} = {value};\n"),
        }
    }

    /// The head of a function of numbers that gives a number or a vector.
    fn head(self, name: &str, gives_vector: bool, arguments: &[(&str, bool)]) -> String {
        let kind = |is_vector: bool| match (self, is_vector) {
            (_, true) => self.vector(),
            (Self::Wgsl, false) => "f32",
            _ => "float",
        };
        let arguments: Vec<String> = arguments
            .iter()
            .map(|(name, is_vector)| match self {
                Self::Wgsl => format!("{name}: {}", kind(*is_vector)),
                _ => format!("{} {name}", kind(*is_vector)),
            })
            .collect();
        let arguments = arguments.join(", ");
        match self {
            Self::Wgsl => format!("fn {name}({arguments}) -> {} {{\n", kind(gives_vector)),
            Self::C => format!("static inline {} {name}({arguments}) {{\n", kind(gives_vector)),
            _ => format!("{} {name}({arguments}) {{\n", kind(gives_vector)),
        }
    }

    /// A constant list of numbers, at the place that the language has for it.
    fn list(self, name: &str, values: &[f32]) -> String {
        let numbers: Vec<String> = values.iter().map(|x| self.number(f64::from(*x))).collect();
        let (numbers, count) = (numbers.join(", "), values.len());
        match self {
            Self::Glsl => format!("const float {name}[{count}] = float[{count}]({numbers});\n"),
            Self::Wgsl => format!("const {name}_values = array<f32, {count}>({numbers});\n"),
            Self::Hlsl | Self::C => format!("static const float {name}[{count}] = {{{numbers}}};\n"),
            Self::Osl => format!("    float {name}[{count}] = {{{numbers}}};\n"),
        }
    }

    fn function(self, material: &MaterialSettings) -> String {
        let mut text = self.introduction(material);
        text += &self.distance_function(material);
        text += &self.sample_function(material);
        text
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

    /// D(ξ).
    fn distance_function(self, material: &MaterialSettings) -> String {
        let head = self.head("glossmith_distance", false, &[("xi", false)]);
        let n = |x: f64| self.number(x);
        let f = |name: &str| self.of_library(name);
        let mut body = String::new();
        let mut before = String::new();
        match material.curve {
            Curve::Linear => body += "    return xi;\n",
            Curve::Sqrt => body += &format!("    return {}(xi);\n", f("sqrt")),
            Curve::Cbrt => body += &format!("    return {}(xi, {});\n", f("pow"), n(1.0 / 3.0)),
            Curve::Smooth => {
                body += &self.named("root", &format!("{}(xi)", f("sqrt")), false);
                body += &format!(
                    "    return root / ({one} + {sqrt}({max}({one} - root, {zero})));\n",
                    one = n(1.0),
                    zero = n(0.0),
                    sqrt = f("sqrt"),
                    max = self.maximum(),
                );
            }
            Curve::LongTail => {
                body += &self.named("root", &format!("{}(xi)", f("sqrt")), false);
                // 1 − √ξ without cancellation, and above 0 for the largest number below 1.
                let complement = format!("({one} - xi) / ({one} + root)", one = n(1.0));
                let least = n(0.5 / 16_777_216.0);
                body += &format!("    return -{}({}({complement}, {least}));\n", f("log"), self.maximum());
            }
            Curve::Custom => {
                let list = self.list("glossmith_curve", &curve_numbers(&material.custom_curve.table()));
                if self == Self::Osl {
                    body += &list
                } else {
                    before += &list
                }
                body += &self.custom_curve();
            }
        }
        format!("{before}{head}{body}}}\n\n")
    }

    fn maximum(self) -> &'static str {
        if self == Self::C { "fmaxf" } else { "max" }
    }

    /// The quantile of a density that is linear between the nodes of a table (`optics::curve::custom_distance`).
    fn custom_curve(self) -> String {
        let n = |x: f64| self.number(x);
        let (sqrt, max) = (self.of_library("sqrt"), self.maximum());
        let table = "glossmith_curve";
        let mut text = String::new();
        if self == Self::Wgsl {
            // Constants are not indexed by variables there.
            text += "    var glossmith_curve = glossmith_curve_values;\n";
        }
        text += if self == Self::Wgsl {
            "    var low = 0;\n"
        } else {
            "    int low = 0;\n"
        };
        let last = CUSTOM_INTERVALS - 1;
        text += &format!("    while (low < {last} && {table}[low + 2] <= xi) {{\n        low = low + 1;\n    }}\n");
        text += &self.named("width", &format!("{table}[0] / {}", n(CUSTOM_INTERVALS as f64)), false);
        let first = CUSTOM_INTERVALS + 1;
        text += &self.named("left", &format!("{table}[low + {first}]"), false);
        text += &self.named("right", &format!("{table}[low + {}]", first + 1), false);
        text += &self.named("missing", &format!("{max}(xi - {table}[low + 1], {})", n(0.0)), false);
        let square = format!("left * left + {} * (right - left) / width * missing", n(2.0));
        text += &self.named("root", &format!("{sqrt}({max}({square}, {}))", n(0.0)), false);
        let step = format!("{} * missing / {max}(left + root, {})", n(2.0), n(1e-12));
        text += &self.named("step", &step, false);
        let low = if self == Self::Wgsl { "f32(low)" } else { "low" };
        let least = if self == Self::C { "fminf" } else { "min" };
        text += &format!("    return width * {low} + {least}(step, width);\n");
        text
    }

    fn sample_function(self, material: &MaterialSettings) -> String {
        let n = |x: f64| self.number(x);
        let f = |name: &str| self.of_library(name);
        let roughness = f64::from(material.roughness);
        let stretch = stretch_from_anisotropy(f64::from(material.anisotropy));
        let (sin, cos) = f64::from(material.rotation_deg).to_radians().sin_cos();
        let mut text = self.head("glossmith_sample", true, &[("wo", true), ("xi", true)]);
        let mut line = |name: &str, value: String| text += &self.named(name, &value, name == "z");
        // A point on the unit sphere, lifted by R.
        line("ball_x", format!("{} * xi.x - {}", n(2.0), n(1.0)));
        let square = format!("{} - ball_x * ball_x", n(1.0));
        line(
            "ring",
            format!("{}({}({square}, {}))", f("sqrt"), self.maximum(), n(0.0)),
        );
        line("phi", format!("{} * xi.y", n(std::f64::consts::TAU)));
        line("distance", "glossmith_distance(xi.z)".to_owned());
        line("along", format!("{} * ball_x", n(roughness * stretch)));
        line(
            "across",
            format!("{} * ring * {}(phi)", n(roughness / stretch), f("sin")),
        );
        let up = format!("ring * {}(phi) + {}", f("cos"), n(roughness));
        line("up", format!("{} * ({up})", n(roughness)));
        let keep = n(1.0 - roughness);
        let (turned_x, turned_y) = if stretch != 1.0 && material.rotation_deg != 0.0 {
            let [sin, cos] = [n(sin), n(cos)];
            (
                format!("({cos} * along - {sin} * across)"),
                format!("({sin} * along + {cos} * across)"),
            )
        } else {
            ("along".to_owned(), "across".to_owned())
        };
        line("x", format!("distance * {turned_x} - {keep} * wo.x"));
        line("y", format!("distance * {turned_y} - {keep} * wo.y"));
        line("z", format!("distance * up + {keep} * wo.z"));
        line("size", format!("{}(x * x + y * y + z * z)", f("sqrt")));
        if material.horizon == Horizon::Mirror {
            text += &format!("    z = {}(z);\n", if self == Self::C { "fabsf" } else { "abs" });
        }
        // R = 1 may leave nothing to normalise.
        text += &format!("    if (size < {}) {{\n", n(1e-20));
        text += &format!(
            "        return {};\n    }}\n",
            self.vector_of([&n(0.0), &n(0.0), &n(1.0)])
        );
        text += &format!(
            "    return {};\n}}\n",
            self.vector_of(["x / size", "y / size", "z / size"])
        );
        text
    }
}

/// What [`Language::custom_curve`] reads, each number once: D's maximum, the distribution where each interval begins, the
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
