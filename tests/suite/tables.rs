//! Tables as people have them: the good ones are read right, each bad one gets its sentence, and nothing panics.

use std::path::Path;

use barbule::measure::{
    Certainty, Geometry, GonioTable, Guess, SpectraLayout, Table, TableError, TableLayout, TableText, guess_layout,
    read_table,
};

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::data::data_file;

/// A layout as a job writes it.
fn layout(toml: &str) -> TableLayout {
    toml::from_str(toml).unwrap_or_else(|error| panic!("{toml}\n{error}"))
}

fn load(name: &str) -> TableText {
    TableText::load(&data_file(name)).unwrap()
}

fn read_real(name: &str, toml: &str) -> GonioTable {
    match read_table(&load(name), &TableLayout::Spectra(spectra_layout(toml))).unwrap() {
        Table::Spectra(table) => table,
        Table::Peaks(_) => panic!("asked for spectra"),
    }
}

fn spectra_layout(toml: &str) -> SpectraLayout {
    toml::from_str(toml).unwrap_or_else(|error| panic!("{toml}\n{error}"))
}

/// Reads the table as if it came from a file.
fn read(table: impl AsRef<[u8]>, layout: &TableLayout) -> Result<Table, TableError> {
    read_table(&TableText::from_bytes(Path::new("table.csv"), table.as_ref().to_vec())?, layout)
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
    let long = read_real("gonio/teal_wing_patch.csv", TEAL);
    assert_eq!(long.spectra.len(), 12);
    assert_eq!(long.spectra[0].wavelengths_nm.len(), 401);
    let wide = r#"
        quantity = "reflectance"
        percent = true
        [columns.wide]
        wavelength = "wl"
        angles = { mirror = [15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70] }
    "#;
    let wide = read_real("gonio/teal_wing_patch_wide.csv", wide);
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

/// The sentence that a bad table gets.
fn sentence(table: impl AsRef<[u8]>, toml: &str) -> String {
    read(table, &layout(toml)).expect_err("a bad table was read").to_string()
}

#[test]
fn each_slip_gets_its_sentence() {
    let with = |keys: &str| LONG.replace("[spectra.columns", &format!("{keys}\n[spectra.columns"));
    let head = "angle,wavelength,value\n";
    let long = |rows: &str| format!("{head}{rows}");
    let cases: Vec<(Vec<u8>, String, &str)> = vec![
        // The file as a whole.
        (
            "".into(),
            LONG.into(),
            r#": the file is empty; expected a line of column names and then one row of numbers after another"#,
        ),
        (
            " \n\n".into(),
            LONG.into(),
            r#": the file is empty; expected a line of column names and then one row of numbers after another"#,
        ),
        (
            head.into(),
            LONG.into(),
            r#": found column names but no row of numbers; the file may have been cut off when it was written"#,
        ),
        (
            b"PK\x03\x04\x14\x00".into(),
            LONG.into(),
            r#": this is an Excel workbook or another zip archive; expected a table as CSV text: save the sheet as "CSV UTF-8" and name that file"#,
        ),
        (
            b"\xFF\xFEa\0n\0".into(),
            LONG.into(),
            r#": this is UTF-16 text; expected a table as CSV text: save the sheet as "CSV UTF-8" and name that file"#,
        ),
        (
            b"angle,wavelength,value\n15,400,\0\n".into(),
            LONG.into(),
            r#": found a zero byte at offset 30, which no text has; the copy may be damaged, or it is another kind of file: expected a table as CSV text"#,
        ),
        (
            b"angle,wavelength,value\n15,400,0.2\n15,410,\xB5\n".into(),
            LONG.into(),
            r#", line 3: found the byte 0xB5, which is not UTF-8 text; save the file as "CSV UTF-8""#,
        ),
        (
            long("15,400,\"0.2\n15,410,0.3\n").into(),
            LONG.into(),
            r#", line 2: a quotation mark is opened and not closed on the same line; close it, or delete it"#,
        ),
        // Columns.
        (
            "15,400,0.2\n15,410,0.2\n".into(),
            LONG.into(),
            r#", line 1: found numbers where column names were expected; write a first line that names the columns"#,
        ),
        (
            "angle,Wavelength,value\n15,400,0.2\n".into(),
            LONG.into(),
            r#", line 1: there is no column "wavelength"; the file has "angle", "Wavelength", "value"; did you mean "Wavelength"?"#,
        ),
        (
            "angle,wavelength,R\n15,400,0.2\n".into(),
            LONG.into(),
            r#", line 1: there is no column "value"; the file has "angle", "wavelength", "R"; name one of these in the job"#,
        ),
        (
            "angle,wavelength,value,value\n15,400,0.2,0.3\n".into(),
            LONG.into(),
            r#", column "value": two columns have this name; rename one of them"#,
        ),
        (
            "angle;wavelength;value\n15;400;0,2\n".into(),
            LONG.into(),
            r#", line 1: the first line has semicolons between its cells where the job says commas; write text = { delimiter = "semicolon" }"#,
        ),
        (
            "wl,a,,b\n400,1,2,3\n".into(),
            WIDE.into(),
            r#", line 1: column 3 has no name; name it in the first line, or delete it"#,
        ),
        (
            "wl,a,b,c\n400,1,2,3\n".into(),
            WIDE.into(),
            r#", line 1: the job gives angles for 2 spectra and the file has 3: "a", "b", "c"; give one for each, in this order, or name them as { "a" = 15 }"#,
        ),
        // Cells.
        (
            long("15,400,0.2\n15,410").into(),
            LONG.into(),
            r#", line 3: the row has 2 cells where the first line names 3 columns; it may have been cut off: complete it, or delete it"#,
        ),
        (
            long("15,400,0.2,9.5\n").into(),
            LONG.into(),
            r#", line 2: the row has 4 cells where the first line names 3 columns; put quotation marks around a cell that has the delimiter in it, or delete what is too much"#,
        ),
        (
            long("15,400,0,2\n").into(),
            LONG.into(),
            r#", line 2: the row has 4 cells where the first line names 3 columns, as if its numbers had decimal commas; write numbers as 0.5, or save with semicolons between cells and write text = { delimiter = "semicolon", decimal_comma = true }"#,
        ),
        (
            "angle;wavelength;value\n15;400;0,2\n".into(),
            with("text.delimiter = \"semicolon\""),
            r#", line 2, column "value": found "0,2", a number with a decimal comma; if all are written so, add decimal_comma = true under `text`"#,
        ),
        (
            long("15,400,0.2\n15,410,\n").into(),
            LONG.into(),
            r#", line 3, column "value": the cell is empty where a number was expected; fill it in, or leave the row out"#,
        ),
        (
            long("15,400,0.2\n15,410,NaN\n").into(),
            LONG.into(),
            r#", line 3, column "value": found "NaN" where a number was expected; a reading that is missing has no row: leave the row out"#,
        ),
        (
            long("15,400,0.2\n15,410,-inf\n").into(),
            LONG.into(),
            r#", line 3, column "value": found "-inf" where a number was expected; a reading that is missing has no row: leave the row out"#,
        ),
        (
            long("15,400,0.2\n15,410,1e999\n").into(),
            LONG.into(),
            r#", line 3, column "value": found "1e999" where a number was expected; a reading that is missing has no row: leave the row out"#,
        ),
        (
            long("15,400,0.2\n15,410,NA\n").into(),
            LONG.into(),
            r#", line 3, column "value": found "NA" where a number was expected; a reading that is missing has no row: leave the row out"#,
        ),
        (
            long("15,400,0.2\n15,410,bright\n").into(),
            LONG.into(),
            r#", line 3, column "value": found "bright" where a number was expected; correct the cell, or name another column in the job"#,
        ),
        // Values and units.
        (
            long("15,-400,0.2\n").into(),
            LONG.into(),
            r#", line 2, column "wavelength": found the wavelength -400; a wavelength is more than 0 nm: correct the cell, or delete the row"#,
        ),
        (
            long("15,0.40,0.2\n15,0.41,0.2\n").into(),
            LONG.into(),
            r#", column "wavelength": the wavelengths run from 0.4 to 0.41, which are micrometres rather than nm; write wavelength_unit = "um", or multiply them by 1000"#,
        ),
        (
            long("15,4000,0.2\n").into(),
            LONG.into(),
            r#", line 2, column "wavelength": found the wavelength 4000 nm, and expected 100 to 3000 nm; if the table is in another unit (ångström, 1/cm), convert it to nm"#,
        ),
        (
            long("15,400,0.2\n15,410,-0.001\n").into(),
            LONG.into(),
            r#", line 3, column "value": found the reading -0.001, below 0; if it is noise about a dark reading, write negative = "keep" (or "drop" to leave such readings out), else correct it"#,
        ),
        (
            long("15,400,22.3\n15,410,63.9\n").into(),
            LONG.into(),
            r#", line 2, column "value": found the reflectance 22.3, and the job does not say its unit; if 100 is the white standard, write percent = true; if 1 is, percent = false"#,
        ),
        (
            long("95,400,0.2\n").into(),
            LONG.into(),
            r#", line 2, column "angle": found an inclination of 95°, and expected 0° to less than 90°, counted from the surface's normal; if the table counts from the surface itself, write 90° − angle"#,
        ),
        (
            long("-15,400,0.2\n").into(),
            LONG.into(),
            r#", line 2, column "angle": found an inclination of -15°, and expected 0° to less than 90°, counted from the surface's normal; write a negative one as positive, with the azimuth turned by 180°"#,
        ),
        (
            long("0.26,400,0.2\n0.52,400,0.2\n").into(),
            LONG.into(),
            r#": all inclinations lie between 0 and 0.52, which are radians rather than degrees; write angle_unit = "radians", or if they are degrees, angle_unit = "degrees""#,
        ),
        (
            "ti,to,po,wavelength,value\n10,20,1800,400,0.1\n".into(),
            FOUR.into(),
            r#", line 2: found an azimuth of 1800°, and expected −360° to 360°; correct it"#,
        ),
        (
            long("15,400,0\n").into(),
            with("sigma.relative = 0.02"),
            r#", line 2: the standard deviation is 0; it is more than 0: where it is unknown, leave `sigma` out, and where readings may be 0 give `absolute` too"#,
        ),
        (
            "angle,peak,sigma,order\n15,520,0,1\n".into(),
            PEAKS.into(),
            r#", line 2: the standard deviation is 0; it is more than 0: where it is unknown, leave `sigma` out, and where readings may be 0 give `absolute` too"#,
        ),
        (
            "angle,peak,sigma,order\n15,520,1,0.5\n".into(),
            PEAKS.into(),
            r#", line 2, column "order": found 0.5 where a count of maxima was expected: 1 for the one of longest wavelength, 2 for the next"#,
        ),
        // Rows together.
        (
            long("15,400,0.2\n15,410,0.2\n15,400,0.3\n").into(),
            LONG.into(),
            r#", line 4, column "wavelength": the reading at 400 nm of the spectrum at 15° stands in line 2 already; delete one of them, or if they are two spectra, name the column that tells them apart as `id`"#,
        ),
        (
            long("15,400,0.2\n15,420,0.2\n15,410,0.3\n").into(),
            LONG.into(),
            r#", line 4, column "wavelength": 410 nm comes after 420 nm in the spectrum at 15°, against the order of the lines before; sort the table by spectrum and wavelength, and look whether two spectra were mixed"#,
        ),
        (
            "ti,to,po,wavelength,value\n10,20,180,400,0.1\n10,20,-180,400,0.1\n".into(),
            FOUR.into(),
            r#", line 3: θi 10° φi 0° θo 20° φo -180° has the same angles as θi 10° φi 0° θo 20° φo 180°; correct them, or if they are repeated measurements, write replicates = true"#,
        ),
        (
            "wl,a,b\n400,1,2\n".into(),
            WIDE.replace("30", "15"),
            r#", column "b": b has the same angles as a; correct them, or if they are repeated measurements, write replicates = true"#,
        ),
        (
            "angle,peak,sigma,order\n15,520,1,1\n15,510,1,1\n".into(),
            PEAKS.into(),
            r#", line 3: the peak "15°" has the same angles as the peak "15°"; correct them, or if they are repeated measurements, write replicates = true"#,
        ),
        (
            "angle,wavelength,value,bird\n15,400,0.2,a\n20,400,0.2,a\n".into(),
            LONG.to_owned() + "id = \"bird\"",
            r#", line 3, column "bird": the spectrum "a" has other angles here than in line 2; correct them, or leave `id` out if that column does not name a spectrum"#,
        ),
        // The job's own words.
        (
            long("15,400,0.2\n").into(),
            with("only = { angle = 20 }"),
            r#": of 1 readings nothing is left: `only` leaves out 1; widen the job's choice"#,
        ),
        (
            long("15,400,0.2\n").into(),
            with("window_nm = [500, 600]"),
            r#", line 2, column "angle": of 1 readings nothing is left: `window_nm` leaves out 1; widen the job's choice"#,
        ),
        (
            long("15,400,0.2\n").into(),
            with("window_nm = [600, 500]"),
            r#": the job's `window_nm` is [600, 500]; expected [first, last], the first below the last"#,
        ),
        (long("15,400,0.2\n").into(), with("stride = 0"), ": the job's `stride` is 0; expected 1 or more"),
        (
            long("15,400,0.2\n").into(),
            with("sigma = {}"),
            r#": the job's `sigma` is empty; expected at least one of column, relative and absolute; leave `sigma` out where it is unknown"#,
        ),
        (
            long("15,400,0.2\n").into(),
            with("sigma.relative = -1.0"),
            r#": the job's `sigma.relative` is -1; expected a number more than 0"#,
        ),
        (
            "ti,to,po,wavelength,value\n10,20,180,400,0.1\n".into(),
            FOUR.replace("\"brdf\"", "\"brdf\"\npercent = true"),
            r#": the job's `percent` is true; expected left out, since only a reflectance is measured in percent"#,
        ),
        (
            "wl,a,b\n400,1,2\n".into(),
            WIDE.replace("[spectra.columns", "only = { a = 1 }\n[spectra.columns"),
            r#": the job's `only` is given; expected left out, since a row of a wide table holds one wavelength of all spectra; name the columns wanted under `angles`"#,
        ),
    ];
    for (table, toml, expected) in &cases {
        assert_eq!(sentence(table, toml), format!("table.csv{expected}"));
    }
}

#[test]
fn what_programs_do_to_text_does_not_matter() {
    let plain = "angle,wavelength,value\n15,400,0.2\n15,410,0.25\n";
    let expected = spectra(plain, LONG);
    let semicolon = LONG
        .replace("[spectra.columns", "text = { delimiter = \"semicolon\", decimal_comma = true }\n[spectra.columns");
    assert_eq!(spectra(format!("\u{feff}{plain}"), LONG), expected, "byte order mark");
    assert_eq!(spectra(plain.replace('\n', "\r\n"), LONG), expected, "Windows line ends");
    assert_eq!(spectra(plain.replace('\n', "\r"), LONG), expected, "old Mac line ends");
    assert_eq!(spectra(plain.replace('\n', "\n\n").trim_end(), LONG), expected, "blank lines, none at the end");
    assert_eq!(spectra(plain.replace("angle,", "\"angle\" , "), LONG), expected, "quotation marks and blanks");
    assert_eq!(spectra(plain.replace(',', ";").replace('.', ","), &semicolon), expected, "a spreadsheet in German");
    let upside_down = "angle,wavelength,value\n15,410,0.25\n15,400,0.2\n";
    assert_eq!(spectra(upside_down, LONG), expected, "scanned downwards");
}

#[test]
fn lines_are_counted_as_an_editor_does() {
    for (table, line) in [
        ("angle,wavelength,value\r\n15,400,0.2\r\n15,410,x\r\n", 3),
        ("\nangle,wavelength,value\n\n15,400,0.2\n\n\n15,410,x", 7),
        ("angle,wavelength,value\r15,400,x", 2),
    ] {
        let found = sentence(table, LONG);
        assert!(found.starts_with(&format!("table.csv, line {line}, column \"value\": found \"x\"")), "{found}");
    }
}

#[test]
fn units_that_a_job_states_are_believed() {
    let with = |keys: &str| LONG.replace("[spectra.columns", &format!("{keys}\n[spectra.columns"));
    let plain = spectra("angle,wavelength,value\n1,400,64\n", &with("percent = false"));
    assert_eq!(plain.spectra[0].values, [64.0]);
    let percent = spectra("angle,wavelength,value\n1,400,64\n", &with("percent = true"));
    assert_eq!(percent.spectra[0].values, [0.64]);
    let um = spectra("angle,wavelength,value\n1,0.4,0.2\n", &with("wavelength_unit = \"um\""));
    assert_eq!(um.spectra[0].wavelengths_nm, [400.0]);
    let radians = spectra("angle,wavelength,value\n0.5,400,0.2\n", &with("angle_unit = \"radians\""));
    assert_eq!(radians.spectra[0].geometry, Geometry::mirror(0.5_f64.to_degrees()));
    let degrees = spectra("angle,wavelength,value\n0.5,400,0.2\n", &with("angle_unit = \"degrees\""));
    assert_eq!(degrees.spectra[0].geometry, Geometry::mirror(0.5));
}

#[test]
fn a_job_chooses_rows_and_wavelengths() {
    let with = |keys: &str| LONG.replace("[spectra.columns", &format!("{keys}\n[spectra.columns"));
    let table = "angle,wavelength,value,bird\n15,390,NA,a\n15,400,0.2,a\n15,410,-0.1,a\n15,420,0.3,a\n20,400,0.4,b\n";
    let read = |keys: &str| {
        let table = spectra(table, &with(keys));
        table.spectra.into_iter().map(|one| (one.id, one.wavelengths_nm, one.values)).collect::<Vec<_>>()
    };
    let b = ("20°".to_owned(), vec![400.0], vec![0.4]);
    let a = |wavelengths: &[f64], values: &[f64]| ("15°".to_owned(), wavelengths.to_vec(), values.to_vec());
    // The window lies over a cell without a number; outside it, such a cell does not matter.
    let window = "window_nm = [400, 500]\n";
    let keep = read(&format!("{window}negative = \"keep\""));
    assert_eq!(keep, [a(&[400.0, 410.0, 420.0], &[0.2, -0.1, 0.3]), b.clone()]);
    let drop = read(&format!("{window}negative = \"drop\""));
    assert_eq!(drop, [a(&[400.0, 420.0], &[0.2, 0.3]), b.clone()]);
    let stride = read(&format!("{window}negative = \"keep\"\nstride = 2"));
    assert_eq!(stride, [a(&[400.0, 420.0], &[0.2, 0.3]), b.clone()]);
    assert_eq!(read("only = { bird = \"b\" }"), std::slice::from_ref(&b));
    assert_eq!(read("only = { angle = 20.0 }"), [b]);
}

#[test]
fn standard_deviations_add_as_variances() {
    let keys = "percent = true\nsigma = { column = \"s\", relative = 0.04, absolute = 1.2 }\n[spectra.columns";
    let table = spectra("angle,wavelength,value,s\n15,400,10,0.3\n", &LONG.replace("[spectra.columns", keys));
    // √(0.3² + (0.04 · 10)² + 1.2²) = √(0.09 + 0.16 + 1.44) = 1.3 percent.
    let sigma = table.spectra[0].sigmas.as_ref().unwrap()[0];
    assert!((sigma - 0.013).abs() < 1e-15, "{sigma}: rounding alone");
    assert_eq!(spectra("angle,wavelength,value\n15,400,0.1\n", LONG).spectra[0].sigmas, None, "unknown is not 0");
}

#[test]
fn wide_tables_come_as_r_writes_them() {
    let table = "\"\",\"wl\",\"a\",\"b\"\n\"1\",400,0.1,0.2\n\"2\",410,0.3,0.4\n";
    let both = spectra(table, WIDE);
    assert_eq!(both.spectra[1].id, "b");
    assert_eq!(both.spectra[1].values, [0.2, 0.4]);
    assert_eq!(both.spectra[1].geometry, Geometry::mirror(30.0));
    let one = spectra(table, &WIDE.replace("[15, 30]", "{ b = 30 }"));
    assert_eq!(one.spectra, both.spectra[1..]);
    let geometry = "{ theta_i_deg = 0, phi_i_deg = 0, theta_o_deg = 45, phi_o_deg = 180 }";
    let four = spectra(table, &WIDE.replace("mirror = [15, 30]", &format!("four = {{ a = {geometry} }}")));
    assert_eq!(
        four.spectra[0].geometry,
        Geometry { theta_i_deg: 0.0, phi_i_deg: 0.0, theta_o_deg: 45.0, phi_o_deg: 180.0 }
    );
    let twice = WIDE.replace("[15, 30]", "[15, 15]").replace("[spectra.c", "replicates = true\n[spectra.c");
    assert_eq!(spectra(table, &twice).spectra.len(), 2);
}

#[test]
fn peaks_keep_order_and_uncertainty() {
    let table = "angle,peak,sigma,order\n15,0.520,0.002,1\n15,0.310,0.001,2\n20,0.516,0.002,1\n";
    let toml = PEAKS.replace("[peaks]", "[peaks]\nwavelength_unit = \"um\"");
    let Table::Peaks(table) = read(table, &layout(&toml)).unwrap() else { panic!("asked for peaks") };
    let found: Vec<_> = table.readings.iter().map(|one| (one.id.as_str(), one.wavelength_nm, one.order)).collect();
    assert_eq!(found, [("15°", 520.0, Some(1)), ("15°", 310.0, Some(2)), ("20°", 516.0, Some(1))]);
    assert_eq!(table.readings[1].sigma_nm, Some(1.0));
}

#[test]
fn a_path_that_is_no_file_is_said_so() {
    let folder = tempfile::tempdir().unwrap();
    let sentence = |name: &str| TableText::load(&folder.path().join(name)).unwrap_err().problem.to_string();
    assert!(sentence("none.csv").starts_with("there is no such file"));
    assert!(sentence("").starts_with("found a folder or a device"));
}

/// A download that was set aside and never filled has the size of a table and nothing in it.
#[test]
fn a_gigabyte_of_zeros_costs_neither_time_nor_memory() {
    let folder = tempfile::tempdir().unwrap();
    let refuse = |name: &str, start: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, start).unwrap();
        std::fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(1 << 30).unwrap();
        let begin = std::time::Instant::now();
        let problem = TableText::load(&path).unwrap_err().problem.to_string();
        // Reading it would take a second or more; refusing it takes microseconds.
        assert!(begin.elapsed().as_millis() < 200, "{:?}", begin.elapsed());
        problem
    };
    assert!(refuse("zeros.csv", b"").starts_with("found a zero byte at offset 0,"));
    assert!(refuse("head.csv", b"angle,wavelength,value\n15,400,0.2\n").starts_with("found a zero byte at offset 34,"));
    let rows = "15,400,0.2\n".repeat(10_000);
    assert!(refuse("long.csv", rows.as_bytes()).starts_with("the file has 1073741824 bytes, and a table may have"));
}

