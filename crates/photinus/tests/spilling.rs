//! Centres and light of spots whose charge spills, before a detector that knows nothing of the camera.
//!
//! Gaussian spots narrower than a pixel, integrated over pixels by the error function, with as much light as LEDs at 2 to 10 m; charge above a
//! full well goes to the four neighbours but for what is drained, until no pixel has more. Checked: errors over what is claimed of them.

#![allow(clippy::print_stdout, reason = "the measured numbers are worth reading")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use photinus::camera::Pixel;
use photinus::frame::FrameView;
use photinus::spots::{Detector, Settings};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

const SIDE: usize = 160;
const SPACING: usize = 40;
const DARK_DN: f64 = 6.0;
/// Frames to learn from, and those that count.
const LEARNT: usize = 60;
const COUNTED: usize = 100;

/// A camera whose full pixels give on what is too much.
#[derive(Clone, Copy, Debug)]
struct Camera {
    sigma_px: f64,
    well_dn: f64,
    spill: f64,
    /// How much more goes to the pixels above and below than to those beside, as a share of the mean.
    along_columns: f64,
    spots: usize,
    brightest: f64,
    /// Radius of what shines, px: of a disc that is brighter on one side, or 0 of a point.
    disc_px: f64,
}

impl Camera {
    /// Where what shines does, from the centroid of its light, px, and which share of it.
    fn sources(&self) -> Vec<([f64; 2], f64)> {
        if self.disc_px == 0.0 {
            return vec![([0.0; 2], 1.0)];
        }
        let grid = || (-4..=4).map(|step| 0.25 * f64::from(step));
        let places = grid().flat_map(|u| grid().map(move |v| [u, v]));
        let in_disc: Vec<[f64; 2]> = places.filter(|[u, v]| u * u + v * v <= 1.0).collect();
        let weight = |[u, v]: [f64; 2]| 1.0 + 0.6 * u + 0.3 * v;
        let all: f64 = in_disc.iter().copied().map(weight).sum();
        let middle = |axis: usize| in_disc.iter().map(|&at| at[axis] * weight(at)).sum::<f64>() / all;
        let middle = [middle(0), middle(1)];
        let source = |at: [f64; 2]| {
            (std::array::from_fn(|axis| self.disc_px * (at[axis] - middle[axis])), weight(at) / all)
        };
        in_disc.into_iter().map(source).collect()
    }

    /// Charge of a frame with these spots: place and light.
    fn charge(&self, spots: &[(Pixel, f64)]) -> Vec<f64> {
        let mut charge = vec![0.0; SIDE * SIDE];
        let below = |edge: f64| 0.5 * libm::erfc(-edge / (self.sigma_px * std::f64::consts::SQRT_2));
        let within = |from_px: f64| below(from_px + 0.5) - below(from_px - 0.5);
        let sources = self.sources();
        let reach = |from: f64| (from as usize).saturating_sub(9)..(from as usize + 11).min(SIDE);
        for ((centre, light), ([aside, down], share)) in
            spots.iter().flat_map(|spot| sources.iter().map(move |source| (spot, source)))
        {
            let (u, v) = (centre.u + aside, centre.v + down);
            let columns: Vec<f64> = reach(u).map(|column| within(column as f64 - u)).collect();
            for row in reach(v) {
                let in_row = light * share * within(row as f64 - v);
                for (column, part) in reach(u).zip(&columns) {
                    charge[row * SIDE + column] += in_row * part;
                }
            }
        }
        charge
    }

    /// Gives on what is above a full well, pixel by pixel, until none is.
    fn overflow(&self, charge: &mut [f64]) {
        let well = self.well_dn - DARK_DN;
        loop {
            let full: Vec<usize> = (0..charge.len()).filter(|&at| charge[at] > well + 0.1).collect();
            if full.is_empty() {
                return;
            }
            for at in full {
                let part = 0.25 * self.spill * (charge[at] - well);
                charge[at] = well;
                for (beside, share) in [(1, 1.0 - self.along_columns), (SIDE, 1.0 + self.along_columns)] {
                    charge[at - beside] += share * part;
                    charge[at + beside] += share * part;
                }
            }
        }
    }
}

