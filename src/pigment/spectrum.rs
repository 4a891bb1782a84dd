//! The shape of an absorber's spectrum.

/// Why a pigment cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PigmentError {
    /// A negative amount.
    #[error("the amount of a pigment must be a finite number, 0 or more, but {0} was given")]
    Amount(f64),
    /// A wavelength that is none.
    #[error("a wavelength must be a positive number in nm, but {0} was given")]
    Wavelength(f64),
    /// A band without width, or upside down.
    #[error(
        "an absorption band needs a positive peak and width and a height of 0 or more, but peak {peak}, width {width} and height {height} were given"
    )]
    Band {
        /// Position of the peak.
        peak: f64,
        /// Standard deviation.
        width: f64,
        /// Height.
        height: f64,
    },
    /// A sum of nothing.
    #[error("the list of bands is empty; give at least one, as `{{ peak_nm = 450, width_nm = 30 }}`")]
    NoBands,
    /// A table that is no function.
    #[error(
        "an absorption table needs at least two wavelengths in nm, positive and ascending, each with a finite absorption, but row {row} holds {wavelength_nm} nm and {absorption}"
    )]
    Table {
        /// Number of the row, from 1; 0 if there are too few.
        row: usize,
        /// Its wavelength.
        wavelength_nm: f64,
        /// Its absorption.
        absorption: f64,
    },
    /// A table of a pigment that would send out light.
    #[error(
        "the absorption is {absorption} at {wavelength_nm} nm; expected 0 or more (noise about 0 has to be set to 0, or cut away)"
    )]
    Negative {
        /// Where.
        wavelength_nm: f64,
        /// What was found there.
        absorption: f64,
    },
    /// A table asked beyond its ends.
    #[error(
        "the absorption table covers {first_nm} to {last_nm} nm, but {wavelength_nm} nm was asked for; choose channels inside it or extend the table"
    )]
    OutsideTable {
        /// What was asked.
        wavelength_nm: f64,
        /// Where the table begins.
        first_nm: f64,
        /// Where it ends.
        last_nm: f64,
    },
}

/// The axis along which a band is symmetric.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// 1/cm, proportional to energy: electronic bands are broadened evenly along it.
    Wavenumber,
    /// nm, as bands are often quoted.
    Wavelength,
}

impl Scale {
    /// Where a wavelength in nm stands on the scale.
    pub fn position(self, wavelength_nm: f64) -> f64 {
        match self {
            Self::Wavenumber => 1e7 / wavelength_nm,
            Self::Wavelength => wavelength_nm,
        }
    }
}

/// A Gaussian band: height · exp(−(x − peak)²/(2 width²)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Centre, in the scale's unit.
    pub peak: f64,
    /// Standard deviation, in the scale's unit; the full width at half maximum is 2.355 times as much.
    pub width: f64,
    /// Absorption at the peak.
    pub height: f64,
}

/// Absorption over wavelength, read between its rows on straight lines.
#[derive(Debug, Clone, PartialEq)]
pub struct AbsorptionTable {
    rows: Vec<(f64, f64)>,
}

impl AbsorptionTable {
    /// From rows of wavelength in nm, ascending, and absorption. Negative values are kept: a measured
    /// baseline scatters about 0, and where a model needs σₐ ≥ 0 it says so.
    ///
    /// # Errors
    /// If there are fewer than two rows, or one that is out of order or no number.
    pub fn new(rows: Vec<(f64, f64)>) -> Result<Self, PigmentError> {
        if rows.len() < 2 {
            return Err(PigmentError::Table { row: 0, wavelength_nm: f64::NAN, absorption: f64::NAN });
        }
        let mut previous = 0.0;
        for (index, &(wavelength_nm, absorption)) in rows.iter().enumerate() {
            if !(wavelength_nm > previous && wavelength_nm.is_finite() && absorption.is_finite()) {
                return Err(PigmentError::Table { row: index + 1, wavelength_nm, absorption });
            }
            previous = wavelength_nm;
        }
        Ok(Self { rows })
    }

    fn at(&self, wavelength_nm: f64) -> Result<f64, PigmentError> {
        let (first_nm, last_nm) = (self.rows[0].0, self.rows[self.rows.len() - 1].0);
        if !(wavelength_nm >= first_nm && wavelength_nm <= last_nm) {
            return Err(PigmentError::OutsideTable { wavelength_nm, first_nm, last_nm });
        }
        let after = self.rows.partition_point(|row| row.0 < wavelength_nm).max(1);
        let ((x0, y0), (x1, y1)) = (self.rows[after - 1], self.rows[after]);
        Ok(y0 + (y1 - y0) * (wavelength_nm - x0) / (x1 - x0))
    }
}

