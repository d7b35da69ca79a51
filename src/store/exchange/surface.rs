//! A material as other programs know it: microfacets with GGX over a diffuse or refracting base, under a coat.

use super::reflection::{fresnel_terms, shown_tint};
use super::report::{Entry, Residual};
use crate::document::import::ggx_under_texture;
use crate::document::material::{FILM_THICKNESS_MAX, specular_color};
use crate::document::{ImportLobe, MaterialSettings, TextureUse};
use crate::matching::{lobe_of_material, nearest_ggx};
use crate::optics::fresnel::{
    Fresnel, fresnel, fresnel_dielectric, fresnel_f0, fresnel_metal, fresnel_schlick, weighted_ior,
};
use crate::optics::lobe::{Lobe, Width, anisotropy_from_ratio, stretch_from_anisotropy};
use crate::optics::vector::Vec3;

/// A material as other programs know it. Colours are linear Rec. 709 in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name in lists.
    pub name: String,
    /// Albedo of the diffuse base; of a metal, its reflectance at normal incidence.
    pub base_color: [f32; 3],
    /// Roughness of the diffuse base, in [0, 1].
    pub diffuse_roughness: f32,
    /// In [0, 1].
    pub metalness: f32,
    /// Factor of what a dielectric reflects, in [0, 1].
    pub specular_weight: f32,
    /// The factor scales the reflectance head-on, through the index; else at every angle.
    pub weight_in_index: bool,
    /// Tint of what a dielectric reflects; above 1 it raises Schlick's reflectance head-on.
    pub specular_color: [f32; 3],
    /// Weight and tint are a metal's too.
    pub specular_on_metal: bool,
    /// What a metal's reflection is multiplied by near 82 degrees.
    pub edge_tint: [f32; 3],
    /// Of the dielectric.
    pub ior: f32,
    /// The square root of GGX's α, the mean of both widths where they differ, in [0, 1].
    pub roughness: f32,
    /// The widths' stretch as Glossmith has it, in [−1, 1]: the longer one lies along the tangent where it is positive.
    pub anisotropy: f32,
    /// Turn of the tangent, degrees.
    pub rotation_deg: f32,
    /// In [0, 1].
    pub transmission_weight: f32,
    /// Tint of what is refracted, or what is left of white after `transmission_depth`.
    pub transmission_color: [f32; 3],
    /// In bounding radii of the model; 0 where nothing is absorbed inside.
    pub transmission_depth: f32,
    /// In [0, 1].
    pub coat_weight: f32,
    /// The square root of GGX's α.
    pub coat_roughness: f32,
    pub coat_ior: f32,
    /// What the coat leaves of the light that crosses it twice.
    pub coat_color: [f32; 3],
    /// The stretch of its widths, as `anisotropy`.
    pub coat_anisotropy: f32,
    /// It changes what lies below it.
    pub coat_on_base: bool,
    /// How much of its darkening shows, in [0, 1].
    pub coat_darkening: f32,
    /// In [0, 1].
    pub fuzz_weight: f32,
    /// Tint of the fuzz.
    pub fuzz_color: [f32; 3],
    /// In [0, 1].
    pub fuzz_roughness: f32,
    /// Share of the surface that has a thin film, in [0, 1].
    pub film_weight: f32,
    /// In µm.
    pub film_thickness: f32,
    /// Of the thin film.
    pub film_ior: f32,
    /// Emitted radiance.
    pub emission: [f32; 3],
    /// Share of light that is stopped, in [0, 1].
    pub opacity: f32,
}

/// How a format's dielectric reflects more towards grazing angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// By the exact equations.
    Exact,
    Schlick,
}

