//! Colour against the published ΔE2000 pairs, an independent colour program, and what must hold for any colour.
//!
//! `tests/oracles/color_*.csv` were made with colour-science 0.4.7; `color_ciede2000.csv` starts with the 34 pairs of
//! Sharma, Wu and Dalal (2005).

use std::collections::BTreeMap;
use std::path::Path;

use barbule::measure::colour::{Lab, LinearRgb, Swatch, Xyz, encode, spectral_locus};
use barbule::measure::{Geometry, Quantity};
use proptest::prelude::*;

/// The columns of an oracle table, by name, as text.
fn oracle(name: &str) -> BTreeMap<String, Vec<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracles").join(name);
    let mut reader = csv::Reader::from_path(path).unwrap();
    let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let mut columns: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for record in reader.records() {
        for (name, cell) in names.iter().zip(&record.unwrap()) {
            columns.entry(name.clone()).or_default().push(cell.to_owned());
        }
    }
    columns
}

fn numbers(column: &[String]) -> Vec<f64> {
    column.iter().map(|cell| cell.parse().unwrap()).collect()
}

fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "{what}: found {found}, expected {expected}, off by {off:e}, allowed {tolerance:e}");
}

/// XYZ of each oracle spectrum.
fn colours() -> Vec<(String, Xyz)> {
    let spectra = oracle("color_spectra.csv");

    let wavelengths_nm = numbers(&spectra["lambda_nm"]);
    oracle("color_xyz.csv")["spectrum"]
        .iter()
        .map(|name| (name.clone(), Xyz::of_reflectance(&wavelengths_nm, &numbers(&spectra[name])).unwrap()))
        .collect()
}

#[test]
fn tristimulus_values_and_linear_rgb_agree_with_colour_science() {
    let expected = oracle("color_xyz.csv");
    let column = |name: &str| numbers(&expected[name]);
    let [x, y, z] = ["sum5nm_X", "sum5nm_Y", "sum5nm_Z"].map(column);
    let [r, g, b] = ["linsrgb_derived_r", "linsrgb_derived_g", "linsrgb_derived_b"].map(column);
    for (index, (name, found)) in colours().iter().enumerate() {
        // The oracle has ten digits, of values up to about 1.
        for (found, expected) in [(found.x, x[index]), (found.y, y[index]), (found.z, z[index])] {
            assert_close(found, expected, 1e-9, name);
        }
        // Row sums of the matrix are below 6, so that ten digits of XYZ give nine of RGB.
        for (found, expected) in found.to_linear_rgb().0.into_iter().zip([r[index], g[index], b[index]]) {
            assert_close(found, expected, 6e-9, name);
        }
    }
}

#[test]
fn a_5_nm_sum_is_close_to_a_1_nm_sum() {
    let expected = oracle("color_xyz.csv");
    let [x, y, z] = ["sum1nm_X", "sum1nm_Y", "sum1nm_Z"].map(|name| numbers(&expected[name]));
    for (index, (name, found)) in colours().iter().enumerate() {
        // The worst of the oracle's spectra, a band 15 nm wide, differs by 3.5e-4.
        for (found, expected) in [(found.x, x[index]), (found.y, y[index]), (found.z, z[index])] {
            assert_close(found, expected, 4e-4, name);
        }
    }
}

#[test]
fn lab_agrees_with_colour_science() {
    let expected = oracle("color_lab.csv");
    let [l, a, b] = ["L", "a", "b"].map(|name| numbers(&expected[name]));
    for (index, (name, found)) in colours().iter().enumerate() {
        assert_eq!(*name, expected["spectrum"][index]);
        let found = found.to_lab();
        // The oracle has ten digits of numbers up to about 200.
        for (found, expected) in [(found.l, l[index]), (found.a, a[index]), (found.b, b[index])] {
            assert_close(found, expected, 2e-7, name);
        }
    }
}

