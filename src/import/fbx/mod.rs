//! FBX files, by the ufbx crate: their hierarchy in a pose, in metres and with Y up, with materials, cameras and lights.
//!
//! The crate evaluates skins, blend shapes and curves, and knows the units and axes of the programs that write the format.

mod material;
pub mod polygons;

use std::{collections::HashMap, path::Path};

use glam::{DMat4, DVec3};
use ufbx::{
    AllocatorOpts, CoordinateAxes, ElementType, ErrorType, EvaluateOpts, IndexErrorHandling, LightDecay, LightType,
    LoadOpts, ProgressCb, ProgressResult, ProjectionMode, SubdivisionDisplayMode,
};

pub use self::material::FBX_PARAMETERS;

use self::material::{Painted, Painter};
use self::polygons::{Broken, Look, Polygons};
use crate::{
    assembly::{Assembly, camera_at, light_at},
    files::{Files, Import},
    limits::LIMIT_VARIABLE,
    maps::Maps,
    model_error::ModelError,
    scene::{
        LightKind, Loading, Model, ModelCamera, ModelLens, ModelLight, ModelOptions, Slot,
        mesh::Mesh,
        report::{Fate, ImportReport},
        texture::TextureTarget,
    },
};

/// Nodes deeper than this are refused.
const DEPTH_MAX: u32 = 4096;

/// What an import may take of memory with this crate.
fn limited(import: &Import) -> AllocatorOpts {
    AllocatorOpts {
        allocator: ufbx::Allocator::Libc,
        // Half for the scene, half for what is made on the way; 0 is no limit.
        memory_limit: usize::try_from(import.budget.left() / 2).unwrap_or(usize::MAX).max(1),
        ..AllocatorOpts::default()
    }
}

/// Options of every file of the crate: what it may take, and when it stops.
pub fn options_of<'a>(import: &Import, progress: &'a dyn Fn(&ufbx::Progress) -> ProgressResult) -> LoadOpts<'a> {
    LoadOpts {
        temp_allocator: limited(import),
        result_allocator: limited(import),
        node_depth_limit: DEPTH_MAX,
        index_error_handling: IndexErrorHandling::NoIndex,
        no_format_from_content: true,
        progress_cb: ProgressCb::Ref(progress),
        ..LoadOpts::default()
    }
}

/// Stops the crate where the import is not wanted any more.
pub fn progress_of(loading: &Loading) -> impl Fn(&ufbx::Progress) -> ProgressResult {
    |_| match loading.check() {
        Ok(()) => ProgressResult::Continue,
        Err(_) => ProgressResult::Cancel,
    }
}

/// Why the crate can't read a file.
pub fn unread(path: &Path, import: &Import, error: &ufbx::Error) -> ModelError {
    match error.type_ {
        ErrorType::MemoryLimit | ErrorType::OutOfMemory | ErrorType::AllocationLimit => {
            let mib = import.budget.left() >> 20;
            let remedy = format_args!("make it smaller, or allow more by {LIMIT_VARIABLE}=MIB");
            ModelError::refused(
                path,
                format_args!("it takes more than the {mib} MiB that are left for it; {remedy}"),
            )
        }
        ErrorType::NodeDepthLimit => {
            let what = format_args!("its nodes are deeper than {DEPTH_MAX}; flatten its hierarchy");
            ModelError::refused(path, what)
        }
        ErrorType::UnrecognizedFileFormat | ErrorType::EmptyFile => {
            ModelError::refused(path, "no FBX file by its content; export the model again")
        }
        ErrorType::UnsupportedVersion => ModelError::refused(
            path,
            "of a version of FBX that is not read; export the model as FBX 2014 or later",
        ),
        ErrorType::Unknown => ModelError::invalid(path, "a part of it breaks the rules of the format"),
        _ => ModelError::invalid(path, &*error.description),
    }
}

/// Reports what the crate had to mend.
pub fn report_warnings(scene: &ufbx::Scene, report: &mut ImportReport) {
    for warning in &scene.metadata.warnings {
        let what = format!("what the file has wrong ({})", &*warning.description);
        report.count(Fate::Ignored, what, "", warning.count.max(1));
    }
}