/// What a format has a place for.
#[derive(Clone, Copy, Debug)]
pub struct Takes {
    /// How its dielectrics reflect.
    pub law: Law,
    /// η and k of metals.
    pub eta_and_k: bool,
    /// The roughness of the diffuse base.
    pub diffuse_roughness: bool,
    /// The tint of a metal's edge.
    pub edge_tint: bool,
    /// Weight and tint of a dielectric's reflection.
    pub specular: bool,
    /// The weight scales the reflectance head-on, through the index.
    pub weighs_index: bool,
    /// The weight is a metal's too.
    pub weighs_metal: bool,
    /// The dielectric's index of refraction.
    pub ior: bool,
    /// The widths of a stretched highlight that it shows, as GGX's α, the longer one first.
    pub widths: fn(&Surface) -> [f32; 2],
    /// A coat; of its index and colour where `coat_details` says so.
    pub coat: bool,
    /// The coat's index of refraction and colour.
    pub coat_details: bool,
    /// The stretch of the coat's highlight.
    pub coat_stretch: bool,
    /// What OpenPBR's coat changes below it.
    pub coat_on_base: bool,
    pub fuzz: bool,
    pub film: bool,
    /// The weight of a thin film: without one, the film is everywhere.
    pub film_weight: bool,
    /// What facets scatter more than once.
    pub scattering: bool,
    pub transmission: bool,
    /// Absorption inside.
    pub absorption: bool,
    /// Images that vary a parameter over the surface.
    pub textures: bool,
    /// The user's own images, of which the format reports more itself.
    pub own_textures: bool,
}

/// Least difference that is worth a word.
const NOTABLE: f64 = 1e-3;
/// Cosines at which reflectances are compared.
const COSINES: usize = 64;

impl Default for Surface {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [0.8; 3],
            diffuse_roughness: 0.0,
            metalness: 0.0,
            specular_weight: 1.0,
            weight_in_index: false,
            specular_color: [1.0; 3],
            specular_on_metal: false,
            edge_tint: [1.0; 3],
            ior: 1.5,
            roughness: 0.5,
            anisotropy: 0.0,
            rotation_deg: 0.0,
            transmission_weight: 0.0,
            transmission_color: [1.0; 3],
            transmission_depth: 0.0,
            coat_weight: 0.0,
            coat_roughness: 0.0,
            coat_ior: 1.5,
            coat_color: [1.0; 3],
            coat_anisotropy: 0.0,
            coat_on_base: false,
            coat_darkening: 0.0,
            fuzz_weight: 0.0,
            fuzz_color: [1.0; 3],
            fuzz_roughness: 0.5,
            film_weight: 0.0,
            film_thickness: 0.5,
            film_ior: 1.4,
            emission: [0.0; 3],
            opacity: 1.0,
        }
    }
}

fn scaled(color: [f32; 3], by: [f32; 3]) -> [f32; 3] {
    [color[0] * by[0], color[1] * by[1], color[2] * by[2]]
}

fn unit(x: f32) -> f32 {
    x.clamp(0.0, 1.0)
}

/// To the digits that a file is read by people with.
pub(super) fn rounded(x: f32) -> f32 {
    ((f64::from(x) * 1e5).round() / 1e5) as f32
}

impl Surface {
    /// The material that looks nearest, and what its highlight became.
    pub fn of(material: &MaterialSettings) -> (Self, Entry) {
        let (roughness, entry) = highlight(material);
        let mut surface = Self {
            name: material.name.clone(),
            base_color: material.base_color.map(|x| rounded(x * material.base_weight)),
            diffuse_roughness: material.diffuse_roughness,
            metalness: material.metalness,
            specular_weight: material.specular_weight,
            weight_in_index: material.has_weight_in_index(),
            specular_color: shown_tint(material),
            specular_on_metal: material.specular_on_metal,
            edge_tint: material.edge_tint,
            ior: material.ior,
            roughness,
            anisotropy: if material.lobe.is_anisotropic() {
                material.anisotropy
            } else {
                0.0
            },
            rotation_deg: material.rotation_deg,
            transmission_weight: material.transmission_weight,
            transmission_color: material.transmission_color,
            transmission_depth: material.transmission_depth,
            coat_weight: material.coat_weight,
            coat_roughness: rounded(material.coat_ggx_roughness()),
            coat_ior: material.coat_ior,
            coat_color: material.coat_color,
            coat_anisotropy: material.coat_anisotropy,
            coat_on_base: material.coat_on_base,
            coat_darkening: material.coat_darkening,
            fuzz_weight: material.fuzz_weight,
            fuzz_color: material.fuzz_color,
            fuzz_roughness: material.fuzz_roughness,
            film_weight: material.film_weight,
            film_thickness: material.film_thickness,
            film_ior: material.film_ior,
            emission: material.emission_color.map(|x| x * material.emission_strength),
            opacity: material.opacity,
        };
        if surface.weight_in_index && surface.metalness == 0.0 {
            let ior = weighted_ior(surface.ior.into(), surface.specular_weight.into());
            (surface.ior, surface.specular_weight, surface.weight_in_index) = (rounded(ior as f32), 1.0, false);
        }
        surface.take_fresnel(material);
        (surface, entry)
    }

