//! Markers close to one another, of different brightness, and many of them.

use photinus::camera::Pixel;
use photinus::frame::FrameView;
use photinus::optics::PointSpread;
use photinus::spots::{Brightness, Detector, Settings};
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64;

use crate::scene::{RULES, Scene, distance_px, spot_at};

/// What was found of pairs.
#[derive(Default)]
struct Pairs {
    scenes: u32,
    both: u32,
    extra: u32,
    squares: f64,
    worst_px: f64,
    beyond: u32,
}

impl Pairs {
    fn rms_px(&self) -> f64 {
        (self.squares / f64::from(2 * self.both)).sqrt()
    }

    /// Share of centres off by more than three of their sigmas.
    fn beyond_three_sigma(&self) -> f64 {
        f64::from(self.beyond) / f64::from(2 * self.both)
    }
}

fn pairs(apart_px: f64, width_px: f64, heights: [f64; 2], noise: f64, rule: Brightness) -> Pairs {
    let mut rng = Pcg64::new(11, 3);
    let phase = Uniform::new(-0.5, 0.5).unwrap();
    let direction = Uniform::new(0.0, std::f64::consts::TAU).unwrap();
    let mut result = Pairs::default();
    for _ in 0..150 {
        let mut scene = Scene::flat(48, 48, 8.0);
        let first = Pixel::new(23.0 + phase.sample(&mut rng), 23.0 + phase.sample(&mut rng));
        let (sin, cos) = libm::sincos(direction.sample(&mut rng));
        let second = Pixel::new(first.u + apart_px * cos, first.v + apart_px * sin);
        scene.marker(first, width_px, heights[0]);
        scene.marker(second, width_px, heights[1]);
        let found = scene.detect(&scene.noisy(noise, &mut rng), rule);
        result.scenes += 1;
        result.extra += found.spots.len().saturating_sub(2) as u32;
        let near = |place: Pixel| {
            found.spots.iter().find(|spot| distance_px(spot.centre, place) < apart_px / 2.0).map(|spot| {
                let error = distance_px(spot.centre, place);
                (error, error > 3.0 * spot.sigma_px() * std::f64::consts::SQRT_2)
            })
        };
        if let (Some(a), Some(b)) = (near(first), near(second)) {
            result.both += 1;
            for (error, beyond) in [a, b] {
                result.squares += error * error;
                result.worst_px = result.worst_px.max(error);
                result.beyond += u32::from(beyond);
            }
        }
    }
    println!(
        "{apart_px} px apart, sigma {width_px}, heights {heights:?}, noise {noise}: both in {}/{}, {} extra, rms {:.3} px, worst {:.3} px, {} beyond 3 sigma",
        result.both,
        result.scenes,
        result.extra,
        result.rms_px(),
        result.worst_px,
        result.beyond,
    );
    result
}

/// The point spread of such markers: the scene takes the light in the middle of a pixel for that of the pixel.
pub(crate) fn spread(width_px: f64) -> PointSpread {
    let place = |at: usize| at as f64 / PointSpread::SAMPLES_PER_PX as f64 - PointSpread::REACH_PX as f64;
    let share = |index: usize| {
        let (x, y) = (place(index % PointSpread::SIDE), place(index / PointSpread::SIDE));
        libm::exp(-(x * x + y * y) / (2.0 * width_px * width_px))
    };
    PointSpread::new((0..PointSpread::SIDE * PointSpread::SIDE).map(share).collect()).unwrap()
}

#[test]
fn pairs_as_far_apart_as_a_point_spread_resolves_are_told_apart_half_of_the_time() {
    for width_px in [1.0, 1.3, 1.6] {
        let resolution_px = spread(width_px).resolution_px();
        let told = |times: f64| pairs(times * resolution_px, width_px, [220.0, 220.0], 1.0, RULES[1]).both;
        let [nearer, farther] = [0.85, 1.2].map(told);
        assert!(nearer < 40 && farther > 110, "{nearer} and {farther} of 150 about {resolution_px} px");
    }
}

/// Measured: all pairs up to a width of 0.7 px; wider ones, whose light overlaps more, are lost first when one is fainter.
#[test]
fn two_markers_three_pixels_apart_are_two_spots() {
    for (width, heights, both, rms_px) in [
        (0.5, [220.0, 220.0], 150, 0.071),
        (0.5, [180.0, 120.0], 150, 0.073),
        (0.7, [220.0, 220.0], 150, 0.058),
        (0.7, [180.0, 120.0], 150, 0.075),
        (0.85, [220.0, 220.0], 150, 0.112),
        (0.85, [180.0, 120.0], 144, 0.141),
        (1.0, [220.0, 220.0], 144, 0.078),
        (1.0, [180.0, 120.0], 106, 0.159),
    ] {
        let result = pairs(3.0, width, heights, 1.0, RULES[1]);
        let what = format!("width {width} {heights:?}");
        assert!(
            result.both.abs_diff(both) <= 8 && result.extra == 0,
            "{what}: {} pairs, {} extra",
            result.both,
            result.extra
        );
        assert!((result.rms_px() / rms_px - 1.0).abs() < 0.2, "{what}: {} px", result.rms_px());
        assert!(result.beyond_three_sigma() < 0.01, "{what}: {} beyond", result.beyond_three_sigma());
    }
}

