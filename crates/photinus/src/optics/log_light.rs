//! How much light, as spots, locator and poses tell each other.

/// A logarithm of light, and how far its measurement can be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogLight {
    /// Natural logarithm.
    pub value: f64,
    /// Standard deviation of the measurement alone.
    pub sigma: f64,
}
