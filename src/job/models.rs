//! The models that a job can name: how each is made, what it is, and where it comes from.

use std::fmt;

use super::JobError;
use super::file::ModelFile;
use crate::bsdf::cylinder::{CylinderModel, FilmedCylinderModel, NearFieldCylinderModel};
use crate::bsdf::spongy_barb::SpongyBarbModel;
use crate::bsdf::{
    CoatedBase, Feather, FilmAtUnknownAngle, GranierHeidrich, IridescentPlastic, Lambertian, MicrofacetInterface,
    Model, Oriented, PigmentedBase, RoughPlastic,
};
use crate::measure::{PeakModel, ThinFilmLaw};
use crate::nearest::suggestion;
use crate::optics::Reference;
use crate::parameter::Parameter;
use crate::pigment::PigmentDesign;

impl ModelFile {
    /// The scattering model at these wavelengths, nm.
    pub(crate) fn scattering(&self, wavelengths_nm: &[f64]) -> Result<Box<dyn Model>, JobError> {
        Ok(match self {
            Self::CoatedBase(design) => Box::new(CoatedBase::new(design, wavelengths_nm)?),
            Self::Microfacet(design) => Box::new(MicrofacetInterface::new(design, wavelengths_nm)?),
            Self::RoughPlastic(design) => Box::new(RoughPlastic::new(design, wavelengths_nm)?),
            Self::IridescentPlastic(design) => Box::new(IridescentPlastic::new(design, wavelengths_nm)?),
            Self::GranierHeidrich(design) => Box::new(GranierHeidrich::new(design, wavelengths_nm)?),
            Self::Lambertian(design) => Box::new(Lambertian::new(design, wavelengths_nm)?),
            Self::Cylinder(design) => oriented(CylinderModel::new(design, wavelengths_nm)?),
            Self::NearFieldCylinder(design) => oriented(NearFieldCylinderModel::new(design, wavelengths_nm)?),
            Self::FilmedCylinder(design) => oriented(FilmedCylinderModel::new(design, wavelengths_nm)?),
            Self::SpongyBarb(design) => oriented(SpongyBarbModel::new(design, wavelengths_nm)?),
            Self::Feather(design) => oriented(Feather::new(design, wavelengths_nm)?),
            Self::PigmentedBase(design) => Box::new(PigmentedBase::new(design, wavelengths_nm)?),
            Self::FilmAtUnknownAngle(design) => Box::new(FilmAtUnknownAngle::new(design, wavelengths_nm)?),
            Self::ThinFilmLaw(_) => {
                let problem = "`thin-film-law` predicts peak wavelengths, not spectra; use `coated-base`";
                return Err(JobError::key("model.kind", problem));
            }
        })
    }

    /// Whether its readings depend on where light and viewer stand: a table that does not say it cannot be fitted by it.
    pub(super) fn needs_geometry(&self) -> bool {
        !matches!(self, Self::Lambertian(_) | Self::PigmentedBase(_) | Self::FilmAtUnknownAngle(_))
    }

    /// Names of its pigments that are sums of bands, which describe a spectrum and name no substance.
    pub(super) fn band_names(&self) -> Vec<&str> {
        let Self::PigmentedBase(design) = self else { return Vec::new() };
        let bands = design.pigments.iter().filter(|pigment| matches!(pigment, PigmentDesign::Bands { .. }));
        bands.map(PigmentDesign::name).collect()
    }

