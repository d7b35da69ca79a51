//! What is rendered, and how: a document from files and options.

use std::{path::Path, path::PathBuf, str::FromStr as _};

use anyhow::bail;
use clap::Args;

use super::{
    answer::{Destination, write_json},
    lights,
    lights::LightArgument,
    names, parse,
    settings::SettingOptions,
    textures,
    textures::TextureArgument,
};
use crate::{
    document::{
        Background, Document, GroupName, ImportLobe, LightMix, MaterialSettings, ParameterError,
        effect::EffectSwitches,
        of_model::{import_report, lights_left_out, materials_of},
        range,
    },
    import::is_model,
    render::{EngineChoice, Session},
    scene::{
        Model, ModelOptions, ModelSource,
        environment::{EnvironmentEncoding, EnvironmentSource},
    },
    store::{
        exchange,
        exchange::ReadOptions,
        file_kind::{FileKind, may_hold_document, what_is_opened},
        lut,
        opened::Opened,
    },
};

/// Arguments that describe what is rendered, and how. Options override what files say.
#[derive(Debug, Default, Args)]
#[command(next_line_help = true)]
pub struct SceneArguments {
    /// What to begin with: projects (.json), images saved here (.png, with the document inside), models (several are
    /// shown together), environments, materials. Options override what they say.
    #[arg(value_name = "FILE", value_parser = parse::name_of_file(parse::file))]
    files: Vec<PathBuf>,
    /// What to render: a built-in model, a file (.glb, .gltf, .usd, .usdz, .fbx, .obj, .ply, .stl, .zip), or a folder with one [default: teapot].
    #[arg(long, value_name = "FILE|teapot|sphere|plane|shaderball|still-life", value_parser = parse::name_of_file(parse::model))]
    model: Option<ModelSource>,
    /// Which scene of the model's file, counted from 0. Without it the file's default one.
    #[arg(long, value_name = "N")]
    scene: Option<usize>,
    /// Which variant of the model's materials. Without it the file's own materials.
    #[arg(long, value_name = "NAME")]
    variant: Option<String>,
    /// Pose the model as its first animation does at this time. Without it as the file has it at rest.
    #[arg(long, value_name = "SECONDS", value_parser = parse::number_in(range::POSE_TIME_S), allow_negative_numbers = true)]
    time_of_pose: Option<f64>,
    /// The longest side of a model's textures in texels; larger ones are halved until they fit [default: 8192].
    #[arg(long, value_name = "N", value_parser = parse::number_in(range::TEXTURE_SIDE))]
    texture_size: Option<f64>,
    /// Write what became of the parts of the model's file (used, approximated, ignored, missing), as JSON; - is standard output.
    #[arg(long, value_name = "FILE|-")]
    pub import_report: Option<Destination>,
    /// Where the light comes from: a built-in environment (product, studio, portrait, rim, warehouse, overcast, sky,
    /// furnace), an image of the whole sphere (.hdr, .exr, .ktx2, .dds, .png, .jpg, .tif, .webp; lat-long or cube map), or a
    /// folder with the six faces of a cube [default: product].
    #[arg(long, value_name = "FILE|NAME", value_parser = parse::name_of_file(EnvironmentSource::from_str))]
    environment: Option<EnvironmentSource>,
    /// What the numbers of a .png, .jpg, .tif or .webp environment stand for: colours of a screen, or light [default: display].
    #[arg(long, value_name = "display|linear", value_parser = parse::environment_encoding)]
    environment_encoding: Option<EnvironmentEncoding>,
    /// A rectangle (triangle, disc, sphere) that shines, looking at the middle of the model: its direction in degrees, then distance, sides (all
    /// in bounding radii of the model) and radiance; a colour, or the temperature of one, may follow, and WORD=VALUE as of
    /// --spot. A sphere may have a light profile (profile=FILE.ies). May be repeated, 64 lights in all.
    #[arg(long = "area-light", value_name = "YAW,PITCH,DISTANCE,WIDTH,HEIGHT,STRENGTH[,triangle|,disc|,sphere][,#rrggbb|,3200K][,WORD=VALUE]…", value_parser = lights::area_light, allow_hyphen_values = true)]
    area_lights: Vec<LightArgument>,
    /// A spot, a disc that shines into a cone: yaw, pitch (degrees), distance, target (x,y,z), turn, width, height, cone
    /// (degrees), softness, colour, temperature (2700K), strength (radiance) or power (lumens). May be repeated.
    #[arg(long = "spot", value_name = "WORD=VALUE,…", value_parser = lights::spot, allow_hyphen_values = true)]
    spots: Vec<LightArgument>,
    /// A sun: yaw, pitch (degrees), angle across it (degrees), colour, temperature (5600K), strength (irradiance at the model)
    /// or power (lux, the same). May be repeated.
    #[arg(long = "sun", value_name = "WORD=VALUE,…", value_parser = lights::sun, allow_hyphen_values = true)]
    suns: Vec<LightArgument>,
    /// Multiply the light of a group by a factor and a colour after rendering; needs --light-groups. May be repeated.
    #[arg(long = "light-mix", value_name = "GROUP=FACTOR[,#rrggbb|,3200K]", value_parser = lights::light_mix)]
    light_mix: Vec<LightMix>,
    /// What the camera sees where it hits nothing [default: environment].
    #[arg(long, value_name = "environment|transparent|#rrggbb", value_parser = parse::background)]
    background: Option<Background>,
    /// The material of everything: the name of a shipped one, or a file (.json, or one of another program, such as .mtlx).
    /// Without it a file's own materials stay.
    #[arg(long, value_name = "FILE|NAME", value_parser = parse::name_of_file(String::from_str))]
    material: Option<String>,
    #[arg(long = "texture", value_name = "[SLOT:]USE=FILE", value_parser = textures::argument(), help = textures::help())]
    textures: Vec<TextureArgument>,
    /// The lobe of a file's own materials: geometric, its roughness matched to the look of the file's, or ggx.
    #[arg(long, default_value = "geometric", value_name = "geometric|ggx", value_parser = names::choice::<ImportLobe>)]
    import_lobe: ImportLobe,
    /// Set a parameter of every material, such as specular.roughness=0.2, or a setting, such as camera.fov=40. Overrides
    /// all other options. May be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse::assignment)]
    assignments: Vec<String>,
    /// Where the camera is, in degrees around and above its target.
    #[arg(long, value_name = "YAW,PITCH", value_parser = parse::numbers_in([range::YAW_DEG, range::PITCH_DEG]), allow_hyphen_values = true, conflicts_with = "camera-position")]
    camera_orbit: Option<[f64; 2]>,
    /// A table of colours (.cube) that the image for screens goes through last, as codes of sRGB: a look.
    #[arg(long, value_name = "FILE")]
    lut: Option<PathBuf>,
    /// Width and height in pixels [default: 512x512]. An image takes about 100 bytes of memory per pixel. Denoising adds
    /// 184, and up to 1.6 GB for the library. An image that does not fit the memory is refused before rendering.
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    size: Option<[u32; 2]>,
    /// Render this part of the image only, the rest staying transparent: shares of width and height.
    #[arg(long, value_name = "LEFT,TOP,RIGHT,BOTTOM", value_parser = parse::region)]
    region: Option<[f64; 4]>,
    #[command(flatten)]
    pub settings: SettingOptions,
    /// Which effects are simulated: those that the scene calls for (auto); all, needed or not; or these alone (names of
    /// `glossmith plan`, with commas between; +NAME and -NAME change what the scene calls for) [default: auto].
    #[arg(long, value_name = "auto|all|LIST", allow_hyphen_values = true)]
    effects: Option<EffectSwitches>,
    /// The engine: a hardware GPU if there is one, else the CPU; the GPU; the CPU.
    #[arg(long, default_value = "auto", value_name = "auto|gpu|cpu")]
    pub engine: EngineChoice,
}

