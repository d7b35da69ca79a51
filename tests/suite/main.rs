//! The tests, in one program but for those of `tests/numbers`: see docs/ARCHITECTURE.md.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::sync::LazyLock;

/// The repository's folder.
pub const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// Path of the program, which `cargo build --release` leaves beside the tests.
pub fn program() -> &'static str {
    static PROGRAM: LazyLock<String> = LazyLock::new(|| {
        let tests = std::env::current_exe().expect("this program has a path");
        let folder = tests.ancestors().nth(2).expect("tests lie in deps");
        let program = folder.join(format!("glossmith{}", std::env::consts::EXE_SUFFIX));
        assert!(
            program.is_file(),
            "{} is missing: run cargo build --release",
            program.display()
        );
        program.to_str().expect("a path in UTF-8").to_owned()
    });
    &PROGRAM
}

/// Fails where a number isn't as expected, within a tolerance; words may say which number.
macro_rules! near {
    ($found:expr, $expected:expr, $tolerance:expr) => {
        near!($found, $expected, $tolerance, "")
    };
    ($found:expr, $expected:expr, $tolerance:expr, $($what:tt)+) => {{
        let (found, expected, tolerance) = ($found, $expected, $tolerance);
        let what = format_args!($($what)+);
        assert!((found - expected).abs() <= tolerance, "{found} instead of {expected} ± {tolerance} {what}");
    }};
}

mod analytic;
mod analytic_bodies;
mod analytic_lobes;
mod analytic_media;
mod analytic_scenes;
mod batch;
mod benchmark;
mod bounds;
mod brushed;
mod camera_views;
mod check;
mod cli_errors;
mod cli_pictures;
mod cli_render;
mod cli_saved;
mod cli_scatter;
mod cli_support;
mod coat_base;
mod colors;
mod compare;
mod crashed;
mod default_look;
mod denoise;
mod denoise_told;
mod device_loss;
mod displays;
mod docs;
mod docs_commands;
mod docs_results;
mod docs_tables;
mod document;
mod environment;
mod environment_files;
mod environment_sampling;
mod environment_shapes;
mod estimates;
mod evaluate;
mod exchange;
mod exchange_details;
mod explain;
mod file_colors;
mod file_kinds;
mod file_parameters;
mod file_scenes;
mod files;
mod film;
mod firefly;
mod fit;
mod fuzz_layer;
mod geometry;
mod gltf;
mod gltf_builder;
mod gltf_damaged;
mod gltf_extensions;
mod gltf_materials;
mod gltf_meaning;
mod gpu_pictures;
mod hard;
mod hierarchy;
mod import_report;
mod instances;
mod kept_files;
mod killed;
mod layer_stacks;
mod library;
mod light_groups;
mod light_paths;
mod light_profiles;
mod lights;
mod lobe_views;
mod look_of_ggx;
mod lut;
mod manual;
mod many_materials;
mod memory;
mod merge;
mod model_formats;
mod model_parts;
mod moved_lights;
mod nobody_listens;
mod noise;
mod nothing_lost;
mod open_pbr_oracle;
mod own_textures;
mod parameters;
mod parting;
mod paths;
mod picture_files;
mod plan;
mod plan_kernels;
mod precision;
mod random_documents;
mod ray_queries;
mod refused;
mod renders;
mod rough_diffuse;
mod same_bits;
mod scenes;
mod shadow_catcher;
mod signals;
mod strangers;
mod structure;
mod study;
mod support;
mod technique;
mod terminator;
mod textures;
mod thin_film;
#[cfg(feature = "thorough")]
mod thorough;
mod tone;
mod transmission;
mod twin_names;
mod ui;
mod ui_browser;
mod ui_edges;
mod ui_export;
mod ui_files;
mod ui_hands;
mod ui_lights;
mod ui_look;
mod ui_notes;
mod ui_objects;
mod ui_panels;
mod ui_pictures;
mod ui_queue;
mod ui_scene;
mod ui_strangers;
mod ui_study;
mod ui_textures;
mod ui_views;
mod ui_workshop;
mod ui_workspaces;
mod video;
mod worker;