#[test]
fn a_line_without_end_is_refused() {
    let found = sentence("angle,".repeat(1 << 18), LONG);
    assert!(found.starts_with("table.csv, line 1: the line has 1572864 bytes"), "{found}");
}

/// Guesses the layout of the table, then reads it so.
fn guess(table: &str) -> (Guess, Result<Table, TableError>) {
    let text = TableText::from_bytes(Path::new("table.csv"), table.into()).unwrap();
    let guess = guess_layout(&text).unwrap();
    let table = read_table(&text, &guess.layout);
    (guess, table)
}

#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn real_tables_are_guessed() {
    // Spectra, and readings of each, that the guessed layout reads.
    let read = [
        ("teal_wing_patch", 12, 401),
        ("peacock_feather_curet", 137, 1),
        ("mystique_paint_cornell", 1080, 31),
        ("garnet_red_paint_cornell", 1439, 31),
    ];
    for (name, spectra, readings) in read {
        let text = load(&format!("gonio/{name}.csv"));
        let Table::Spectra(table) = read_table(&text, &guess_layout(&text).unwrap().layout).unwrap() else {
            panic!("{name} holds spectra")
        };
        assert_eq!((table.spectra.len(), table.spectra[0].values.len()), (spectra, readings), "{name}");
    }
    let teal = guess_layout(&load("gonio/teal_wing_patch.csv")).unwrap().layout;
    assert_eq!(teal, TableLayout::Spectra(spectra_layout(TEAL)));
    // One file lacks its angles; three others, taken at one unknown geometry, likewise. That is said, not made up.
    for name in [
        "gonio/teal_wing_patch_wide",
        "spectra/sicalis_citrina",
        "spectra/pavo_specsdata",
        "spectra/starling_elisabeth",
    ] {
        let text = load(&format!("{name}.csv"));
        let guess = guess_layout(&text).unwrap();
        assert!(guess.notes.iter().any(|note| note.key.ends_with("angles") && note.certainty == Certainty::Missing));
        assert!(matches!(&guess.layout, TableLayout::Spectra(layout) if layout.is_without_geometry()), "{name}");
    }
}

