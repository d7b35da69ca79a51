//! The integration tests, in one binary: see docs/ARCHITECTURE.md.
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

#[path = "suite/analytic.rs"]
mod analytic;
#[path = "suite/analytic_bodies.rs"]
mod analytic_bodies;
#[path = "suite/analytic_lobes.rs"]
mod analytic_lobes;
#[path = "suite/analytic_media.rs"]
mod analytic_media;
#[path = "suite/analytic_scenes.rs"]
mod analytic_scenes;
#[path = "suite/batch.rs"]
mod batch;
#[path = "suite/benchmark.rs"]
mod benchmark;
#[path = "suite/bounds.rs"]
mod bounds;
#[path = "suite/brushed.rs"]
mod brushed;
#[path = "suite/camera_views.rs"]
mod camera_views;
#[path = "suite/check.rs"]
mod check;
#[path = "suite/cli_errors.rs"]
mod cli_errors;
#[path = "suite/cli_pictures.rs"]
mod cli_pictures;
#[path = "suite/cli_render.rs"]
mod cli_render;
#[path = "suite/cli_saved.rs"]
mod cli_saved;
#[path = "suite/cli_scatter.rs"]
mod cli_scatter;
#[path = "suite/cli_support.rs"]
mod cli_support;
#[path = "suite/coat.rs"]
mod coat;
#[path = "suite/coat_base.rs"]
mod coat_base;
#[path = "suite/colors.rs"]
mod colors;
#[path = "suite/compare.rs"]
mod compare;
#[path = "suite/crashed.rs"]
mod crashed;
#[path = "suite/default_look.rs"]
mod default_look;
#[path = "suite/denoise.rs"]
mod denoise;
#[path = "suite/denoise_told.rs"]
mod denoise_told;
#[path = "suite/density.rs"]
mod density;
#[path = "suite/device_loss.rs"]
mod device_loss;
#[path = "suite/displays.rs"]
mod displays;
#[path = "suite/docs.rs"]
mod docs;
#[path = "suite/docs_commands.rs"]
mod docs_commands;
#[path = "suite/docs_results.rs"]
mod docs_results;
#[path = "suite/docs_tables.rs"]
mod docs_tables;
#[path = "suite/document.rs"]
mod document;
#[path = "suite/elementary.rs"]
mod elementary;
#[path = "suite/environment.rs"]
mod environment;
#[path = "suite/environment_files.rs"]
mod environment_files;
#[path = "suite/environment_sampling.rs"]
mod environment_sampling;
#[path = "suite/environment_shapes.rs"]
mod environment_shapes;
#[path = "suite/estimates.rs"]
mod estimates;
#[path = "suite/evaluate.rs"]
mod evaluate;
#[path = "suite/exchange.rs"]
mod exchange;
#[path = "suite/exchange_details.rs"]
mod exchange_details;
#[path = "suite/explain.rs"]
mod explain;
#[path = "suite/facets.rs"]
mod facets;
#[path = "suite/file_colors.rs"]
mod file_colors;
#[path = "suite/file_kinds.rs"]
mod file_kinds;
#[path = "suite/file_parameters.rs"]
mod file_parameters;
#[path = "suite/file_scenes.rs"]
mod file_scenes;
#[path = "suite/files.rs"]
mod files;
#[path = "suite/film.rs"]
mod film;
#[path = "suite/fit.rs"]
mod fit;
#[path = "suite/geometry.rs"]
mod geometry;
#[path = "suite/gltf.rs"]
mod gltf;
#[path = "suite/gltf_builder.rs"]
mod gltf_builder;
#[path = "suite/gltf_damaged.rs"]
mod gltf_damaged;
#[path = "suite/gltf_extensions.rs"]
mod gltf_extensions;
#[path = "suite/gltf_materials.rs"]
mod gltf_materials;
#[path = "suite/gltf_meaning.rs"]
mod gltf_meaning;
#[path = "suite/hierarchy.rs"]
mod hierarchy;
#[path = "suite/import_report.rs"]
mod import_report;
#[path = "suite/instances.rs"]
mod instances;
#[path = "suite/kept_files.rs"]
mod kept_files;
#[path = "suite/killed.rs"]
mod killed;
#[path = "suite/lanes.rs"]
mod lanes;
#[path = "suite/library.rs"]
mod library;
#[path = "suite/light_groups.rs"]
mod light_groups;
#[path = "suite/light_paths.rs"]
mod light_paths;
#[path = "suite/light_profiles.rs"]
mod light_profiles;
#[path = "suite/lights.rs"]
mod lights;
#[path = "suite/lobe_cases.rs"]
mod lobe_cases;
#[path = "suite/lobe_views.rs"]
mod lobe_views;
#[path = "suite/look_of_ggx.rs"]
mod look_of_ggx;
#[path = "suite/lut.rs"]
mod lut;
#[path = "suite/manual.rs"]
mod manual;
#[path = "suite/many_materials.rs"]
mod many_materials;
#[path = "suite/memory.rs"]
mod memory;
#[path = "suite/merge.rs"]
mod merge;
#[path = "suite/model_formats.rs"]
mod model_formats;
#[path = "suite/model_parts.rs"]
mod model_parts;
#[path = "suite/moved_lights.rs"]
mod moved_lights;
#[path = "suite/nobody_listens.rs"]
mod nobody_listens;
#[path = "suite/noise.rs"]
mod noise;
#[path = "suite/nothing_lost.rs"]
mod nothing_lost;
#[path = "suite/open_pbr_oracle.rs"]
mod open_pbr_oracle;
#[path = "suite/own_textures.rs"]
mod own_textures;
#[path = "suite/parameters.rs"]
mod parameters;
#[path = "suite/parting.rs"]
mod parting;
#[path = "suite/paths.rs"]
mod paths;
#[path = "suite/picture_files.rs"]
mod picture_files;
#[path = "suite/plan.rs"]
mod plan;
#[path = "suite/plan_kernels.rs"]
mod plan_kernels;
#[path = "suite/precision.rs"]
mod precision;
#[path = "suite/random_documents.rs"]
mod random_documents;
#[path = "suite/ray_queries.rs"]
mod ray_queries;
#[path = "suite/refused.rs"]
mod refused;
#[path = "suite/renders.rs"]
mod renders;
#[path = "suite/rough_diffuse.rs"]
mod rough_diffuse;
#[path = "suite/same_bits.rs"]
mod same_bits;
#[path = "suite/scattering.rs"]
mod scattering;
#[path = "suite/scenes.rs"]
mod scenes;
#[path = "suite/shadow_catcher.rs"]
mod shadow_catcher;
#[path = "suite/signals.rs"]
mod signals;
#[path = "suite/statistics.rs"]
mod statistics;
#[path = "suite/strangers.rs"]
mod strangers;
#[path = "suite/structure.rs"]
mod structure;
#[path = "suite/study.rs"]
mod study;
#[path = "suite/support.rs"]
mod support;
#[path = "suite/technique.rs"]
mod technique;
#[path = "suite/terminator.rs"]
mod terminator;
#[path = "suite/textures.rs"]
mod textures;
#[path = "suite/tone.rs"]
mod tone;
#[path = "suite/transmission.rs"]
mod transmission;
#[path = "suite/twin_names.rs"]
mod twin_names;
#[path = "suite/ui.rs"]
mod ui;
#[path = "suite/ui_browser.rs"]
mod ui_browser;
#[path = "suite/ui_edges.rs"]
mod ui_edges;
#[path = "suite/ui_export.rs"]
mod ui_export;
#[path = "suite/ui_files.rs"]
mod ui_files;
#[path = "suite/ui_hands.rs"]
mod ui_hands;
#[path = "suite/ui_lights.rs"]
mod ui_lights;
#[path = "suite/ui_look.rs"]
mod ui_look;
#[path = "suite/ui_notes.rs"]
mod ui_notes;
#[path = "suite/ui_objects.rs"]
mod ui_objects;
#[path = "suite/ui_panels.rs"]
mod ui_panels;
#[path = "suite/ui_pictures.rs"]
mod ui_pictures;
#[path = "suite/ui_queue.rs"]
mod ui_queue;
#[path = "suite/ui_scene.rs"]
mod ui_scene;
#[path = "suite/ui_strangers.rs"]
mod ui_strangers;
#[path = "suite/ui_study.rs"]
mod ui_study;
#[path = "suite/ui_textures.rs"]
mod ui_textures;
#[path = "suite/ui_views.rs"]
mod ui_views;
#[path = "suite/ui_workshop.rs"]
mod ui_workshop;
#[path = "suite/ui_workspaces.rs"]
mod ui_workspaces;
#[path = "suite/video.rs"]
mod video;
#[path = "suite/worker.rs"]
mod worker;

#[path = "suite/firefly.rs"]
mod firefly;
#[path = "suite/fuzz_layer.rs"]
mod fuzz_layer;
#[path = "suite/gpu_pictures.rs"]
mod gpu_pictures;
#[path = "suite/hard.rs"]
mod hard;
#[path = "suite/layouts.rs"]
mod layouts;
#[path = "suite/shaders.rs"]
mod shaders;
#[path = "suite/thin_film.rs"]
mod thin_film;
#[cfg(feature = "thorough")]
#[path = "suite/thorough/mod.rs"]
mod thorough;
#[path = "suite/twins/mod.rs"]
mod twins;
