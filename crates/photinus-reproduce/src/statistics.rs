//! Numbers about numbers.

/// Root of the mean square; not a number without values.
pub(crate) fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (count, sum) = values.into_iter().fold((0.0, 0.0), |(count, sum), x| (count + 1.0, sum + x * x));
    (sum / count).sqrt()
}

/// Mean; not a number without values.
pub(crate) fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (count, sum) = values.into_iter().fold((0.0, 0.0), |(count, sum), x| (count + 1.0, sum + x));
    sum / count
}

/// Standard deviation of a sample; not a number for fewer than two values.
pub(crate) fn deviation(values: &[f64]) -> f64 {
    let middle = mean(values.iter().copied());
    let squares: f64 = values.iter().map(|x| (x - middle) * (x - middle)).sum();
    (squares / (values.len() as f64 - 1.0)).sqrt()
}

/// Share of cases that hold, 0 to 1; not a number without cases.
pub(crate) fn share(cases: impl IntoIterator<Item = bool>) -> f64 {
    mean(cases.into_iter().map(|holds| if holds { 1.0 } else { 0.0 }))
}

/// The slope of a straight line through points, by least squares; not a number for fewer than two different x.
pub(crate) fn slope(points: &[(f64, f64)]) -> f64 {
    let (x_mean, y_mean) = (mean(points.iter().map(|p| p.0)), mean(points.iter().map(|p| p.1)));
    let products: f64 = points.iter().map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
    products / points.iter().map(|(x, _)| (x - x_mean) * (x - x_mean)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_those_of_a_hand_calculation() {
        assert!((rms([3.0, 4.0]) - 12.5_f64.sqrt()).abs() < 1e-12);
        assert!((deviation(&[1.0, 2.0, 3.0]) - 1.0).abs() < 1e-12);
        assert!((share([true, false, true, true]) - 0.75).abs() < 1e-12);
        assert!((slope(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)]) - 2.0).abs() < 1e-12);
        assert!(rms([]).is_nan() && share([]).is_nan() && deviation(&[1.0]).is_nan());
    }
}
