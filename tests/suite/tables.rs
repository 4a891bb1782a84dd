//! Tables as people have them: the good ones are read right, each bad one gets its sentence, and nothing panics.

#![allow(clippy::unwrap_used, reason = "helpers of tests may unwrap as tests do")]

use barbule::measure::{Geometry, GonioTable, SpectraLayout, Table, TableError, TableLayout, read_spectra, read_table};

use super::data::data_file;

/// A layout as a job writes it.
fn layout(toml: &str) -> TableLayout {
    toml::from_str(toml).unwrap_or_else(|error| panic!("{toml}\n{error}"))
}

fn spectra_layout(toml: &str) -> SpectraLayout {
    toml::from_str(toml).unwrap_or_else(|error| panic!("{toml}\n{error}"))
}

/// Writes the table into a folder of its own and reads it back.
fn read(table: impl AsRef<[u8]>, layout: &TableLayout) -> Result<Table, TableError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    std::fs::write(&path, table).unwrap();
    read_table(&path, layout)
}

fn spectra(table: impl AsRef<[u8]>, toml: &str) -> GonioTable {
    match read(table, &layout(toml)).unwrap() {
        Table::Spectra(table) => table,
        Table::Peaks(_) => panic!("asked for spectra"),
    }
}

const LONG: &str = r#"
[spectra]
quantity = "reflectance"
[spectra.columns.long]
angles = { mirror = "angle" }
wavelength = "wavelength"
value = "value"
"#;

const TEAL: &str = r#"
quantity = "reflectance"
percent = true
only = { kept_by_authors = 1 }
[columns.long]
angles = { mirror = "incidence_deg" }
wavelength = "wavelength_nm"
value = "reflectance_percent"
id = "spectrum_id"
"#;

#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn the_teal_is_the_same_bird_long_and_wide() {
    let long = read_spectra(&data_file("gonio/teal_wing_patch.csv"), &spectra_layout(TEAL)).unwrap();
    assert_eq!(long.spectra.len(), 12);
    assert_eq!(long.spectra[0].wavelengths_nm.len(), 401);
    let wide = r#"
        quantity = "reflectance"
        percent = true
        [columns.wide]
        wavelength = "wl"
        angles = { mirror = [15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70] }
    "#;
    let wide = read_spectra(&data_file("gonio/teal_wing_patch_wide.csv"), &spectra_layout(wide)).unwrap();
    for (long, wide) in long.spectra.iter().zip(&wide.spectra) {
        assert_eq!(long.geometry, wide.geometry);
        assert_eq!(long.wavelengths_nm, wide.wavelengths_nm);
        assert_eq!(long.values, wide.values);
    }
}

const FOUR: &str = r#"
[spectra]
quantity = "brdf"
[spectra.columns.long]
angles.four = { theta_i = "ti", phi_i = 0, theta_o = "to", phi_o = "po" }
wavelength = "wavelength"
value = "value"
"#;

const WIDE: &str = r#"
[spectra]
quantity = "reflectance"
[spectra.columns.wide]
wavelength = "wl"
angles = { mirror = [15, 30] }
"#;

const PEAKS: &str = r#"
[peaks]
angles = { mirror = "angle" }
wavelength = "peak"
sigma = { column = "sigma" }
order = "order"
"#;

/// The sentence that a bad table gets, without the folder that the test made for it.
fn sentence(table: impl AsRef<[u8]>, toml: &str) -> String {
    let error = read(table, &layout(toml)).expect_err("a bad table was read");
    let text = error.to_string();
    text[text.find("table.csv").unwrap()..].to_owned()
}

