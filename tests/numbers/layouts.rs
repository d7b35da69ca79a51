//! The structures that Rust writes and shaders read lie alike in memory: naga's offsets and sizes against Rust's.

use std::mem::offset_of;

use glossmith::{
    gpu::layout::{Globals, PixelColors, PixelStatistics, Tile, Triangle},
    job::guides::GuideSums,
    optics::material::{FIELDS, Field, Material},
    optics::target::TextureTarget,
    scene::{Vertex, camera::Camera},
};

use super::shaders::modules;

/// A structure as Rust lays it out.
struct Layout {
    name: &'static str,
    size: usize,
    /// Name, offset and size of each member.
    members: Vec<(String, usize, usize)>,
}

fn size_of_member<S, M>(_member: fn(&S) -> &M) -> usize {
    size_of::<M>()
}

macro_rules! layout {
    ($name:ident: $type:ty { $($member:ident),* $(,)? }) => {
        Layout {
            name: stringify!($name),
            size: size_of::<$type>(),
            members: vec![$((
                stringify!($member).to_owned(),
                offset_of!($type, $member),
                size_of_member(|s: &$type| &s.$member),
            )),*],
        }
    };
}

/// A field of a material; the shaders have one for each texture.
fn material_members(field: &Field) -> Vec<(String, usize, usize)> {
    if field.name != "textures" {
        return vec![(field.name.to_owned(), field.offset, field.size)];
    }
    let texture = |index: usize| {
        let named = |target: &TextureTarget| format!("{}_texture", target.name().replace('-', "_"));
        let name = TextureTarget::ALL.get(index).map(named);
        (name.unwrap_or(format!("spare_{index}")), field.offset + 4 * index, 4)
    };
    (0..field.size / 4).map(texture).collect()
}

fn rust_layouts() -> Vec<Layout> {
    vec![
        layout!(Globals: Globals {
            camera, image_size, bounces, sequence, background, background_kind, environment_rotation,
            environment_cells_size, environment_strength, strategy, seed, node_count, light_cells_size,
            environment_probability, density_per_luminance, firefly_clamp, catcher_slot, catcher_reflection_slot,
            catcher_table, least_reflections, around_root, around_triangle, camera_medium, first_hidden_slot, light_groups,
            rounds_surfaces, roulette_floor,
        }),
        layout!(Tile: Tile { origin, first_sample, sample_count }),
        layout!(PixelStatistics: PixelStatistics {
            luminance_squared, kept_dropped, rays_clamped, cut, unused,
        }),
        layout!(PixelColors: PixelColors { all, odd }),
        layout!(GuideSums: GuideSums { albedo, hits, normal, depth }),
        layout!(Camera: Camera<f32> {
            origin, lens_radius, forward, focus_distance, right, filter_kind, up, parallel_from,
        }),
        Layout {
            name: "Material",
            size: size_of::<Material<f32>>(),
            members: FIELDS.iter().flat_map(material_members).collect(),
        },
        layout!(Triangle: Triangle { corners }),
        layout!(Vertex: Vertex { normal, red_green, tangent, blue_side, uvs }),
    ]
}

#[test]
fn members_lie_alike_in_rust_and_wgsl() {
    let modules = modules();
    for rust in rust_layouts() {
        let named = |module: &naga::Module| {
            let found = module
                .types
                .iter()
                .find(|(_, found)| found.name.as_deref() == Some(rust.name));
            found.map(|(handle, _)| handle)
        };
        let mut places = modules
            .iter()
            .filter_map(|(_, module)| named(module).map(|handle| (module, handle)));
        let (module, handle) = places
            .next()
            .unwrap_or_else(|| panic!("no structure {} in the shaders", rust.name));
        let naga::TypeInner::Struct { members, span } = &module.types[handle].inner else {
            panic!("{} is no structure in the shaders", rust.name);
        };
        let wgsl: Vec<_> = members
            .iter()
            .map(|member| {
                let size = module.types[member.ty].inner.size(module.to_ctx());
                let name = member.name.clone().unwrap_or_default();
                (name, member.offset as usize, size as usize)
            })
            .collect();
        assert_eq!(
            wgsl, rust.members,
            "{}: (name, offset, size) in WGSL and in Rust",
            rust.name
        );
        assert_eq!(*span as usize, rust.size, "{}: size in WGSL and in Rust", rust.name);
        // The distance of an array's elements.
        let mut layouter = naga::proc::Layouter::default();
        layouter.update(module.to_ctx()).unwrap();
        assert_eq!(
            layouter[handle].to_stride() as usize,
            rust.size,
            "{}: stride",
            rust.name
        );
        let sum: usize = rust.members.iter().map(|(_, _, size)| size).sum();
        assert_eq!(
            sum, rust.size,
            "{}: a member of the Rust structure is not compared",
            rust.name
        );
    }
}

/// The structures that a type is made of.
fn collect_structures(module: &naga::Module, ty: naga::Handle<naga::Type>, names: &mut Vec<String>) {
    let found = &module.types[ty];
    match &found.inner {
        naga::TypeInner::Struct { members, .. } => {
            names.push(found.name.clone().unwrap_or_default());
            for member in members {
                collect_structures(module, member.ty, names);
            }
        }
        naga::TypeInner::Array { base, .. } => collect_structures(module, *base, names),
        _ => {}
    }
}

#[test]
fn every_bound_structure_is_compared() {
    let compared: Vec<_> = rust_layouts().iter().map(|layout| layout.name.to_owned()).collect();
    let mut bound = Vec::new();
    for (_, module) in modules() {
        for (_, variable) in module.global_variables.iter().filter(|(_, v)| v.binding.is_some()) {
            collect_structures(&module, variable.ty, &mut bound);
        }
    }
    assert!(!bound.is_empty());
    for name in bound {
        assert!(
            compared.contains(&name),
            "{name} is bound, but its layout is not compared"
        );
    }
}
