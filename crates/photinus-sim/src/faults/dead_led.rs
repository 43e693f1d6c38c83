//! An LED that is dead, painted out of frames in which it shone: its surroundings take its place.
//!
//! The disc that is painted reaches half way to the nearest other LED, and as far as an ordinary spot at most: what is left of a
//! large spot's halo stays. Scenes that are simulated do without the LED instead.

use photinus_io::dataset::{TruthFrame, TruthLed};
use photinus_io::image::GreyImage;

use super::{Shot, repainted};

/// The light of a marker, halo included, is within this, px.
const REACH_PX: f64 = 9.0;
/// The surroundings are as wide, px.
const RIM_PX: f64 = 3.0;

/// Paints out LED number `led` of every neighbour and takes it out of the truth.
pub(super) fn paint_out(shot: &mut Shot, led: u32) {
    let Some(truth) = &mut shot.truth else { return };
    let all: Vec<(f64, f64)> = places(truth, |_| true);
    for dead in places(truth, |one| one.led == Some(led)) {
        let apart = |other: &(f64, f64)| libm::hypot(other.0 - dead.0, other.1 - dead.1);
        // LEDs in one place are one spot: painted out, all of them would be dead.
        let nearest_px = all.iter().filter(|other| *other != &dead).map(apart).fold(f64::INFINITY, f64::min);
        shot.frame.image = painted(&shot.frame.image, dead, REACH_PX.min(0.5 * nearest_px));
    }
    for neighbour in &mut truth.neighbours {
        neighbour.leds.retain(|one| one.led != Some(led));
    }
}

fn places(truth: &TruthFrame, of: impl Fn(&TruthLed) -> bool) -> Vec<(f64, f64)> {
    let leds = truth.neighbours.iter().flat_map(|neighbour| &neighbour.leds);
    leds.filter(|led| of(led)).map(|led| (led.u_px, led.v_px)).collect()
}

/// The image with a disc at the median level of the rim around it.
fn painted(image: &GreyImage, (u_px, v_px): (f64, f64), radius_px: f64) -> GreyImage {
    let (width, height) = (image.width(), image.height());
    let outer_px = radius_px + RIM_PX;
    // Saturates: no pixel is left of the image or above it.
    let span =
        |at: f64, side: usize| (at - outer_px).ceil() as usize..((at + outer_px) as usize + 1).min(side);
    let (mut disc, mut rim) = (Vec::new(), Vec::new());
    for v in span(v_px, height) {
        for u in span(u_px, width) {
            let off_px = libm::hypot(u as f64 - u_px, v as f64 - v_px);
            let pixel = v * width + u;
            if off_px <= radius_px {
                disc.push(pixel);
            } else if off_px <= outer_px {
                rim.push(image.pixels()[pixel]);
            }
        }
    }
    rim.sort_unstable();
    let level = rim.get(rim.len() / 2).copied().unwrap_or(0);
    let mut pixels = image.pixels().to_vec();
    disc.into_iter().for_each(|pixel| pixels[pixel] = level);
    repainted(image, pixels)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{shot, truth};
    use super::*;

    #[test]
    fn the_dead_one_is_dark_and_the_others_shine_as_before() {
        let mut pixels = vec![7; 80 * 60];
        for (u, v) in [(20, 30), (21, 30), (26, 30), (60, 40)] {
            pixels[v * 80 + u] = 200;
        }
        let mut shot = shot(0, pixels.clone(), 80, 60);
        shot.truth = Some(truth(0, &[[20.4, 30.0], [26.0, 30.0], [60.0, 40.0]]));
        let before = shot.clone();
        paint_out(&mut shot, 0);
        pixels[30 * 80 + 20] = 7;
        pixels[30 * 80 + 21] = 7;
        assert_eq!(shot.frame.image.pixels(), pixels, "its own two pixels and nothing else");
        let left: Vec<_> =
            shot.truth.as_ref().unwrap().neighbours[0].leds.iter().map(|led| led.led).collect();
        assert_eq!(left, [Some(1), Some(2)]);
        let mut nobody = Shot { truth: None, ..before.clone() };
        paint_out(&mut nobody, 0);
        assert_eq!(nobody.frame, before.frame, "without truth nothing is known");
    }

    #[test]
    fn at_the_edge_of_the_image_nothing_breaks() {
        let mut shot = shot(0, vec![9; 12 * 10], 12, 10);
        shot.truth = Some(truth(0, &[[-0.4, 9.4], [1e12, -1e12]]));
        paint_out(&mut shot, 0);
        paint_out(&mut shot, 1);
        assert!(shot.frame.image.pixels().iter().all(|&grey| grey == 9));
    }
}
