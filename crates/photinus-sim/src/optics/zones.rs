//! A measured point spread that is another in every zone of the image.

use super::SampledSpread;

/// Tables of zones that share the image evenly, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct ZonedSpread {
    columns: usize,
    per_px: [f64; 2],
    tables: Vec<SampledSpread>,
}

impl ZonedSpread {
    /// Zones in rows of `columns`, over an image of this width and height, px. `None` unless they fill their rows.
    pub fn new(tables: Vec<SampledSpread>, columns: usize, size_px: [usize; 2]) -> Option<Self> {
        let whole = columns > 0 && !tables.is_empty() && tables.len().is_multiple_of(columns);
        whole.then(|| {
            let counts = [columns, tables.len() / columns];
            let per_px = [0, 1].map(|axis| counts[axis] as f64 / size_px[axis].max(1) as f64);
            Self { columns, per_px, tables }
        })
    }

    /// The table at a place of the image; beside it that of the nearest zone.
    pub fn at(&self, u_px: f64, v_px: f64) -> &SampledSpread {
        let zone = |px: f64, axis: usize, count: usize| {
            let index = ((px + 0.5) * self.per_px[axis]).max(0.0) as usize;
            index.min(count - 1)
        };
        let rows = self.tables.len() / self.columns;
        &self.tables[zone(v_px, 1, rows) * self.columns + zone(u_px, 0, self.columns)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_has_the_table_of_its_zone() {
        let table = |middle: f64| {
            let mut rows = vec![vec![1.0; 5]; 5];
            rows[2][2] = middle;
            SampledSpread::new(1, &rows).unwrap()
        };
        let tables: Vec<SampledSpread> = (1..=6).map(|number| table(f64::from(number))).collect();
        let zones = ZonedSpread::new(tables.clone(), 3, [300, 100]).unwrap();
        for (u, v, index) in
            [(0.0, 0.0, 0), (99.4, 49.4, 0), (99.6, 0.0, 1), (299.0, 60.0, 5), (-9.0, 999.0, 3)]
        {
            assert_eq!(zones.at(u, v), &tables[index], "{u} {v}");
        }
        assert_eq!(ZonedSpread::new(tables, 4, [300, 100]), None);
    }
}