#[test]
fn codes_of_a_screen_agree_with_colour_science() {
    let table = oracle("color_srgb_transfer.csv");
    for (linear, encoded) in numbers(&table["linear"]).into_iter().zip(numbers(&table["encoded"])) {
        // The oracle has ten digits.
        assert_close(encode(linear), encoded, 1e-10, &format!("{linear}"));
    }
}

#[test]
fn differences_agree_with_the_published_pairs() {
    let table = oracle("color_ciede2000.csv");
    let [l1, a1, b1, l2, a2, b2, other] =
        ["L1", "a1", "b1", "L2", "a2", "b2", "colour_science"].map(|name| numbers(&table[name]));
    let mut published_pairs = 0;
    for (index, published) in table["published"].iter().enumerate() {
        let first = Lab { l: l1[index], a: a1[index], b: b1[index] };
        let second = Lab { l: l2[index], a: a2[index], b: b2[index] };
        let found = first.delta_e_2000(second);
        let what = format!("pair {}", index + 1);
        if !published.is_empty() {
            published_pairs += 1;
            // Printed to four decimals.
            assert_close(found, published.parse().unwrap(), 5e-5, &what);
        }
        // The oracle has ten digits of numbers up to about 100.
        assert_close(found, other[index], 1e-7, &what);
    }
    assert_eq!((published_pairs, l1.len()), (34, 134));
}

#[test]
fn a_swatch_says_what_it_hides() {
    let all = [380.0, 780.0];
    let white = Swatch::new(&all, &[1.0, 1.0]).unwrap();
    assert_eq!((white.hex.as_str(), white.clipped, white.extended), ("#ffffff", false, false));
    assert_eq!(Swatch::new(&all, &[0.0, 0.0]).unwrap().hex, "#000000");
    // 0.5 encodes to 0.7354 = 187.5 of 255; the white of the 5 nm sums lies 4e-5 above and 3e-4 below the screen's.
    assert_eq!(Swatch::new(&all, &[0.5, 0.5]).unwrap().hex, "#bcbcbb");
    // A saturated band lies outside what a screen can show; twice the white standard is brighter than it can.
    let spectra = oracle("color_spectra.csv");
    let wavelengths_nm = numbers(&spectra["lambda_nm"]);
    assert!(Swatch::new(&wavelengths_nm, &numbers(&spectra["gauss_500_40"])).unwrap().clipped);
    assert!(Swatch::new(&all, &[2.0, 2.0]).unwrap().clipped);
    let short = Swatch::new(&[400.0, 700.0], &[1.0, 1.0]).unwrap();
    assert_eq!((short.hex.as_str(), short.extended), ("#ffffff", true));
    assert_eq!(Swatch::new(&[], &[]), None);
    assert_eq!(Swatch::new(&all, &[1.0]), None);
}

/// Chromaticities of spectral colours as the CIE prints them (CIE 15:2018, Table T.4), to four decimals, and of D65.
#[test]
fn chromaticities_are_the_published_ones() {
    let locus: Vec<(f64, [f64; 2])> = spectral_locus().collect();
    let of = |nm: f64| locus.iter().find(|(known, _)| (known - nm).abs() < 0.5).unwrap().1;
    for (nm, x, y) in
        [(450.0, 0.1566, 0.0177), (520.0, 0.0743, 0.8338), (580.0, 0.5125, 0.4866), (700.0, 0.7347, 0.2653)]
    {
        assert_close(of(nm)[0], x, 5e-5, "x");
        assert_close(of(nm)[1], y, 5e-5, "y");
    }
    let [x, y] = Xyz::white().chromaticity().unwrap();
    assert_close(x, 0.3127, 5e-5, "x of D65");
    assert_close(y, 0.3290, 5e-5, "y of D65");
    assert_eq!(Xyz { x: 0.0, y: 0.0, z: 0.0 }.chromaticity(), None);
}

