//! Normal noise, independent from pixel to pixel and from frame to frame.

use photinus_io::image::GreyImage;
use rand_distr::{Distribution, StandardNormal};

use super::chance::Chance;
use super::{repainted, to_grey};

pub(super) fn apply(image: &GreyImage, sigma_dn: f64, frame: &Chance) -> GreyImage {
    let rows = image.pixels().chunks_exact(image.width()).enumerate();
    let noisy = rows.flat_map(|(v, row)| {
        let mut random = frame.row(v);
        row.iter().map(move |&grey| {
            let draw: f64 = StandardNormal.sample(&mut random);
            to_grey(f64::from(grey) + sigma_dn * draw)
        })
    });
    repainted(image, noisy.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_pixels_have_the_sigma_and_no_neighbour_knows_another() {
        let (width, height, grey) = (1000, 1000, 128.0);
        let image = GreyImage::new(vec![128; width * height], width, height).unwrap();
        let noisy = apply(&image, 8.0, &Chance::new(1, 0).of_frame(4));
        let off: Vec<f64> = noisy.pixels().iter().map(|&level| f64::from(level) - grey).collect();
        let count = off.len() as f64;
        let mean = off.iter().sum::<f64>() / count;
        let moment = |power: i32| off.iter().map(|x| x.powi(power)).sum::<f64>() / count;
        // rounding adds 1/12; the variance of a variance is 2 sigma^4 / n
        let variance = 64.0 + 1.0 / 12.0;
        assert!(mean.abs() < 4.0 * (variance / count).sqrt(), "{mean}");
        assert!((moment(2) / variance - 1.0).abs() < 4.0 * (2.0 / count).sqrt(), "{}", moment(2));
        assert!((moment(4) / (variance * variance) - 3.0).abs() < 0.03, "{}", moment(4));
        for step in [1, width] {
            let together = off.iter().zip(&off[step..]).map(|(a, b)| a * b).sum::<f64>() / count / variance;
            assert!(together.abs() < 4.0 / count.sqrt(), "{together} over {step}");
        }
    }
}