#[test]
fn what_ecologists_export_is_guessed() {
    let (wide, read) = guess("\"\",\"wl\",\"bird-01\",\"bird-02\"\n\"1\",300,12.5,8\n\"2\",301,13,9\n");
    let TableLayout::Spectra(layout) = wide.layout else { panic!("holds spectra") };
    assert_eq!(layout.percent, Some(true));
    let Table::Spectra(table) = read.unwrap() else { panic!("holds spectra") };
    assert!(table.spectra.iter().all(|one| one.origin.without_geometry), "01 and 02 are birds, not angles");

    let (named, read) = guess("wl;R_15deg;R_30deg\n300;0,12;0,08\n301;0,13;0,09\n");
    let TableLayout::Spectra(layout) = named.layout else { panic!("holds spectra") };
    assert_eq!((layout.percent, layout.text.decimal_comma), (Some(false), true));
    let Table::Spectra(table) = read.unwrap() else { panic!("holds spectra") };
    assert_eq!(table.spectra[1].geometry, Geometry::mirror(30.0));

    let (_, read) = guess("Angle\tPeak wavelength (nm)\tSD\n15\t520.3\t1\n20\t516.0\t1\n");
    let Table::Peaks(table) = read.unwrap() else { panic!("holds peaks") };
    assert_eq!((table.readings[1].wavelength_nm, table.readings[1].sigma_nm), (516.0, Some(1.0)));
}

