//! A lamp that is not a marker: a steady spot of light, fixed in the image or beside a neighbour.

use photinus_io::dataset::TruthFrame;
use photinus_io::image::GreyImage;

use super::chance::Chance;
use super::{Shot, repainted, to_grey};

/// Where a lamp stands in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lamp {
    /// Somewhere, the same place in every frame: which one follows from the seed.
    Somewhere,
    /// Here in every frame.
    Fixed {
        /// Column, px.
        u_px: f64,
        /// Row, px.
        v_px: f64,
    },
    /// In the row of an LED of the first neighbour in view, so far to the right of its rightmost one; to the left of the
    /// leftmost one where the image ends.
    Beside {
        /// How far, px.
        gap_px: f64,
    },
}

/// Sigma of the spot, px.
const SIGMA_PX: f64 = 0.7;
/// Its light, grey levels in all: that of a marker some metres away.
const LIGHT_DN: f64 = 700.0;
/// Beyond this nothing is left of it, px.
const REACH_PX: f64 = 5.0;

impl Lamp {
    /// Adds its light to a shot; where it stands beside nobody it is dark.
    pub(super) fn light(self, shot: &mut Shot, chance: &Chance) {
        let image = &shot.frame.image;
        let (width, height) = (image.width() as f64, image.height() as f64);
        let place = match self {
            Self::Somewhere => Some([chance.share(0) * width - 0.5, chance.share(1) * height - 0.5]),
            Self::Fixed { u_px, v_px } => Some([u_px, v_px]),
            Self::Beside { gap_px } => shot.truth.as_ref().and_then(|truth| beside(truth, gap_px, width)),
        };
        if let Some(place) = place {
            shot.frame.image = lit(image, place);
        }
    }
}

fn beside(truth: &TruthFrame, gap_px: f64, width: f64) -> Option<[f64; 2]> {
    let leds = &truth.neighbours.iter().find(|neighbour| !neighbour.leds.is_empty())?.leds;
    let rightmost = leds.iter().max_by(|a, b| a.u_px.total_cmp(&b.u_px))?;
    let leftmost = leds.iter().min_by(|a, b| a.u_px.total_cmp(&b.u_px))?;
    Some(match rightmost.u_px + gap_px + REACH_PX < width {
        true => [rightmost.u_px + gap_px, rightmost.v_px],
        false => [leftmost.u_px - gap_px, leftmost.v_px],
    })
}

/// The image with a spot at a place.
fn lit(image: &GreyImage, [u_px, v_px]: [f64; 2]) -> GreyImage {
    let (width, height) = (image.width(), image.height());
    let mut pixels = image.pixels().to_vec();
    // Saturates: nothing is left of the image or above it, nor below the last row or past the last column.
    let span =
        |at: f64, side: usize| (at - REACH_PX).ceil() as usize..((at + REACH_PX) as usize + 1).min(side);
    for v in span(v_px, height) {
        for u in span(u_px, width) {
            let light_dn = LIGHT_DN * share(u as f64 - u_px) * share(v as f64 - v_px);
            let pixel = &mut pixels[v * width + u];
            *pixel = to_grey(f64::from(*pixel) + light_dn);
        }
    }
    repainted(image, pixels)
}

/// The share of a line of light that falls into a pixel so far away.
fn share(off_px: f64) -> f64 {
    let up_to = |edge_px: f64| 0.5 * libm::erf(edge_px / (SIGMA_PX * core::f64::consts::SQRT_2));
    up_to(off_px + 0.5) - up_to(off_px - 0.5)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{shot, truth};
    use super::*;

    fn centre(image: &GreyImage) -> (f64, [f64; 2]) {
        let (mut light, mut sums) = (0.0, [0.0; 2]);
        for (i, &grey) in image.pixels().iter().enumerate() {
            let grey = f64::from(grey);
            light += grey;
            sums[0] += grey * (i % image.width()) as f64;
            sums[1] += grey * (i / image.width()) as f64;
        }
        (light, sums.map(|sum| sum / light))
    }

    #[test]
    fn its_light_stands_where_it_is_said() {
        let mut dark = shot(0, vec![0; 80 * 60], 80, 60);
        Lamp::Fixed { u_px: 40.3, v_px: 20.8 }.light(&mut dark, &Chance::new(1, 0));
        let (light, [u, v]) = centre(&dark.frame.image);
        assert!((light / LIGHT_DN - 1.0).abs() < 0.01, "{light}");
        assert!((u - 40.3).abs() < 0.02 && (v - 20.8).abs() < 0.02, "{u} {v}");
        let mut at_the_edge = shot(0, vec![0; 80 * 60], 80, 60);
        Lamp::Fixed { u_px: -0.5, v_px: 59.5 }.light(&mut at_the_edge, &Chance::new(1, 0));
        let (quarter, _) = centre(&at_the_edge.frame.image);
        assert!((quarter / LIGHT_DN - 0.25).abs() < 0.01, "{quarter}");
        let mut outside = shot(0, vec![0; 80 * 60], 80, 60);
        Lamp::Fixed { u_px: 1e9, v_px: -1e9 }.light(&mut outside, &Chance::new(1, 0));
        assert!(outside.frame.image.pixels().iter().all(|&grey| grey == 0));
    }

    #[test]
    fn beside_a_neighbour_it_stands_in_the_row_of_its_last_led() {
        let place = |leds: &[[f64; 2]]| {
            let mut shot = shot(0, vec![0; 120 * 60], 120, 60);
            shot.truth = Some(truth(0, leds));
            Lamp::Beside { gap_px: 25.0 }.light(&mut shot, &Chance::new(1, 0));
            let (light, place) = centre(&shot.frame.image);
            (light > 0.0).then(|| place.map(f64::round))
        };
        assert_eq!(place(&[[30.0, 20.0], [50.0, 22.0]]), Some([75.0, 22.0]));
        assert_eq!(place(&[[60.0, 20.0], [100.0, 22.0]]), Some([35.0, 20.0]));
        assert_eq!(place(&[]), None);
    }

    #[test]
    fn somewhere_is_the_same_place_for_a_seed() {
        let place = |seed| {
            let mut shot = shot(seed, vec![0; 80 * 60], 80, 60);
            Lamp::Somewhere.light(&mut shot, &Chance::new(seed, 0));
            shot.frame.image
        };
        assert_eq!(place(1), place(1));
        assert_ne!(place(1), place(2));
    }
}
