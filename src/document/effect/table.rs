//! The table of effects.

use super::{
    Effect, Facts,
    Needs::{AnyMaterial, Scene, When},
    Remove::{Document, EachMaterial, Never, Switched, Textures},
    horizon,
};
use crate::{
    document::{
        AreaLight, Background, Denoise, GroundKind, MaterialSettings, Strategy,
        import::{ImportLobe, ROUGHNESS_MAX},
    },
    job::effect::{ANY, Decision, EffectId},
    optics::{
        curve::Curve,
        fresnel::Fresnel,
        layer::material_is_mirror,
        lobe::Lobe,
        material::{
            COAT_ABSORBS, COAT_IS_GGX, COMPENSATES, FILM_BANDS, HAS_BOX, Material, VERTEX_BASE, VERTEX_EMISSION,
            VERTEX_OPACITY,
        },
        vector::Vec3,
    },
    scene::texture::TextureTarget as On,
};

macro_rules! effects {
    ($($id:ident $label:literal $help:literal $needs:expr, $remove:expr;)*) => {
        /// Every effect, in the order of [`EffectId::ALL`].
        pub static EFFECTS: &[Effect] = &[$(Effect {
            id: EffectId::$id,
            label: $label,
            help: $help,
            needs: $needs,
            remove: $remove,
        }),*];
    };
}

