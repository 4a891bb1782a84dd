//! What a column's name says of what is in it.

/// What a column seems to hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    ThetaI,
    PhiI,
    ThetaO,
    PhiO,
    Wavelength,
    Peak,
    Order,
    Value,
    Sigma,
    /// Names the spectrum or the row.
    Id,
    /// Names the individual.
    Specimen,
    /// Sets specimens apart: species, patch.
    Group,
    /// Marks rows to be kept.
    Keep,
    Unknown,
}

/// The role that the name suggests. The first that fits: `peak_wavelength` is a peak, `sigma_reflectance` a σ.
pub(super) fn role(name: &str) -> Role {
    let name =
        name.to_lowercase().replace('θ', "theta").replace('φ', "phi").replace('λ', "lambda").replace('σ', "sigma");
    let has = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
    let words: Vec<&str> = name.split(|letter: char| !letter.is_alphanumeric() && letter != '%').collect();
    let word = |wanted: &[&str]| words.iter().any(|word| wanted.contains(word));

    let azimuth = has(&["phi", "azim"]);
    let light = has(&["incid", "light", "illum", "source"])
        || has(&["theta_i", "thetai", "phi_i", "phii"])
        || word(&["i", "ti", "pi"]);
    let viewer = has(&["view", "detect", "observ", "collect", "emerg", "sensor"])
        || has(&["theta_o", "thetao", "theta_r", "theta_v", "phi_o", "phio", "phi_r", "phi_v"])
        || word(&["o", "to", "po"]);
    let angle = azimuth || has(&["theta", "angle", "inclin"]) || word(&["deg", "degrees", "rad"]);

    if has(&["sigma", "stdev", "std_", "uncert", "error"]) || word(&["sd", "se", "std", "err"]) {
        Role::Sigma
    } else if word(&["individual", "specimen", "bird", "animal", "skin"]) {
        Role::Specimen
    } else if word(&["species", "taxon", "patch", "part", "region", "site"]) {
        Role::Group
    } else if word(&["id", "name", "sample", "label"]) || name.ends_with("_id") {
        Role::Id
    } else if has(&["keep", "kept", "valid", "include"]) || word(&["use", "used"]) {
        Role::Keep
    } else if has(&["peak", "lambda_max", "lambdamax", "hue"]) || word(&["lmax"]) {
        Role::Peak
    } else if word(&["order"]) {
        Role::Order
    } else if has(&["reflect", "brdf", "bsdf", "btdf", "radiance"]) || word(&["value", "r", "refl", "percent", "%"]) {
        Role::Value
    } else if viewer && !light {
        if azimuth { Role::PhiO } else { Role::ThetaO }
    } else if angle || light {
        if azimuth { Role::PhiI } else { Role::ThetaI }
    } else if has(&["wavelength", "lambda"]) || word(&["wl", "nm", "wave", "um"]) {
        Role::Wavelength
    } else {
        Role::Unknown
    }
}

/// An angle in a column's name, as `R_15deg`, `45°` or, in R, `X15`; not the running number of `bird-15`.
pub(super) fn angle_in(name: &str) -> Option<f64> {
    let lower = name.to_lowercase();
    let marked = lower.contains("deg") || lower.contains('°') || lower.contains("theta") || lower.contains('θ');
    let digits: String =
        lower.chars().skip_while(|c| !c.is_ascii_digit()).take_while(|c| c.is_ascii_digit() || *c == '.').collect();
    let bare = lower.strip_prefix('x').unwrap_or(&lower) == digits;
    let angle: f64 = digits.parse().ok()?;
    ((marked || bare) && (0.0..90.0).contains(&angle)).then_some(angle)
}
