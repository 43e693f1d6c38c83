//! Hot pixels among which a neighbour stands: as dense as they are, they are no reason to doubt what looks like points of light.

use super::*;

const HOT: usize = 30;

/// Single pixels anywhere in the image, as likely clutter by their look as `log_odds` says.
fn lone_pixels(log_odds: f64, rng: &mut Pcg64) -> Vec<Spot> {
    let (u, v) = (Uniform::new(5.0, 747.0).unwrap(), Uniform::new(5.0, 475.0).unwrap());
    let share = Uniform::new(0.2, 1.0).unwrap();
    let mut pixel = || {
        let centre = Pixel::new(f64::round(u.sample(rng)), f64::round(v.sample(rng)));
        let faint = spot(centre, share.sample(rng), 8.0);
        let middle = faint.middle;
        let extent = Extent { left: middle.0, top: middle.1, right: middle.0, bottom: middle.1 };
        Spot { area_px: 1, marker_log_odds: log_odds, extent, ..faint }
    };
    (0..HOT).map(|_| pixel()).collect()
}

/// Mean probability of a lone hexarotor among such pixels, of frames that follow no others; and how many other neighbours are told.
fn among(log_odds: f64) -> (f64, usize) {
    let (airframe, mut rng) = (hexarotor(), Pcg64::new(43, 1));
    let mut locator = locator(&airframe);
    let (yaw, range) = (Uniform::new(0.0, TAU).unwrap(), Uniform::new(3.0, 10.0).unwrap());
    let (mut sum, mut others, frames) = (0.0, 0, 60);
    for _ in 0..frames {
        let placed = Placed::new(
            ahead(range.sample(&mut rng), 0.4 * (yaw.sample(&mut rng) - 3.0) / 3.0, 0.0),
            yaw.sample(&mut rng),
            Vector3::zeros(),
        );
        let own = placed.spots(&airframe, &camera(), &mut rng);
        let count = own.len();
        let mut all = own;
        all.extend(lone_pixels(log_odds, &mut rng));
        locator.forget();
        let located = locator.locate(Input::spots(&all).gravity(Some(&level()))).expect("spots have no size");
        let is_own = |neighbour: &&Neighbour| neighbour.sightings.iter().all(|&spot| spot < count);
        sum += located.neighbours.iter().find(is_own).map_or(0.0, |neighbour| neighbour.probability);
        others += located.neighbours.iter().filter(|neighbour| !is_own(neighbour)).count();
    }
    (sum / f64::from(frames), others)
}

#[test]
fn hot_pixels_tell_nothing_of_what_looks_otherwise() {
    let (hot, phantoms) = among(-6.0);
    let (plain, _) = among(0.0);
    assert!(hot > 0.99, "{hot} among hot pixels");
    assert!(plain < hot - 0.1, "{plain} among points that look like markers, {hot} among hot pixels");
    assert_eq!(phantoms, 0);
}
