//! The vane of a feather: barbs along the tangent, and barbules that branch off them to both sides.
//!
//! ```text
//! f = w_b f_b + w_bp f_bp + w_bd f_bd + w_t δ(ωo, −ωi)/|n·ωi|,    w_bp = w_bd = (1 − w_b − w_t)/2
//! ```
//!
//! The first thesis (Romeo Arroyo 2021), equation 5.3; there the last term reads δ(1 − ωi·ωo), which neither points the
//! right way nor lets the share `w_t` pass, and a fibre's S stands for its f = S/|n·ωi|. Each w is a share of the area: of
//! the barb, the proximal and the distal barbules, and of what is open. The last term is no function of directions:
//! [`Bsdf::evaluate`] leaves it out, [`Bsdf::straight_through`] is `w_t`.
//!
//! **Barbs** are a [`cylinder`](super::cylinder) along x, or one with a [sponge](super::spongy_barb) inside. **Barbules**
//! are cylinders at ± the barbule angle to the barb, bare or with layers on them, or flat lamellae that carry a film or a stack, a [`CoatedBase`] whose
//! normal is the vane's; then their angle does not matter and nothing goes through them.
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | `barb_share`: share of the area that barbs cover | `w_b` | | 0.0704, or the species' | 0 to 0.5 |
//! | `through_share`: share that is open | `w_t` | | 0 | 0 to 0.5 |
//! | `barbule_angle_deg`, of cylinders | `θ_b` | ° | 45 | 0 to 90 |
//! | `barb.…` | | | | those of the barb's model |
//! | `barbule.…` | | | | those of the barbules' model, the same for both sides |
//!
//! Within these ranges no share is negative. `barb_share` is width/(width + spacing): by default that of the mean barb of
//! the thesis's section 3.1, 20 µm wide and 264 µm from the next, or that of a species in [`BarbSpecies`] (0.026 to
//! 0.27). Barbules of both sides branch off at the same angle, 45° there.
//!
//! Of cylinders without absorption, ∫ f |n·ωi| dωi over the whole sphere is 1 − `w_t` for each viewer, as far as the
//! shares go. Like its cylinders the feather is not reciprocal.
//!
//! **What it leaves out.** Barbs and barbules that hide each other: the shares are the same from everywhere. Barbs that are
//! elliptical (the thesis gives a mean ratio of 2.25) or conical, or that lie at other angles within the area seen.
//! Plumulaceous feathers (down), whose barbules do not lie in the vane. Fluorescence of psittacofulvins and porphyrins.
//! Light that meets several fibres one after another.

mod species;

pub use species::BarbSpecies;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use self::species::barb_share;
use super::cylinder::{CylinderDesign, CylinderModel, FilmedCylinderDesign, FilmedCylinderModel};
use super::oriented::Tangent;
use super::sampling::Choice;
use super::spongy_barb::SpongyBarbModel;
use super::{Bsdf, ChannelMix, CoatedBase, Design, Direction, Model, ModelError, Sample};
use crate::parameter::{Parameter, Spread};

/// Mean width and spacing of barbs, µm (the first thesis, section 3.1, which calls the width a radius; Pap et al. 2015).
const MEAN_BARB_UM: (f64, f64) = (20.0, 264.0);

/// The vane of a feather as typed in a job.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FeatherDesign {
    /// Scientific name of a bird whose barbs give `barb_share`: `Columba livia`. Without this key, the mean of birds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub species: Option<String>,
    /// The barbs.
    pub barb: BarbDesign,
    /// The barbules of both sides.
    pub barbule: BarbuleDesign,
}

/// A barb as typed in a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum BarbDesign {
    /// A dielectric fibre.
    Cylinder(CylinderDesign),
    /// The same fibre with a sponge inside that scatters one band of wavelengths.
    SpongyBarb(CylinderDesign),
}

impl Default for BarbDesign {
    fn default() -> Self {
        Self::Cylinder(CylinderDesign::default())
    }
}

