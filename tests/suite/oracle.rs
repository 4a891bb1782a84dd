//! Tables of values from other programs.

/// Rows of an oracle table as columns by name.
pub(super) struct Oracle {
    names: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
}

impl Oracle {
    pub(super) fn read(path: &str) -> Self {
        let mut reader = csv::Reader::from_path(path).unwrap();
        let names = reader.headers().unwrap().iter().map(str::to_owned).collect();
        let rows = reader.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect();
        Self { names, rows }
    }

    pub(super) fn number(&self, row: usize, name: &str) -> f64 {
        self.text(row, name).parse().unwrap()
    }

    pub(super) fn text(&self, row: usize, name: &str) -> &str {
        let column = self.names.iter().position(|known| known == name).unwrap_or_else(|| panic!("no column {name}"));
        &self.rows[row][column]
    }
}
