//! Symmetric positive definite systems, with sums in a written order.

/// A lower triangle L with L L^T the matrix it was made from, line by line.
pub(super) struct Cholesky {
    size: usize,
    lower: Vec<f64>,
}

impl Cholesky {
    /// Factors a matrix of `size` lines; `None` where it is not positive definite.
    pub(super) fn new(size: usize, matrix: &[f64]) -> Option<Self> {
        let mut lower = vec![0.0; size * size];
        for i in 0..size {
            for j in 0..=i {
                let mut sum = matrix[i * size + j];
                for k in 0..j {
                    sum -= lower[i * size + k] * lower[j * size + k];
                }
                if i == j {
                    // What rounding leaves of a zero is no information.
                    if sum <= 1e-12 * matrix[i * size + i].max(1e-300) {
                        return None;
                    }
                    lower[i * size + i] = libm::sqrt(sum);
                } else {
                    lower[i * size + j] = sum / lower[j * size + j];
                }
            }
        }
        Some(Self { size, lower })
    }

    /// Solves for one right side, in its place.
    pub(super) fn solve(&self, right: &mut [f64]) {
        let n = self.size;
        for i in 0..n {
            for k in 0..i {
                right[i] -= self.lower[i * n + k] * right[k];
            }
            right[i] /= self.lower[i * n + i];
        }
        for i in (0..n).rev() {
            for k in i + 1..n {
                right[i] -= self.lower[k * n + i] * right[k];
            }
            right[i] /= self.lower[i * n + i];
        }
    }

    /// A column of the inverse.
    pub(super) fn inverse_column(&self, column: usize) -> Vec<f64> {
        let mut right = vec![0.0; self.size];
        right[column] = 1.0;
        self.solve(&mut right);
        right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_inverts() {
        let matrix = [4.0, 1.0, 0.5, 1.0, 3.0, -1.0, 0.5, -1.0, 2.0];
        let factored = Cholesky::new(3, &matrix).unwrap();
        for column in 0..3 {
            let x = factored.inverse_column(column);
            for line in 0..3 {
                let product: f64 = (0..3).map(|k| matrix[line * 3 + k] * x[k]).sum();
                assert!((product - f64::from(u8::from(line == column))).abs() < 1e-12);
            }
        }
        assert!(Cholesky::new(2, &[1.0, 1.0, 1.0, 1.0]).is_none());
    }
}