/// Loads the contents of an FBX file.
pub fn load(path: &Path, files: &Files, bytes: &[u8], options: &ModelOptions) -> Result<Model, ModelError> {
    let import = &files.import;
    let loading = &import.loading;
    let progress = progress_of(loading);
    let at_rest = ufbx::load_memory(
        bytes,
        LoadOpts {
            file_format: ufbx::FileFormat::Fbx,
            target_axes: CoordinateAxes::right_handed_y_up(),
            target_camera_axes: CoordinateAxes::right_handed_y_up(),
            target_unit_meters: 1.0,
            evaluate_skinning: true,
            clean_skin_weights: true,
            use_blender_pbr_material: true,
            generate_missing_normals: true,
            ..options_of(import, &progress)
        },
    );
    loading.check()?;
    let at_rest = at_rest.map_err(|error| unread(path, import, &error))?;
    let animation = at_rest.anim_stacks.as_ref().first();
    #[expect(clippy::result_large_err, reason = "the library's own error")]
    let posed = animation.zip(options.time_s).map(|(animation, time_s)| {
        let options = EvaluateOpts {
            temp_allocator: limited(import),
            result_allocator: limited(import),
            evaluate_skinning: true,
            ..EvaluateOpts::default()
        };
        let time_s = animation.time_begin + f64::from(time_s);
        ufbx::evaluate_scene(&at_rest, &animation.anim, time_s, options)
    });
    let posed = posed.transpose().map_err(|error| unread(path, import, &error))?;
    let scene: &ufbx::Scene = posed.as_ref().unwrap_or(&at_rest);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut reader = Reader {
        scene,
        loading,
        path,
        stem: &stem,
        maps: Maps::new(files, options),
        slot_of: HashMap::new(),
        painted: Vec::new(),
        report: ImportReport::default(),
    };
    report_warnings(&at_rest, &mut reader.report);
    let model = reader.model()?;
    Ok(Model {
        duration_s: animation.map_or(0.0, |animation| {
            (animation.time_end - animation.time_begin).max(0.0) as f32
        }),
        ..model
    })
}

struct Reader<'a> {
    scene: &'a ufbx::Scene,
    loading: &'a Loading,
    path: &'a Path,
    stem: &'a str,
    maps: Maps<'a>,
    /// Slot of a material by its number; none for faces without one.
    slot_of: HashMap<Option<u32>, u32>,
    painted: Vec<Painted>,
    report: ImportReport,
}

