//! Functions of `shaders/optics` and `shaders/scene` have twins in Rust of the same names, so that who reads one finds the
//! other (docs/ARCHITECTURE.md).

use std::{collections::BTreeSet, fs, path::Path, path::PathBuf};

use crate::structure::files_with;

/// Functions without a twin, and why. The list may only become shorter.
const ALONE: &[(&str, &[&str])] = &[
    (
        "reads an array that is bound to the pass; in Rust it is a slice or a field",
        &[
            "material_at",
            "node_words",
            "slot_at",
            "table_number",
            "table_numbers",
            "texel_at",
            "three_texels",
            "vertex_at",
        ],
    ),
    (
        "asks the plan's constants, which the CPU engine does not have: it looks at the values themselves",
        &[
            "compensates",
            "has_rows",
            "has_vertex_flag",
            "planned",
            "shows_film",
            "transmits_anywhere",
        ],
    ),
    (
        "is a method of numbers in Rust (src/optics/elementary.rs)",
        &["arctan2", "unit_circle"],
    ),
    (
        "walks the hierarchy of obvhs with one ray; lanes walk one with other nodes (src/scene/hierarchy)",
        &["bounded_inverse", "intersect_node"],
    ),
    (
        "reads a vertex that is packed otherwise: methods of `Vertex` in src/scene/part.rs",
        &["corner_color", "vertex_side"],
    ),
    (
        "searches cells of a texture; slices are searched by src/scene/inversion.rs",
        &["environment_draw"],
    ),
    (
        "is a part of surfaces_at, which fetches what lanes need together",
        &["surface_of", "hit_uvs"],
    ),
    (
        "is a part of a layer whose share in Rust is a default of the layers' trait (src/optics/layer)",
        &["cover_choose", "material_scatter", "material_steps"],
    ),
    (
        "finds layers by number; Rust walks over their types (src/optics/layer/mod.rs)",
        &["is_layer", "layer_choice", "planned_layer"],
    ),
];

/// The names that stand behind a word, `fn` say.
fn declared(text: &str, word: &str) -> BTreeSet<String> {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or(""));
    let words = code.flat_map(|line| {
        line.split(|c: char| !c.is_alphanumeric() && c != '_')
            .filter(|word| !word.is_empty())
    });
    let words: Vec<&str> = words.collect();
    let pairs = words.windows(2).filter(|pair| pair[0] == word);
    pairs.map(|pair| pair[1].to_owned()).collect()
}

/// `RayFrame` as `ray_frame`.
fn in_snake_case(name: &str) -> String {
    let parts = name.char_indices().map(|(at, c)| {
        let before = if at > 0 && c.is_uppercase() { "_" } else { "" };
        format!("{before}{}", c.to_lowercase())
    });
    parts.collect()
}

/// All names that WGSL, which has neither modules nor methods, may give the functions of a Rust file: their own, and behind
/// the name of the file, its folder or a type in it. A type's own name stands for its `new`.
fn names_in_shaders(file: &Path) -> BTreeSet<String> {
    let text = fs::read_to_string(file).unwrap();
    let functions = declared(&text, "fn");
    let folder = file.parent().and_then(Path::file_name);
    let mut before: BTreeSet<String> = declared(&text, "struct")
        .iter()
        .map(|name| in_snake_case(name))
        .collect();
    let mut names: BTreeSet<String> = before.iter().filter(|_| functions.contains("new")).cloned().collect();
    before.extend(
        [file.file_stem(), folder]
            .into_iter()
            .flatten()
            .map(|name| name.to_str().unwrap().to_owned()),
    );
    for function in functions {
        names.extend(before.iter().map(|before| format!("{before}_{function}")));
        names.insert(function);
    }
    names
}

#[test]
fn shader_functions_have_twins() {
    let root = Path::new(crate::ROOT);
    let mut alone: BTreeSet<&str> = ALONE.iter().flat_map(|(_, names)| names.iter().copied()).collect();
    let mut wrong = Vec::new();
    for folder in ["optics", "scene"] {
        let twins: BTreeSet<String> = files_with("rs", &root.join("src").join(folder))
            .iter()
            .flat_map(|file| names_in_shaders(file))
            .collect();
        let shaders: Vec<PathBuf> = files_with("wgsl", &root.join("shaders").join(folder));
        for shader in shaders {
            for function in declared(&fs::read_to_string(&shader).unwrap(), "fn") {
                let (is_twin, is_listed) = (twins.contains(&function), alone.remove(function.as_str()));
                if is_twin == is_listed {
                    let what = if is_twin {
                        "has a twin: take it off the list"
                    } else {
                        "has no twin"
                    };
                    wrong.push(format!("{function} in {} {what}", shader.display()));
                }
            }
        }
    }
    wrong.extend(alone.iter().map(|name| format!("{name} is gone: take it off the list")));
    assert!(
        wrong.is_empty(),
        "functions of shaders and their twins:\n{}",
        wrong.join("\n")
    );
}