    /// Its entry in the list of models.
    pub(super) fn card(&self) -> &'static ModelCard {
        match self {
            Self::CoatedBase(_) => &COATED_BASE,
            Self::Microfacet(_) => &MICROFACET,
            Self::RoughPlastic(_) => &ROUGH_PLASTIC,
            Self::IridescentPlastic(_) => &IRIDESCENT_PLASTIC,
            Self::GranierHeidrich(_) => &GRANIER_HEIDRICH,
            Self::Lambertian(_) => &LAMBERTIAN,
            Self::Cylinder(_) => &CYLINDER,
            Self::NearFieldCylinder(_) => &NEAR_FIELD_CYLINDER,
            Self::FilmedCylinder(_) => &FILMED_CYLINDER,
            Self::SpongyBarb(_) => &SPONGY_BARB,
            Self::Feather(_) => &FEATHER,
            Self::PigmentedBase(_) => &PIGMENTED_BASE,
            Self::FilmAtUnknownAngle(_) => &FILM_AT_UNKNOWN_ANGLE,
            Self::ThinFilmLaw(_) => &THIN_FILM_LAW,
        }
    }
}

/// A model with a tangent: how it lies in the table's frame is one more parameter.
fn oriented(model: impl Model + 'static) -> Box<dyn Model> {
    Box::new(Oriented::new(Box::new(model)))
}

/// What is said of a model wherever it is named.
#[derive(Debug)]
pub(super) struct ModelCard {
    /// Name in a job: `model.kind`.
    pub(super) kind: &'static str,
    /// What it is, complete sentences for a methods section.
    pub(super) text: &'static str,
    /// What it reads, and what to know before using it.
    usage: &'static str,
    /// A `[model]` section to start from.
    example: &'static str,
    /// Key and full citation of each work.
    works: &'static [(&'static str, &'static str)],
}

impl ModelCard {
    /// Works to cite.
    pub(super) fn references(&self) -> Vec<Reference> {
        self.works.iter().map(|(key, citation)| Reference::new(key, citation)).collect()
    }
}

const WALTER: (&str, &str) = (
    "Walter 2007",
    "Walter, B., Marschner, S. R., Li, H. and Torrance, K. E. (2007). Microfacet models for refraction through rough \
     surfaces. Eurographics Symposium on Rendering, 195–206.",
);

/// Every model, in the order in which `barbule models` lists them.
const CARDS: [&ModelCard; 14] = [
    &COATED_BASE,
    &MICROFACET,
    &ROUGH_PLASTIC,
    &IRIDESCENT_PLASTIC,
    &GRANIER_HEIDRICH,
    &LAMBERTIAN,
    &CYLINDER,
    &NEAR_FIELD_CYLINDER,
    &FILMED_CYLINDER,
    &SPONGY_BARB,
    &FEATHER,
    &PIGMENTED_BASE,
    &FILM_AT_UNKNOWN_ANGLE,
    &THIN_FILM_LAW,
];

const COATED_BASE: ModelCard = ModelCard {
    kind: "coated-base",
    text: "A film, a stack of layers or a plain interface inside a rough surface (Beckmann), over a diffuse base that receives \
           what the layers let through.",
    usage: "Reads spectra at any four angles, and peak wavelengths (then without roughness and base, which do not move a \
            peak). Its parameters are named after the layers and materials of the job. A clear substrate holds the base, \
            `diffuse_albedo`; one that absorbs, as here, has a share of light that scatters beside the layers instead, \
            `diffuse_share`.",
    example: "kind = \"coated-base\"\n\
              layers = [{ name = \"cortex\", material = \"keratin\", thickness_nm = 330.0 }]\n\
              substrate = \"bird_melanin\"",
    works: &[],
};

const MICROFACET: ModelCard = ModelCard {
    kind: "microfacet",
    text: "A rough dielectric interface (Walter et al. 2007), which reflects and transmits.",
    usage: "Reads spectra at any four angles, the viewer on either side.",
    example: "kind = \"microfacet\"\ndistribution = \"beckmann\"",
    works: &[WALTER],
};

const ROUGH_PLASTIC: ModelCard = ModelCard {
    kind: "rough-plastic",
    text: "A rough dielectric coat (Beckmann; Walter et al. 2007) over a diffuse base, with the light that the coat turns \
           back summed over all bounces.",
    usage: "Reads spectra at any four angles. `per_channel` gives the parameters that it names one value a wavelength.",
    example: "kind = \"rough-plastic\"",
    works: &[WALTER],
};

