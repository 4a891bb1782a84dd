//! How a material's index depends on the wavelength.

use num_complex::Complex64;
use thiserror::Error;

/// Complex refractive index n + ik over wavelength.
#[derive(Debug, Clone, PartialEq)]
pub enum Dispersion {
    /// The same at every wavelength.
    Constant {
        /// n.
        index: f64,
        /// k, 0 for a clear material.
        extinction: f64,
    },
    /// n = a + b/λ² (Cauchy) with k = c e^{−λ/l}.
    Cauchy {
        /// a.
        a: f64,
        /// b, nm².
        b_nm2: f64,
        /// c, 0 for a clear material.
        extinction_c: f64,
        /// l, nm.
        extinction_length_nm: f64,
    },
    /// Linear interpolation between measured values.
    Table(IndexTable),
}

impl Dispersion {
    /// n + ik at a wavelength. Outside a table's range there is no value, and both parts are NaN: a caller that cannot
    /// rule it out asks [`Dispersion::check`] first.
    pub fn at(&self, wavelength_nm: f64) -> Complex64 {
        match self {
            Self::Constant { index, extinction } => Complex64::new(*index, *extinction),
            Self::Cauchy { a, b_nm2, extinction_c, extinction_length_nm } => {
                let n = a + b_nm2 / (wavelength_nm * wavelength_nm);
                let k = if *extinction_c > 0.0 {
                    extinction_c * (-wavelength_nm / extinction_length_nm).exp()
                } else {
                    0.0
                };
                Complex64::new(n, k)
            }
            Self::Table(table) => table.at(wavelength_nm),
        }
    }

    /// n and k at each of these wavelengths.
    ///
    /// # Errors
    /// [`MaterialError::BeyondTable`] where a table does not reach.
    pub fn spectrum(&self, wavelengths_nm: &[f64]) -> Result<(Vec<f64>, Vec<f64>), MaterialError> {
        self.check(wavelengths_nm)?;
        Ok(wavelengths_nm.iter().map(|&wavelength| self.at(wavelength)).map(|index| (index.re, index.im)).unzip())
    }

    /// Whether the material has a value at each of these wavelengths.
    ///
    /// # Errors
    /// [`MaterialError::BeyondTable`] for the first wavelength that a table does not reach.
    pub fn check(&self, wavelengths_nm: &[f64]) -> Result<(), MaterialError> {
        let Self::Table(table) = self else { return Ok(()) };
        let (from_nm, to_nm) = table.range_nm();
        match wavelengths_nm.iter().find(|&&wavelength| !(from_nm..=to_nm).contains(&wavelength)) {
            Some(&wavelength_nm) => Err(MaterialError::BeyondTable { wavelength_nm, from_nm, to_nm }),
            None => Ok(()),
        }
    }

    /// Whether the material absorbs at any wavelength.
    pub fn absorbs(&self) -> bool {
        match self {
            Self::Constant { extinction, .. } => *extinction > 0.0,
            Self::Cauchy { extinction_c, .. } => *extinction_c > 0.0,
            Self::Table(table) => table.rows.iter().any(|row| row[2] > 0.0),
        }
    }
}

/// A checked table of λ (nm), n, k: at least two rows, wavelengths rising, n > 0, k ≥ 0, all finite.
#[derive(Debug, Clone, PartialEq)]
pub struct IndexTable {
    rows: Vec<[f64; 3]>,
}

impl IndexTable {
    /// Checks the rows, each λ in nm, n, k.
    ///
    /// # Errors
    /// [`MaterialError`] names the first row that is wrong.
    pub fn new(rows: Vec<[f64; 3]>) -> Result<Self, MaterialError> {
        if rows.len() < 2 {
            return Err(MaterialError::ShortTable { rows: rows.len() });
        }
        for (i, &[wavelength_nm, n, k]) in rows.iter().enumerate() {
            let fine = wavelength_nm.is_finite()
                && wavelength_nm > 0.0
                && (1e-3..=100.0).contains(&n)
                && (0.0..=100.0).contains(&k);
            if !fine {
                return Err(MaterialError::BadRow { row: i + 1, wavelength_nm, n, k });
            }
            if i > 0 && wavelength_nm <= rows[i - 1][0] {
                return Err(MaterialError::Unsorted { row: i + 1, wavelength_nm, before_nm: rows[i - 1][0] });
            }
        }
        Ok(Self { rows })
    }

    /// First and last wavelength, nm.
    pub fn range_nm(&self) -> (f64, f64) {
        (self.rows[0][0], self.rows[self.rows.len() - 1][0])
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    fn at(&self, wavelength_nm: f64) -> Complex64 {
        let (from, to) = self.range_nm();
        if !(from..=to).contains(&wavelength_nm) {
            return Complex64::new(f64::NAN, f64::NAN);
        }
        let upper = self.rows.partition_point(|row| row[0] < wavelength_nm).max(1);
        let ([left, n0, k0], [right, n1, k1]) = (self.rows[upper - 1], self.rows[upper]);
        let share = (wavelength_nm - left) / (right - left);
        Complex64::new(n0 + share * (n1 - n0), k0 + share * (k1 - k0))
    }
}

/// What can be wrong with a material.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MaterialError {
    /// No material of this name is known.
    #[error(
        "there is no material {found:?}; known are {known}{suggestion}, or describe your own with `name` and `index`, `cauchy_a` and `cauchy_b_nm2`, or `table`"
    )]
    Unknown {
        /// Name as it was given.
        found: String,
        /// The known names.
        known: String,
        /// `; did you mean …?` or nothing.
        suggestion: String,
    },
    /// A table of fewer than two rows.
    #[error("a table of indices needs at least two rows of [wavelength in nm, n, k], found {rows}")]
    ShortTable {
        /// Number of rows found.
        rows: usize,
    },
    /// A row with senseless numbers.
    #[error(
        "row {row} of the table of indices is [{wavelength_nm}, {n}, {k}]; expected a positive wavelength in nm, n from 0.001 to 100 and k from 0 to 100"
    )]
    BadRow {
        /// Row, counted from 1.
        row: usize,
        /// Wavelength found.
        wavelength_nm: f64,
        /// n found.
        n: f64,
        /// k found.
        k: f64,
    },
    /// Wavelengths that do not rise.
    #[error(
        "row {row} of the table of indices has wavelength {wavelength_nm} nm after {before_nm} nm; sort the rows by rising wavelength, each once"
    )]
    Unsorted {
        /// Row, counted from 1.
        row: usize,
        /// Wavelength found.
        wavelength_nm: f64,
        /// Wavelength of the row before.
        before_nm: f64,
    },
    /// A wavelength that the table does not reach.
    #[error(
        "the table of indices reaches from {from_nm} to {to_nm} nm and says nothing of {wavelength_nm} nm; extend it or leave these wavelengths out"
    )]
    BeyondTable {
        /// Wavelength asked for.
        wavelength_nm: f64,
        /// First wavelength of the table.
        from_nm: f64,
        /// Last wavelength of the table.
        to_nm: f64,
    },
}
