//! Every shader module links and validates by itself, translates to the other graphics
//! interfaces, and has the constants of its Rust twin.

use glossmith::{
    cpu::integrator,
    document::Document,
    gpu::Traversal,
    gpu::shader::{GENERATED, Linked, link, link_for, module_names},
    job::plan::Plan,
    optics::lobe::{Facets, Lobe},
    render::{EngineChoice, Session},
    scene::camera::{GAUSSIAN_RADIUS, GAUSSIAN_SIGMA},
};
#[cfg(feature = "metal")]
use naga::back::msl;
use naga::back::{hlsl, spv};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

/// naga's reading of a shader, or its first complaint with the module and the line in it.
pub fn validate(linked: &Linked) -> Result<(naga::Module, ModuleInfo), String> {
    let complaint = |location: Option<naga::SourceLocation>, error: &dyn std::error::Error| {
        let (module, line) = linked.locate(location.map_or(1, |location| location.line_number as usize));
        let mut text = format!("{module}, line {line}: {error}");
        let mut cause = error.source();
        while let Some(inner) = cause {
            text += &format!(": {inner}");
            cause = inner.source();
        }
        text
    };
    let module = naga::front::wgsl::parse_str(&linked.source)
        .map_err(|error| complaint(error.location(&linked.source), &error))?;
    // No capability beyond WGSL's core, so that any adapter can take the shaders, but for those that are linked for others.
    let capabilities = match linked.source.starts_with("enable wgpu_ray_query;") {
        true => Capabilities::RAY_QUERY,
        false => Capabilities::empty(),
    };
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|error| {
            // From the function down to the expression: the shortest says where.
            let spans = error.spans().filter(|(span, _)| span.is_defined());
            let shortest = spans.min_by_key(|(span, _)| span.to_range().map_or(usize::MAX, |range| range.len()));
            complaint(
                shortest.map(|(span, _)| span.location(&linked.source)),
                error.as_inner(),
            )
        })?;
    Ok((module, info))
}

/// The numbers of a constant expression, arrays and vectors flattened.
fn numbers(module: &naga::Module, expression: naga::Handle<naga::Expression>) -> Vec<f64> {
    use naga::{Expression, Literal};
    match &module.global_expressions[expression] {
        Expression::Literal(Literal::F32(x)) => vec![f64::from(*x)],
        Expression::Literal(Literal::U32(x)) => vec![f64::from(*x)],
        Expression::Literal(Literal::I32(x)) => vec![f64::from(*x)],
        Expression::Literal(Literal::Bool(x)) => vec![f64::from(u8::from(*x))],
        Expression::Compose { components, .. } => components.iter().flat_map(|&part| numbers(module, part)).collect(),
        Expression::Constant(constant) => numbers(module, module.constants[*constant].init),
        other => panic!("a constant of an unforeseen form: {other:?}"),
    }
}

/// Every module with the generated one, each with naga's reading of it.
pub fn modules() -> Vec<(String, naga::Module)> {
    let mut names = module_names();
    names.extend(GENERATED.iter().map(|(name, _)| (*name).to_owned()));
    let read = |name: String| {
        let module = validate(&link(&name).unwrap()).unwrap().0;
        (name, module)
    };
    names.into_iter().map(read).collect()
}