/// Squared errors over variances of centres and of the logarithm of light, of spots with full pixels.
struct Claims {
    centres: f64,
    lights: f64,
    rms_px: f64,
    share_told: f64,
}

fn claims(camera: Camera, seed: u64) -> Claims {
    let mut rng = Pcg64::new(seed.into(), 0x5b11);
    let (off, even) = (Uniform::new(-3.0, 3.0).unwrap(), Uniform::new(0.0, 1.0).unwrap());
    let mut detector = Detector::new(Settings::default()).unwrap();
    let (mut count, mut told, mut all) = (0.0, 0.0, 0.0);
    let (mut centres, mut lights, mut squares) = (0.0, 0.0, 0.0);
    for number in 0..LEARNT + COUNTED {
        let spots: Vec<(Pixel, f64)> = (0..camera.spots)
            .map(|spot| {
                let place = |at: usize| (at * SPACING + SPACING / 2) as f64;
                let (u, v) = (place(spot % 4) + off.sample(&mut rng), place(spot / 4) + off.sample(&mut rng));
                let farther = 1.0 + 4.0 * even.sample(&mut rng);
                (Pixel::new(u, v), camera.brightest / (farther * farther))
            })
            .collect();
        let mut charge = camera.charge(&spots);
        let quantum = 1.0 / 40.0;
        for charge in &mut charge {
            let noise: f64 = StandardNormal.sample(&mut rng);
            *charge += noise * (*charge * quantum).sqrt();
        }
        camera.overflow(&mut charge);
        let mut value = |charge: f64| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            (DARK_DN + charge + 0.6 * noise).round().clamp(0.0, 255.0) as u8
        };
        let pixels: Vec<u8> = charge.into_iter().map(&mut value).collect();
        let frame = FrameView::packed(&pixels, SIDE, SIDE).unwrap();
        let found = detector.detect(&frame, None).unwrap();
        for &(centre, light) in spots.iter().filter(|_| number >= LEARNT) {
            let near = |spot: &&photinus::spots::Spot| {
                libm::hypot(spot.centre.u - centre.u, spot.centre.v - centre.v) < 3.0
            };
            let Some(spot) = found.spots.iter().find(near) else { continue };
            if f64::from(spot.peak) < camera.well_dn.min(255.0) - 3.0 {
                continue;
            }
            all += 1.0;
            for (error, axis) in [(spot.centre.u - centre.u, 0), (spot.centre.v - centre.v, 1)] {
                centres += error * error / spot.covariance_px2[(axis, axis)];
                squares += error * error;
                count += 1.0;
            }
            if let Some(measured) = spot.light {
                lights += (libm::log(measured.value / light) * measured.value / measured.sigma).powi(2);
                told += 1.0;
            }
        }
    }
    let claims = Claims {
        centres: centres / count,
        lights: lights / told,
        rms_px: libm::sqrt(squares / count),
        share_told: told / all,
    };
    println!(
        "{camera:?} seed {seed}: centres {:.2} of claim, {:.3} px; light {:.2} of claim, told {:.2} of {all}",
        claims.centres, claims.rms_px, claims.lights, claims.share_told
    );
    claims
}

/// Seeds 1 to 4 are of those that limits were set on, 51 and 52 are not.
const SEEDS: [u64; 6] = [1, 2, 3, 4, 51, 52];

/// Claims of a camera with four spots a frame and with twelve, for each seed.
fn all_claims(camera: Camera, seeds: &[u64]) -> impl Iterator<Item = Claims> {
    let frames = seeds.iter().flat_map(|&seed| [(4, seed), (12, seed)]);
    frames.map(move |(spots, seed)| claims(Camera { spots, ..camera }, seed))
}