impl SceneArguments {
    /// Those of files alone.
    pub fn of_files(files: &[PathBuf], engine: EngineChoice) -> Self {
        Self {
            files: files.to_owned(),
            engine,
            ..Self::default()
        }
    }

    /// The document that the arguments describe.
    ///
    /// # Errors
    /// One line that names the file, what is wrong and what to do.
    pub fn document(&self, session: &mut Session) -> anyhow::Result<Document> {
        let mut document = Document::default();
        for file in &self.files {
            open(file, &mut document, self.read_options())?;
        }
        self.put_model(&mut document, session)?;
        if let Some(name) = &self.material {
            document.materials = vec![material(name, self.import_lobe)?];
        }
        if !self.textures.is_empty() {
            let model = session.assets().model(&document.model, &document.import)?;
            for texture in &self.textures {
                texture.apply(&mut document, &model)?;
            }
        }
        self.put_light(&mut document);
        self.put_view(&mut document)?;
        self.put_limits(&mut document);
        self.settings.apply(&mut document)?;
        for assignment in &self.assignments {
            document.assign(assignment)?;
        }
        self.put_light_mix(&mut document)?;
        document.check()?;
        self.check_textures(&document, session)?;
        Ok(document)
    }

    /// A session of the CPU engine with the scene, and its document.
    pub fn on_cpu(&self) -> anyhow::Result<(Session, Document)> {
        let mut session = Session::open(EngineChoice::Cpu)?;
        let document = self.document(&mut session)?;
        session.submit(&document)?;
        Ok((session, document))
    }

