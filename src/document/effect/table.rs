//! The table of effects.

use super::{Effect, Switch, horizon};
use crate::document::import::{ImportLobe, ROUGHNESS_MAX};
use crate::document::{AreaLight, Background, Denoise, Document, GroundKind, MaterialSettings, Strategy};
use crate::job::effect::{ANY, Decision, EffectId};
use crate::optics::curve::Curve;
use crate::optics::fresnel::Fresnel;
use crate::optics::layer::material_is_mirror;
use crate::optics::lobe::Lobe;
use crate::optics::material::{
    COAT_ABSORBS, COAT_IS_GGX, COMPENSATES, HAS_BOX, Material, VERTEX_BASE, VERTEX_EMISSION, VERTEX_OPACITY,
};
use crate::optics::vector::Vec3;
use crate::scene::texture::TextureTarget as On;

/// Every effect, in the order of [`EffectId::ALL`].
pub static EFFECTS: &[Effect] = &[
    Effect {
        id: EffectId::Environment,
        label: "Environment light",
        help: "Light that arrives from the environment map.",
        decide: |facts| {
            if facts.is_environment_black() {
                Decision::off("the environment is black")
            } else {
                Decision::on("the environment shines")
            }
        },
        remove: Some(|document| document.lighting.strength = 0.0),
    },
    Effect {
        id: EffectId::LightSampling,
        label: "Sampling the environment",
        help: "Directions drawn where the environment is bright, a shadow ray for each.",
        decide: |facts| {
            let environment = facts.environment;
            if facts.is_environment_black() {
                Decision::off("the environment is black")
            } else if environment.is_constant {
                Decision::off("the environment is equally bright everywhere")
            } else if facts.settings.strategy == Strategy::Lobe {
                Decision::off("light is found by the lobes alone")
            } else if facts.materials.iter().all(material_is_mirror) {
                Decision::off("every surface is a mirror, which meets light in one direction only")
            } else {
                Decision::on("environment brightness varies")
            }
        },
        remove: Some(|document| document.render.effects.set(EffectId::LightSampling, Switch::Off)),
    },
    Effect {
        id: EffectId::AreaLights,
        label: "Area lights",
        help: "Rectangles, discs, spots and suns that shine beside the model.",
        decide: |facts| match facts.document.lighting.shining().count() {
            0 => Decision::off("there is no area light"),
            1 => Decision::on("there is one area light"),
            lights => Decision::on(format!("there are {lights} area lights")),
        },
        remove: Some(|document| document.lighting.area_lights.clear()),
    },
    Effect {
        id: EffectId::Spot,
        label: "Spots",
        help: "Area lights that send their light into a cone, or by a profile.",
        decide: |facts| {
            let lighting = &facts.document.lighting;
            match (
                lighting.shining().any(AreaLight::is_spot),
                lighting.shining().any(AreaLight::has_profile),
            ) {
                (true, _) => Decision::on("an area light is a spot"),
                (_, true) => Decision::on("an area light has a profile"),
                _ => Decision::off("no light is a spot or has a profile"),
            }
        },
        remove: Some(|document| {
            let lights = &mut document.lighting.area_lights;
            lights.retain(|light| !light.is_spot() && !light.has_profile());
        }),
    },
    Effect {
        id: EffectId::Emission,
        label: "Emission",
        help: "Light that surfaces give off.",
        decide: |facts| facts.needed_by(|material| material.emission.max_component() > 0.0, "emits light"),
        remove: Some(|document| {
            document.lighting.area_lights.clear();
            each_material(document, |material| material.emission_strength = 0.0);
        }),
    },
    Effect {
        id: EffectId::EmitterSampling,
        label: "Sampling emitters",
        help: "Directions drawn towards the triangles that emit, a shadow ray for each.",
        decide: |facts| {
            if facts.settings.light_choice.density_per_luminance <= 0.0 {
                Decision::off("no triangle emits light")
            } else if facts.settings.strategy == Strategy::Lobe {
                Decision::off("light is found by the lobes alone")
            } else if facts.materials.iter().all(material_is_mirror) {
                Decision::off("every surface is a mirror, which meets light in one direction only")
            } else {
                Decision::on("some triangles emit light")
            }
        },
        remove: Some(|document| document.render.effects.set(EffectId::EmitterSampling, Switch::Off)),
    },
    Effect {
        id: EffectId::Background,
        label: "Background",
        help: "The environment, seen by the camera directly.",
        decide: |facts| match facts.document.lighting.background {
            Background::Environment => Decision::on("the environment is visible"),
            Background::Transparent => Decision::off("the background is transparent"),
            Background::Color(_) => Decision::off("the background is one colour"),
        },
        remove: Some(|document| document.lighting.background = Background::Transparent),
    },
    Effect {
        id: EffectId::Ground,
        label: "Ground",
        help: "A surface under the model, on which it casts its shadow.",
        decide: |facts| {
            if facts.document.ground {
                Decision::on("the model stands on a ground")
            } else {
                Decision::off("there is no ground")
            }
        },
        remove: Some(|document| document.ground = false),
    },
    Effect {
        id: EffectId::ShadowCatcher,
        label: "Shadow catcher",
        help: "A ground of which only shadows and reflections are seen, over the background.",
        decide: |facts| {
            if facts.settings.catcher.is_some() {
                Decision::on("the ground shows shadows and reflections alone")
            } else if facts.document.ground {
                Decision::off("the ground is seen itself")
            } else {
                Decision::off("there is no ground")
            }
        },
        remove: Some(|document| document.lighting.ground.kind = GroundKind::Plane),
    },
    Effect {
        id: EffectId::Interreflection,
        label: "Shadows and indirect light",
        help: "Rays that leave a surface and may meet another one.",
        decide: |facts| {
            if facts.geometry.is_convex() {
                Decision::off("the scene is one convex body: rays that leave it hit nothing")
            } else if facts.settings.bounces <= 1 {
                Decision::on("paths end at the first surface, but shadows are cast")
            } else {
                Decision::on("surfaces may see each other")
            }
        },
        remove: None,
    },
    Effect {
        id: EffectId::ShadowTerminator,
        label: "Shadow terminator",
        help: "Light on the round surface that smooth normals describe, instead of on its coarse triangles.",
        decide: |facts| {
            if facts.settings.rounds_surfaces {
                Decision::on("smooth normals lean away from coarse triangles")
            } else {
                Decision::off("the triangles are as fine as their normals are smooth")
            }
        },
        remove: Some(|document| document.render.effects.set(EffectId::ShadowTerminator, Switch::Off)),
    },
    Effect {
        id: EffectId::Base,
        label: "Diffuse base",
        help: "Light that enters the surface and leaves it in all directions (Lambert).",
        decide: |facts| facts.needed_by(Material::has_base, "has a diffuse base"),
        remove: Some(|document| {
            each_material(document, |material| material.base_weight = 0.0);
            document.lighting.ground_color = [0.0; 3];
        }),
    },
    Effect {
        id: EffectId::DiffuseRoughness,
        label: "Rough base",
        help: "A diffuse base that scatters more light back to where it comes from, as clay and cloth do (EON).",
        decide: |facts| facts.needed_by(|m| m.has_base() && m.diffuse_roughness > 0.0, "has a rough base"),
        remove: Some(|document| each_material(document, |material| material.diffuse_roughness = 0.0)),
    },
    Effect {
        id: EffectId::Specular,
        label: "Specular lobe",
        help: "Light that the surface reflects around the mirror direction.",
        decide: |facts| facts.needed_by(Material::has_specular, "reflects"),
        remove: Some(|document| {
            for material in &mut document.materials {
                material.specular_weight = 0.0;
                material.specular_on_metal = true;
                material.transmission_weight = 0.0;
            }
        }),
    },
    Effect {
        id: EffectId::Lobe,
        label: "Multiple lobes",
        help: "Code for every lobe, chosen from at each hit; with one lobe in the scene, only that one's.",
        decide: |facts| facts.shared(|material| material.lobe, |number| Lobe::ALL[number as usize].label()),
        remove: None,
    },
    Effect {
        id: EffectId::Curve,
        label: "Multiple curves",
        help: "Code for every D(ξ) curve, the interception of the long tail's among it; with one curve, only that one's.",
        decide: |facts| {
            let geometric = facts
                .reflecting()
                .filter(|material| Lobe::ALL[material.lobe as usize].has_curves());
            let mut curves = geometric.map(|material| material.curve);
            let Some(first) = curves.next() else {
                // Any number will do; the first keeps the other curves' code out.
                return Decision {
                    value: 0,
                    ..Decision::off("no material has a geometric lobe")
                };
            };
            let label = |number: u32| Curve::ALL[number as usize].label();
            match curves.find(|&curve| curve != first) {
                None => Decision::which(first, format!("{} in every geometric lobe", label(first))),
                Some(other) => Decision::which(ANY, format!("{} and {} are mixed", label(first), label(other))),
            }
        },
        remove: None,
    },
    Effect {
        id: EffectId::Anisotropy,
        label: "Anisotropy",
        help: "Lobes stretched along the surface's tangent.",
        decide: |facts| {
            facts.needed_by(
                |m| (m.has_specular() && m.anisotropy != 0.0) || (m.coat_weight > 0.0 && m.coat_anisotropy != 0.0),
                "stretches its lobe",
            )
        },
        remove: Some(|document| {
            each_material(document, |material| {
                (material.anisotropy, material.coat_anisotropy) = (0.0, 0.0);
            });
        }),
    },
    Effect {
        id: EffectId::Horizon,
        label: "Horizon",
        help: "What happens to samples of a lobe that point into the surface.",
        decide: horizon::decide,
        remove: None,
    },
    Effect {
        id: EffectId::Fresnel,
        label: "Fresnel",
        help: "Code for every Fresnel term, chosen from at each hit; with one term in the scene, only that one's.",
        decide: |facts| facts.shared(|m| m.fresnel, |number| Fresnel::ALL[number as usize].label()),
        remove: None,
    },
    Effect {
        id: EffectId::EdgeTint,
        label: "Edge tint",
        help: "Metals whose reflection is tinted towards grazing angles (F82).",
        decide: |facts| {
            facts.needed_by(
                |m| m.has_specular() && m.edge_tint != Vec3::splat(1.0),
                "tints its edge",
            )
        },
        remove: Some(|document| each_material(document, |material| material.edge_tint = [1.0; 3])),
    },
    Effect {
        id: EffectId::MultipleScattering,
        label: "Multiple scattering",
        help: "Light that meets more than one facet of rough GGX, in metals and clear dielectrics (Turquin 2019).",
        decide: |facts| facts.needed_by(|m| m.has_flag(COMPENSATES), "would lose light between its facets"),
        remove: Some(|document| each_material(document, |material| material.multiple_scattering = false)),
    },
    Effect {
        id: EffectId::Fuzz,
        label: "Fuzz",
        help: "Small fibres over the other lobes, brightest at the edge: velvet, peach, dust.",
        decide: |facts| facts.needed_by(|m| m.fuzz_weight > 0.0, "has fuzz"),
        remove: Some(|document| each_material(document, |material| material.fuzz_weight = 0.0)),
    },
    Effect {
        id: EffectId::Coat,
        label: "Coat",
        help: "A clear layer over the other lobes, with a reflection of its own.",
        decide: |facts| facts.needed_by(|m| m.coat_weight > 0.0, "has a coat"),
        remove: Some(|document| each_material(document, |material| material.coat_weight = 0.0)),
    },
    Effect {
        id: EffectId::CoatGgx,
        label: "GGX coat",
        help: "A coat that spreads its reflection as GGX does.",
        decide: |facts| facts.needed_by(|m| m.has_flag(COAT_IS_GGX), "has a coat of GGX"),
        remove: Some(|document| {
            each_material(document, |material| {
                let roughness = material.coat_ggx_roughness();
                material.set_coat_ggx_roughness(roughness.min(ROUGHNESS_MAX), ImportLobe::Geometric);
            });
        }),
    },
    Effect {
        id: EffectId::CoatDarkening,
        label: "Coat darkening",
        help: "Bases that get darker by the light that a coat reflects back onto them (OpenPBR 1.1).",
        decide: |facts| {
            facts.needed_by(
                |m| m.coat_weight > 0.0 && m.coat_darkening > 0.0,
                "is darkened by its coat",
            )
        },
        remove: Some(|document| each_material(document, |material| material.coat_darkening = 0.0)),
    },
    Effect {
        id: EffectId::CoatAbsorption,
        label: "Coat absorption",
        help: "Coloured coats that take more light the longer its way through them, and from light that comes from below.",
        decide: |facts| facts.needed_by(|m| m.has_flag(COAT_ABSORBS), "has a coloured coat"),
        remove: Some(|document| {
            each_material(document, |material| {
                if material.coat_on_base {
                    material.coat_color = [1.0; 3];
                }
            });
        }),
    },
    Effect {
        id: EffectId::ThinFilm,
        label: "Thin film",
        help: "Interference in a film over the surface that reflects: soap, oil, tempered steel.",
        decide: |facts| facts.needed_by(|m| m.has_film == 1, "has a thin film"),
        remove: Some(|document| each_material(document, |material| material.film_weight = 0.0)),
    },
    Effect {
        id: EffectId::Transmission,
        label: "Refraction",
        help: "Light that passes through surfaces and is refracted there.",
        decide: |facts| facts.needed_by(Material::transmits, "transmits light"),
        remove: Some(|document| each_material(document, |material| material.transmission_weight = 0.0)),
    },
    Effect {
        id: EffectId::Absorption,
        label: "Absorption",
        help: "Light that fades on its way through a clear solid (Beer and Lambert).",
        decide: |facts| {
            facts.needed_by(
                |material| material.transmits() && material.absorption.max_component() > 0.0,
                "absorbs light inside",
            )
        },
        remove: Some(|document| {
            for material in &mut document.materials {
                // Without a depth the colour tints the surface: white is what absorbs nothing.
                if material.transmission_depth > 0.0 {
                    material.transmission_color = [1.0; 3];
                }
            }
        }),
    },
    Effect {
        id: EffectId::ColorTexture,
        label: "Colour textures",
        help: "Base colours from textures or vertex colours.",
        decide: |facts| {
            let is_colored = |m: &Material<f32>| m.has_texture(&[On::BaseColor]) || m.has_flag(VERTEX_BASE);
            facts.needed_by(is_colored, "takes its colour from a texture or from its vertices")
        },
        remove: Some(|document| without_textures(document, &[On::BaseColor])),
    },
    Effect {
        id: EffectId::RoughnessTexture,
        label: "Roughness textures",
        help: "Roughness and metalness from textures.",
        decide: |facts| {
            let is_looked_up = |m: &Material<f32>| m.has_texture(&[On::Roughness, On::Metalness]);
            facts.needed_by(is_looked_up, "takes its roughness from a texture")
        },
        remove: Some(|document| without_textures(document, &[On::Roughness])),
    },
    Effect {
        id: EffectId::RoughTables,
        label: "Energy-compensation tables",
        help: "What the base is left with where a texture changes the roughness, or the surface is metal in part.",
        decide: |facts| {
            facts.needed_by(
                |m| m.has_rough_tables == 1,
                "is metal in part, or its roughness changes over a base",
            )
        },
        remove: None,
    },
    Effect {
        id: EffectId::NormalMap,
        label: "Normal maps",
        help: "Shading normals from normal maps.",
        decide: |facts| facts.needed_by(|m| m.has_texture(&[On::Normal]), "has a normal map"),
        remove: Some(|document| without_textures(document, &[On::Normal])),
    },
    Effect {
        id: EffectId::EmissionTexture,
        label: "Emission textures",
        help: "Emission from textures.",
        decide: |facts| facts.needed_by(|m| m.has_texture(&[On::Emission]), "takes its emission from a texture"),
        remove: Some(|document| without_textures(document, &[On::Emission])),
    },
    Effect {
        id: EffectId::VertexColors,
        label: "Light and opacity of vertices",
        help: "Emission and opacity that change from vertex to vertex.",
        decide: |facts| {
            facts.needed_by(
                |m| m.has_flag(VERTEX_EMISSION | VERTEX_OPACITY),
                "shines or is clear by the colours of its vertices",
            )
        },
        remove: Some(|document| without_textures(document, &[On::Emission, On::Opacity])),
    },
    Effect {
        id: EffectId::CoatTexture,
        label: "Coat textures",
        help: "Weight, roughness and colour of coats from textures.",
        decide: |facts| facts.needed_by(|m| m.has_texture(On::OF_COAT), "has a texture of its coat"),
        remove: Some(|document| without_textures(document, On::OF_COAT)),
    },
    Effect {
        id: EffectId::CoatNormalMap,
        label: "Coat normal maps",
        help: "Normals of coats bent by a texture of their own.",
        decide: |facts| facts.needed_by(|m| m.has_texture(&[On::CoatNormal]), "bends the normals of its coat"),
        remove: Some(|document| without_textures(document, &[On::CoatNormal])),
    },
    Effect {
        id: EffectId::FilmTexture,
        label: "Thin film textures",
        help: "Weights and thicknesses of thin films from textures.",
        decide: |facts| facts.needed_by(|m| m.has_texture(On::OF_FILM), "takes its thin film from a texture"),
        remove: Some(|document| without_textures(document, On::OF_FILM)),
    },
    Effect {
        id: EffectId::FuzzTexture,
        label: "Fuzz textures",
        help: "Weight, colour and roughness of fuzz from textures.",
        decide: |facts| facts.needed_by(|m| m.has_texture(On::OF_FUZZ), "has a texture of its fuzz"),
        remove: Some(|document| without_textures(document, On::OF_FUZZ)),
    },
    Effect {
        id: EffectId::BoxProjection,
        label: "Box projection",
        help: "Images that lie on a surface as on a box, without texture coordinates.",
        decide: |facts| facts.needed_by(|m| m.has_flag(HAS_BOX), "has a texture that lies on it as on a box"),
        remove: Some(|document| each_material(document, MaterialSettings::without_boxes)),
    },
    Effect {
        id: EffectId::Alpha,
        label: "Opacity",
        help: "Surfaces that let some light go straight on.",
        decide: |facts| {
            if facts.materials.iter().any(Material::has_holes) {
                facts.needed_by(Material::has_holes, "is not opaque everywhere")
            } else if facts.settings.first_hidden_slot != u32::MAX {
                Decision::on("the camera looks through a hidden light")
            } else {
                Decision::off("all materials are opaque")
            }
        },
        remove: Some(|document| {
            for material in &mut document.materials {
                material.textures[On::Opacity] = false;
                material.opacity = 1.0;
            }
            for light in &mut document.lighting.area_lights {
                light.is_hidden = false;
            }
        }),
    },
    Effect {
        id: EffectId::DepthOfField,
        label: "Depth of field",
        help: "Thin-lens blur away from the focus distance.",
        decide: |facts| {
            if facts.settings.camera.lens_radius > 0.0 {
                Decision::on("the lens is open")
            } else {
                Decision::off("the camera is a pinhole")
            }
        },
        remove: Some(|document| document.camera.aperture = 0.0),
    },
    Effect {
        id: EffectId::FireflyClamp,
        label: "Firefly clamp",
        help: "Clamps indirect light: less noise, slightly darker.",
        decide: |facts| match facts.document.render.firefly_clamp {
            Some(limit) => Decision::on(format!("limited to a radiance of {limit}")),
            None => Decision::off("no limit is set"),
        },
        remove: Some(|document| document.render.firefly_clamp = None),
    },
    Effect {
        id: EffectId::AdaptiveSampling,
        label: "Adaptive sampling",
        help: "Tiles rest while others need samples more, so that time goes where the error is.",
        decide: |facts| {
            let render = &facts.document.render;
            match (render.is_adaptive(), render.noise) {
                (false, _) => Decision::off("every pixel gets as many samples"),
                (true, Some(noise)) => {
                    Decision::on(format!("samples go where the error is, until the noise is {noise}"))
                }
                (true, None) => Decision::on("samples go where the error is"),
            }
        },
        remove: Some(|document| document.render.adaptive = Some(false)),
    },
    Effect {
        id: EffectId::Variance,
        label: "Variance",
        help: "Sums of squares beside those of the radiance, used to estimate the error.",
        decide: |_| Decision::on("used to estimate the error"),
        remove: None,
    },
    Effect {
        id: EffectId::PictureLayers,
        label: "Image layers (AOVs)",
        help: "Albedo, normal and distance of what is seen, beside the light.",
        decide: |_| Decision::off("written only when an image with layers is saved"),
        remove: None,
    },
    Effect {
        id: EffectId::Guides,
        label: "Guides",
        help: "Albedo, normal and distance of what each pixel sees first, from its first 32 samples: for the denoiser and for \
               layers.",
        decide: |facts| match facts.document.view.denoise {
            Denoise::Off => Decision::off("neither layers nor denoising are requested"),
            _ => Decision::on("they guide the denoiser"),
        },
        remove: None,
    },
    Effect {
        id: EffectId::LightGroups,
        label: "Light groups",
        help: "The light of each group summed apart, for layers and for a mix after rendering.",
        decide: |facts| match facts.settings.light_groups {
            0 => Decision::off("all light is summed together"),
            groups => Decision::on(format!("{groups} groups are summed apart")),
        },
        remove: Some(|document| document.lighting.light_groups = false),
    },
    Effect {
        id: EffectId::Denoising,
        label: "Denoising",
        help: "Denoising with Open Image Denoise, guided by albedo and normal.",
        decide: |facts| match facts.document.view.denoise {
            Denoise::Off => Decision::off("the samples are shown as they are"),
            Denoise::Fast => Decision::on("denoised, fast"),
            Denoise::High => Decision::on("denoised, high quality"),
            Denoise::Auto => Decision::on("denoised until the raw image is more accurate"),
        },
        remove: Some(|document| document.view.denoise = Denoise::Off),
    },
];

fn each_material(document: &mut Document, change: impl FnMut(&mut MaterialSettings)) {
    document.materials.iter_mut().for_each(change);
}

/// Switches off the textures on these targets.
fn without_textures(document: &mut Document, targets: &[On]) {
    each_material(document, |material| {
        for target in targets {
            material.textures[*target] = false;
        }
    });
}
