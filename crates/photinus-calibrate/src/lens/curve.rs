//! The curve between the angle off the axis and the radius, in units of the lens's scale.

use nalgebra::{DMatrix, DVector};

use super::{LensModel, MOST_RADIAL};

/// A model with its numbers.
pub(super) struct Curve<'a> {
    pub(super) model: LensModel,
    pub(super) numbers: &'a [f64],
}

/// The curve at an angle.
pub(super) struct AtAngle {
    pub(super) radius: f64,
    /// d radius / d angle.
    pub(super) slope: f64,
    /// d radius / d number.
    pub(super) by_numbers: [f64; MOST_RADIAL],
}

impl Curve<'_> {
    /// The curve at the angle with this sine and cosine.
    pub(super) fn at(&self, sin: f64, cos: f64) -> Option<AtAngle> {
        match self.model.ocam_degree() {
            None => Some(self.kannala_brandt(libm::atan2(sin, cos))),
            Some(degree) => self.ocam(degree, sin, cos),
        }
    }

    fn kannala_brandt(&self, angle: f64) -> AtAngle {
        let squared = angle * angle;
        let focal = self.numbers[0];
        let (mut sum, mut slope, mut power) = (1.0, 1.0, 1.0);
        let mut by_numbers = [0.0; MOST_RADIAL];
        for (k, by) in by_numbers.iter_mut().enumerate().take(self.model.radial()).skip(1) {
            power *= squared;
            sum += self.numbers[k] * power;
            slope += (2 * k + 1) as f64 * self.numbers[k] * power;
            *by = focal * angle * power;
        }
        by_numbers[0] = angle * sum;
        AtAngle { radius: focal * angle * sum, slope: focal * slope, by_numbers }
    }

    /// The radius r where sin g(r) = cos r, with g = -z of OCamCalib, by Newton's method from the equidistant lens.
    fn ocam(&self, degree: usize, sin: f64, cos: f64) -> Option<AtAngle> {
        let focal = self.numbers[0];
        let mut radius = focal * libm::atan2(sin, cos);
        for _ in 0..40 {
            let (height, height_slope) = self.height(degree, radius);
            let step = (sin * height - cos * radius) / (sin * height_slope - cos);
            radius -= step;
            if radius.is_nan() || radius.abs() >= 1e3 {
                return None;
            }
            if step.abs() <= 1e-13 * (1.0 + radius.abs()) {
                return self.ocam_found(degree, sin, cos, radius);
            }
        }
        None
    }

    fn ocam_found(&self, degree: usize, sin: f64, cos: f64, radius: f64) -> Option<AtAngle> {
        let (height, height_slope) = self.height(degree, radius);
        let steepness = sin * height_slope - cos;
        // the angle grows with the radius where this is negative
        if radius < -1e-9 || steepness >= 0.0 {
            return None;
        }
        let mut by_numbers = [0.0; MOST_RADIAL];
        let mut power = radius;
        by_numbers[0] = -sin / steepness;
        for by in by_numbers.iter_mut().take(degree).skip(1) {
            power *= radius;
            *by = -sin * power / steepness;
        }
        Some(AtAngle { radius, slope: -(cos * height + sin * radius) / steepness, by_numbers })
    }

    /// g and its slope at a radius.
    fn height(&self, degree: usize, radius: f64) -> (f64, f64) {
        let (mut value, mut slope) = (0.0, 0.0);
        for k in (0..=degree).rev() {
            let number = match k {
                0 => self.numbers[0],
                1 => 0.0,
                _ => self.numbers[k - 1],
            };
            slope = slope * radius + value;
            value = value * radius + number;
        }
        (value, slope)
    }
}

/// The numbers of `model` that follow `curve` best out to `reach_rad`; those past the model's are 0.
pub(super) fn fitted(model: LensModel, curve: &Curve<'_>, reach_rad: f64) -> [f64; MOST_RADIAL] {
    let mut numbers = [0.0; MOST_RADIAL];
    if model == curve.model {
        numbers.copy_from_slice(&curve.numbers[..MOST_RADIAL]);
        return numbers;
    }
    const STEPS: usize = 120;
    let columns = model.radial();
    let mut normal = DMatrix::<f64>::zeros(columns, columns);
    let mut right = DVector::<f64>::zeros(columns);
    for i in 1..=STEPS {
        let angle = reach_rad * i as f64 / STEPS as f64;
        let (sin, cos) = libm::sincos(angle);
        let Some(at) = curve.at(sin, cos) else { break };
        // Kannala-Brandt: radius = f a + (f k1) a^3 + ...; OCam: sin (b0 + b2 r^2 + ...) = cos r, in units of angle
        let (row, value): (Vec<f64>, f64) = match model.ocam_degree() {
            None => ((0..columns).map(|k| libm::pow(angle, (2 * k + 1) as f64)).collect(), at.radius),
            Some(_) => {
                let power = |k: usize| if k == 0 { 0 } else { k + 1 };
                let weight = sin / at.radius;
                let row =
                    (0..columns).map(|k| weight * sin * libm::pow(at.radius, power(k) as f64)).collect();
                (row, weight * cos * at.radius)
            }
        };
        for a in 0..columns {
            right[a] += row[a] * value;
            for b in 0..columns {
                normal[(a, b)] += row[a] * row[b];
            }
        }
    }
    for k in 0..columns {
        normal[(k, k)] *= 1.0 + 1e-12;
    }
    if let Some(found) = normal.cholesky().map(|cholesky| cholesky.solve(&right)) {
        let focal = if model.ocam_degree().is_none() { found[0] } else { 1.0 };
        for k in 0..columns {
            numbers[k] = if k == 0 { found[0] } else { found[k] / focal };
        }
    } else {
        numbers[0] = curve.numbers[0];
    }
    numbers
}