    /// Metal as other programs know it: colored at normal incidence, white at grazing angles, with a tint between.
    fn take_fresnel(&mut self, material: &MaterialSettings) {
        let white = [1.0; 3];
        let weight = [material.specular_weight; 3];
        match material.fresnel_model() {
            Fresnel::None | Fresnel::Conductor if material.specular_weight == 0.0 => {}
            Fresnel::None => {
                self.metalness = 1.0;
                self.base_color = scaled(self.specular_color, weight);
            }
            Fresnel::Conductor => {
                let terms = fresnel_terms(material);
                self.metalness = 1.0;
                let f0 = fresnel(&terms, 1.0);
                let seventh = 1.0 / 7.0;
                let (there, plain) = (fresnel(&terms, seventh), fresnel_schlick(f0, seventh));
                self.base_color = f0.to_f32().map(rounded);
                let tint = [there.x / plain.x, there.y / plain.y, there.z / plain.z];
                self.edge_tint = tint.map(|x| rounded(unit(x as f32)));
            }
            _ if material.metalness == 1.0 && material.specular_on_metal => {
                self.base_color = scaled(scaled(self.base_color, self.specular_color), weight).map(rounded);
            }
            _ if material.metalness == 1.0 => {}
            _ => return,
        }
        if self.metalness == 1.0 {
            (self.specular_weight, self.specular_color) = (1.0, white);
        }
    }

    /// A material that looks like it. Roughness is GGX's, or that of the lobe that looks like it.
    pub fn material(&self, lobe: ImportLobe) -> MaterialSettings {
        let (brightest, emission) = self.strength_and_color();
        let mut material = MaterialSettings {
            name: self.name.clone(),
            base_color: self.base_color.map(unit),
            diffuse_roughness: unit(self.diffuse_roughness),
            metalness: unit(self.metalness),
            specular_weight: unit(self.specular_weight),
            specular_in_index: self.weight_in_index,
            specular_color: self.specular_color.map(specular_color),
            specular_on_metal: self.specular_on_metal,
            edge_tint: self.edge_tint.map(unit),
            ior: self.ior.clamp(1.0, 4.0),
            roughness: unit(self.roughness),
            anisotropy: self.anisotropy.clamp(-1.0, 1.0),
            rotation_deg: self.rotation_deg.clamp(-360.0, 360.0),
            transmission_weight: unit(self.transmission_weight),
            transmission_color: self.transmission_color.map(unit),
            transmission_depth: self.transmission_depth.clamp(0.0, 1000.0),
            coat_weight: unit(self.coat_weight),
            coat_ior: self.coat_ior.clamp(1.0, 4.0),
            coat_color: self.coat_color.map(unit),
            coat_anisotropy: self.coat_anisotropy.clamp(-1.0, 1.0),
            fuzz_weight: unit(self.fuzz_weight),
            fuzz_color: self.fuzz_color.map(unit),
            fuzz_roughness: unit(self.fuzz_roughness),
            film_weight: unit(self.film_weight),
            film_thickness: self.film_thickness.clamp(0.0, FILM_THICKNESS_MAX),
            film_ior: self.film_ior.clamp(1.0, 3.0),
            opacity: unit(self.opacity),
            ..MaterialSettings::default()
        };
        lobe.at_roughest(material.roughness).apply(&mut material);
        if self.coat_weight > 0.0 {
            material.set_coat_ggx_roughness(unit(self.coat_roughness), lobe);
            (material.coat_on_base, material.coat_darkening) = (self.coat_on_base, unit(self.coat_darkening));
        }
        if brightest > 0.0 {
            material.emission_color = emission.map(unit);
            material.emission_strength = brightest.min(1e6);
        }
        material
    }