impl Reader<'_> {
    fn model(mut self) -> Result<Model, ModelError> {
        let (scene, loading) = (self.scene, self.loading);
        let nodes = scene.nodes.as_ref();
        let shown: Vec<bool> = nodes.iter().map(|node| self.is_shown(node)).collect();
        let with_mesh = || nodes.iter().zip(&shown).filter(|(_, shown)| **shown);
        let with_mesh = || with_mesh().filter_map(|(node, _)| Some((node, node.mesh.as_deref()?)));
        let keys = with_mesh().map(|(node, mesh)| use_of(node, mesh));
        let mut assembly = Assembly::new(self.path, loading, keys);
        for (node, mesh) in with_mesh() {
            let world_from_mesh = match mesh.skinned_is_local {
                true => matrix(&node.geometry_to_world),
                // Its bones have placed it.
                false => DMat4::IDENTITY,
            };
            let named = (node.element.element_id as usize, &*node.element.name);
            assembly.place(use_of(node, mesh), named, world_from_mesh, || self.mesh(node, mesh))?;
        }
        let mut model = assembly.finish(&mut self.report);
        self.report_others();
        for (node, is_shown) in nodes.iter().zip(&shown) {
            // Cameras are there all the same.
            model
                .cameras
                .extend(node.camera.as_deref().and_then(|camera| self.camera(node, camera)));
            let light = node.light.as_deref().filter(|_| *is_shown);
            model.lights.extend(light.and_then(|light| self.light(node, light)));
        }
        let mut slots: Vec<Slot> = self.painted.into_iter().map(|painted| painted.slot).collect();
        Ok(Model {
            textures: self.maps.finish(&mut slots),
            slots,
            report: self.report,
            ..model
        })
    }

    /// Whether a node and those above it are visible; of levels of detail the first is.
    fn is_shown(&mut self, node: &ufbx::Node) -> bool {
        let (mut above, mut below) = (Some(node), None::<&ufbx::Node>);
        while let Some(node) = above {
            let first = node.children.as_ref().first().map(|child| child.element.element_id);
            let is_coarse = below.is_some_and(|below| Some(below.element.element_id) != first);
            // Before FBX 6 it was a percentage, which the crate takes for 0.
            let share = node.element.props.find_prop("Visibility");
            let is_visible = node.visible || share.is_some_and(|share| share.value_vec4.x > 0.0);
            if !is_visible || node.attrib_type == ElementType::LodGroup && is_coarse {
                let what = match is_visible {
                    true => "coarser levels of detail",
                    false => "hidden nodes, not shown",
                };
                let fate = if is_visible { Fate::Ignored } else { Fate::Used };
                self.report.note(fate, what, &node.element.name);
                return false;
            }
            (below, above) = (above, node.parent.as_deref());
        }
        true
    }

    fn mesh(&mut self, node: &ufbx::Node, mesh: &ufbx::Mesh) -> Mesh {
        let polygons = Polygons::new(mesh, &[], self.loading);
        let (mut read, mut broken) = (Mesh::default(), Broken::default());
        let name = &*node.element.name;
        for (index, part) in mesh
            .material_parts
            .iter()
            .enumerate()
            .filter(|(_, part)| part.num_triangles > 0)
        {
            let material = node.materials.as_ref().get(index);
            let slot = self.slot(material.map(|material| &**material));
            let painted = &mut self.painted[slot as usize];
            let set = |wanted: &Option<String>| {
                let mut sets = mesh.uv_sets.iter();
                let named = sets.find(|set| wanted.as_deref() == Some(&*set.name));
                named.map_or(&mesh.vertex_uv, |set| &set.vertex_uv)
            };
            let second = painted.uv_sets[1].as_ref().map(|_| set(&painted.uv_sets[1]));
            let normal = [TextureTarget::Normal, TextureTarget::CoatNormal];
            let place = normal.into_iter().find_map(|target| painted.slot.texture(target));
            let has_texture = painted.slot.texture(TextureTarget::BaseColor).is_some();
            let has_colors = mesh.vertex_color.exists;
            let look = Look {
                slot,
                uvs: [Some(set(&painted.uv_sets[0])), second],
                // Beside a texture they are masks and weights more often than colours.
                colors: (has_colors && !has_texture).then_some(&mesh.vertex_color),
                normal_texture_from_uv: place.map(|place| place.texture_from_mesh_uv),
            };
            if look.colors.is_some() {
                painted.slot.color_by_vertices();
                self.report.note(Fate::Used, "vertex colours", name);
            } else if has_colors {
                self.report.note(Fate::Ignored, "vertex colours beside a texture", name);
            }
            read.append(polygons.read(&part.face_indices, &look, &mut broken, self.loading));
        }
        broken.report(name, &mut self.report);
        let has_lines = mesh.num_line_faces + mesh.num_point_faces > 0;
        for (is_there, fate, what) in [
            (mesh.skin_deformers.count > 0, Fate::Used, "skinned meshes"),
            (mesh.blend_deformers.count > 0, Fate::Used, "blend shapes"),
            (
                mesh.cache_deformers.count > 0,
                Fate::Ignored,
                "a cache of vertices, which is at rest",
            ),
            (has_lines, Fate::Ignored, "points and lines"),
            (
                mesh.subdivision_display_mode != SubdivisionDisplayMode::Disabled,
                Fate::Approximated,
                "a subdivision surface, as its cage",
            ),
        ] {
            if is_there {
                self.report.note(fate, what, name);
            }
        }
        read
    }

    fn slot(&mut self, material: Option<&ufbx::Material>) -> u32 {
        let key = material.map(|material| material.element.element_id);
        if let Some(slot) = self.slot_of.get(&key) {
            return *slot;
        }
        let painted = match material {
            Some(material) => Painter::new(material, &mut self.maps, &mut self.report, self.stem).paint(),
            None => {
                self.report.note(Fate::Used, "surfaces without a material, as clay", "");
                Painted {
                    slot: Slot::clay(),
                    ..Painted::default()
                }
            }
        };
        self.painted.push(painted);
        let slot = self.painted.len() as u32 - 1;
        self.slot_of.insert(key, slot);
        slot
    }

    /// A camera looks along −Z of its node.
    fn camera(&mut self, node: &ufbx::Node, camera: &ufbx::Camera) -> Option<ModelCamera> {
        let world_from_node = matrix(&node.node_to_world);
        let lens = match camera.projection_mode {
            ProjectionMode::Perspective => ModelLens::Perspective(camera.field_of_view_deg.y),
            ProjectionMode::Orthographic => {
                let metres = self.scene.metadata.root_scale;
                ModelLens::Orthographic(camera.orthographic_size.y * metres)
            }
        };
        camera_at(&node.element.name, world_from_node, lens)
    }

    fn light(&mut self, node: &ufbx::Node, light: &ufbx::Light) -> Option<ModelLight> {
        let name = &*node.element.name;
        let mut note = |fate, what: &str| self.report.note(fate, what, name);
        let half = |whole_deg: f64| (whole_deg / 2.0).clamp(0.0, 89.0).to_radians();
        let kind = match light.type_ {
            LightType::Point => LightKind::Point,
            LightType::Directional => LightKind::Directional,
            LightType::Spot => {
                let outer = half(light.outer_angle);
                LightKind::Spot([half(light.inner_angle).min(outer), outer])
            }
            LightType::Area => {
                note(Fate::Approximated, "an area of light, as a spot");
                LightKind::Spot([half(180.0); 2])
            }
            LightType::Volume => {
                note(Fate::Ignored, "a volume of light");
                return None;
            }
        };
        if kind != LightKind::Directional && light.decay != LightDecay::Quadratic {
            note(
                Fate::Approximated,
                "a light that fades in another way, as with the square of the distance",
            );
        }
        note(
            Fate::Approximated,
            "the intensity of a light, whose unit the format does not say",
        );
        let world_from_node = matrix(&node.node_to_world);
        let direction = &light.local_direction;
        let direction = DVec3::new(direction.x, direction.y, direction.z);
        let color = [light.color.x, light.color.y, light.color.z].map(|x| x as f32);
        let shining = (color, light.intensity as f32);
        light_at((name, kind), world_from_node, direction, shining).filter(|_| light.cast_light)
    }

    /// Reports what a scene has besides meshes, lights and cameras.
    fn report_others(&mut self) {
        let scene = self.scene;
        for (what, count) in [
            ("curves", scene.line_curves.count + scene.nurbs_curves.count),
            (
                "NURBS surfaces",
                scene.nurbs_surfaces.count + scene.nurbs_trim_surfaces.count,
            ),
            ("procedural geometry", scene.procedural_geometries.count),
            ("constraints between nodes", scene.constraints.count),
            ("stereo cameras", scene.stereo_cameras.count),
        ] {
            self.report.count(Fate::Ignored, what, "", count);
        }
    }
}

/// What nodes must share to have the same mesh: one with other materials is another.
fn use_of(node: &ufbx::Node, mesh: &ufbx::Mesh) -> u32 {
    let same =
        |(own, of_mesh): (&ufbx::Material, &ufbx::Material)| own.element.element_id == of_mesh.element.element_id;
    let (own, of_mesh) = (&node.materials, &mesh.materials);
    match own.count == of_mesh.count && own.into_iter().zip(of_mesh).all(same) && mesh.skinned_is_local {
        true => mesh.element.element_id,
        false => node.element.element_id,
    }
}

fn matrix(m: &ufbx::Matrix) -> DMat4 {
    DMat4::from_cols_array(&[
        m.m00, m.m10, m.m20, 0.0, m.m01, m.m11, m.m21, 0.0, m.m02, m.m12, m.m22, 0.0, m.m03, m.m13, m.m23, 1.0,
    ])
}
