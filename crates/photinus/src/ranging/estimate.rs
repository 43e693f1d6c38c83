//! A distance that is an estimate, not a bound.

/// A distance and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Camera's centre to airframe's origin, m.
    pub distance_m: f64,
    /// One standard deviation, m.
    pub sigma_m: f64,
}