#[test]
fn equal_channels_are_grey() {
    for level in [0.001, 0.2, 1.0] {
        let lab = LinearRgb([level; 3]).to_lab();
        // Rounding of numbers up to 500.
        assert!(lab.a.abs() < 1e-12 && lab.b.abs() < 1e-12, "{lab:?}");
    }
    assert_close(LinearRgb([1.0; 3]).to_lab().l, 100.0, 1e-12, "white");
    assert_eq!(LinearRgb([1.0, 0.0, 2.0]).on_screen(), ("#ff00ff".to_owned(), true));
}

#[test]
fn a_white_surface_is_white_in_every_quantity() {
    let geometry = Geometry { theta_i_deg: 10.0, phi_i_deg: 0.0, theta_o_deg: 60.0, phi_o_deg: 90.0 };
    let brdf = 1.0 / std::f64::consts::PI;
    for (quantity, reading) in [(Quantity::Brdf, brdf), (Quantity::BsdfCos, brdf * 0.5), (Quantity::Reflectance, 1.0)] {
        let found = quantity.reflectance_factor(reading, &geometry);
        assert_close(found, 1.0, 1e-15, "cos 60° = 1/2 to rounding");
    }
}

fn lab() -> impl Strategy<Value = Lab> {
    (0.0..100.0, -120.0..120.0, -120.0..120.0).prop_map(|(l, a, b)| Lab { l, a, b })
}

proptest! {
    #[test]
    fn channels_come_back_from_xyz(r in -1.0..2.0_f64, g in -1.0..2.0_f64, b in -1.0..2.0_f64) {
        let back = LinearRgb([r, g, b]).to_xyz().to_linear_rgb();
        // Two products with matrices of entries up to 3.3, whose digits are 17.
        prop_assert!(back.0.iter().zip([r, g, b]).all(|(found, expected)| (found - expected).abs() < 1e-13));
    }

    #[test]
    fn a_difference_is_symmetric_and_vanishes_on_itself(first in lab(), second in lab()) {
        let there = first.delta_e_2000(second);
        // Sums in another order differ by rounding.
        prop_assert!((there - second.delta_e_2000(first)).abs() <= 1e-12 * (1.0 + there));
        prop_assert!(there.is_finite() && there >= 0.0);
        prop_assert!(first.delta_e_2000(first).abs() == 0.0);
    }

    #[test]
    fn greys_differ_by_lightness_alone(first in 0.0..100.0_f64, second in 0.0..100.0_f64) {
        let grey = |l: f64| Lab { l, a: 0.0, b: 0.0 };
        let from_middle = ((first + second) / 2.0 - 50.0).powi(2);
        let expected = (first - second).abs() / (1.0 + 0.015 * from_middle / (20.0 + from_middle).sqrt());
        prop_assert!((grey(first).delta_e_2000(grey(second)) - expected).abs() < 1e-12 * (1.0 + expected));
    }

    /// XYZ is linear in the spectrum, and a grid that is finer than the sums' own changes nothing that is piecewise linear on it.
    #[test]
    fn tristimulus_values_are_linear(values in prop::collection::vec(0.0..1.0_f64, 81), factor in 0.0..2.0_f64) {
        let grid: Vec<f64> = (0..81).map(|index| 380.0 + 5.0 * f64::from(index)).collect();
        let plain = Xyz::of_reflectance(&grid, &values).unwrap();
        let scaled: Vec<f64> = values.iter().map(|value| factor * value).collect();
        let scaled = Xyz::of_reflectance(&grid, &scaled).unwrap();
        prop_assert!((scaled.y - factor * plain.y).abs() < 1e-14);
        let fine: Vec<f64> = (0..161).map(|index| 380.0 + 2.5 * f64::from(index)).collect();
        let between: Vec<f64> = (0..161)
            .map(|index| if index % 2 == 0 { values[index / 2] } else { (values[index / 2] + values[index / 2 + 1]) / 2.0 })
            .collect();
        let fine = Xyz::of_reflectance(&fine, &between).unwrap();
        prop_assert!((fine.x - plain.x).abs() < 1e-14 && (fine.z - plain.z).abs() < 1e-14);
    }
}
