//! Charge per pixel: a full frame in memory, of which only the touched part of each row is ever looked at.

/// Electrons in the pixels of a frame.
#[derive(Clone, Debug)]
pub struct Charge {
    width: usize,
    electrons: Vec<f32>,
    touched: Vec<(usize, usize)>,
}

const UNTOUCHED: (usize, usize) = (usize::MAX, 0);

impl Charge {
    /// A frame without charge.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, electrons: vec![0.0; width * height], touched: vec![UNTOUCHED; height] }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.touched.len()
    }

    /// A row, from its first column to its last.
    pub fn row(&self, v: usize) -> &[f32] {
        &self.electrons[v * self.width..][..self.width]
    }

    /// First column of row `v` that may hold charge and the one past the last; `None` for a dark row.
    pub fn touched(&self, v: usize) -> Option<(usize, usize)> {
        Some(self.touched[v]).filter(|(first, end)| first < end)
    }

    /// Adds `amount` times `shares` to the pixels of row `v` from column `first` on.
    pub fn add_row(&mut self, v: usize, first: usize, shares: &[f32], amount: f32) {
        let end = first + shares.len();
        let row = &mut self.electrons[v * self.width + first..v * self.width + end];
        row.iter_mut().zip(shares).for_each(|(pixel, share)| *pixel += amount * share);
        self.touch(v, first, end);
    }

    /// Adds to one pixel and gives what it holds then.
    pub fn add(&mut self, u: usize, v: usize, electrons: f32) -> f32 {
        self.touch(v, u, u + 1);
        let pixel = &mut self.electrons[v * self.width + u];
        *pixel += electrons;
        *pixel
    }

    /// The touched part of a row, with its first column.
    pub fn touched_row_mut(&mut self, v: usize) -> Option<(usize, &mut [f32])> {
        let (first, end) = self.touched(v)?;
        Some((first, &mut self.electrons[v * self.width + first..v * self.width + end]))
    }

    /// What a pixel holds.
    pub fn at(&self, u: usize, v: usize) -> f32 {
        self.electrons[v * self.width + u]
    }

    /// All charge, electrons.
    pub fn total(&self) -> f64 {
        let row =
            |v| self.touched(v).map_or(0.0, |(a, b)| self.row(v)[a..b].iter().map(|&e| f64::from(e)).sum());
        (0..self.height()).map(row).sum()
    }

    /// Removes all charge.
    pub fn clear(&mut self) {
        for v in 0..self.height() {
            if let Some((_, pixels)) = self.touched_row_mut(v) {
                pixels.fill(0.0);
            }
            self.touched[v] = UNTOUCHED;
        }
    }

    fn touch(&mut self, v: usize, first: usize, end: usize) {
        if first < end {
            let (old_first, old_end) = self.touched[v];
            self.touched[v] = (old_first.min(first), old_end.max(end));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_touched_pixels_are_cleared_and_counted() {
        let mut charge = Charge::new(8, 4);
        assert_eq!(charge.touched(1), None);
        charge.add_row(1, 2, &[0.25, 0.75], 8.0);
        assert!((charge.add(6, 1, 5.0) - 5.0).abs() < 1e-6);
        assert_eq!(charge.touched(1), Some((2, 7)));
        assert_eq!(charge.row(1), [0.0, 0.0, 2.0, 6.0, 0.0, 0.0, 5.0, 0.0]);
        assert!((charge.total() - 13.0).abs() < 1e-6);
        charge.clear();
        assert_eq!((charge.touched(1), charge.row(1)), (None, &[0.0; 8][..]));
        charge.add_row(0, 3, &[], 1.0);
        assert_eq!(charge.touched(0), None);
    }
}
