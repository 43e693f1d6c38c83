//! A driver that mirrors the image: left and right are exchanged, the camera's file is not.

use photinus_io::image::GreyImage;

use super::repainted;

pub(super) fn apply(image: &GreyImage) -> GreyImage {
    let rows = image.pixels().chunks_exact(image.width());
    repainted(image, rows.flat_map(|row| row.iter().rev().copied()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_reversed_and_twice_is_nothing() {
        let image = GreyImage::new(vec![1, 2, 3, 4, 5, 6], 3, 2).unwrap();
        assert_eq!(apply(&image).pixels(), [3, 2, 1, 6, 5, 4]);
        assert_eq!(apply(&apply(&image)), image);
    }
}