    /// What a program shows of a material that takes what `takes` says.
    pub fn as_taken(&self, material: &MaterialSettings, takes: &Takes) -> MaterialSettings {
        let mut taken = self.clone();
        let [longer, shorter] = (takes.widths)(self);
        if self.anisotropy != 0.0 && shorter > 0.0 {
            taken.roughness = (longer * shorter).powf(0.25);
            let stretch = anisotropy_from_ratio(f64::from(shorter / longer)) as f32;
            taken.anisotropy = stretch.copysign(self.anisotropy);
        }
        if !takes.diffuse_roughness {
            taken.diffuse_roughness = 0.0;
        }
        if !takes.edge_tint {
            taken.edge_tint = [1.0; 3];
        }
        if takes.law == Law::Exact {
            taken.specular_color = taken.specular_color.map(unit);
        }
        taken.weight_in_index = takes.weighs_index;
        taken.specular_on_metal = takes.weighs_metal;
        let reflects = self.specular_weight > 0.0 || self.coat_weight > 0.0;
        if !takes.specular && reflects {
            (taken.specular_weight, taken.specular_color) = (1.0, [1.0; 3]);
        }
        if !takes.ior {
            taken.ior = 1.5;
        }
        taken.take_coat(takes);
        if !takes.fuzz {
            taken.fuzz_weight = 0.0;
        }
        if !takes.film {
            taken.film_weight = 0.0;
        } else if !takes.film_weight && taken.film_weight > 0.0 {
            taken.film_weight = 1.0;
        }
        if !takes.transmission {
            taken.transmission_weight = 0.0;
        }
        if !takes.absorption {
            taken.transmission_depth = 0.0;
        }
        let mut shown = taken.material(ImportLobe::Ggx);
        shown.fresnel = match takes.law {
            _ if takes.eta_and_k => material.fresnel,
            Law::Exact => Fresnel::Dielectric,
            Law::Schlick => Fresnel::Schlick,
        };
        (shown.conductor, shown.eta, shown.k) = (material.conductor, material.eta, material.k);
        shown
    }

    /// GGX's α along the tangent and across.
    pub fn alphas(&self) -> [f32; 2] {
        let alpha = self.roughness * self.roughness;
        let stretch = stretch_from_anisotropy(self.anisotropy);
        [alpha * stretch, alpha / stretch]
    }

    /// The narrower width over the wider one, and the turn of the wider one in degrees.
    pub fn ratio_and_rotation(&self) -> (f32, f32) {
        let stretch = stretch_from_anisotropy(self.anisotropy.abs());
        let turn = if self.anisotropy < 0.0 { 90.0 } else { 0.0 };
        (1.0 / (stretch * stretch), self.rotation_deg + turn)
    }

    /// GGX's α of the longer width and of the shorter.
    pub fn widths(&self) -> [f32; 2] {
        let [along, across] = self.alphas();
        [along.max(across), along.min(across)]
    }

    /// The anisotropy a of Disney's principled surface, whose α's are r²/√(1 − 0.9 a) and r² √(1 − 0.9 a).
    pub fn disney_anisotropy(&self) -> f32 {
        let (ratio, _) = self.ratio_and_rotation();
        ((1.0 - ratio) / 0.9).clamp(0.0, 1.0)
    }

    /// The widths that Disney's principled surface shows.
    pub fn disney_widths(&self) -> [f32; 2] {
        let aspect = (1.0 - 0.9 * self.disney_anisotropy()).sqrt();
        let alpha = self.roughness * self.roughness;
        [alpha / aspect, alpha * aspect]
    }