const IRIDESCENT_PLASTIC: ModelCard = ModelCard {
    kind: "iridescent-plastic",
    text: "A rough plastic with a phase term between its specular and its diffuse part in each channel. As published it \
           may send out more than it receives.",
    usage: "Reads spectra at any four angles. `coated-base` over a black base never sends out more than it receives.",
    example: "kind = \"iridescent-plastic\"",
    works: &[WALTER],
};

const GRANIER_HEIDRICH: ModelCard = ModelCard {
    kind: "granier-heidrich",
    text: "A diffuse base under a thin clear film with Phong lobes and Schlick's Fresnel factor (Granier and Heidrich \
           2003). As published it is neither reciprocal nor energy-conserving.",
    usage: "Reads spectra at any four angles.",
    example: "kind = \"granier-heidrich\"",
    works: &[(
        "Granier & Heidrich 2003",
        "Granier, X. and Heidrich, W. (2003). A simple layered RGB BRDF model. Graphical Models 65, 171–184.",
    )],
};

const LAMBERTIAN: ModelCard = ModelCard {
    kind: "lambertian",
    text: "A Lambertian surface, equally bright from everywhere.",
    usage: "Reads spectra at any four angles; the simplest control.",
    example: "kind = \"lambertian\"",
    works: &[],
};

const DEON: (&str, &str) = (
    "d'Eon 2011",
    "d'Eon, E., Francois, G., Hill, M., Letteri, J. and Aubry, J.-M. (2011). An energy-conserving hair reflectance \
     model. Computer Graphics Forum 30, 1181–1187.",
);

const CHIANG: (&str, &str) = (
    "Chiang 2016",
    "Chiang, M. J.-Y., Bitterli, B., Tappan, C. and Burley, B. (2016). A practical and controllable hair and fur model \
     for production path tracing. Computer Graphics Forum 35, 275–283.",
);

const CYLINDER: ModelCard = ModelCard {
    kind: "cylinder",
    text: "A dielectric fibre along the tangent, averaged over its width (d'Eon et al. 2011; Chiang et al. 2016).",
    usage: "Reads spectra at any four angles; `tangent_deg` says how the fibre lies. `per_channel` gives the parameters that it \
            names one value a wavelength.",
    example: "kind = \"cylinder\"",
    works: &[DEON, CHIANG],
};

const NEAR_FIELD_CYLINDER: ModelCard = ModelCard {
    kind: "near-field-cylinder",
    text: "A dielectric fibre along the tangent, seen so closely that the position across it is known (d'Eon et al. 2011; \
           Chiang et al. 2016).",
    usage: "Reads spectra at any four angles; `tangent_deg` says how the fibre lies, `h` where across it. `cylinder` is its \
            mean over `h`.",
    example: "kind = \"near-field-cylinder\"",
    works: &[DEON, CHIANG],
};

const FILMED_CYLINDER: ModelCard = ModelCard {
    kind: "filmed-cylinder",
    text: "A dielectric fibre along the tangent (d'Eon et al. 2011; Chiang et al. 2016) with a film or a stack of layers on \
           its surface: an iridescent barbule.",
    usage: "Reads spectra at any four angles; `tangent_deg` says how the fibre lies. Its parameters are named after the \
            layers of the job; `eta` is the index below them.",
    example: "kind = \"filmed-cylinder\"\n\
              layers = [\n    \
                  { name = \"cortex\", material = \"keratin\", thickness_nm = 330.0 },\n    \
                  { name = \"melanin\", material = \"bird_melanin\", thickness_nm = 120.0 },\n\
              ]",
    works: &[DEON, CHIANG],
};

const SPONGY_BARB: ModelCard = ModelCard {
    kind: "spongy-barb",
    text: "A dielectric fibre along the tangent (d'Eon et al. 2011; Chiang et al. 2016) with a sponge inside that scatters \
           one band of wavelengths.",
    usage: "Reads spectra at any four angles; `tangent_deg` says how the fibre lies.",
    example: "kind = \"spongy-barb\"",
    works: &[DEON, CHIANG],
};