effects! {
    Environment "Environment light" "Light that arrives from the environment map."
        When(|facts| !facts.is_environment_black(), "the environment shines", "the environment is black"),
        Document(|document| document.lighting.strength = 0.0);
    LightSampling "Sampling the environment" "Directions drawn where the environment is bright, a shadow ray for each."
        Scene(|facts| {
            if facts.is_environment_black() {
                Decision::off("the environment is black")
            } else if facts.environment.is_constant {
                Decision::off("the environment is equally bright everywhere")
            } else {
                sampled(facts, "environment brightness varies")
            }
        }),
        Switched;
    AreaLights "Area lights" "Rectangles, discs, spots and suns that shine beside the model."
        Scene(|facts| match facts.document.lighting.shining().count() {
            0 => Decision::off("there is no area light"),
            1 => Decision::on("there is one area light"),
            lights => Decision::on(format!("there are {lights} area lights")),
        }),
        Document(|document| document.lighting.area_lights.clear());
    Spot "Spots" "Area lights that send their light into a cone, or by a profile."
        Scene(|facts| {
            let lighting = &facts.document.lighting;
            if lighting.shining().any(AreaLight::is_spot) {
                Decision::on("an area light is a spot")
            } else if lighting.shining().any(AreaLight::has_profile) {
                Decision::on("an area light has a profile")
            } else {
                Decision::off("no light is a spot or has a profile")
            }
        }),
        Document(|document| {
            let lights = &mut document.lighting.area_lights;
            lights.retain(|light| !light.is_spot() && !light.has_profile());
        });
    Emission "Emission" "Light that surfaces give off."
        AnyMaterial(|material| material.emission.max_component() > 0.0, "emits light"),
        Document(|document| {
            document.lighting.area_lights.clear();
            document.materials.iter_mut().for_each(|material| material.emission_strength = 0.0);
        });
    EmitterSampling "Sampling emitters" "Directions drawn towards the triangles that emit, a shadow ray for each."
        Scene(|facts| {
            if facts.settings.light_choice.density_per_luminance <= 0.0 {
                Decision::off("no triangle emits light")
            } else {
                sampled(facts, "some triangles emit light")
            }
        }),
        Switched;
    Background "Background" "The environment, seen by the camera directly."
        Scene(|facts| match facts.document.lighting.background {
            Background::Environment => Decision::on("the environment is visible"),
            Background::Transparent => Decision::off("the background is transparent"),
            Background::Color(_) => Decision::off("the background is one colour"),
        }),
        Document(|document| document.lighting.background = Background::Transparent);
    Ground "Ground" "A surface under the model, on which it casts its shadow."
        When(|facts| facts.document.ground, "the model stands on a ground", "there is no ground"),
        Document(|document| document.ground = false);
    ShadowCatcher "Shadow catcher" "A ground of which only shadows and reflections are seen, over the background."
        Scene(|facts| {
            if facts.settings.catcher.is_some() {
                Decision::on("the ground shows shadows and reflections alone")
            } else if facts.document.ground {
                Decision::off("the ground is a surface like others")
            } else {
                Decision::off("there is no ground")
            }
        }),
        Document(|document| document.lighting.ground.kind = GroundKind::Plane);
    Interreflection "Shadows and indirect light" "Rays that leave a surface and may meet another one."
        Scene(|facts| {
            if facts.geometry.is_convex() {
                Decision::off("the scene is one convex body: rays that leave it hit nothing")
            } else if facts.settings.bounces <= 1 {
                Decision::on("paths end at the first surface, but shadows are cast")
            } else {
                Decision::on("surfaces may see each other")
            }
        }),
        Never;
    ShadowTerminator "Shadow terminator" "Light on the round surface that smooth normals describe, instead of on its coarse triangles."
        When(
            |facts| facts.settings.rounds_surfaces,
            "smooth normals lean away from coarse triangles",
            "the triangles are as fine as their normals are smooth",
        ),
        Switched;
    Base "Diffuse base" "Light that enters the surface and leaves it in all directions (Lambert)."
        AnyMaterial(Material::has_base, "has a diffuse base"),
        Document(|document| {
            document.materials.iter_mut().for_each(|material| material.base_weight = 0.0);
            document.lighting.ground_color = [0.0; 3];
        });
    DiffuseRoughness "Rough base" "A diffuse base that scatters more light back to where it comes from, as clay and cloth do (EON)."
        AnyMaterial(|m| m.has_base() && m.diffuse_roughness > 0.0, "has a rough base"),
        EachMaterial(|material| material.diffuse_roughness = 0.0);
    Specular "Specular lobe" "Light that the surface reflects around the mirror direction."
        AnyMaterial(Material::has_specular, "reflects"),
        EachMaterial(|material| {
            material.specular_weight = 0.0;
            material.specular_on_metal = true;
            material.transmission_weight = 0.0;
        });
    Lobe "Multiple lobes" "Code for every lobe, chosen from at each hit; with one lobe in the scene, only that one's."
        Scene(|facts| facts.shared(|material| material.lobe, |number| Lobe::ALL[number as usize].label())),
        Never;
    Curve "Multiple curves" "Code for every D(ξ) curve, the interception of the long tail's among it; with one curve, only that one's."
        Scene(|facts| {
            let geometric = facts
                .reflecting()
                .filter(|material| Lobe::ALL[material.lobe as usize].has_curves());
            let mut curves = geometric.map(|material| material.curve);
            let Some(first) = curves.next() else {
                // The first of all keeps the other curves' code out.
                return Decision::off("no material has a geometric lobe");
            };
            let label = |number: u32| Curve::ALL[number as usize].label();
            match curves.find(|&curve| curve != first) {
                None => Decision::which(first, format!("{} in every geometric lobe", label(first))),
                Some(other) => Decision::which(ANY, format!("{} and {} are mixed", label(first), label(other))),
            }
        }),
        Never;
    Anisotropy "Anisotropy" "Lobes stretched along the surface's tangent."
        AnyMaterial(
            |m| (m.has_specular() && m.anisotropy != 0.0) || (m.coat_weight > 0.0 && m.coat_anisotropy != 0.0),
            "stretches its lobe",
        ),
        EachMaterial(|material| (material.anisotropy, material.coat_anisotropy) = (0.0, 0.0));
    Horizon "Horizon" "What happens to samples of a lobe that point into the surface."
        Scene(horizon::decide), Never;
    Fresnel "Fresnel" "Code for every Fresnel term, chosen from at each hit; with one term in the scene, only that one's."
        Scene(|facts| facts.shared(|m| m.fresnel, |number| Fresnel::ALL[number as usize].label())),
        Never;
    EdgeTint "Edge tint" "Metals whose reflection is tinted towards grazing angles (F82)."
        AnyMaterial(|m| m.has_specular() && m.edge_tint != Vec3::splat(1.0), "tints its edge"),
        EachMaterial(|material| material.edge_tint = [1.0; 3]);
    MultipleScattering "Multiple scattering" "Light that meets more than one facet of rough GGX, in metals and clear dielectrics, as random walks between facets have it."
        AnyMaterial(|m| m.has_flag(COMPENSATES), "would lose light between its facets"),
        EachMaterial(|material| material.multiple_scattering = false);
    Fuzz "Fuzz" "Small fibres over the other lobes, brightest at the edge: velvet, peach, dust."
        AnyMaterial(|m| m.fuzz_weight > 0.0, "has fuzz"),
        EachMaterial(|material| material.fuzz_weight = 0.0);
    Coat "Coat" "A clear layer over the other lobes, with a reflection of its own."
        AnyMaterial(|m| m.coat_weight > 0.0, "has a coat"),
        EachMaterial(|material| material.coat_weight = 0.0);
    CoatGgx "GGX coat" "A coat that spreads its reflection as GGX does."
        AnyMaterial(|m| m.has_flag(COAT_IS_GGX), "has a coat of GGX"),
        EachMaterial(|material| {
            let roughness = material.coat_ggx_roughness();
            material.set_coat_ggx_roughness(roughness.min(ROUGHNESS_MAX), ImportLobe::Geometric);
        });
    CoatDarkening "Coat darkening" "Bases that get darker by the light that a coat reflects back onto them (OpenPBR 1.1)."
        AnyMaterial(|m| m.coat_weight > 0.0 && m.coat_darkening > 0.0, "is darkened by its coat"),
        EachMaterial(|material| material.coat_darkening = 0.0);
    CoatAbsorption "Coat absorption" "Coloured coats that take more light the longer its way through them, and from light that comes from below."
        AnyMaterial(|m| m.has_flag(COAT_ABSORBS), "has a coloured coat"),
        EachMaterial(|material| {
            if material.coat_on_base {
                material.coat_color = [1.0; 3];
            }
        });
    ThinFilm "Thin film" "Interference in a film over the surface that reflects: soap, oil, tempered steel."
        AnyMaterial(|m| m.has_film == 1, "has a thin film"),
        EachMaterial(|material| material.film_weight = 0.0);
    FilmBands "Film bands" "Thin films of more than four wavelengths, whose fine fringes a band of wavelengths blurs."
        AnyMaterial(|m| m.has_flag(FILM_BANDS), "has a film thicker than four wavelengths"),
        EachMaterial(|material| material.film_bands = false);
    Transmission "Refraction" "Light that passes through surfaces and is refracted there."
        AnyMaterial(Material::transmits, "transmits light"),
        EachMaterial(|material| material.transmission_weight = 0.0);
    Absorption "Absorption" "Light that fades on its way through a clear solid (Beer and Lambert)."
        AnyMaterial(|m| m.transmits() && m.absorption.max_component() > 0.0, "absorbs light inside"),
        EachMaterial(|material| {
            // Without a depth the colour tints the surface: white is what absorbs nothing.
            if material.transmission_depth > 0.0 {
                material.transmission_color = [1.0; 3];
            }
        });
    ColorTexture "Colour textures" "Base colours from textures or vertex colours."
        AnyMaterial(
            |m| m.has_texture(On::OF_COLOR) || m.has_flag(VERTEX_BASE),
            "takes its colour from a texture or from its vertices",
        ),
        Textures(On::OF_COLOR);
    RoughnessTexture "Roughness textures" "Roughness, metalness and weights of reflection and refraction from textures."
        AnyMaterial(|m| m.has_texture(On::OF_ROUGHNESS), "takes its roughness from a texture"),
        Textures(On::OF_ROUGHNESS);
    RoughTables "Energy-compensation tables" "What the base is left with where a texture changes the roughness, or the surface is metal in part."
        AnyMaterial(|m| m.holds_integrals(), "is metal in part, or its roughness changes over a base"),
        Never;
    NormalMap "Normal maps" "Shading normals from normal maps."
        AnyMaterial(|m| m.has_texture(On::OF_NORMAL), "has a normal map"),
        Textures(On::OF_NORMAL);
    EmissionTexture "Emission textures" "Emission from textures."
        AnyMaterial(|m| m.has_texture(On::OF_EMISSION), "takes its emission from a texture"),
        Textures(On::OF_EMISSION);
    VertexColors "Light and opacity of vertices" "Emission and opacity that change from vertex to vertex."
        AnyMaterial(
            |m| m.has_flag(VERTEX_EMISSION | VERTEX_OPACITY),
            "shines or is clear by the colours of its vertices",
        ),
        Textures(&[On::Emission, On::Opacity]);
    CoatTexture "Coat textures" "Weight, roughness and colour of coats from textures."
        AnyMaterial(|m| m.has_texture(On::OF_COAT), "has a texture of its coat"),
        Textures(On::OF_COAT);
    CoatNormalMap "Coat normal maps" "Normals of coats bent by a texture of their own."
        AnyMaterial(|m| m.has_texture(On::OF_COAT_NORMAL), "bends the normals of its coat"),
        Textures(On::OF_COAT_NORMAL);
    FilmTexture "Thin film textures" "Weights and thicknesses of thin films from textures."
        AnyMaterial(|m| m.has_texture(On::OF_FILM), "takes its thin film from a texture"),
        Textures(On::OF_FILM);
    FuzzTexture "Fuzz textures" "Weight, colour and roughness of fuzz from textures."
        AnyMaterial(|m| m.has_texture(On::OF_FUZZ), "has a texture of its fuzz"),
        Textures(On::OF_FUZZ);
    BoxProjection "Box projection" "Images that lie on a surface as on a box, without texture coordinates."
        AnyMaterial(|m| m.has_flag(HAS_BOX), "has a texture that lies on it as on a box"),
        EachMaterial(MaterialSettings::without_boxes);
    Alpha "Opacity" "Surfaces that let some light go straight on."
        Scene(|facts| {
            if facts.materials.iter().any(Material::has_holes) {
                facts.needed_by(Material::has_holes, "is not opaque everywhere")
            } else if facts.settings.first_hidden_slot != u32::MAX {
                Decision::on("the camera looks through a hidden light")
            } else {
                Decision::off("all materials are opaque")
            }
        }),
        Document(|document| {
            for material in &mut document.materials {
                material.textures[On::Opacity] = false;
                material.opacity = 1.0;
            }
            for light in &mut document.lighting.area_lights {
                light.is_hidden = false;
            }
        });
    DepthOfField "Depth of field" "Thin-lens blur away from the focus distance."
        When(|facts| facts.settings.camera.lens_radius > 0.0, "the lens is open", "the camera is a pinhole"),
        Document(|document| document.camera.aperture = 0.0);
    FireflyClamp "Firefly clamp" "Clamps indirect light: less noise, slightly darker."
        Scene(|facts| match facts.document.render.firefly_clamp {
            Some(limit) => Decision::on(format!("limited to a radiance of {limit}")),
            None => Decision::off("no limit is set"),
        }),
        Document(|document| document.render.firefly_clamp = None);
    AdaptiveSampling "Adaptive sampling" "Tiles rest while others need samples more, so that time goes where the error is."
        Scene(|facts| {
            let render = &facts.document.render;
            match (render.is_adaptive(), render.noise) {
                (false, _) => Decision::off("every pixel gets as many samples"),
                (true, Some(noise)) => {
                    Decision::on(format!("samples go where the error is, until the noise is {noise}"))
                }
                (true, None) => Decision::on("samples go where the error is"),
            }
        }),
        Document(|document| document.render.adaptive = Some(false));
    Guides "Guides" "Albedo, normal and distance of what each pixel sees first, from its first 32 samples: for the denoiser and for layers."
        When(
            |facts| facts.document.view.denoise != Denoise::Off,
            "they guide the denoiser",
            "neither layers nor denoising are requested",
        ),
        Never;
    LightGroups "Light groups" "The light of each group summed apart, for layers and for a mix after rendering."
        Scene(|facts| match facts.settings.light_groups {
            0 => Decision::off("all light is summed together"),
            groups => Decision::on(format!("{groups} groups are summed apart")),
        }),
        Document(|document| document.lighting.light_groups = false);
    Denoising "Denoising" "Denoising with Open Image Denoise, guided by albedo and normal."
        Scene(|facts| match facts.document.view.denoise {
            Denoise::Off => Decision::off("the samples are shown as they are"),
            Denoise::Fast => Decision::on("denoised, fast"),
            Denoise::High => Decision::on("denoised, high quality"),
            Denoise::Auto => Decision::on("denoised until the raw image is more accurate"),
        }),
        Document(|document| document.view.denoise = Denoise::Off);
}

/// The decision on drawing directions of light where there is light to find.
fn sampled(facts: &Facts<'_>, why: &str) -> Decision {
    if facts.settings.strategy == Strategy::Lobe {
        Decision::off("light is found by the lobes alone")
    } else if facts.materials.iter().all(material_is_mirror) {
        Decision::off("every surface is a mirror, which meets light in one direction only")
    } else {
        Decision::on(why)
    }
}