#[test]
fn spots_that_spill_are_within_their_claim() {
    for (sigma_px, well_dn, spill) in [(0.4, 256.0, 0.5), (0.5, 250.0, 1.0)] {
        let camera = Camera {
            sigma_px,
            well_dn,
            spill,
            along_columns: 0.0,
            spots: 4,
            brightest: 8000.0,
            disc_px: 0.0,
        };
        for found in all_claims(camera, &SEEDS) {
            assert!(found.centres < 2.5 && found.rms_px < 0.02, "{} {} px", found.centres, found.rms_px);
            assert!(found.lights < 2.5 && found.share_told > 0.98, "light {}", found.lights);
        }
    }
}

/// Nobody tells that charge spills alike to all sides: along columns with a third more than along rows, or along them alone.
#[test]
fn centres_of_spots_that_spill_otherwise_are_within_their_claim() {
    for (sigma_px, well_dn, spill, along_columns, most_px) in
        [(0.4, 256.0, 0.5, 0.3, 0.03), (0.5, 250.0, 1.0, 0.3, 0.02), (0.4, 256.0, 0.5, 1.0, 0.05)]
    {
        let camera =
            Camera { sigma_px, well_dn, spill, along_columns, spots: 4, brightest: 8000.0, disc_px: 0.0 };
        for found in all_claims(camera, &SEEDS[4..]) {
            assert!(found.centres < 2.5 && found.rms_px < most_px, "{} {} px", found.centres, found.rms_px);
            // The law that is wrong is not in the claim of light.
            assert!(found.lights < 25.0, "light {}", found.lights);
        }
    }
}

#[test]
fn light_beyond_full_pixels_that_keep_their_charge_is_told_by_the_wings() {
    for (spots, seed) in SEEDS.into_iter().flat_map(|seed| [(4, seed), (12, seed)]) {
        let camera = Camera {
            sigma_px: 0.4,
            well_dn: 400.0,
            spill: 0.0,
            along_columns: 0.0,
            spots,
            brightest: 8000.0,
            disc_px: 0.0,
        };
        let found = claims(camera, seed);
        assert!((0.7..1.7).contains(&found.centres), "seed {seed}: {}", found.centres);
        assert!(found.lights < 2.5 && found.share_told > 0.99, "seed {seed}: light {}", found.lights);
    }
}

/// Where a spot is a few full pixels and hardly anything beside them, these alone tell where it is: anywhere that leaves them full.
#[test]
fn spots_of_a_few_full_pixels_are_within_their_claim() {
    let camera = Camera {
        sigma_px: 0.3,
        well_dn: 400.0,
        spill: 0.0,
        along_columns: 0.0,
        spots: 4,
        brightest: 4000.0,
        disc_px: 0.0,
    };
    for found in all_claims(camera, &SEEDS[2..]) {
        assert!(found.centres < 2.0 && found.rms_px < 0.05, "{} {} px", found.centres, found.rms_px);
        assert!(found.lights < 2.5 && found.share_told > 0.98, "light {}", found.lights);
    }
}

/// Where no pixel but of charge that spills tells that discs are no points, how badly they fit does.
#[test]
fn discs_that_spill_are_not_placed_as_points() {
    // What is full hides which side is brighter: the claim knows little of that.
    for (disc_px, most) in [(2.0, 3.3), (2.6, 5.2)] {
        let camera = Camera {
            sigma_px: 0.5,
            well_dn: 250.0,
            spill: 0.5,
            along_columns: 0.0,
            spots: 12,
            brightest: 120_000.0,
            disc_px,
        };
        for seed in [SEEDS[0], SEEDS[4]] {
            let found = claims(camera, seed);
            assert!(found.centres < most, "{disc_px} px, seed {seed}: {}", found.centres);
            assert!(found.lights < 2.5, "{disc_px} px, seed {seed}: light {}", found.lights);
        }
    }
}