    /// Refuses images that are named here and can't be had; those that files name are logged. What is read stays with the
    /// session.
    fn check_textures(&self, document: &Document, session: &mut Session) -> anyhow::Result<()> {
        let files: Vec<_> = self.textures.iter().flat_map(TextureArgument::files).collect();
        if files.is_empty() {
            return Ok(());
        }
        for own in session.user_texture_files(document)? {
            if let Err(why) = own.picture
                && files.contains(&&own.file)
            {
                bail!(
                    "{}: this texture can't be had: {why}; give another file",
                    own.file.display()
                );
            }
        }
        Ok(())
    }

    /// The length of a unit that a document will have, metres; its textures come later.
    fn unit_m(&self, document: &Document) -> anyhow::Result<f64> {
        let mut document = document.clone();
        self.settings.apply(&mut document)?;
        for assignment in &self.assignments {
            match document.assign(assignment) {
                Ok(()) | Err(ParameterError::NoTexture { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(document.unit_m)
    }

    /// How materials of other programs are read.
    fn read_options(&self) -> ReadOptions {
        ReadOptions {
            lobe: self.import_lobe,
            ..ReadOptions::default()
        }
    }

    /// The model: another one with its materials, lights and cameras, or other parts of the document's. Several files are
    /// shown together.
    fn put_model(&self, document: &mut Document, session: &mut Session) -> anyhow::Result<()> {
        let mut named = self.files.iter().filter(|file| is_model_file(file)).cloned();
        let source = self.model.clone().or_else(|| named.next().map(ModelSource::File));
        let import = &mut document.import;
        if source.is_some() {
            *import = ModelOptions {
                beside: if self.model.is_none() {
                    named.collect()
                } else {
                    Vec::new()
                },
                ..ModelOptions::default()
            };
        }
        import.scene = self.scene.or(import.scene);
        import.variant = self.variant.clone().or(import.variant.take());
        import.time_s = self.time_of_pose.map(|time| time as f32).or(import.time_s);
        import.texture_side_max = self.texture_size.map_or(import.texture_side_max, |side| side as u32);
        let takes_materials = source.is_some() || self.scene.is_some() || self.variant.is_some();
        document.model = source.unwrap_or(document.model.clone());
        self.import_report.iter().try_for_each(Destination::check_writable)?;
        let model = session.assets().model(&document.model, &document.import)?;
        self.check_choices(document, &model)?;
        if let Some(destination) = &self.import_report {
            let report = serde_json::json!({
                "model": model.name,
                "entries": import_report(&model, self.import_lobe).entries,
                "scenes": model.scenes,
                "variants": model.variants,
                "animation_seconds": model.duration_s,
            });
            write_json(destination, &report)?;
        }
        let has_materials = matches!(document.model, ModelSource::File(_));
        if takes_materials && has_materials {
            document.materials = materials_of(&model, self.import_lobe);
        }
        let radius_m = model.bounding_radius() * self.unit_m(document)?;
        let given = [&self.area_lights, &self.spots, &self.suns].into_iter().flatten();
        given.clone().try_for_each(LightArgument::check_profile)?;
        document
            .lighting
            .area_lights
            .extend(given.map(|light| light.in_scene(radius_m)));
        if takes_materials && let Some(message) = lights_left_out(document.add_lights_and_cameras(&model)) {
            log::warn!("{message}");
        }
        Ok(())
    }

    /// Refuses a scene or a variant that the model's file does not have; of several files each has its own.
    fn check_choices(&self, document: &Document, model: &Model) -> anyhow::Result<()> {
        let (scenes, variants) = (model.scenes.len().max(1), &model.variants);
        if !document.import.beside.is_empty() {
            return Ok(());
        }
        match (self.scene, &self.variant) {
            (Some(scene), _) if scene >= scenes => {
                bail!("--scene {scene}: the model's scenes are 0 to {}", scenes - 1)
            }
            (_, Some(wanted)) if variants.is_empty() => bail!("--variant {wanted}: the model has no variants"),
            (_, Some(wanted)) if !variants.contains(wanted) => {
                bail!(
                    "--variant {wanted}: the model has no such variant; it has {}",
                    variants.join(", ")
                )
            }
            _ => Ok(()),
        }
    }

    fn put_light(&self, document: &mut Document) {
        let lighting = &mut document.lighting;
        if let Some(environment) = &self.environment {
            lighting.environment = environment.clone();
        }
        lighting.environment_encoding = self.environment_encoding.unwrap_or(lighting.environment_encoding);
        lighting.background = self.background.unwrap_or(lighting.background);
    }

    /// The mix of light groups, each of which must be there.
    fn put_light_mix(&self, document: &mut Document) -> anyhow::Result<()> {
        let names = document.light_groups();
        for mix in &self.light_mix {
            if !names.contains(&mix.group) {
                let all: Vec<_> = names.iter().map(GroupName::as_str).collect();
                match all[..] {
                    [] => bail!("--light-mix {}: add --light-groups", mix.group),
                    _ => bail!("--light-mix {}: no such group; there are {}", mix.group, all.join(", ")),
                }
            }
            document.set_light_mix(*mix);
        }
        Ok(())
    }

    fn put_view(&self, document: &mut Document) -> anyhow::Result<()> {
        if let Some(path) = &self.lut {
            lut::load(path)?;
            document.view.lut = Some(path.clone());
        }
        let camera = &mut document.camera;
        if let Some([yaw_deg, pitch_deg]) = self.camera_orbit {
            (camera.yaw_deg, camera.pitch_deg) = (yaw_deg, pitch_deg);
        }
        if self.camera_orbit.is_some() || self.settings.has("camera.distance") {
            // A position in the document overrides both.
            camera.position = None;
        }
        let render = &mut document.render;
        if let Some([width, height]) = self.size {
            (render.width, render.height) = (width, height);
        }
        render.region = self.region.or(render.region);
        if let Some(effects) = self.effects {
            render.effects = effects;
        }
        Ok(())
    }

    /// With a time or noise to reach only, samples are not limited.
    fn put_limits(&self, document: &mut Document) {
        let is_limited = ["render.time", "render.noise"].iter().any(|key| self.settings.has(key));
        if is_limited && !self.settings.has("render.samples") {
            document.render.samples = u32::MAX;
        }
    }
}

fn is_model_file(path: &Path) -> bool {
    is_model(path) || path.is_dir()
}

/// Puts what a file holds in the document: an environment, a material or a whole project. Models are left alone.
fn open(path: &Path, document: &mut Document, options: ReadOptions) -> anyhow::Result<()> {
    match FileKind::of(path) {
        _ if is_model_file(path) => {}
        Some(FileKind::Light | FileKind::Picture) if !may_hold_document(path) => {
            document.lighting.environment = EnvironmentSource::File(path.to_owned())
        }
        Some(FileKind::Document | FileKind::Picture | FileKind::Material) => match exchange::open(path, options)? {
            Opened::Material(material) => {
                warn(&material.warnings);
                document.materials = vec![material.value];
            }
            Opened::Document(project) | Opened::Picture(project) => {
                warn(&project.warnings);
                *document = project.value;
            }
        },
        _ if !path.exists() => bail!("{}: no such file; check the path", path.display()),
        _ => bail!(
            "{}: not a kind of file that can be opened; those are {}",
            path.display(),
            what_is_opened()
        ),
    }
    Ok(())
}

/// A shipped material, or one of a file.
pub fn material(name: &str, lobe: ImportLobe) -> anyhow::Result<MaterialSettings> {
    let found = exchange::find(
        name,
        ReadOptions {
            lobe,
            ..ReadOptions::default()
        },
    )?;
    warn(&found.warnings);
    Ok(found.value)
}

fn warn(warnings: &[String]) {
    warnings.iter().for_each(|warning| log::warn!("{warning}"));
}