#[test]
fn guesses_of_units_and_repeats_are_marked() {
    let table = "spectrum_id,theta_i,wavelength,R\na,0.5,0.4,0.1\nb,0.5,0.4,0.2\n";
    let (guess, read) = guess(table);
    let Table::Spectra(table) = read.unwrap() else { panic!("holds spectra") };
    assert_eq!(table.spectra[0].wavelengths_nm, [400.0]);
    assert_eq!(table.spectra[0].geometry, Geometry::mirror(0.5_f64.to_degrees()));
    for key in ["wavelength_unit", "angle_unit", "replicates", "quantity", "percent"] {
        assert!(guess.notes.iter().any(|note| note.key == key && note.certainty == Certainty::Guessed), "{key}");
    }
}

/// What `new` writes: every reason stands above its key, and the whole is a layout again.
#[test]
fn guesses_are_written_with_their_reasons() {
    let tables = [
        "spectrum_id,theta_i,wavelength,R,sd,kept\na,0.5,0.4,0.1,0.01,1\nb,0.5,0.4,0.2,0.01,1\n",
        "ti;to;wavelength;brdf\n10;20;400;0,1\n",
        "theta,peak,sd,order\n15,520,1,1\n",
        "wl,theta15,theta30\n400,20,10\n",
    ];
    for table in tables {
        let (guess, _) = guess(table);
        let text = guess.commented_toml("data").unwrap();
        let job: toml::Table = text.parse().unwrap();
        assert_eq!(job["data"].clone().try_into::<TableLayout>().unwrap(), guess.layout, "{text}");
        for note in &guess.notes {
            assert_eq!(text.matches(&note.text).count(), 1, "{}\n{text}", note.text);
        }
    }
    let (teal, _) = guess("wl,bird-1,bird-2\n400,22.5,20\n405,23,21\n");
    let expected = r#"[data.spectra]
# guess: no name speaks of a BRDF; taken against a white standard
quantity = "reflectance"
# guess: readings go up to 23, which are percent
percent = true
negative = "refuse"
stride = 1
replicates = false

[data.spectra.columns.wide]
# guess: "wl" runs from 400 to 405, step 5
wavelength = "wl"
# FILL IN: the file does not hold the angles of its 2 spectra: where you know them, write { mirror = [15, 30, …] }, the light's inclination for each column with the viewer in the mirror direction, or { four = … }; left as it is, only models that need none can be fitted
angles = "not_recorded"
"#;
    assert_eq!(teal.commented_toml("data").unwrap(), expected);
}

