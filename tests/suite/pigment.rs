//! Absorbers and colour inversion against published numbers, an independent program, and the model's own albedo.

use barbule::bsdf::cylinder::{absorption_for_albedo, mean_attenuation};
use barbule::pigment::{
    AbsorptionSpectrum, AbsorptionTable, Band, InversionError, PigmentError, Scale, absorption_from_concentrations,
    chiang_absorption,
};
use proptest::prelude::*;

/// The table has 12 digits.
fn assert_close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-11 * expected.abs().max(1e-3), "found {found}, expected {expected}");
}

#[test]
fn absorption_agrees_with_the_oracle() {
    let path = format!("{}/tests/oracles/hair_sigma.csv", env!("CARGO_MANIFEST_DIR"));
    let mut count = 0;
    for record in csv::Reader::from_path(path).unwrap().records() {
        let record = record.unwrap();
        let number = |column: usize| record[column].parse::<f64>().unwrap();
        if &record[0] == "reflectance" {
            assert_close(chiang_absorption(number(2), number(1)).unwrap(), number(5));
        } else {
            let found = absorption_from_concentrations(number(3), number(4)).unwrap();
            for (channel, found) in found.into_iter().enumerate() {
                assert_close(found, number(5 + channel));
            }
        }
        count += 1;
    }
    assert_eq!(count, 43);
}

/// Donner and Jensen 2006: the ratio of the melanins' absorptions at 400 and 700 nm is a power of 7/4.
#[test]
fn melanins_follow_their_power_laws() {
    let [blue, middle, red] =
        AbsorptionSpectrum::eumelanin().sample(&[400.0, 500.0, 700.0]).unwrap().try_into().unwrap();
    assert_close(middle, 1.0);
    assert_close(blue / red, 1.75_f64.powf(3.33));
    let pheomelanin = AbsorptionSpectrum::pheomelanin().sample(&[400.0, 700.0]).unwrap();
    assert_close(pheomelanin[0] / pheomelanin[1], 1.75_f64.powf(4.75));
}

/// β-carotene in hexane has its fingers at 451 and 478 nm (Britton et al. 1995); a shift moves them to the red.
#[test]
fn carotenoid_has_its_fingers() {
    let wavelengths: Vec<f64> = (3800..5600).map(|tenth| f64::from(tenth) * 0.1).collect();
    for (shift, expected) in [(0.0, [451.0, 478.0]), (1000.0, [472.3, 502.0])] {
        let values = AbsorptionSpectrum::carotenoid(shift).sample(&wavelengths).unwrap();
        let peaks: Vec<f64> = (1..values.len() - 1)
            .filter(|&k| values[k] > values[k - 1] && values[k] >= values[k + 1] && wavelengths[k] > 440.0)
            .map(|k| wavelengths[k])
            .collect();
        assert_eq!(peaks.len(), 2, "{peaks:?}");
        for (peak, expected) in peaks.iter().zip(expected) {
            assert!((peak - expected).abs() < 3.0, "{peaks:?} instead of {expected:?}");
        }
    }
}

#[test]
fn bands_and_tables_say_what_is_wrong() {
    let band = |width: f64| AbsorptionSpectrum::Bands {
        scale: Scale::Wavelength,
        bands: vec![Band { peak: 450.0, width, height: 2.0 }],
        shift: 10.0,
    };
    assert_close(band(20.0).sample(&[460.0]).unwrap()[0], 2.0);
    assert_close(band(20.0).sample(&[480.0]).unwrap()[0], 2.0 * (-0.5_f64).exp());
    assert!(matches!(band(0.0).sample(&[460.0]), Err(PigmentError::Band { .. })));
    assert!(matches!(band(20.0).sample(&[f64::NAN]), Err(PigmentError::Wavelength(_))));

    let table = AbsorptionTable::new(vec![(400.0, 1.0), (500.0, 3.0), (600.0, 0.0)]).unwrap();
    let spectrum = AbsorptionSpectrum::Table(table);
    let found = spectrum.sample(&[400.0, 450.0, 500.0, 600.0]).unwrap();
    for (found, expected) in found.into_iter().zip([1.0, 2.0, 3.0, 0.0]) {
        assert_close(found, expected);
    }
    let error = spectrum.sample(&[601.0]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the absorption table covers 400 to 600 nm, but 601 nm was asked for; choose channels inside it or extend the table"
    );
    for rows in [vec![(400.0, 1.0)], vec![(500.0, 1.0), (400.0, 1.0)], vec![(400.0, f64::NAN), (500.0, 1.0)]] {
        assert!(matches!(AbsorptionTable::new(rows), Err(PigmentError::Table { .. })));
    }
    assert!(matches!(absorption_from_concentrations(-1.0, 0.0), Err(PigmentError::Amount(_))));
}

#[test]
fn impossible_colours_are_refused() {
    assert_eq!(absorption_for_albedo(1.55, 0.0, 1.0), Ok(0.0));
    assert!(matches!(absorption_for_albedo(1.55, 0.0, 1.01), Err(InversionError::TooBright { .. })));
    assert!(matches!(absorption_for_albedo(1.55, 0.0, f64::NAN), Err(InversionError::TooBright { .. })));
    assert!(matches!(absorption_for_albedo(1.55, 0.0, 0.05), Err(InversionError::TooDark { .. })));
    assert!(matches!(chiang_absorption(0.0, 0.3), Err(InversionError::Colour(_))));
    assert!(matches!(chiang_absorption(1.2, 0.3), Err(InversionError::Colour(_))));
    assert!(matches!(chiang_absorption(0.5, f64::NAN), Err(InversionError::Roughness(_))));
}

proptest! {
    /// There and back. Absorption is read from the albedo with an error of 1e-12 over the slope of the albedo.
    #[test]
    fn inversion_returns_the_absorption(eta in 1.1..2.4_f64, sine in -0.95..0.95_f64, sigma_a in 0.0..3.0_f64) {
        let albedo = mean_attenuation(eta, sigma_a, sine).total();
        let found = absorption_for_albedo(eta, sine, albedo).unwrap();
        prop_assert!((mean_attenuation(eta, found, sine).total() - albedo).abs() < 1e-12);
        prop_assert!((found - sigma_a).abs() < 1e-7, "{found} instead of {sigma_a}");
    }
}
