//! Light behind the markers, as the sensor takes it: a coarse grid.

/// Light that changes slowly over the image (sky, ground, glare, dark current): electrons on a coarse grid, linear between.
#[derive(Clone, Debug)]
pub struct Background {
    columns: usize,
    rows: usize,
    electrons: Vec<f32>,
}

impl Background {
    /// Pixels between two nodes of the grid.
    pub const STEP_PX: usize = 16;

    /// A background of nothing for an image of this size.
    pub fn new(width: usize, height: usize) -> Self {
        let nodes = |length: usize| length.div_ceil(Self::STEP_PX) + 1;
        let (columns, rows) = (nodes(width), nodes(height));
        Self { columns, rows, electrons: vec![0.0; columns * rows] }
    }

    /// Sets every node to what `electrons` gives for its column and row in the image.
    pub fn fill(&mut self, mut electrons: impl FnMut(usize, usize) -> f32) {
        for (index, node) in self.electrons.iter_mut().enumerate() {
            let (column, row) = (index % self.columns, index / self.columns);
            *node = electrons(column * Self::STEP_PX, row * Self::STEP_PX);
        }
    }

    /// Adds to every node of a column `share` of what all pixels of that column hold.
    pub(super) fn smear(&mut self, share: f32, height: usize) {
        for column in 0..self.columns {
            let nodes = self.electrons[column..].iter().step_by(self.columns);
            let ends =
                0.5 * (self.electrons[column] + self.electrons[(self.rows - 1) * self.columns + column]);
            let mean = (nodes.sum::<f32>() - ends) / (self.rows - 1) as f32;
            let added = share * mean * height as f32;
            self.electrons[column..].iter_mut().step_by(self.columns).for_each(|node| *node += added);
        }
    }

    /// Number of nodes, in the order of [`Background::fill`].
    pub fn nodes(&self) -> usize {
        self.electrons.len()
    }

    /// Electrons at the nodes' columns, for image row `v`.
    pub(super) fn row(&self, v: usize, onto: &mut Vec<f32>) {
        let above = (v / Self::STEP_PX).min(self.rows - 2);
        let weight = (v - above * Self::STEP_PX) as f32 / Self::STEP_PX as f32;
        let [upper, lower] =
            [above, above + 1].map(|row| &self.electrons[row * self.columns..][..self.columns]);
        onto.clear();
        onto.extend(upper.iter().zip(lower).map(|(a, b)| a + (b - a) * weight));
    }
}