/// What a job's author gets for a slip in the layout: the line, the key and what it may be.
#[test]
fn slips_in_a_layout_name_line_and_key() {
    let quantity = "quantity = \"reflectance\"";
    let cases = [
        (quantity, "quantity = \"colour\"", 3, "expected one of `brdf`, `bsdf_cos`, `reflectance`"),
        (quantity, "quantity = \"reflectance\"\nstep = 5", 4, "unknown field `step`, expected one of"),
        (quantity, "", 2, "missing field `quantity`"),
        ("\"angle\"", "true", 5, "expected a column's name in quotes, or one number for all rows"),
        ("mirror", "mirrored", 5, "unknown variant `mirrored`, expected one of `mirror`, `four`, `not_recorded`"),
    ];
    for (right, wrong, line, text) in cases {
        let found = toml::from_str::<TableLayout>(&LONG.replace(right, wrong)).unwrap_err().to_string();
        assert!(found.contains(&format!("line {line}")) && found.contains(text), "{found}");
    }
}

#[test]
fn a_layout_is_written_as_it_is_read_and_as_its_schema_says() {
    let schema = serde_json::to_value(schemars::schema_for!(TableLayout)).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    for toml in [LONG, FOUR, WIDE, PEAKS] {
        let written = toml::to_string(&layout(toml)).unwrap();
        assert_eq!(layout(&written), layout(toml), "{written}");
        assert!(schema.is_valid(&serde_json::to_value(layout(toml)).unwrap()), "{written}");
    }
    let unknown_key = serde_json::json!({ "peaks": { "angles": { "mirror": 1 }, "wavelength": "w", "colour": 1 } });
    assert!(!schema.is_valid(&unknown_key));
}

