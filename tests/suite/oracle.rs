//! Tables of values from other programs.

/// Rows of an oracle table as columns by name.
pub(super) struct Oracle {
    names: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
}

impl Oracle {
    pub(super) fn read(path: &str) -> Self {
        let mut reader = csv::Reader::from_path(path).expect("the table is there");
        let names = reader.headers().expect("the table has names").iter().map(str::to_owned).collect();
        let rows =
            reader.records().map(|row| row.expect("the row is text").iter().map(str::to_owned).collect()).collect();
        Self { names, rows }
    }

    pub(super) fn number(&self, row: usize, name: &str) -> f64 {
        self.text(row, name).parse().expect("the value is a number")
    }

    pub(super) fn text(&self, row: usize, name: &str) -> &str {
        let column = self.names.iter().position(|known| known == name).unwrap_or_else(|| panic!("no column {name}"));
        &self.rows[row][column]
    }
}
