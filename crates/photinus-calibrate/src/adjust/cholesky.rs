//! A symmetric positive matrix taken apart, in an order of sums that no processor changes.

use nalgebra::{DMatrix, DVector};

/// The lower triangle L of A = L L^T.
#[derive(Clone, Debug)]
pub(crate) struct Cholesky {
    lower: Vec<f64>,
    size: usize,
}

impl Cholesky {
    /// Takes the lower triangle of `a` apart; `None` when it is not positive.
    pub(crate) fn new(a: &DMatrix<f64>) -> Option<Self> {
        let size = a.nrows();
        let mut lower = vec![0.0; size * size]; // by rows
        for i in 0..size {
            for j in 0..=i {
                let dot = dot(&lower[i * size..i * size + j], &lower[j * size..j * size + j]);
                let rest = a[(i, j)] - dot;
                if i == j {
                    if !(rest > 0.0 && rest.is_finite()) {
                        return None;
                    }
                    lower[i * size + i] = rest.sqrt();
                } else {
                    lower[i * size + j] = rest / lower[j * size + j];
                }
            }
        }
        Some(Self { lower, size })
    }

    /// x of A x = b.
    pub(crate) fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        let n = self.size;
        let mut x = b.clone();
        for i in 0..n {
            let done = dot(&self.lower[i * n..i * n + i], &x.as_slice()[..i]);
            x[i] = (x[i] - done) / self.lower[i * n + i];
        }
        for i in (0..n).rev() {
            x[i] /= self.lower[i * n + i];
            let value = x[i];
            for j in 0..i {
                x[j] -= self.lower[i * n + j] * value;
            }
        }
        x
    }

    /// The first `count` rows and columns of the inverse of A.
    pub(crate) fn inverse_block(&self, count: usize) -> DMatrix<f64> {
        let mut block = DMatrix::zeros(count, count);
        for k in 0..count {
            let mut unit = DVector::zeros(self.size);
            unit[k] = 1.0;
            let column = self.solve(&unit);
            for i in 0..count {
                block[(i, k)] = column[i];
            }
        }
        block
    }
}

/// Four sums side by side, added at the end: the order is written here, not chosen by the compiler.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (quads_a, quads_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = quads_a.remainder().iter().zip(quads_b.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in quads_a.zip(quads_b) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_solves_and_inverts_and_refuses() {
        let n = 11;
        let a =
            DMatrix::from_fn(n, n, |i, j| 1.0 / (1.0 + i as f64 + j as f64) + if i == j { 2.0 } else { 0.0 });
        let x = DVector::from_fn(n, |i, _| i as f64 - 3.0);
        let cholesky = Cholesky::new(&a).unwrap();
        assert!((cholesky.solve(&(&a * &x)) - &x).norm() < 1e-12);
        let inverse = a.clone().try_inverse().unwrap();
        assert!((cholesky.inverse_block(4) - inverse.view((0, 0), (4, 4))).norm() < 1e-12);
        assert!(Cholesky::new(&(a - DMatrix::identity(n, n) * 5.0)).is_none());
    }
}