impl BarbDesign {
    fn model(&self, wavelengths_nm: &[f64]) -> Result<Box<dyn Model>, ModelError> {
        Ok(match self {
            Self::Cylinder(design) => Box::new(CylinderModel::new(design, wavelengths_nm)?),
            Self::SpongyBarb(design) => Box::new(SpongyBarbModel::new(design, wavelengths_nm)?),
        })
    }
}

/// Barbules as typed in a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum BarbuleDesign {
    /// Dielectric fibres at ± the barbule angle to the barb.
    Cylinder(CylinderDesign),
    /// The same fibres with a film or a stack on their surface: an iridescent feather.
    FilmedCylinder(FilmedCylinderDesign),
    /// Flat plates in the vane that carry a film or a stack: an iridescent feather too.
    Lamella(Box<Design>),
}

impl Default for BarbuleDesign {
    fn default() -> Self {
        Self::Cylinder(CylinderDesign::default())
    }
}

/// The vane of a feather for a list of wavelengths.
#[derive(Debug)]
pub struct Feather {
    barb: Box<dyn Model>,
    barbule: Box<dyn Model>,
    /// Whether the barbules have a direction: then their angle is a parameter.
    barbules_are_fibres: bool,
    parameters: Vec<Parameter>,
}

impl Feather {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// No wavelengths, senseless ones, a species that is not in the table, or a barb or barbule that cannot be made.
    pub fn new(design: &FeatherDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let species = design.species.as_deref().map(BarbSpecies::named).transpose()?;
        let barb = design.barb.model(wavelengths_nm)?;
        let (barbule, barbules_are_fibres): (Box<dyn Model>, _) = match &design.barbule {
            BarbuleDesign::Cylinder(design) => (Box::new(CylinderModel::new(design, wavelengths_nm)?), true),
            BarbuleDesign::FilmedCylinder(design) => {
                (Box::new(FilmedCylinderModel::new(design, wavelengths_nm)?), true)
            }
            BarbuleDesign::Lamella(design) => (Box::new(CoatedBase::new(design, wavelengths_nm)?), false),
        };

        let mut parameters = vec![barb_share_parameter(species), through_share_parameter()];
        if barbules_are_fibres {
            parameters.push(barbule_angle_parameter());
        }
        parameters.extend(barb.parameters().iter().map(|parameter| of_part("barb", parameter)));
        parameters.extend(barbule.parameters().iter().map(|parameter| of_part("barbule", parameter)));
        Ok(Self { barb, barbule, barbules_are_fibres, parameters })
    }
}

fn barb_share_parameter(species: Option<&BarbSpecies>) -> Parameter {
    let (default, source) = match species {
        Some(species) => (
            species.barb_share(),
            format!("{}: {} µm wide, {} µm apart", species.name, species.width_um, species.spacing_um),
        ),
        None => {
            let (width, spacing) = MEAN_BARB_UM;
            (barb_share(width, spacing), format!("mean of birds: {width} µm wide, {spacing} µm apart"))
        }
    };
    Parameter {
        name: "barb_share".to_owned(),
        symbol: "w_b".to_owned(),
        unit: "",
        default,
        lower: 0.0,
        upper: 0.5,
        spread: Spread::Linear,
        scan_step: None,
        text: format!("share of the area that barbs cover ({source})"),
    }
}

fn through_share_parameter() -> Parameter {
    Parameter {
        name: "through_share".to_owned(),
        symbol: "w_t".to_owned(),
        unit: "",
        default: 0.0,
        lower: 0.0,
        upper: 0.5,
        spread: Spread::Linear,
        scan_step: None,
        text: "share of the area that is open, where light goes straight through".to_owned(),
    }
}

fn barbule_angle_parameter() -> Parameter {
    Parameter {
        name: "barbule_angle_deg".to_owned(),
        symbol: "θ_b".to_owned(),
        unit: "°",
        default: 45.0,
        lower: 0.0,
        upper: 90.0,
        spread: Spread::Linear,
        scan_step: None,
        text: "angle between a barb and its barbules, the same on both sides".to_owned(),
    }
}

