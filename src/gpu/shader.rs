//! Puts shaders together: `#import "optics/fresnel"` brings in `shaders/optics/fresnel.wgsl`, once.

use include_dir::{Dir, include_dir};

use crate::job::effect::{ANY, EffectId};
use crate::optics::lobe::Lobe;

static SHADERS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/shaders");

/// The module that is generated from the registry of lobes.
const LOBE_REGISTRY: &str = "optics/lobe/registry";
/// The module that is generated from the list of effects.
const PLAN_CONSTANTS: &str = "scene/plan_constants";

/// A shader with everything that it imports.
#[derive(Clone, Debug, Default)]
pub struct Linked {
    /// WGSL.
    pub source: String,
    /// The modules in their order, each with the line (from 1) of `source` at which it begins.
    pub modules: Vec<(String, usize)>,
}

impl Linked {
    /// Where a line (from 1) of the source comes from: module and line in it.
    pub fn locate(&self, line: usize) -> (&str, usize) {
        let begun = self.modules.iter().rev().find(|(_, first)| *first <= line);
        begun.map_or(("", line), |(module, first)| (module.as_str(), line - first + 1))
    }

    /// Appends WGSL as a module of this name; each of its lines becomes one line.
    fn append(&mut self, module: &str, text: &str) {
        self.modules.push((module.to_owned(), self.source.lines().count() + 1));
        for line in text.lines() {
            // An import leaves an empty line behind: line numbers stay those of the file.
            self.source
                .push_str(if line.starts_with("#import") { "" } else { line });
            self.source.push('\n');
        }
    }

    fn add(&mut self, module: &str) -> Result<(), String> {
        if self.modules.iter().any(|(name, _)| name == module) {
            return Ok(());
        }
        // Claimed before its imports, so that a circle of imports ends.
        let place = self.modules.len();
        self.modules.push((module.to_owned(), 0));
        let text = module_source(module)?;
        for line in text.lines().filter_map(|line| line.strip_prefix("#import \"")) {
            self.add(line.trim_end().trim_end_matches('"'))?;
        }
        self.modules.remove(place);
        self.append(module, &text);
        Ok(())
    }
}

/// A module of `shaders/` with everything that it imports.
///
/// # Errors
/// Names the module that does not exist.
pub fn link(module: &str) -> Result<Linked, String> {
    link_with(&[module], "")
}

/// What [`Linked::locate`] calls the source that came on top of the modules.
pub const EXTRA: &str = "extra source";

/// Modules of `shaders/` with everything that they import, then `extra_source`, which may use all of it: an entry point
/// around functions that have none.
///
/// # Errors
/// Names the module that does not exist.
pub fn link_with(modules: &[&str], extra_source: &str) -> Result<Linked, String> {
    let mut linked = Linked::default();
    for module in modules {
        linked.add(module)?;
    }
    linked.append(EXTRA, extra_source);
    Ok(linked)
}

/// The names of all modules in `shaders/`.
pub fn module_names() -> Vec<String> {
    fn collect(dir: &Dir<'_>, names: &mut Vec<String>) {
        for file in dir.files() {
            if let Some(name) = file.path().to_str().and_then(|path| path.strip_suffix(".wgsl")) {
                names.push(name.replace('\\', "/"));
            }
        }
        dir.dirs().for_each(|dir| collect(dir, names));
    }
    let mut names = Vec::new();
    collect(&SHADERS, &mut names);
    names
}

fn module_source(module: &str) -> Result<String, String> {
    match module {
        LOBE_REGISTRY => return Ok(lobe_registry()),
        PLAN_CONSTANTS => return Ok(plan_constants()),
        _ => {}
    }
    let file = SHADERS.get_file(format!("{module}.wgsl"));
    let text = file.and_then(|file| file.contents_utf8());
    text.map(str::to_owned)
        .ok_or_else(|| format!("no shader module {module}"))
}

/// The override constants of the plan, each with the value that leaves nothing out.
fn plan_constants() -> String {
    let mut text = format!("// Generated from src/job/effect.rs.\nconst ANY: u32 = {ANY}u;\n");
    for constant in EffectId::ALL.iter().filter_map(|effect| effect.constant()) {
        text += &format!("override {}: u32 = {}u;\n", constant.name, constant.general);
    }
    text
}

/// WGSL that finds a lobe's functions by its number: the twin of the `match`es in `src/optics/lobe/mod.rs`.
fn lobe_registry() -> String {
    let mut text = String::from("// Generated from the registry in src/optics/lobe/mod.rs.\n");
    for lobe in Lobe::ALL {
        text += &format!("#import \"optics/lobe/{}\"\n", lobe.module());
    }
    for lobe in Lobe::ALL {
        text += &format!(
            "const LOBE_{}: u32 = {}u;\n",
            lobe.module().to_uppercase(),
            *lobe as u32
        );
    }
    let cases = |call: &dyn Fn(&str) -> String| -> String {
        let case = |lobe: &Lobe| {
            format!(
                "        case {}u: {{ return {}; }}\n",
                *lobe as u32,
                call(lobe.module())
            )
        };
        Lobe::ALL.iter().map(case).collect()
    };
    let dispatch = |signature: &str, switch: &str, cases: String, otherwise: &str| {
        format!(
            "fn {signature} {{\n    switch {switch} {{\n{cases}        default: {{ return {otherwise}; }}\n    }}\n}}\n"
        )
    };
    let directions = "shape: LobeShape, frame: Frame, wo: vec3f";
    text += &dispatch(
        &format!("raw_sample({directions}, xi: vec3f) -> vec3f"),
        "shape.lobe",
        cases(&|module| format!("{module}_sample(shape, frame, wo, xi)")),
        "frame.normal",
    );
    for name in ["density", "weight"] {
        text += &dispatch(
            &format!("raw_{name}({directions}, wi: vec3f) -> f32"),
            "shape.lobe",
            cases(&|module| format!("{module}_{name}(shape, frame, wo, wi)")),
            "0.0",
        );
    }
    let property = |signature: &str, value: &dyn Fn(Lobe) -> String, otherwise: &str| {
        let case = |lobe: &Lobe| format!("        case {}u: {{ return {}; }}\n", *lobe as u32, value(*lobe));
        dispatch(signature, "lobe", Lobe::ALL.iter().map(case).collect(), otherwise)
    };
    let hemispherical = |lobe: Lobe| format!("{}_HEMISPHERICAL", lobe.module().to_uppercase());
    text += &property("is_hemispherical(lobe: u32) -> bool", &hemispherical, "true");
    let anisotropic = |lobe: Lobe| lobe.is_anisotropic().to_string();
    text += &property("is_anisotropic(lobe: u32) -> bool", &anisotropic, "false");
    let facets = |lobe: Lobe| format!("{}u", lobe.facets() as u32);
    text += &property("facets(lobe: u32) -> u32", &facets, "0u");
    text
}
