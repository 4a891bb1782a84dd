//! Tables of plain spectra: no angles, several individuals, several readings of each.

use std::path::Path;

use barbule::measure::{
    GonioTable, PeaksLayout, SpectraLayout, Table, TableError, TableLayout, TableText, guess_layout, read_table,
};

use super::data::data_file;

fn read(text: &str, layout: &str) -> Result<GonioTable, TableError> {
    let layout: SpectraLayout = toml::from_str(layout).unwrap();
    let text = TableText::from_bytes(Path::new("birds.csv"), text.as_bytes().to_vec()).unwrap();
    match read_table(&text, &TableLayout::Spectra(layout))? {
        Table::Spectra(table) => Ok(table),
        Table::Peaks(_) => panic!("holds spectra"),
    }
}

const LONG: &str =
    "quantity = \"reflectance\"\n[columns.long]\nangles = \"not_recorded\"\nwavelength = \"nm\"\nvalue = \"R\"\n";

/// Two birds, two patches, no names of spectra.
const BIRDS: &str = "bird,patch,nm,R\nred,crown,400,0.1\nred,crown,410,0.2\nred,belly,400,0.3\nred,belly,410,0.4\n\
                     blue,crown,400,0.5\nblue,crown,410,0.6\nblue,belly,400,0.7\nblue,belly,410,0.8\n";

#[test]
fn individuals_and_patches_are_told_apart() {
    let table = read(BIRDS, &format!("{LONG}specimen = \"bird\"\ngroup = [\"patch\"]\n")).unwrap();
    let seen: Vec<(&str, &str, &str, f64)> =
        table.spectra.iter().map(|s| (s.id.as_str(), s.specimen(), s.origin.group.as_str(), s.values[1])).collect();
    assert_eq!(
        seen,
        [
            ("crown red", "red", "crown", 0.2),
            ("belly red", "red", "belly", 0.4),
            ("crown blue", "blue", "crown", 0.6),
            ("belly blue", "blue", "belly", 0.8),
        ]
    );
    assert!(table.spectra.iter().all(|spectrum| spectrum.origin.without_geometry));
}

/// Three readings each: the mean, and σ = s/√3 with s pooled over both birds, by hand: at 400 nm the squares are 0.02 and
/// 0.08 over 2 + 2 degrees of freedom.
#[test]
fn readings_of_one_place_become_their_mean_and_its_error() {
    let mut text = "id,nm,R\n".to_owned();
    for (id, values) in [0.4, 0.5, 0.6, 0.1, 0.3, 0.5].iter().enumerate() {
        text += &format!("{id},400,{values}\n{id},410,{}\n", values + 0.01 * (id % 3) as f64);
    }
    let table = read(&text, &format!("average_of = 3\n{LONG}id = \"id\"\n")).unwrap();
    assert_eq!(table.spectra.len(), 2);
    let [first, second] = [&table.spectra[0], &table.spectra[1]];
    assert_eq!((first.id.as_str(), second.specimen()), ("0 to 2", "3 to 5"));
    assert!((first.values[0] - 0.5).abs() < 1e-15 && (second.values[0] - 0.3).abs() < 1e-15);
    let sigma = (0.10_f64 / 4.0 / 3.0).sqrt();
    for spectrum in [first, second] {
        assert!((spectrum.sigmas.as_ref().unwrap()[0] - sigma).abs() < 1e-15);
    }
}

#[test]
fn what_cannot_be_averaged_is_refused() {
    let with = |keys: &str, columns: &str| format!("{keys}{LONG}{columns}");
    let cases = [
        (
            with("average_of = 3\n", "specimen = \"bird\"\ngroup = [\"patch\"]\n"),
            "the 4 spectra that the job keeps are no multiple",
        ),
        (
            with("average_of = 2\n", "specimen = \"bird\"\ngroup = [\"patch\"]\n"),
            "\"crown red\" and \"belly red\" differ",
        ),
        (with("average_of = 1\n", "specimen = \"bird\"\n"), "expected 2 or more"),
        (with("average_of = 2\nsigma = { absolute = 0.1 }\n", "specimen = \"bird\"\n"), "takes σ from the scatter"),
    ];
    for (layout, text) in cases {
        let found = read(BIRDS, &layout).unwrap_err().to_string();
        assert!(found.contains(text), "{found}");
    }
    let copies = "id,nm,R\na,400,0.1\nb,400,0.1\n";
    let found = read(copies, &with("average_of = 2\n", "id = \"id\"\n")).unwrap_err().to_string();
    assert!(found.contains("are they copies of one another?"), "{found}");
    let layout: PeaksLayout = toml::from_str("angles = \"not_recorded\"\nwavelength = \"peak\"\n").unwrap();
    let text = TableText::from_bytes(Path::new("peaks.csv"), b"peak\n500\n".to_vec()).unwrap();
    let found = read_table(&text, &TableLayout::Peaks(layout)).unwrap_err().to_string();
    assert!(found.contains("expected the angles"), "{found}");
}

/// What R writes of a pavo object with several species.
#[test]
fn a_wide_table_is_read_without_angles() {
    let text = "\"\",\"wl\",\"cardinal\",\"cardinal.1\",\"jacana\"\n\"1\",400,10,11,12\n\"2\",401,13,14,15\n";
    let layout =
        "quantity = \"reflectance\"\npercent = true\n[columns.wide]\nwavelength = \"wl\"\nangles = \"not_recorded\"\n";
    let all = read(text, layout).unwrap();
    let names: Vec<&str> = all.spectra.iter().map(|spectrum| spectrum.specimen()).collect();
    assert_eq!(names, ["cardinal", "cardinal.1", "jacana"]);
    let some = read(text, &format!("{layout}starts_with = \"cardinal\"\n")).unwrap();
    assert_eq!(some.spectra, all.spectra[..2]);
    let found = read(text, &format!("{layout}starts_with = \"robin\"\n")).unwrap_err().to_string();
    assert!(
        found
            .contains("no column's name starts with \"robin\"; expected one of these to: cardinal, cardinal.1, jacana")
    );
}

/// The three tables as `new` guesses them: every spectrum of every individual, by hand from their description.
#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn tables_of_birds_are_guessed() {
    for (name, spectra, groups, specimens) in
        [("sicalis_citrina", 21, 3, 7), ("starling_elisabeth", 88, 11, 8), ("pavo_specsdata", 129, 4, 129)]
    {
        let text = TableText::load(&data_file(&format!("spectra/{name}.csv"))).unwrap();
        let Table::Spectra(table) = read_table(&text, &guess_layout(&text).unwrap().layout).unwrap() else {
            panic!("{name} holds spectra")
        };
        let distinct = |of: fn(&barbule::measure::Spectrum) -> &str| {
            let mut names: Vec<&str> = table.spectra.iter().map(of).collect();
            names.sort_unstable();
            names.dedup();
            names.len()
        };
        assert_eq!(
            (table.spectra.len(), distinct(|s| &s.origin.group), distinct(|s| s.specimen())),
            (spectra, groups, specimens),
            "{name}"
        );
        assert!(table.spectra.iter().all(|spectrum| spectrum.values.len() == 401), "{name}");
    }
}
