//! What building a scene found out about its features, as tables: earth moved, gaps left, levels taken.

/// All tables, in the order in which the passes began them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneReport {
    /// No two of one name.
    pub tables: Vec<ReportTable>,
}

/// One table: a row for each feature that it tells of.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportTable {
    /// What its rows are, such as `conformed roads`.
    pub name: &'static str,
    /// What its columns hold.
    pub columns: &'static [ReportColumn],
    /// A cell for each column.
    pub rows: Vec<Vec<ReportCell>>,
}

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReportColumn {
    /// What it says, such as `cut`.
    pub name: &'static str,
    /// Its unit, such as `m3`; empty for names and counts.
    pub unit: &'static str,
}

/// What a row says in a column.
#[derive(Clone, Debug, PartialEq)]
pub enum ReportCell {
    /// A name; may be empty.
    Text(String),
    /// A measure in the column's unit, rounded when it is shown.
    Number(f64),
    /// A count.
    Count(usize),
    /// Nothing to say.
    Empty,
}

impl SceneReport {
    /// Adds a row to the table called `name`, which is begun if it is not there yet.
    ///
    /// # Panics
    /// Where the row has not one cell for each column.
    pub fn add(&mut self, (name, columns): (&'static str, &'static [ReportColumn]), row: Vec<ReportCell>) {
        assert_eq!(row.len(), columns.len(), "a row of '{name}' has a cell for each column");
        match self.tables.iter_mut().find(|table| table.name == name) {
            Some(table) => table.rows.push(row),
            None => self.tables.push(ReportTable { name, columns, rows: vec![row] }),
        }
    }

    /// The table called `name`.
    pub fn table(&self, name: &str) -> Option<&ReportTable> {
        self.tables.iter().find(|table| table.name == name)
    }
}