const FEATHER: ModelCard = ModelCard {
    kind: "feather",
    text: "The vane of a feather (Romeo Arroyo 2021): barbs along the tangent and barbules at an angle to both sides of \
           them, each weighted by the share of the area that it covers. Barbs and barbules are dielectric fibres (d'Eon et \
           al. 2011; Chiang et al. 2016) or, as the job says, spongy barbs and barbules or lamellae with layers on them.",
    usage: "Reads spectra at any four angles; `tangent_deg` says how the barbs lie. `species` takes the barbs' share from \
            a table of 46 birds (Pap et al. 2015). `per_channel` of barb or barbule gives the parameters that it names one \
            value a wavelength.",
    example: "kind = \"feather\"\n\
              species = \"Columba livia\"\n\
              barb = { kind = \"cylinder\" }\n\
              barbule = { kind = \"cylinder\" }",
    works: &[
        (
            "Romeo Arroyo 2021",
            "Romeo Arroyo, Á. (2021). Modelado basado en física de la apariencia de plumas (physically based modeling of \
             feathers). Bachelor's thesis, Universidad de Zaragoza.",
        ),
        (
            "Pap 2015",
            "Pap, P. L., Osváth, G., Sándor, K., Vincze, O., Bărbos, L., Marton, A., Nudds, R. L. and Vágási, C. I. \
             (2015). Interspecific variation in the structural properties of flight feathers in birds indicates \
             adaptation to flight requirements and habitat. Functional Ecology 29, 746–757.",
        ),
        DEON,
        CHIANG,
    ],
};

const DONNER: (&str, &str) = (
    "Donner & Jensen 2006",
    "Donner, C. and Jensen, H. W. (2006). A spectral BSSRDF for shading human skin. Eurographics Symposium on Rendering, \
     409–417.",
);

const PIGMENTED_BASE: ModelCard = ModelCard {
    kind: "pigmented-base",
    text: "A layer that scatters with a power of the wavelength and absorbs by its pigments, over black (Kubelka and Munk \
           1931, Kubelka 1948), under a surface that sends back a constant share.",
    usage: "Reads spectra at any angles, or at none: it is Lambertian. Pigments are `eumelanin`, `pheomelanin`, `carotenoid`, \
            `bands` (a list of peaks and widths) and `table` (a file). `sponge = true` adds a band of wavelengths that is \
            scattered more, for feathers that are blue or green without iridescence.",
    example: "kind = \"pigmented-base\"\n\
              pigments = [\n    \
                  { kind = \"eumelanin\" },\n    \
                  { kind = \"carotenoid\" },\n    \
                  { kind = \"bands\", name = \"violet\", bands = [{ peak_nm = 390, width_nm = 30 }] },\n\
              ]",
    works: &[
        (
            "Kubelka & Munk 1931",
            "Kubelka, P. and Munk, F. (1931). Ein Beitrag zur Optik der Farbanstriche. Zeitschrift für technische Physik 12, \
             593–601.",
        ),
        (
            "Kubelka 1948",
            "Kubelka, P. (1948). New contributions to the optics of intensely light-scattering materials. Part I. Journal of \
             the Optical Society of America 38, 448–457.",
        ),
        DONNER,
    ],
};

const FILM_AT_UNKNOWN_ANGLE: ModelCard = ModelCard {
    kind: "film-at-unknown-angle",
    text: "One film on a substrate, seen at an angle that was not recorded: what is fitted is its optical path, index × \
           thickness × cosine of the angle inside it (Born & Wolf 1999).",
    usage: "Reads spectra at any angles, or at none; free the instrument's gain and offset, which stand for what the angle does \
            to the level. Paths a quarter of a wavelength apart are twins, and all that the spectra allow are listed.",
    example: "kind = \"film-at-unknown-angle\"\nfilm = \"keratin\"\nsubstrate = \"bird_melanin\"",
    works: &[BORN],
};