    /// The tint of reflections in OpenPBR: of a metal that of its edge.
    pub fn tint(&self) -> [f32; 3] {
        if self.metalness > 0.5 {
            self.edge_tint
        } else {
            self.specular_color.map(unit)
        }
    }

    /// The brightest channel of the emission and the colour that makes the emission of it; white where there is none.
    pub fn strength_and_color(&self) -> (f32, [f32; 3]) {
        let brightest = self.emission.into_iter().fold(0.0_f32, f32::max);
        let color = self.emission.map(|x| if brightest > 0.0 { x / brightest } else { 1.0 });
        (brightest, color)
    }

    /// What is lost where a highlight lies along the tangent though it is turned.
    pub fn rotation_loss(&self) -> Option<Entry> {
        let is_turned = self.anisotropy != 0.0 && self.ratio_and_rotation().1 != 0.0;
        is_turned.then(|| Entry::dropped("rotation of the highlight", "it lies along the tangent"))
    }

    /// What becomes of the widths of a stretched highlight.
    fn widths_loss(&self, takes: &Takes) -> Entry {
        let (what, own, shown) = ("anisotropy", self.widths(), (takes.widths)(self));
        let apart = |i: usize| f64::from((own[i] - shown[i]).abs() / own[i].max(f32::MIN_POSITIVE));
        if apart(0).max(apart(1)) < NOTABLE {
            return Entry::exact(what);
        }
        let detail = format!(
            "widths (GGX's α) of {:.3} and {:.3} stand for {:.3} and {:.3}",
            shown[0], shown[1], own[0], own[1]
        );
        Entry::approximated(what, detail, None)
    }

    /// The reflectance that a program shows that takes what `takes` says, by the cosine at the half vector.
    fn reflectance(&self, takes: &Takes, cosine: f64) -> Vec3<f64> {
        let white = Vec3::splat(1.0);
        let edge = if takes.edge_tint {
            Vec3::from_f32(self.edge_tint)
        } else {
            white
        };
        let metal = fresnel_metal(Vec3::from_f32(self.base_color), edge, cosine);
        let (tint, weight) = match takes.specular {
            true => (Vec3::from_f32(self.specular_color), f64::from(self.specular_weight)),
            false => (white, 1.0),
        };
        let metal = if takes.weighs_metal { metal * weight } else { metal };
        let mut ior = if takes.ior { f64::from(self.ior) } else { 1.5 };
        let mut of_dielectric = weight;
        if takes.weighs_index && self.transmission_weight == 0.0 {
            (ior, of_dielectric) = (weighted_ior(ior, weight), 1.0);
        }
        let dielectric = match takes.law {
            Law::Exact => {
                Vec3::from_f32(self.specular_color.map(unit)) * (fresnel_dielectric(cosine, ior) * of_dielectric)
            }
            Law::Schlick => fresnel_schlick(tint * fresnel_f0(ior), cosine) * of_dielectric,
        };
        dielectric.mix(metal, f64::from(self.metalness))
    }

