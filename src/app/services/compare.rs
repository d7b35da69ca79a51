//! A and B: the document, and the same scene seen by the same camera with the same random numbers in another material.
//! B has a renderer of its own for as long as the two are compared, which shares models and environments with A's.

use std::sync::Arc;

use crate::{
    analysis::difference::difference,
    document::{Change, Document, MaterialSettings},
    matching::{lobe_of_material, matched_lobe},
    named::{named, with_defaults},
    optics::lobe::{Lobe, model::LobeModel},
    render::EngineKind,
    render::worker::{Picture, Snapshot, Worker},
    services::beside::Beside,
};

#[derive(Clone, Debug, PartialEq)]
pub enum Rival {
    /// The selected material with another lobe, its roughness chosen so that the look is nearest.
    Lobe(Lobe),
    /// Another material in the selected slot.
    Material(Box<MaterialSettings>),
    /// All materials of another document, and what to call them.
    Materials(String, Vec<MaterialSettings>),
}

/// What the materials before the last change are called.
pub const BEFORE: &str = "What you had";

named! {
    /// How A and B are shown.
    #[derive(Default)]
    View {
        #[default]
        Wipe, "wipe", "Wipe", "A left of the divider, B right of it. Drag the divider.";
        SideBySide, "side-by-side", "Side by side", "One beside the other.";
        Difference, "difference", "Difference", "Luminance of B less that of A, in linear light.";
        Flicker, "flicker", "Flicker", "One after the other in the same place.";
    }
}

/// A lobe to match, and with which.
type MatchQuery = (LobeModel, Lobe);

/// Two images to compare, and the scale that was chosen.
#[derive(Clone)]
struct DifferenceQuery {
    a: Arc<Picture>,
    b: Arc<Picture>,
    scale: Option<f32>,
}

impl PartialEq for DifferenceQuery {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.a, &other.a) && Arc::ptr_eq(&self.b, &other.b) && self.scale == other.scale
    }
}

/// How two images differ.
pub struct Compared {
    /// Columns and rows.
    pub size: [usize; 2],
    /// The image of the difference.
    pub rgba: Vec<u8>,
    /// Its full colours, in radiance.
    pub scale: f32,
    /// Root mean square relative difference.
    pub rms: f64,
    /// Samples per pixel of A and B.
    pub samples: [u32; 2],
    /// Differs from one to the next.
    pub serial: u64,
}

with_defaults! {
    /// The comparison; B is only rendered while it is on.
    pub struct Compare {
        pub is_on: bool,
        pub view: View,
        pub rival: Rival = Rival::Lobe(Lobe::Ggx),
        /// It was chosen: it stays until something else is.
        pub is_chosen: bool,
        /// Where the divider is, as a share of the image's width.
        pub divider: f32 = 0.5,
        /// Changes a second.
        pub flicker_hz: f32 = 2.0,
        /// The difference with the full colour; `None` is automatic.
        pub scale: Option<f32>,
        pub renderer: Option<Renderer>,
        matching: Beside<MatchQuery, (MatchQuery, Result<LobeModel, String>)>,
        differing: Beside<DifferenceQuery, Arc<Compared>>,
        /// Counts B's renderers: serial numbers restart with each.
        pub generation: u64,
    }
}

pub struct Renderer {
    pub worker: Worker,
    pub engine: EngineKind,
    pub submitted: Option<Document>,
    pub is_paused: bool,
}

impl Compare {
    /// The state of B's renderer; `None` where there is none yet.
    pub fn snapshot(&self) -> Option<Arc<Snapshot>> {
        Some(self.renderer.as_ref()?.worker.snapshot())
    }

    pub fn picture(&self) -> Option<Arc<Picture>> {
        self.snapshot()?.picture.clone()
    }

    /// How the latest images differ.
    pub fn compared(&self) -> Option<Arc<Compared>> {
        self.differing.latest()
    }

    /// What B is called.
    pub fn name(&self, material: &MaterialSettings) -> String {
        match &self.rival {
            Rival::Lobe(lobe) => match self.matched(material, *lobe) {
                Some(Ok(model)) => format!("{}, R {:.3}", lobe.label(), model.roughness),
                _ => lobe.label().to_owned(),
            },
            Rival::Material(material) => material.name.clone(),
            Rival::Materials(name, _) => name.clone(),
        }
    }

    /// Why the look could not be matched.
    pub fn match_error(&self, material: &MaterialSettings) -> Option<String> {
        match &self.rival {
            Rival::Lobe(lobe) => self.matched(material, *lobe)?.err(),
            _ => None,
        }
    }

    /// The lobe that was found for this material; the last one while another is looked for.
    fn matched(&self, material: &MaterialSettings, lobe: Lobe) -> Option<Result<LobeModel, String>> {
        let ((model, with), found) = self.matching.latest()?;
        (with == lobe && model.lobe == material.lobe).then_some(found)
    }

    /// The document with B's materials.
    pub fn rival_document(&self, document: &Document, slot: usize) -> Document {
        let mut rival = document.clone();
        let material = rival.material_mut(slot);
        match &self.rival {
            Rival::Lobe(lobe) => {
                let matched = self.matched(material, *lobe);
                material.lobe = *lobe;
                if let Some(Ok(model)) = matched {
                    material.roughness = model.roughness as f32;
                    material.horizon = model.horizon;
                    material.curve = model.curve;
                    material.anisotropy = 0.0;
                }
            }
            Rival::Material(other) => *material = MaterialSettings::clone(other),
            Rival::Materials(_, all) => rival.materials = all.clone(),
        }
        rival
    }

    /// Looks for the roughness of another lobe, where B is one.
    pub fn match_look(&mut self, ctx: &egui::Context, material: &MaterialSettings) {
        let Rival::Lobe(lobe) = self.rival else { return };
        let mut model = lobe_of_material(material);
        // Another name is not another look.
        model.name.clear();
        // Without a thread B keeps A's roughness.
        self.matching
            .ask(ctx, "match lobes", (model, lobe), |query, responder| {
                let found = matched_lobe(&query.0, query.1).map_err(crate::in_words);
                responder.publish((query, found));
            });
    }

    /// Requests the difference of the images if they are new and of the same size and view.
    pub fn take_difference(&mut self, ctx: &egui::Context, a: Option<&Arc<Picture>>) {
        let (Some(a), Some(b)) = (a, self.picture()) else {
            return;
        };
        let beside_materials = Change {
            materials: false,
            display: false,
            target: false,
            ..Change::between(&a.document, &b.document)
        };
        if a.reduction != b.reduction || !beside_materials.is_none() {
            return;
        }
        let mut serial = 0;
        let query = DifferenceQuery {
            a: a.clone(),
            b,
            scale: self.scale,
        };
        self.differing.ask(ctx, "difference", query, move |query, responder| {
            let Some(found) = difference(&query.a.image, &query.b.image) else {
                return;
            };
            let scale = query.scale.unwrap_or_else(|| found.automatic_scale());
            serial += 1;
            responder.publish(Arc::new(Compared {
                size: [found.width as usize, found.height as usize],
                rgba: found.rgba(scale),
                scale,
                rms: found.rms_relative,
                samples: [query.a.samples_per_pixel, query.b.samples_per_pixel],
                serial,
            }));
        });
    }

    /// Ends B's renderer, beside the window: its thread may have to finish a step.
    pub fn stop(&mut self) {
        if let Some(renderer) = self.renderer.take() {
            // Without a thread it ends here.
            let _ = std::thread::Builder::new()
                .name("farewell".to_owned())
                .spawn(move || drop(renderer));
        }
        self.differing = Beside::default();
    }
}