const BORN: (&str, &str) = (
    "Born & Wolf 1999",
    "Born, M. and Wolf, E. (1999). Principles of Optics, 7th edition, section 7.6. Cambridge University Press.",
);

const THIN_FILM_LAW: ModelCard = ModelCard {
    kind: "thin-film-law",
    text: "The closed law of a single film's peaks, m λ = 2 d √(n² − sin²θ).",
    usage: "Reads peak wavelengths only.",
    example: "kind = \"thin-film-law\"",
    works: &[BORN],
};

/// A model as `barbule models` lists it.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelEntry {
    /// Name in a job: `model.kind`.
    pub kind: &'static str,
    /// What it is and what it reads.
    pub text: String,
    /// A `[model]` section to start from.
    pub example: &'static str,
    /// Parameters that the example declares.
    pub parameters: Vec<Parameter>,
}

/// Wavelength for which a listing declares its parameters; only scan steps hang on it.
const LISTING_NM: f64 = 500.0;

/// The cards of all models, or of the one named.
fn cards(kind: Option<&str>) -> Result<Vec<&'static ModelCard>, JobError> {
    let Some(kind) = kind else { return Ok(CARDS.to_vec()) };
    CARDS.iter().find(|card| card.kind == kind).map(|card| vec![*card]).ok_or_else(|| {
        let known: Vec<&str> = CARDS.iter().map(|card| card.kind).collect();
        let meant = suggestion(kind, known.iter().copied());
        JobError::Option { option: "MODEL", problem: format!("found `{kind}`; known are {}{meant}", known.join(", ")) }
    })
}

fn example(card: &ModelCard) -> Result<ModelFile, JobError> {
    toml::from_str(card.example).map_err(|error| JobError::key(format!("example of {}", card.kind), error.to_string()))
}

/// The example of every model, or of the one named.
pub(super) fn examples(kind: Option<&str>) -> Result<Vec<(&'static str, ModelFile)>, JobError> {
    cards(kind)?.into_iter().map(|card| Ok((card.kind, example(card)?))).collect()
}

/// Every model that a job can name, or the one named.
pub fn models(kind: Option<&str>) -> Result<Vec<ModelEntry>, JobError> {
    let entry = |card: &'static ModelCard| {
        let model = example(card)?;
        let parameters = match &model {
            ModelFile::ThinFilmLaw(design) => ThinFilmLaw::new(design.clone(), LISTING_NM).parameters().to_vec(),
            _ => model.scattering(&[LISTING_NM])?.parameters().to_vec(),
        };
        Ok(ModelEntry {
            kind: card.kind,
            text: format!("{} {}", card.text, card.usage),
            example: card.example,
            parameters,
        })
    };
    cards(kind)?.into_iter().map(entry).collect()
}

impl fmt::Display for ModelEntry {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        writeln!(formatter, "{}\n", self.kind)?;
        for line in wrapped(&self.text, 100) {
            writeln!(formatter, "  {line}")?;
        }
        writeln!(formatter, "\n  Example:\n")?;
        for line in self.example.lines() {
            writeln!(formatter, "    {line}")?;
        }
        writeln!(formatter, "\n  Its parameters (default, range, unit):\n")?;
        for parameter in &self.parameters {
            let range =
                format!("{} [{} to {}] {}", parameter.default, parameter.lower, parameter.upper, parameter.unit);
            writeln!(formatter, "    {:<28} {:<28} {}", parameter.name, range.trim_end(), parameter.text)?;
        }
        Ok(())
    }
}

/// Lines of at most so many characters, broken at blanks.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        if lines[last].is_empty() {
            word.clone_into(&mut lines[last]);
        } else if lines[last].chars().count() + 1 + word.chars().count() <= width {
            lines[last].push(' ');
            lines[last].push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}
