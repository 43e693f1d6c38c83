//! So many LEDs -> ways to spread them over an airframe, the best for a wanted range first.
//!
//! Rings of one or two LEDs an arm, and rings with a gap: one arm more than there are LEDs, one of them without. A ring is the same after
//! a turn from arm to arm, so that yaw is told modulo that turn unless the LEDs blink signals; with a gap it is told in full, at the price
//! of a dark side.

use photinus::airframe::{Airframe, Led, Ring};
use serde::Serialize;

use crate::range::Range;
use crate::setup::Setup;
use crate::spot::SpotTable;

/// Angles between the two LEDs of an arm, deg.
const SPLAYS_DEG: [f64; 3] = [60.0, 90.0, 120.0];
/// A layout whose frames tell a distance as often as this is good enough to be compared by its error.
const OFTEN: f64 = 0.95;

/// A layout and what it is worth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Layout {
    /// What it is, in words.
    pub name: String,
    /// Share of frames that tell a distance at the wanted range.
    pub two: f64,
    /// Median error of those, m.
    pub distance_error_m: Option<f64>,
    /// Root mean square error of yaw, rad, modulo `yaw_turn_rad`.
    pub yaw_rms_rad: Option<f64>,
    /// Yaw is told modulo this, rad: a whole circle where nothing is like anything else.
    pub yaw_turn_rad: f64,
    /// How far half of all frames tell a distance, m.
    pub half_m: f64,
}

/// Layouts of as many LEDs as the set-up's airframe has and as wide as it, the best first.
pub(crate) fn compare(setup: &Setup, table: &SpotTable) -> Vec<Layout> {
    let (leds, radius_m) = (setup.airframe.leds().len(), setup.airframe.max_radius_m());
    let mut layouts: Vec<Layout> = candidates(leds, radius_m, &setup.airframe)
        .into_iter()
        .map(|(name, airframe)| {
            let mut range = Range::new(setup, table, &airframe);
            let at = range.at(setup.wanted_m);
            Layout {
                name,
                two: at.two,
                distance_error_m: at.distance_error_m,
                yaw_rms_rad: at.yaw_rms_rad,
                yaw_turn_rad: core::f64::consts::TAU / range.turns() as f64,
                half_m: range.reach()[1].half_m,
            }
        })
        .collect();
    let rank = |layout: &Layout| {
        let error_m = layout.distance_error_m.unwrap_or(f64::INFINITY);
        if layout.two >= OFTEN { (0, error_m) } else { (1, -layout.two) }
    };
    layouts.sort_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    layouts
}

/// Layouts with their names; LEDs shine as those of `like`.
fn candidates(leds: usize, radius_m: f64, like: &Airframe) -> Vec<(String, Airframe)> {
    let ring = |arms: usize, leds_per_arm: usize, splay_deg: f64| {
        let ring = Ring { arms, radius_m, leds_per_arm, splay_rad: splay_deg.to_radians() };
        alike(Airframe::from_ring("layout", ring).ok()?.leds().to_vec(), like)
    };
    let mut found = Vec::new();
    let mut offer = |name: String, airframe: Option<Airframe>| {
        found.extend(airframe.map(|airframe| (name, airframe)));
    };
    offer(format!("{leds} arms, one LED each"), ring(leds, 1, 0.0));
    let gap = ring(leds + 1, 1, 0.0).and_then(|whole| alike(whole.leds()[1..].to_vec(), like));
    offer(format!("{} arms, one of them without an LED", leds + 1), gap);
    for splay_deg in SPLAYS_DEG.into_iter().filter(|_| leds.is_multiple_of(2)) {
        let arms = leds / 2;
        offer(format!("{arms} arms, two LEDs each, {splay_deg} deg apart"), ring(arms, 2, splay_deg));
    }
    found
}

fn alike(leds: Vec<Led>, like: &Airframe) -> Option<Airframe> {
    let lobe = &like.leds().first()?.lobe;
    let leds = leds.into_iter().map(|led| Led { lobe: lobe.clone(), ..led }).collect();
    Airframe::new("layout", leds).ok()
}