/// Reads damaged tables, and their guesses: an error or a table, never a panic, and a table keeps its promises.
fn damage(cases: u64) {
    let tables = [
        (LONG, "angle,wavelength,value\n15,400,0.2\n15,410,0.25\n20,400,0.3\n20,410,0.35\n"),
        (FOUR, "ti,to,po,wavelength,value\n10,20,180,400,0.1\n10,20,180,410,0.2\n"),
        (WIDE, "\"\",\"wl\",\"a\",\"b\"\n\"1\",400,0.1,0.2\n\"2\",410,0.3,0.4\n"),
        (PEAKS, "angle,peak,sigma,order\n15,520,2,1\n20,516,2,1\n"),
    ];
    let layouts: Vec<TableLayout> = tables.iter().map(|(toml, _)| layout(toml)).collect();
    // What damage is made of: whatever has a meaning to some part of the reader.
    let pieces: [&[u8]; 16] = [
        b",",
        b";",
        b"\"",
        b"\n",
        b"\r",
        b"\t",
        b"\0",
        b"\xFF",
        b"\xEF\xBB\xBF",
        b"-",
        b".",
        b"e9",
        b"NaN",
        b"1e999",
        b"9",
        b"0",
    ];
    let (mut read, mut refused) = (0_u64, 0_u64);
    for case in 0..cases {
        let mut random = ChaCha8Rng::seed_from_u64(20_260_101);
        random.set_stream(case);
        let index = random.random_range(0..tables.len());
        let mut bytes = tables[index].1.as_bytes().to_vec();
        for _ in 0..random.random_range(1..4) {
            let (from, to) = (random.random_range(0..=bytes.len()), random.random_range(0..=bytes.len()));
            match random.random_range(0..4) {
                0 => bytes.truncate(from),
                1 => drop(bytes.drain(from.min(to)..from.max(to))),
                2 => drop(bytes.splice(from..from, pieces[random.random_range(0..pieces.len())].iter().copied())),
                _ => {
                    let copy = bytes[from.min(to)..from.max(to)].to_vec();
                    drop(bytes.splice(from..from, copy));
                }
            }
        }
        let text = TableText::from_bytes(Path::new("table.csv"), bytes);
        let guessed = text.clone().and_then(|text| guess_layout(&text)).map(|guess| guess.layout);
        for layout in std::iter::once(layouts[index].clone()).chain(guessed) {
            match text.clone().and_then(|text| read_table(&text, &layout)) {
                Ok(table) => {
                    read += 1;
                    keeps_its_promises(&table);
                }
                Err(error) => {
                    refused += 1;
                    assert!(error.to_string().len() > 40, "no sentence: {error}");
                }
            }
        }
    }
    // Both ways must have been taken, or the damage proves nothing.
    assert!(read > cases / 20 && refused > cases / 20, "{read} read, {refused} refused");
}

fn keeps_its_promises(table: &Table) {
    match table {
        Table::Spectra(table) => {
            assert!(!table.spectra.is_empty());
            for spectrum in &table.spectra {
                assert!(spectrum.wavelengths_nm.windows(2).all(|pair| pair[0] < pair[1]));
                assert!(spectrum.values.iter().all(|value| value.is_finite() && *value >= 0.0));
                assert_eq!(spectrum.wavelengths_nm.len(), spectrum.values.len());
                assert!(!spectrum.values.is_empty());
                assert!((0.0..90.0).contains(&spectrum.geometry.theta_i_deg));
            }
        }
        Table::Peaks(table) => {
            assert!(!table.readings.is_empty());
            for peak in &table.readings {
                assert!((100.0..=3000.0).contains(&peak.wavelength_nm));
                assert!(peak.sigma_nm.is_none_or(|sigma| sigma > 0.0));
            }
        }
    }
}

#[test]
fn damaged_tables_never_panic() {
    damage(2_000);
}

#[test]
#[ignore = "long: run by .ci/long"]
fn a_million_damaged_tables_never_panic() {
    damage(1_000_000);
}