#[test]
fn every_module_links_and_validates_by_itself() {
    let mut failures = Vec::new();
    for name in module_names() {
        if let Err(message) = link(&name).and_then(|linked| validate(&linked)) {
            failures.push(format!("{name}: {message}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(
        module_names().iter().any(|name| name == "pass/path_trace"),
        "{:?}",
        module_names()
    );
}

#[test]
fn generated_registry_covers_every_lobe() {
    let (module, _) = validate(&link("optics/lobe/registry").unwrap()).unwrap();
    let function = |name: &str| {
        let found = module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(name));
        found.unwrap_or_else(|| panic!("no function {name}")).1
    };
    for verb in ["sample", "density", "weight"] {
        let body = &function(&format!("raw_{verb}")).body;
        let cases = body
            .iter()
            .find_map(|statement| match statement {
                naga::Statement::Switch { cases, .. } => Some(cases),
                _ => None,
            })
            .unwrap();
        assert_eq!(
            cases.len(),
            Lobe::ALL.len() + 1,
            "the cases of raw_{verb} and the default"
        );
        for lobe in Lobe::ALL {
            let case = cases
                .iter()
                .find(|case| case.value == naga::SwitchValue::U32(*lobe as u32));
            let callee = case.unwrap().body.iter().find_map(|statement| match statement {
                naga::Statement::Call { function, .. } => module.functions[*function].name.clone(),
                _ => None,
            });
            assert_eq!(
                callee,
                Some(format!("{}_{verb}", lobe.module())),
                "raw_{verb} of {}",
                lobe.name()
            );
        }
    }
}

/// The constants that both languages have, by their names in WGSL, from the Rust side.
fn twin_constants() -> Vec<(String, Vec<f64>)> {
    let mut twins = Vec::new();
    let mut number = |name: String, value: f64| twins.push((name, vec![value]));
    for lobe in Lobe::ALL {
        number(
            format!("LOBE_{}", lobe.module().to_uppercase()),
            f64::from(*lobe as u32),
        );
    }
    let kept = 1.0 - (-0.5 * (GAUSSIAN_RADIUS / GAUSSIAN_SIGMA).powi(2)).exp();
    for (name, value) in [
        ("PI", std::f64::consts::PI),
        ("INV_PI", std::f64::consts::FRAC_1_PI),
        // Private to the traversal: the numbers themselves.
        ("FAR_MARGIN", f64::from(1.000_000_5_f32)),
        ("INVERSE_MAX", f64::from(1e18_f32)),
        ("RELATIVE_ERROR", f64::from(6e-7_f32)),
        ("FACETS_NONE", f64::from(Facets::None as u32)),
        ("FACETS_VISIBLE", f64::from(Facets::Visible as u32)),
        ("FACETS_ALL", f64::from(Facets::All as u32)),
        ("GAUSSIAN_KEPT", kept),
        ("FIRST_DIMENSION", f64::from(integrator::FIRST_DIMENSION)),
        ("BOUNCE_DIMENSIONS", f64::from(integrator::BOUNCE_DIMENSIONS)),
        ("BELOW_DIMENSION", f64::from(integrator::BELOW_DIMENSION)),
        ("CATCHER_DIMENSION", f64::from(integrator::CATCHER_DIMENSION)),
        ("OPACITY_DIMENSION", f64::from(integrator::OPACITY_DIMENSION)),
        ("PASSES_MAX", f64::from(integrator::PASSES_MAX)),
        ("ROULETTE_START", f64::from(integrator::ROULETTE_START)),
        ("RADIANCE_MAX", integrator::RADIANCE_MAX),
    ] {
        number(name.into(), value);
    }
    twins
}

/// Constants that only shaders need.
const WITHOUT_TWIN: &[&str] = &[
    "ANY",
    "NO_HIT",
    "UPWARDS",
    "WHITE",
    "STACK_SIZE",
    "EXTENT_MAX",
    "CATCHER_MISS",
    "CATCHER_SHADOW",
    "CATCHER_SHADOW_ALPHA",
    "CATCHER_MIRRORED",
];

#[test]
fn constants_equal_their_twins() {
    let twins = twin_constants();
    let generated: String = GENERATED.iter().map(|(_, generate)| generate()).collect();
    let mut met = Vec::new();
    for (name, module) in modules() {
        for (_, constant) in module.constants.iter() {
            let Some(constant_name) = constant.name.as_deref() else {
                continue;
            };
            if WITHOUT_TWIN.contains(&constant_name) || generated.contains(&format!("const {constant_name}:")) {
                continue;
            }
            let twin = twins.iter().find(|(twin, _)| twin == constant_name);
            let (_, expected) = twin.unwrap_or_else(|| panic!("{constant_name} in {name} is compared with nothing"));
            let expected: Vec<_> = expected.iter().map(|&x| x as f32).collect();
            let found: Vec<_> = numbers(&module, constant.init).iter().map(|&x| x as f32).collect();
            assert_eq!(found, expected, "{constant_name} in {name}, and in Rust");
            met.push(constant_name.to_owned());
        }
    }
    assert!(met.len() > 15);
}

#[test]
fn overrides_are_those_of_the_plan() {
    let (module, _) = validate(&link("scene/plan").unwrap()).unwrap();
    let mut wgsl: Vec<_> = module
        .overrides
        .iter()
        .map(|(_, o)| (o.name.clone().unwrap_or_default(), numbers(&module, o.init.unwrap())[0]))
        .collect();
    // The defaults are those of the general plan, so that a pipeline without constants leaves nothing out.
    let constants = Plan::general().constants();
    let mut rust: Vec<_> = constants
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect();
    wgsl.sort_by(|a, b| a.0.cmp(&b.0));
    rust.sort_by(|a, b| a.0.cmp(&b.0));
    assert_eq!(wgsl, rust);
}

/// The plan of the default document: it fixes all that a plan can fix.
fn narrow_plan() -> Plan {
    let mut session = Session::open(EngineChoice::Cpu).unwrap();
    session.submit(&Document::default()).unwrap();
    let plan = session.job().unwrap().plan.clone();
    assert!(plan.left_out() >= 8, "{plan:?}");
    plan
}

#[test]
fn passes_translate_for_every_graphics_interface() {
    let mut translated = 0;
    let each = |name: String| Traversal::ALL.iter().map(move |&traversal| (name.clone(), traversal));
    for (name, traversal) in module_names().into_iter().flat_map(each) {
        let (module, info) = validate(&link_for(&name, traversal).unwrap()).unwrap();
        for entry in &module.entry_points {
            for plan in [Plan::general(), narrow_plan()] {
                let point = (entry.stage, entry.name.as_str());
                let constants = plan.constants().into_iter();
                let constants = constants.map(|(name, value)| (name.to_owned(), value));
                let constants = constants.filter(|(name, _)| {
                    module
                        .overrides
                        .iter()
                        .any(|(_, o)| o.name.as_deref() == Some(name.as_str()))
                });
                let (module, info) = naga::back::pipeline_constants::process_overrides(
                    &module,
                    &info,
                    Some(point),
                    &constants.collect(),
                )
                .unwrap_or_else(|error| panic!("{name}, {}: {error}", entry.name));
                translate(&module, &info, point, traversal)
                    .unwrap_or_else(|message| panic!("{name}, {}: {message}", entry.name));
                translated += 1;
            }
        }
    }
    assert!(translated >= 2);
}

/// Vulkan, Metal, and Direct3D 12 by either of its compilers; in the versions that have ray queries, where rays are those.
fn translate(
    module: &naga::Module,
    info: &ModuleInfo,
    entry: (naga::ShaderStage, &str),
    traversal: Traversal,
) -> Result<(), String> {
    let direct3d: &[_] = match traversal {
        Traversal::Own => &[hlsl::ShaderModel::V5_1, hlsl::ShaderModel::V6_0],
        Traversal::RayQueries => &[hlsl::ShaderModel::V6_5],
    };
    #[cfg(feature = "metal")]
    translate_for_metal(module, info, entry, traversal)?;
    let (stage, name) = entry;
    let options = spv::PipelineOptions {
        shader_stage: stage,
        entry_point: name.to_owned(),
    };
    spv::write_vec(module, info, &spv::Options::default(), Some(&options)).map_err(|e| format!("SPIR-V: {e}"))?;
    for &shader_model in direct3d {
        let options = hlsl::Options {
            shader_model,
            fake_missing_bindings: true,
            ..Default::default()
        };
        let pipeline = hlsl::PipelineOptions {
            entry_point: Some((stage, name.to_owned())),
        };
        let mut text = String::new();
        let reflected = hlsl::Writer::new(&mut text, &options, &pipeline)
            .write(module, info, None)
            .map_err(|e| format!("HLSL {shader_model:?}: {e}"))?;
        if let Some(Err(error)) = reflected.entry_point_names.first() {
            return Err(format!("HLSL {shader_model:?}: {error}"));
        }
    }
    Ok(())
}

/// Metal, whose writer of shaders is compiled with the feature `metal` alone.
#[cfg(feature = "metal")]
fn translate_for_metal(
    module: &naga::Module,
    info: &ModuleInfo,
    entry: (naga::ShaderStage, &str),
    traversal: Traversal,
) -> Result<(), String> {
    let metal = match traversal {
        Traversal::Own => (2, 0),
        Traversal::RayQueries => (2, 4),
    };
    let (stage, name) = entry;
    let options = msl::Options {
        lang_version: metal,
        ..Default::default()
    };
    let pipeline = msl::PipelineOptions {
        entry_point: Some((stage, name.to_owned())),
        ..Default::default()
    };
    let (text, reflected) = msl::write_string(module, info, &options, &pipeline).map_err(|e| format!("Metal: {e}"))?;
    if let Some(Err(error)) = reflected.entry_point_names.first() {
        return Err(format!("Metal: {error}"));
    }
    if text.is_empty() {
        return Err("Metal: nothing came out".into());
    }
    Ok(())
}
