//! How much a residual counts.

/// What a residual of length r costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Loss {
    /// Grows like r past this length, px.
    SoftL1(f64),
    /// Grows like ln r past this length, px.
    Cauchy(f64),
}

impl Loss {
    /// The cost of a squared residual, and the weight that makes its square follow the cost.
    pub(crate) fn cost_and_weight(self, squared_px2: f64) -> (f64, f64) {
        match self {
            Self::SoftL1(scale) => {
                let root = (1.0 + squared_px2 / (scale * scale)).sqrt();
                (scale * scale * (root - 1.0), 1.0 / root)
            }
            Self::Cauchy(scale) => {
                let ratio = squared_px2 / (scale * scale);
                (0.5 * scale * scale * libm::log1p(ratio), 1.0 / (1.0 + ratio))
            }
        }
    }
}
