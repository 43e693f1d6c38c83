//! A gain that is not what it was: every grey level times a factor.

use photinus_io::image::GreyImage;

use super::{repainted, to_grey};

pub(super) fn apply(image: &GreyImage, factor: f64) -> GreyImage {
    repainted(image, image.pixels().iter().map(|&grey| to_grey(factor * f64::from(grey))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_scaled_and_rounded_and_stop_at_the_ends() {
        let image = GreyImage::new(vec![0, 1, 3, 100, 200, 255], 3, 2).unwrap();
        assert_eq!(apply(&image, 0.5).pixels(), [0, 1, 2, 50, 100, 128]);
        assert_eq!(apply(&image, 1.5).pixels(), [0, 2, 5, 150, 255, 255]);
    }
}
