//! Which spots lie next to which.

use nalgebra::Vector2;

/// The `count` nearest other spots of each spot, nearest first.
pub(super) fn nearest(spots: &[Vector2<f64>], count: usize) -> Vec<Vec<usize>> {
    let of = |i: usize| {
        let mut others: Vec<usize> = (0..spots.len()).filter(|&j| j != i).collect();
        others.sort_by(|&a, &b| {
            let distance = |j: usize| (spots[j] - spots[i]).norm_squared();
            distance(a).total_cmp(&distance(b)).then(a.cmp(&b))
        });
        others.truncate(count);
        others
    };
    (0..spots.len()).map(of).collect()
}

/// The spots in the order of their distance to the median spot.
pub(super) fn from_the_middle(spots: &[Vector2<f64>]) -> Vec<usize> {
    let median = |axis: usize| {
        let mut values: Vec<f64> = spots.iter().map(|spot| spot[axis]).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let middle = Vector2::new(median(0), median(1));
    let mut order: Vec<usize> = (0..spots.len()).collect();
    order.sort_by(|&a, &b| {
        let distance = |i: usize| (spots[i] - middle).norm_squared();
        distance(a).total_cmp(&distance(b)).then(a.cmp(&b))
    });
    order
}