/// Absorption of one unit of a pigment.
#[derive(Debug, Clone, PartialEq)]
pub enum AbsorptionSpectrum {
    /// (λ/500 nm)^−exponent.
    PowerLaw {
        /// Positive for a pigment that absorbs blue more than red.
        exponent: f64,
    },
    /// A sum of bands, all moved by `shift` towards longer wavelengths: a pigment in a feather absorbs at other places than
    /// in a solvent.
    Bands {
        /// Unit of peaks, widths and shift.
        scale: Scale,
        /// The bands.
        bands: Vec<Band>,
        /// How far the bands are moved to the red, in the scale's unit.
        shift: f64,
    },
    /// Any measured spectrum.
    Table(AbsorptionTable),
}

impl AbsorptionSpectrum {
    /// Eumelanin as a power law, λ^−3.33 (Donner and Jensen 2006, *A spectral BSSRDF for shading human skin*, after measurements
    /// collected by S. Jacques). Their absolute value, 6.6e10 λ^−3.33 per mm of pure pigment, is 67.9/mm at 500 nm.
    ///
    /// How well it is known: the shape to some 0.2 in the exponent (Jacques 1998 gives 3.48 for the melanosomes of skin, from
    /// thresholds of laser damage), the absolute value to a factor of ten, by his own words. It is of mammals; no
    /// table for feathers was found. Visible and near infrared, 400 to 1000 nm.
    pub fn eumelanin() -> Self {
        Self::PowerLaw { exponent: 3.33 }
    }

    /// Pheomelanin as a power law, λ^−4.75 (the same source; absolute 2.9e14 λ^−4.75 per mm, 43.9/mm at 500 nm). Known less
    /// well than eumelanin. 400 to 700 nm.
    pub fn pheomelanin() -> Self {
        Self::PowerLaw { exponent: 4.75 }
    }

    /// A carotenoid with the three fingers of β-carotene, moved to the red by `shift_per_cm`.
    ///
    /// Four bands with the spacing of a C=C stretch, 1408/cm, fitted for this file to the molar extinction of β-carotene in
    /// hexane (PhotochemCAD): rms difference 1.1 % of the peak from 390 to 540 nm; the ultraviolet bands are left out. Peak
    /// 1 near 451 nm. In feathers the bands are broader and lie further to the red, by an amount that is to be fitted
    /// (1000/cm is 21 nm there).
    pub fn carotenoid(shift_per_cm: f64) -> Self {
        let band = |k: f64, width: f64, height: f64| Band { peak: 20_815.0 + 1_408.0 * k, width, height };
        Self::Bands {
            scale: Scale::Wavenumber,
            bands: vec![
                band(0.0, 555.0, 0.715),
                band(1.0, 612.0, 0.927),
                band(2.0, 612.0, 0.647),
                band(3.0, 612.0, 0.390),
            ],
            shift: shift_per_cm,
        }
    }

    /// Absorption of one unit at each of these wavelengths.
    ///
    /// # Errors
    /// If a wavelength is no positive number or outside the table, or a band has no width.
    pub fn sample(&self, wavelengths_nm: &[f64]) -> Result<Vec<f64>, PigmentError> {
        wavelengths_nm.iter().map(|&wavelength| self.at(wavelength)).collect()
    }

    fn at(&self, wavelength_nm: f64) -> Result<f64, PigmentError> {
        if !(wavelength_nm > 0.0 && wavelength_nm.is_finite()) {
            return Err(PigmentError::Wavelength(wavelength_nm));
        }
        match self {
            Self::PowerLaw { exponent } => Ok((wavelength_nm / 500.0).powf(-exponent)),
            Self::Bands { scale, bands, shift } => {
                // To the red is to smaller wavenumbers, and to longer wavelengths.
                let unmoved = match scale {
                    Scale::Wavenumber => scale.position(wavelength_nm) + shift,
                    Scale::Wavelength => scale.position(wavelength_nm) - shift,
                };
                bands.iter().map(|band| band.at(unmoved)).sum()
            }
            Self::Table(table) => table.at(wavelength_nm),
        }
    }
}

impl Band {
    /// Absorption at a position in the scale's unit.
    ///
    /// # Errors
    /// [`PigmentError::Band`] if the band has no peak, no width or a negative height.
    pub fn at(&self, position: f64) -> Result<f64, PigmentError> {
        let Self { peak, width, height } = *self;
        if !(peak > 0.0 && width > 0.0 && height >= 0.0 && peak.is_finite() && width.is_finite() && height.is_finite())
        {
            return Err(PigmentError::Band { peak, width, height });
        }
        let x = (position - peak) / width;
        Ok(height * (-0.5 * x * x).exp())
    }
}