/// A parameter of the barb's or the barbules' model as the feather's.
fn of_part(part: &str, parameter: &Parameter) -> Parameter {
    Parameter {
        name: format!("{part}.{}", parameter.name),
        symbol: format!("{} {part}", parameter.symbol),
        text: format!("{part}: {}", parameter.text),
        ..parameter.clone()
    }
}

impl Model for Feather {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.barb.channel_count()
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        let [own, barb, barbule] = self.of_parts(values);
        Box::new(self.bound(own, self.barb.bind(barb), self.barbule.bind(barbule)))
    }

    fn bind_for_picture(&self, shades: &[Vec<f64>], mix: Option<&ChannelMix>) -> Vec<Box<dyn Bsdf + '_>> {
        let part = |number: usize| -> Vec<Vec<f64>> {
            shades.iter().map(|values| self.of_parts(values)[number].to_vec()).collect()
        };
        let barbs = self.barb.bind_for_picture(&part(1), mix);
        let barbules = self.barbule.bind_for_picture(&part(2), mix);
        let parts = shades.iter().zip(barbs).zip(barbules);
        let bound = parts.map(|((values, barb), barbule)| -> Box<dyn Bsdf + '_> {
            Box::new(self.bound(self.of_parts(values)[0], barb, barbule))
        });
        bound.collect()
    }
}

impl Feather {
    /// The values of the feather's own parameters, of its barb's and of its barbules'.
    fn of_parts<'v>(&self, values: &'v [f64]) -> [&'v [f64]; 3] {
        let (own, parts) = values.split_at(if self.barbules_are_fibres { 3 } else { 2 });
        let (barb, barbule) = parts.split_at(self.barb.parameters().len());
        [own, barb, barbule]
    }

    /// The feather of these parts.
    fn bound<'a>(&self, own: &[f64], barb: Box<dyn Bsdf + 'a>, barbule: Box<dyn Bsdf + 'a>) -> BoundFeather<'a> {
        let (barb_share, through_share) = (own[0], own[1]);
        let barbule_share = 0.5 * (1.0 - barb_share - through_share);
        BoundFeather {
            shares: Shares { barb: barb_share, proximal: barbule_share, distal: barbule_share, through: through_share },
            barb,
            barbule,
            // Absent where the barbules' model knows no direction.
            directions: own
                .get(2)
                .map(|&angle| Barbules { proximal: Tangent::at_degrees(angle), distal: Tangent::at_degrees(-angle) }),
        }
    }
}

/// How the light is shared out; they sum to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Shares {
    barb: f64,
    proximal: f64,
    distal: f64,
    through: f64,
}

/// Directions of the barbules of both sides.
#[derive(Debug, Clone, Copy)]
struct Barbules {
    proximal: Tangent,
    distal: Tangent,
}

/// A feather with its parameters given.
struct BoundFeather<'a> {
    shares: Shares,
    barb: Box<dyn Bsdf + 'a>,
    barbule: Box<dyn Bsdf + 'a>,
    directions: Option<Barbules>,
}

impl BoundFeather<'_> {
    /// The shares that light from `incoming` and a viewer at `outgoing` find: here the areas, from everywhere. Barbs and
    /// barbules that hide each other would change them here and nowhere else.
    fn shares(&self, _incoming: &Direction, _outgoing: &Direction) -> Shares {
        self.shares
    }
}

/// Channels up to which a feather's parts are evaluated without asking for memory.
const FEW_CHANNELS: usize = 8;

