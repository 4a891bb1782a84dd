//! What can be wrong with a model as a user describes it.

use thiserror::Error;

use crate::optics::MaterialError;
use crate::pigment::{InversionError, PigmentError};

/// A model that cannot be made, with what was found, what was expected and how to mend it.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// No channels.
    #[error("a model needs at least one wavelength, found none")]
    NoWavelengths,
    /// A number outside its range.
    #[error("{what} is {found}; expected {expected}")]
    OutOfRange {
        /// The key or thing, with its layer or material.
        what: String,
        /// Value found.
        found: f64,
        /// Allowed values, with their unit.
        expected: &'static str,
    },
    /// A number of values that is not the number of parameters.
    #[error("the model has {expected} parameters, found {found} values; give one for each")]
    WrongCount {
        /// Number of values found.
        found: usize,
        /// Number of parameters.
        expected: usize,
    },
    /// A parameter's value outside its bounds, or no number.
    #[error("`{name}` is {found}; expected a number from {lower} to {upper}{unit}: {text}")]
    BadValue {
        /// The parameter.
        name: String,
        /// Value found.
        found: f64,
        /// Smallest value allowed.
        lower: f64,
        /// Largest value allowed.
        upper: f64,
        /// Unit with a space before it, or nothing.
        unit: String,
        /// What the parameter means.
        text: String,
    },
    /// A parameter that has one value for all channels, or does not exist.
    #[error("`per_channel` names {name:?}; expected some of: {expected}")]
    NotPerChannel {
        /// Name found.
        name: String,
        /// Names that could stand there.
        expected: String,
    },
    /// A vector that gives no direction.
    #[error(
        "{what} is [{}, {}, {}]; expected a vector that points out of the surface (its third number above 0), of any length",
        found[0], found[1], found[2]
    )]
    NotADirection {
        /// The key.
        what: &'static str,
        /// Vector found.
        found: [f64; 3],
    },
    /// A name that cannot be used.
    #[error(
        "{name:?} cannot be the name of a {what}; expected a letter and then letters, digits or underscores, since parameters are named after it"
    )]
    BadName {
        /// `layer` or `material`.
        what: &'static str,
        /// Name found.
        name: String,
    },
    /// Two layers of one name.
    #[error("two layers are named {name:?}; give each a name of its own, since its thickness is named after it")]
    TwoLayers {
        /// The name.
        name: String,
    },
    /// One name for two materials.
    #[error(
        "two different materials are named {name:?}; give each a name of its own, since its parameters are named after it"
    )]
    TwoMaterials {
        /// The name.
        name: String,
    },
    /// Knots of the base in no order.
    #[error("`base_knots_nm` must be wavelengths that rise, each once")]
    UnsortedKnots,
    /// A period without layers.
    #[error("a period has no layers; list them in `period`, from the outside in, or leave the entry out")]
    EmptyPeriod,
    /// A number of periods outside its range.
    #[error("`count` of a period is {found}; expected 1 to 1000")]
    BadCount {
        /// Number found.
        found: usize,
    },
    /// A material described in no way or in several.
    #[error(
        "material {name:?} is described by {found}; expected one of: `index` (and `extinction`); `cauchy_a` and `cauchy_b_nm2` (and `extinction_c` with `extinction_length_nm`); `table`"
    )]
    Description {
        /// Name of the material.
        name: String,
        /// The keys found.
        found: String,
    },
    /// A bird that is not in the table of barbs.
    #[error(
        "`species` is {found:?}, which is none of the {count} birds whose barbs are known; {meant}; or leave the key out and set `barb_share`"
    )]
    UnknownSpecies {
        /// Name found.
        found: String,
        /// Number of birds known.
        count: usize,
        /// Which names could be meant.
        meant: String,
    },
    /// Two absorbers of one name.
    #[error("two pigments are named {name:?}; give each a `name` of its own, since its parameters are named after it")]
    TwoPigments {
        /// The name.
        name: String,
    },
    /// An absorber that is known in three channels, in a job that has others.
    #[error(
        "pigment {name:?} is known in red, green and blue only, and the readings have {channels} wavelengths; use a kind with a spectrum (`eumelanin`, `pheomelanin`, `carotenoid`, `bands`, `table`)"
    )]
    PigmentNeedsRgb {
        /// The name.
        name: String,
        /// Channels of the job.
        channels: usize,
    },
    /// A colour where no fibre is.
    #[error(
        "pigment {name:?} is the absorption of a fibre behind a colour, and this model has no fibre; use another kind"
    )]
    PigmentNeedsFibre {
        /// The name.
        name: String,
    },
    /// Absorbers and their sum at once.
    #[error("`per_channel` names \"sigma_a\", which `pigments` make; leave one of the two out")]
    PigmentsAndAbsorption,
    /// An absorber that cannot be.
    #[error("pigment {name:?}: {problem}")]
    Pigment {
        /// The name.
        name: String,
        /// What is wrong with it.
        #[source]
        problem: PigmentError,
    },
    /// A colour that no absorption gives.
    #[error("pigment {name:?}: {problem}")]
    Colour {
        /// The name.
        name: String,
        /// Why.
        #[source]
        problem: InversionError,
    },
    /// A material that does not exist, or a wrong table.
    #[error("{what}: {problem}")]
    Material {
        /// Where the material stands.
        what: String,
        /// What is wrong with it.
        #[source]
        problem: MaterialError,
    },
}