    /// What becomes of a material's parts, other than the highlight's shape.
    pub fn losses(&self, material: &MaterialSettings, takes: &Takes) -> Vec<Entry> {
        let mut entries = vec![Entry::exact("base colour, metalness")];
        let is_specular = material.reflects();
        if is_specular && !(takes.eta_and_k && material.fresnel == Fresnel::Conductor && self.metalness == 1.0) {
            entries.push(self.fresnel_loss(material, takes));
        }
        if material.fresnel == Fresnel::Conductor && material.metalness < 1.0 && material.specular_weight > 0.0 {
            entries.push(Entry::dropped(
                "the diffuse base",
                "there is none under a metal of η and k",
            ));
        }
        if self.anisotropy != 0.0 && is_specular {
            entries.push(self.widths_loss(takes));
        }
        let mut layer = |is_used: bool, is_taken: bool, what: &str, detail: &str| {
            if is_used && is_taken {
                entries.push(Entry::exact(what));
            } else if is_used {
                entries.push(Entry::dropped(what, detail));
            }
        };
        let none = "the format has none";
        layer(
            material.transmission_weight > 0.0,
            takes.transmission,
            "refraction",
            none,
        );
        let absorbs = material.transmission_weight > 0.0 && material.transmission_depth > 0.0;
        layer(absorbs, takes.absorption, "absorption inside", none);
        let has_extra = material.transmission_weight > 0.0 && material.transmission_roughness != 0.0;
        layer(has_extra, false, "extra roughness of the refraction", none);
        let is_rough = material.diffuse_roughness > 0.0 && material.metalness < 1.0;
        layer(is_rough, takes.diffuse_roughness, "roughness of the diffuse base", none);
        layer(material.fuzz_weight > 0.0, takes.fuzz, "fuzz", none);
        layer(material.has_film(), takes.film, "thin film", none);
        let is_partial = material.has_film() && material.film_weight < 1.0 && takes.film;
        layer(
            is_partial,
            takes.film_weight,
            "the thin film's weight",
            "the format's film is everywhere",
        );
        let loses_light = material.lobe.traits().loses_light && material.metalness > 0.0;
        let dims = loses_light && material.multiple_scattering && !takes.scattering;
        layer(dims, false, "multiple scattering between facets", none);
        layer(material.emission_strength > 0.0, true, "emission", none);
        layer(material.opacity < 1.0, true, "opacity", none);
        let is_textured = material.uses_of_model() != TextureUse::default();
        layer(
            is_textured,
            takes.textures,
            "textures of the model",
            "convert to a glTF model to take them along",
        );
        let has_own = material
            .user_textures
            .iter()
            .any(|(target, _)| material.uses_texture(target));
        layer(
            has_own && !takes.own_textures,
            false,
            "textures of your own",
            "convert to a glTF model to take them along",
        );
        entries.extend(self.coat_losses(material, takes));
        entries
    }

    fn fresnel_loss(&self, material: &MaterialSettings, takes: &Takes) -> Entry {
        let terms = fresnel_terms(material);
        let worst = (0..=COSINES).map(|i| {
            let cosine = i as f64 / COSINES as f64;
            let apart = fresnel(&terms, cosine) - self.reflectance(takes, cosine);
            apart.map(f64::abs).max_component()
        });
        let worst = worst.fold(0.0, f64::max);
        let what = "reflectance by angle";
        if worst < NOTABLE {
            return Entry::exact(what);
        }
        let law = match (self.metalness == 1.0, takes.law) {
            (true, _) if takes.edge_tint => "a metal's by its colour and edge tint",
            (true, _) => "a metal's by its colour",
            (false, Law::Exact) => "a dielectric's by the exact equations",
            (false, Law::Schlick) => "a dielectric's by Schlick's approximation",
        };
        Entry::approximated(what, law, Some(Residual::reflectance(worst)))
    }
}

/// The roughness of GGX that looks like a material's highlight, and how near it comes.
fn highlight(material: &MaterialSettings) -> (f32, Entry) {
    let what = "highlight";
    if !material.reflects() {
        return (material.roughness, Entry::exact("no highlight"));
    }
    if matches!(material.lobe, Lobe::Ggx | Lobe::Ggx2018 | Lobe::GgxNdf) {
        return (material.roughness, Entry::exact(what));
    }
    let model = lobe_of_material(material);
    if !model.has_density() {
        return (0.0, Entry::exact("highlight, a mirror's"));
    }
    let nearest = nearest_ggx(&model);
    let is_matched = material.textures.roughness && material.lobe.traits().width == Width::Roughness;
    let roughness = match is_matched {
        // What its texture multiplies here.
        true => ggx_under_texture(material.roughness),
        false => nearest.roughness as f32,
    };
    let roughness = rounded(roughness);
    let detail = format!(
        "GGX of roughness {roughness} stands for the {} lobe of {}",
        material.lobe.name(),
        material.roughness
    );
    let residual = Residual::total_variation(nearest.total_variation);
    (roughness, Entry::approximated(what, detail, Some(residual)))
}
