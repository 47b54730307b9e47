use std::fmt;

/// A table of texts, whose columns are as wide as their widest cell.
pub(in crate::command) struct Table {
    rows: Vec<Vec<String>>,
    /// The columns whose cells stand at their right.
    numbers: Vec<usize>,
}

impl Table {
    pub(in crate::command) fn new(head: &[&str]) -> Table {
        Table { rows: vec![head.iter().map(|&cell| cell.to_owned()).collect()], numbers: Vec::new() }
    }

    /// The same table with numbers in these columns.
    pub(in crate::command) fn with_numbers(self, numbers: impl IntoIterator<Item = usize>) -> Table {
        Table { numbers: numbers.into_iter().collect(), ..self }
    }

    pub(in crate::command) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }
}

impl fmt::Display for Table {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width =
            |column: usize| self.rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
        let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
        for row in &self.rows {
            let cells = row.iter().zip(&widths).enumerate();
            let cells = cells.map(|(column, (cell, width))| match self.numbers.contains(&column) {
                true => format!("{cell:>width$}"),
                false => format!("{cell:width$}"),
            });
            writeln!(formatter, "{}", cells.collect::<Vec<_>>().join("  ").trim_end())?;
        }
        Ok(())
    }
}
