//! A material as other programs know it: microfacets with GGX over a diffuse or refracting base, under a coat.

use super::report::{Entry, Residual};
use crate::{
    document::{CoatLobe, ImportLobe, MaterialSettings, PARAMETERS, TextureUse, import::ggx_under_texture, parameter},
    matching::{lobe_of_material, nearest_ggx},
    optics::{
        fresnel::{
            Fresnel, FresnelTerms, fresnel, fresnel_dielectric, fresnel_f0, fresnel_metal, fresnel_schlick,
            weighted_ior,
        },
        lobe::{Lobe, Width, anisotropy_from_ratio, stretch_from_anisotropy},
        material::coat_blur,
        thin_film::FilmTerms,
        vector::Vec3,
    },
    scene::texture::TextureTarget,
};

/// A material as other programs know it: both lobes are GGX, and what only Glossmith has is that of [`MaterialSettings::of_file`].
pub type Surface = MaterialSettings;

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
    /// The widths of a stretched highlight that it shows, as GGX's α, the longer one first.
    pub widths: fn(&Surface) -> [f32; 2],
    /// Keys of the parameters that it has no place for, with blanks between. `base.color_texture` is every texture, `thin_film.thickness` the
    /// film, `specular.eta` all of a measured metal.
    pub lacks: [&'static str; 2],
}

impl Takes {
    /// Whether it has a place for a parameter.
    pub fn has(&self, key: &str) -> bool {
        !self.lacks().any(|lacking| lacking == key)
    }

    fn lacks(&self) -> impl Iterator<Item = &'static str> {
        self.lacks.into_iter().flat_map(str::split_whitespace)
    }

    /// What becomes of a part that this parameter is for.
    pub(super) fn part(&self, is_used: bool, key: &str, what: &str, detail: &str) -> Option<Entry> {
        let entry = || {
            if self.has(key) {
                Entry::exact(what)
            } else {
                Entry::dropped(what, detail)
            }
        };
        is_used.then(entry)
    }
}