/// Far away no marker stands alone. Of any lens a halo is believed to hold a tenth of the light, here it is half: what it puts beside the others would draw
/// them together.
#[test]
fn markers_none_of_which_stands_alone_tell_their_point_spread() {
    for count in [2_u32, 3] {
        let mut rng = Pcg64::new(29, u128::from(count));
        let phase = Uniform::new(-0.5, 0.5).unwrap();
        let direction = Uniform::new(0.0, std::f64::consts::TAU).unwrap();
        let mut settings = Settings::default();
        settings.brightness = RULES[1];
        let mut detector = Detector::new(settings).unwrap();
        let (mut squares, mut towards_px, mut told) = (0.0, 0.0, 0.0);
        for frame in 0..60 {
            let mut scene = Scene::flat(48, 48, 8.0);
            let middle = Pixel::new(24.0 + phase.sample(&mut rng), 24.0 + phase.sample(&mut rng));
            let turned = direction.sample(&mut rng);
            let places = (0..count).map(|marker| {
                let (sin, cos) =
                    libm::sincos(turned + std::f64::consts::TAU * f64::from(marker) / f64::from(count));
                Pixel::new(middle.u + 3.2 * cos, middle.v + 3.2 * sin)
            });
            let places: Vec<Pixel> = places.collect();
            for (place, light) in places.iter().zip([1.0, 0.6, 0.4]) {
                scene.marker(*place, 0.6, 180.0 * light);
                scene.marker(*place, 2.0, 16.0 * light);
            }
            let pixels = scene.noisy(0.6, &mut rng);
            let found = detector.detect(&FrameView::packed(&pixels, 48, 48).unwrap(), None).unwrap();
            for place in places.iter().filter(|_| frame >= 20) {
                let spot = spot_at(found, *place, 1.5);
                let off = [spot.centre.u - place.u, spot.centre.v - place.v];
                let inward = [middle.u - place.u, middle.v - place.v];
                squares += (off[0] * off[0] + off[1] * off[1]) / 2.0;
                towards_px += (off[0] * inward[0] + off[1] * inward[1]) / 3.2;
                told += 1.0;
            }
        }
        let (rms_px, towards_px) = (libm::sqrt(squares / told), towards_px / told);
        println!("{count} markers: rms {rms_px:.4} px, drawn together by {towards_px:+.4} px");
        assert!(rms_px < 0.02 && towards_px.abs() < 0.02, "{count}: {rms_px} px, {towards_px} px");
    }
}

#[test]
fn two_saturated_markers_with_a_gap_are_two_spots() {
    for (apart, width, height) in
        [(3.0, 0.6, 400.0), (4.0, 0.8, 400.0), (5.0, 1.0, 600.0), (9.0, 1.5, 2000.0)]
    {
        let result = pairs(apart, width, [height, height], 1.0, RULES[1]);
        assert_eq!((result.both, result.extra), (result.scenes, 0));
        assert!(result.worst_px < 0.15 && result.beyond_three_sigma() < 0.02, "{} px", result.worst_px);
    }
}

/// The default takes what is fainter than 0.22 of the brightest for a reflection: 60 levels beside 245 are at that limit.
#[test]
fn a_faint_marker_is_found_beside_saturated_ones() {
    let mut rng = Pcg64::new(5, 9);
    let phase = Uniform::new(-0.5, 0.5).unwrap();
    for level in [10.0, 120.0] {
        let mut worst_px = 0.0_f64;
        for _ in 0..40 {
            let mut scene = Scene::flat(100, 80, level);
            let place = Pixel::new(50.0 + phase.sample(&mut rng), 40.0 + phase.sample(&mut rng));
            scene.marker(place, 1.2, 75.0);
            let bright =
                [(20.0, 40.0, 300.0), (80.0, 40.0, 600.0), (62.0, 40.0, 2000.0), (50.0, 60.0, 5000.0)];
            for (u, v, height) in bright {
                scene.marker(Pixel::new(u, v), 1.2, height);
            }
            let found = scene.detect(&scene.noisy(1.0, &mut rng), RULES[1]);
            assert_eq!((found.spots.len(), found.rejected.len()), (5, 0), "level {level}: {found:?}");
            let spot = spot_at(&found, place, 1.0);
            worst_px = worst_px.max(distance_px(spot.centre, place));
        }
        println!("75 above {level}: worst {worst_px:.3} px");
        assert!(worst_px < 0.25, "level {level}: {worst_px}");
    }
}