impl Bsdf for BoundFeather<'_> {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        let shares = self.shares(incoming, outgoing);
        self.barb.evaluate(incoming, outgoing, values);
        for value in values.iter_mut() {
            *value *= shares.barb;
        }

        let (mut few, mut many) = ([0.0; FEW_CHANNELS], Vec::new());
        let part = match few.get_mut(..values.len()) {
            Some(few) => few,
            None => {
                many.resize(values.len(), 0.0);
                many.as_mut_slice()
            }
        };
        let mut add = |share: f64, incoming: &Direction, outgoing: &Direction| {
            self.barbule.evaluate(incoming, outgoing, part);
            for (value, part) in values.iter_mut().zip(&*part) {
                *value += share * part;
            }
        };
        match &self.directions {
            Some(Barbules { proximal, distal }) => {
                add(shares.proximal, &proximal.to_frame(incoming), &proximal.to_frame(outgoing));
                add(shares.distal, &distal.to_frame(incoming), &distal.to_frame(outgoing));
            }
            None => add(shares.proximal + shares.distal, incoming, outgoing),
        }
    }

    fn evaluate_many(&self, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
        if incoming.is_empty() {
            return;
        }
        let channels = values.len() / incoming.len();
        let shares: Vec<Shares> = incoming.iter().zip(outgoing).map(|(i, o)| self.shares(i, o)).collect();
        self.barb.evaluate_many(incoming, outgoing, values);
        for (values, shares) in values.chunks_exact_mut(channels).zip(&shares) {
            for value in values {
                *value *= shares.barb;
            }
        }

        let mut part = vec![0.0; values.len()];
        let mut add = |share: fn(&Shares) -> f64, incoming: &[Direction], outgoing: &[Direction]| {
            self.barbule.evaluate_many(incoming, outgoing, &mut part);
            let pairs = values.chunks_exact_mut(channels).zip(part.chunks_exact(channels));
            for ((values, part), shares) in pairs.zip(&shares) {
                for (value, part) in values.iter_mut().zip(part) {
                    *value += share(shares) * part;
                }
            }
        };
        match &self.directions {
            Some(Barbules { proximal, distal }) => {
                add(|shares| shares.proximal, &proximal.all_to_frame(incoming), &proximal.all_to_frame(outgoing));
                add(|shares| shares.distal, &distal.all_to_frame(incoming), &distal.all_to_frame(outgoing));
            }
            None => add(|shares| shares.proximal + shares.distal, incoming, outgoing),
        }
    }

    fn straight_through(&self, incoming: &Direction) -> f64 {
        self.shares(incoming, &-incoming).through
    }

    /// Chooses a part by its share, and the part draws.
    fn sample(&self, outgoing: &Direction, [first, second, choice]: [f64; 3]) -> Option<Sample> {
        let shares = self.shares(&-outgoing, outgoing);
        let mut choice = Choice(choice);
        if choice.takes(shares.through) {
            return Some(Sample { incoming: -outgoing, density: 0.0, straight_through: true });
        }
        let remaining = 1.0 - shares.through;
        let incoming = if choice.takes(shares.barb / remaining) {
            self.barb.sample(outgoing, [first, second, choice.0])?.incoming
        } else {
            match &self.directions {
                Some(Barbules { proximal, distal }) => {
                    let tangent = if choice.takes(shares.proximal / (shares.proximal + shares.distal)) {
                        proximal
                    } else {
                        distal
                    };
                    let drawn = self.barbule.sample(&tangent.to_frame(outgoing), [first, second, choice.0])?;
                    tangent.out_of_frame(&drawn.incoming)
                }
                None => self.barbule.sample(outgoing, [first, second, choice.0])?.incoming,
            }
        };
        Some(Sample::scattered(incoming, self.density(&incoming, outgoing)))
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        let shares = self.shares(&-outgoing, outgoing);
        let barbules = match &self.directions {
            Some(Barbules { proximal, distal }) => {
                let of_side = |share: f64, tangent: &Tangent| {
                    share * self.barbule.density(&tangent.to_frame(incoming), &tangent.to_frame(outgoing))
                };
                of_side(shares.proximal, proximal) + of_side(shares.distal, distal)
            }
            None => (shares.proximal + shares.distal) * self.barbule.density(incoming, outgoing),
        };
        shares.barb * self.barb.density(incoming, outgoing) + barbules
    }
}