/// Least difference that is worth a word.
const NOTABLE: f64 = 0.001;
/// Cosines at which reflectances are compared.
const COSINES: usize = 64;

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
        let mut surface = Surface::of_file();
        for parameter in PARAMETERS.iter() {
            if let Some(numbers) = parameter.rgb(material) {
                parameter.put_rgb(&mut surface, numbers);
            }
        }
        surface = Self {
            name: material.name.clone(),
            base_weight: 1.0,
            base_color: material.base_color.map(|x| rounded(x * material.base_weight)),
            specular_in_index: material.has_weight_in_index(),
            specular_color: shown_tint(material),
            specular_on_metal: material.specular_on_metal,
            roughness,
            anisotropy: if material.lobe.is_anisotropic() {
                material.anisotropy
            } else {
                0.0
            },
            transmission_roughness: 0.0,
            coat_roughness: rounded(material.coat_ggx_roughness()),
            coat_on_base: material.coat_on_base,
            coat_normal_strength: 1.0,
            normal_strength: 1.0,
            ..surface
        };
        if surface.specular_in_index && surface.metalness == 0.0 {
            let ior = weighted_ior(surface.ior.into(), surface.specular_weight.into());
            (surface.ior, surface.specular_weight, surface.specular_in_index) = (rounded(ior as f32), 1.0, false);
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

    /// What a program shows of a material that takes what `takes` says.
    pub fn as_taken(&self, material: &MaterialSettings, takes: &Takes) -> MaterialSettings {
        let mut taken = self.clone();
        let [longer, shorter] = (takes.widths)(self);
        if self.anisotropy != 0.0 && shorter > 0.0 {
            taken.roughness = (longer * shorter).powf(0.25);
            let stretch = anisotropy_from_ratio(f64::from(shorter / longer)) as f32;
            taken.anisotropy = stretch.copysign(self.anisotropy);
        }
        let plain = Surface::of_file();
        for parameter in takes.lacks().flat_map(parameter) {
            parameter.put(&mut taken, parameter.get(&plain));
        }
        if takes.law == Law::Exact {
            taken.specular_color = taken.specular_color.map(unit);
        }
        taken.specular_in_index = takes.has("specular.weight_in_index");
        taken.specular_on_metal = takes.has("specular.on_metal");
        if self.specular_weight == 0.0 && self.coat_weight == 0.0 {
            taken.specular_weight = 0.0;
        }
        if takes.has("coat.on_base") {
            taken.counter_coat();
        }
        if takes.has("thin_film.thickness") && !takes.has("thin_film.weight") {
            taken.film_weight = f32::from(self.film_weight > 0.0);
        }
        let mut shown = taken.with_lobe(ImportLobe::Ggx, 1.0);
        shown.fresnel = match takes.law {
            _ if takes.has("specular.eta") => material.fresnel,
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
        let edge = if takes.has("specular.edge_tint") {
            Vec3::from_f32(self.edge_tint)
        } else {
            white
        };
        let metal = fresnel_metal(Vec3::from_f32(self.base_color), edge, cosine);
        let (tint, weight) = if takes.has("specular.weight") {
            (Vec3::from_f32(self.specular_color), f64::from(self.specular_weight))
        } else {
            (white, 1.0)
        };
        let metal = if takes.has("specular.on_metal") {
            metal * weight
        } else {
            metal
        };
        let mut ior = f64::from(self.ior);
        let mut of_dielectric = weight;
        if takes.has("specular.weight_in_index") {
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
        if is_specular
            && !(takes.has("specular.eta") && material.fresnel == Fresnel::Conductor && self.metalness == 1.0)
        {
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
        let mut layer = |is_used, key, what, detail| entries.extend(takes.part(is_used, key, what, detail));
        let none = "the format has none";
        layer(
            material.transmission_weight > 0.0,
            "transmission.weight",
            "refraction",
            none,
        );
        let absorbs = material.transmission_weight > 0.0 && material.transmission_depth > 0.0;
        layer(absorbs, "transmission.depth", "absorption inside", none);
        let has_extra = material.transmission_weight > 0.0 && material.transmission_roughness != 0.0;
        layer(
            has_extra,
            "transmission.roughness",
            "extra roughness of the refraction",
            none,
        );
        let is_rough = material.diffuse_roughness > 0.0 && material.metalness < 1.0;
        layer(
            is_rough,
            "base.diffuse_roughness",
            "roughness of the diffuse base",
            none,
        );
        layer(material.fuzz_weight > 0.0, "fuzz.weight", "fuzz", none);
        layer(material.has_film(), "thin_film.thickness", "thin film", none);
        let is_partial = material.has_film() && material.film_weight < 1.0 && takes.has("thin_film.thickness");
        layer(
            is_partial,
            "thin_film.weight",
            "the thin film's weight",
            "the format's film is everywhere",
        );
        let loses_light = material.lobe.traits().loses_light && material.metalness > 0.0;
        let dims = loses_light && material.multiple_scattering && !takes.has("specular.multiple_scattering");
        layer(
            dims,
            "specular.multiple_scattering",
            "multiple scattering between facets",
            none,
        );
        layer(material.emission_strength > 0.0, "emission.strength", "emission", none);
        layer(material.opacity < 1.0, "geometry.opacity", "opacity", none);
        let mut of_model = material.uses_of_model();
        // One switch for both, which an own texture of the roughness needs.
        of_model[TextureTarget::Metalness] &= material.user_textures.get(TextureTarget::Roughness).is_none();
        let is_textured = of_model != TextureUse::default();
        layer(
            is_textured,
            "base.color_texture",
            "textures of the model",
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
            (true, _) if takes.has("specular.edge_tint") => "a metal's by its colour and edge tint",
            (true, _) => "a metal's by its colour",
            (false, Law::Exact) => "a dielectric's by the exact equations",
            (false, Law::Schlick) => "a dielectric's by Schlick's approximation",
        };
        Entry::approximated(what, law, Some(Residual::reflectance(worst)))
    }

    /// The coat's narrower width over its wider one.
    pub fn coat_ratio(&self) -> f32 {
        let stretch = stretch_from_anisotropy(self.coat_anisotropy.abs());
        1.0 / (stretch * stretch)
    }

    /// Sets index and roughness of the base so that a coat which changes both (OpenPBR 1.1, "Coat") leaves the look of one
    /// that does not.
    pub(super) fn counter_coat(&mut self) {
        if self.coat_on_base || self.coat_weight == 0.0 {
            return;
        }
        if let Some(ior) = self.countered_ior() {
            self.ior = ior;
        }
        let below = |roughness: f32| {
            let blurred = (roughness.powi(4) + coat_blur(self.coat_roughness)).min(1.0).powf(0.25);
            roughness + (blurred - roughness) * self.coat_weight
        };
        let (mut low, mut high) = (0.0, self.roughness);
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if below(middle) < self.roughness {
                low = middle;
            } else {
                high = middle;
            }
        }
        (self.coat_on_base, self.roughness) = (true, rounded(low));
    }

    /// The index that a coat brings down to that of the base; none where light is refracted by it or a film lies on it.
    fn countered_ior(&self) -> Option<f32> {
        let ior = self.ior / (1.0 - self.coat_weight + self.coat_weight / self.coat_ior);
        let is_free = self.transmission_weight == 0.0 && self.film_weight == 0.0 && ior >= self.coat_ior;
        is_free.then(|| rounded(ior))
    }

    /// What becomes of a material's coat.
    fn coat_losses(&self, material: &MaterialSettings, takes: &Takes) -> Vec<Entry> {
        if material.coat_weight == 0.0 {
            return Vec::new();
        }
        if !takes.has("coat.weight") {
            return vec![Entry::dropped("coat", "the format has none")];
        }
        let mut entries = Vec::new();
        let mut part = |is_used, key, what, detail| entries.extend(takes.part(is_used, key, what, detail));
        let is_tinted = material.coat_ior != 1.5 || material.coat_color != [1.0; 3];
        part(is_tinted, "coat.ior", "the coat's index and colour", "1.5 and white");
        let is_stretched = material.coat_anisotropy != 0.0;
        part(is_stretched, "coat.anisotropy", "the coat's anisotropy", "it is round");
        let changes = material.coat_on_base || material.coat_darkening > 0.0;
        let detail = "what lies below keeps its reflection, roughness, brightness and emission";
        part(changes, "coat.on_base", "what the coat changes below it", detail);
        if takes.has("coat.on_base") && !material.coat_on_base {
            let set = match self.countered_ior() {
                Some(_) => "index and roughness are",
                None => "roughness is",
            };
            let dimmed = if self.emission() == [0.0; 3] {
                ""
            } else {
                "; emission is dimmed"
            };
            let detail = format!("the base's {set} set against a coat that always acts on it{dimmed}");
            entries.push(Entry::approximated("the coat's share in the base", detail, None));
        }
        entries.push(match material.coat_lobe {
            CoatLobe::Geometric => {
                let detail = format!("GGX of roughness {} stands for its geometric lobe", self.coat_roughness);
                Entry::approximated("coat", detail, None)
            }
            CoatLobe::Ggx => Entry::exact("coat"),
        });
        entries
    }
}

/// The Fresnel factor's terms of a material as it is edited.
fn fresnel_terms(material: &MaterialSettings) -> FresnelTerms<f64> {
    let tint = Vec3::from_f32(shown_tint(material));
    let weight = f64::from(material.specular_weight);
    FresnelTerms {
        model: material.fresnel_model(),
        metal_f0: Vec3::from_f32(material.base_color) * f64::from(material.base_weight),
        metalness: f64::from(material.metalness),
        tint,
        metal_tint: if material.specular_on_metal {
            tint * weight
        } else {
            Vec3::splat(1.0)
        },
        edge_tint: Vec3::from_f32(material.edge_tint),
        weight: if material.has_weight_in_index() { 1.0 } else { weight },
        ior: if material.has_weight_in_index() {
            weighted_ior(material.ior.into(), weight)
        } else {
            f64::from(material.ior)
        },
        eta: Vec3::from_f32(material.eta),
        k: Vec3::from_f32(material.k),
        // A thin film is reported as a part of its own.
        has_film: false,
        before: 1.0,
        film: FilmTerms::none_over(1.0),
    }
}

/// The tint that shows: only Schlick's reflectance head-on can be raised, up to 1.
fn shown_tint(material: &MaterialSettings) -> [f32; 3] {
    let most = match material.fresnel_model() {
        Fresnel::Schlick => fresnel_f0(material.ior).recip(),
        _ => 1.0,
    };
    material.specular_color.map(|x| x.min(most))
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
    let is_matched = material.textures[TextureTarget::Roughness] && material.lobe.traits().width == Width::Roughness;
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
