//! Hot pixels: the same places of the sensor in every frame, each with its own height.

use photinus_io::image::GreyImage;

use super::chance::Chance;
use super::{repainted, to_grey};

/// How far a hot pixel stands up, grey levels.
const LEAST_DN: f64 = 60.0;
const MOST_DN: f64 = 255.0;

pub(super) fn apply(image: &GreyImage, count: usize, chance: &Chance) -> GreyImage {
    let mut pixels = image.pixels().to_vec();
    for index in 0..count as u64 {
        let place = (chance.share(2 * index) * pixels.len() as f64) as usize;
        let height_dn = LEAST_DN + (MOST_DN - LEAST_DN) * chance.share(2 * index + 1);
        pixels[place] = pixels[place].saturating_add(to_grey(height_dn));
    }
    repainted(image, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn so_many_pixels_stand_up_evenly_spread_and_always_the_same() {
        let (width, height, count) = (752, 480, 3000);
        let image = GreyImage::new(vec![0; width * height], width, height).unwrap();
        let chance = Chance::new(5, 1);
        let hot = apply(&image, count, &chance);
        assert_eq!(hot, apply(&image, count, &chance));
        assert_ne!(hot, apply(&image, count, &Chance::new(6, 1)));
        let found: Vec<(usize, u8)> =
            hot.pixels().iter().copied().enumerate().filter(|(_, grey)| *grey > 0).collect();
        // two in one place are one: 3000^2 / 2 / 361 000 = 12
        assert!((2970..=3000).contains(&found.len()), "{}", found.len());
        assert!(found.iter().all(|(_, grey)| f64::from(*grey) >= LEAST_DN));
        let mean = |of: &dyn Fn(&(usize, u8)) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
        let (u, v) = (mean(&|(i, _)| (i % width) as f64), mean(&|(i, _)| (i / width) as f64));
        let standard_error = |span: f64| span / (12.0 * count as f64).sqrt();
        assert!((u - 375.5).abs() < 4.0 * standard_error(752.0), "{u}");
        assert!((v - 239.5).abs() < 4.0 * standard_error(480.0), "{v}");
        assert!((mean(&|(_, grey)| f64::from(*grey)) - 157.5).abs() < 4.0 * standard_error(195.0) + 0.5);
    }
}