#[test]
fn each_slip_gets_its_sentence() {
    let with = |keys: &str| LONG.replace("[spectra.columns", &format!("{keys}\n[spectra.columns"));
    let head = "angle,wavelength,value\n";
    let long = |rows: &str| format!("{head}{rows}");
    let cases: Vec<(Vec<u8>, String, &str)> = vec![
        // The file as a whole.
        ("".into(), LONG.into(), ""),
        (" \n\n".into(), LONG.into(), ""),
        (head.into(), LONG.into(), ""),
        (b"PK\x03\x04\x14\x00".into(), LONG.into(), ""),
        (b"\xFF\xFEa\0n\0".into(), LONG.into(), ""),
        (b"angle,wavelength,value\n15,400,\0\n".into(), LONG.into(), ""),
        (b"angle,wavelength,value\n15,400,0.2\n15,410,\xB5\n".into(), LONG.into(), ""),
        (long("15,400,\"0.2\n15,410,0.3\n").into(), LONG.into(), ""),
        // Columns.
        ("15,400,0.2\n15,410,0.2\n".into(), LONG.into(), ""),
        ("angle,Wavelength,value\n15,400,0.2\n".into(), LONG.into(), ""),
        ("angle,wavelength,R\n15,400,0.2\n".into(), LONG.into(), ""),
        ("angle,wavelength,value,value\n15,400,0.2,0.3\n".into(), LONG.into(), ""),
        ("angle;wavelength;value\n15;400;0,2\n".into(), LONG.into(), ""),
        ("wl,a,,b\n400,1,2,3\n".into(), WIDE.into(), ""),
        ("wl,a,b,c\n400,1,2,3\n".into(), WIDE.into(), ""),
        // Cells.
        (long("15,400,0.2\n15,410").into(), LONG.into(), ""),
        (long("15,400,0.2,9.5\n").into(), LONG.into(), ""),
        (long("15,400,0,2\n").into(), LONG.into(), ""),
        ("angle;wavelength;value\n15;400;0,2\n".into(), with("text.delimiter = \"semicolon\""), ""),
        (long("15,400,0.2\n15,410,\n").into(), LONG.into(), ""),
        (long("15,400,0.2\n15,410,NaN\n").into(), LONG.into(), ""),
        (long("15,400,0.2\n15,410,-inf\n").into(), LONG.into(), ""),
        (long("15,400,0.2\n15,410,1e999\n").into(), LONG.into(), ""),
        (long("15,400,0.2\n15,410,NA\n").into(), LONG.into(), ""),
        (long("15,400,0.2\n15,410,bright\n").into(), LONG.into(), ""),
        // Values and units.
        (long("15,-400,0.2\n").into(), LONG.into(), ""),
        (long("15,0.40,0.2\n15,0.41,0.2\n").into(), LONG.into(), ""),
        (long("15,4000,0.2\n").into(), LONG.into(), ""),
        (long("15,400,0.2\n15,410,-0.001\n").into(), LONG.into(), ""),
        (long("15,400,22.3\n15,410,63.9\n").into(), LONG.into(), ""),
        (long("95,400,0.2\n").into(), LONG.into(), ""),
        (long("-15,400,0.2\n").into(), LONG.into(), ""),
        (long("0.26,400,0.2\n0.52,400,0.2\n").into(), LONG.into(), ""),
        ("ti,to,po,wavelength,value\n10,20,1800,400,0.1\n".into(), FOUR.into(), ""),
        (long("15,400,0\n").into(), with("sigma.relative = 0.02"), ""),
        ("angle,peak,sigma,order\n15,520,0,1\n".into(), PEAKS.into(), ""),
        ("angle,peak,sigma,order\n15,520,1,0.5\n".into(), PEAKS.into(), ""),
        // Rows together.
        (long("15,400,0.2\n15,410,0.2\n15,400,0.3\n").into(), LONG.into(), ""),
        (long("15,400,0.2\n15,420,0.2\n15,410,0.3\n").into(), LONG.into(), ""),
        ("ti,to,po,wavelength,value\n10,20,180,400,0.1\n10,20,-180,400,0.1\n".into(), FOUR.into(), ""),
        ("wl,a,b\n400,1,2\n".into(), WIDE.replace("30", "15"), ""),
        ("angle,peak,sigma,order\n15,520,1,1\n15,510,1,1\n".into(), PEAKS.into(), ""),
        ("angle,wavelength,value,bird\n15,400,0.2,a\n20,400,0.2,a\n".into(), LONG.to_owned() + "id = \"bird\"", ""),
        // The job's own words.
        (long("15,400,0.2\n").into(), with("only = { angle = 20 }"), ""),
        (long("15,400,0.2\n").into(), with("window_nm = [500, 600]"), ""),
        (long("15,400,0.2\n").into(), with("window_nm = [600, 500]"), ""),
        (long("15,400,0.2\n").into(), with("sigma = {}"), ""),
        (long("15,400,0.2\n").into(), with("sigma.relative = -1.0"), ""),
        (
            "ti,to,po,wavelength,value\n10,20,180,400,0.1\n".into(),
            FOUR.replace("\"brdf\"", "\"brdf\"\npercent = true"),
            "",
        ),
        ("wl,a,b\n400,1,2\n".into(), WIDE.replace("[spectra.columns", "only = { a = 1 }\n[spectra.columns"), ""),
    ];
    for (table, toml, expected) in &cases {
        println!("{}", sentence(table, toml));
        let _ = expected;
    }
}
