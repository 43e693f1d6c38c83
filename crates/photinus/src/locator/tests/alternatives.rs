//! Handfuls that are left out before they are looked at, against looks at all of them: the same ones are chosen.

use super::most::sighted;
use super::*;
use crate::locator::alternatives::{Alternatives, MOST_WEIGHED, NEAREST, POOR_GAIN, Question};
use crate::locator::candidates::Candidates;
use crate::locator::context::Context;
use crate::locator::explanation::Explanation;
use crate::locator::grouping::Groups;
use crate::locator::kinds::Kinds;
use crate::pose::LogLight;

/// A marker that is seen so far from the side that it hardly shows.
const GRAZING: f64 = 0.012;

#[test]
fn what_is_left_out_beforehand_would_not_have_been_chosen() {
    for (airframe, down) in [(hexarotor(), Some(level())), (quadrotor(), Some(level())), (hexarotor(), None)]
    {
        let (mut looked, mut all) = (0, 0);
        for (neighbours, clutter) in [(2, 0), (4, 3), (10, 2), (14, 0), (18, 30), (0, 80)] {
            for seed in 0..4 {
                let mut rng = Pcg64::new(seed, 41);
                let spots = crowd(&airframe, neighbours, clutter, &mut rng);
                let (own, of_all) = compare(&airframe, &spots, down.as_ref(), &mut rng);
                looked += own;
                all += of_all;
            }
        }
        assert!(looked < all, "{looked} looks at {all} handfuls: nothing is left out");
    }
}

/// Neighbours anywhere, each with the markers that hardly show, and clutter.
fn crowd(airframe: &Airframe, neighbours: usize, clutter: usize, rng: &mut Pcg64) -> Vec<Spot> {
    let mut uniform = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(rng);
    let mut spots = Vec::new();
    for _ in 0..neighbours {
        let distance_m = libm::exp(uniform(0.7, 2.4));
        let place_m = ahead(distance_m, uniform(-0.8, 0.8), uniform(-0.4, 0.4));
        let placed = Placed::new(place_m, uniform(0.0, TAU), Vector3::new(uniform(-0.1, 0.1), 0.0, 0.0));
        let camera_m = placed.camera_from_body.inverse() * -place_m;
        for marker in 0..airframe.markers().len() {
            let intensity = airframe.intensity(marker, &camera_m);
            let marker_m = placed.camera_from_body * airframe.markers()[marker].position_m + place_m;
            let pixel = Bearing::new(marker_m).and_then(|bearing| camera().pixel(&bearing));
            if let Some(pixel) = pixel.filter(|_| intensity > GRAZING) {
                spots.push(super::spot(pixel, intensity * uniform(0.8, 1.2), marker_m.norm()));
            }
        }
    }
    for _ in 0..clutter {
        let place = Pixel::new(uniform(50.0, 700.0), uniform(50.0, 430.0));
        spots.push(super::spot(place, uniform(0.01, 1.0), uniform(2.0, 12.0)));
    }
    spots
}

/// Compares what is chosen around every spot with what looks at all handfuls would choose. Returns how many looks either takes.
fn compare(
    airframe: &Airframe,
    spots: &[Spot],
    down: Option<&Unit<Vector3<f64>>>,
    rng: &mut Pcg64,
) -> (usize, usize) {
    let camera = camera();
    let (sightings, near) = sighted(&camera, spots);
    let settings = Settings::default();
    let mut kinds = Kinds::new(&[Kind::new(airframe.clone(), &settings.pose)], &settings).unwrap();
    let density: f64 = Uniform::new(-12.0, 12.0).unwrap().sample(rng);
    let clutter = vec![density; sightings.len()];
    let context = Context {
        sightings: &sightings,
        near: &near,
        gravity: down,
        watched: Watched::new(&camera, None),
        power: None,
        detection_limit: limit(0.01 * FAINTEST),
        clutter: &clutter,
        miss_rate: pose::Settings::default().missed,
        tilt_sigma_rad: pose::Settings::default().tilt_sigma_rad,
        light_times: 1.0,
        log_neighbours: 0.0,
        known: None,
    };
    kinds.begin();
    let mut groups = Groups::default();
    groups.sort_out(&context, &mut kinds);
    let power = Some(LogLight { value: libm::log(POWER), sigma: 0.35 });
    let context = Context { power, ..context };
    let mut candidates = Candidates::with_room(64);
    for group in (0..groups.len()).map(|group| groups.group(group)) {
        kinds.weigh(&context, group, &mut candidates, || true);
    }
    let mut explanation = Explanation::with_room(64);
    explanation.suppose(clutter.len(), |_| 1.0);
    explanation.explain(&candidates, &clutter, |_| context.log_neighbours);
    explanation.hold(&candidates);
    let asked =
        Question { context: &context, groups: &groups, explanation: &explanation, candidates: &candidates };
    let (mut alternatives, mut looked, mut all) = (Alternatives::with_room(), 0, 0);
    for observation in 0..sightings.len() {
        alternatives.begin(sightings.len());
        looked += alternatives.look(&asked, observation, &mut kinds) as usize;
        alternatives.choose(&asked, observation, &mut kinds);
        let mut chosen: Vec<Vec<usize>> = alternatives.chosen().map(<[usize]>::to_vec).collect();
        if groups.group_of(observation).len() == 1 {
            // That which is put to the nearest group is told apart by a bound of its own.
            chosen.retain(|handful| is_around(&context, &kinds, observation, handful));
        }
        let mut looks = Vec::new();
        for handful in handfuls(&context, &kinds, observation) {
            all += 1;
            let Some(log_density) = kinds.log_density(&context, &handful) else { continue };
            let gain = log_density + context.log_neighbours - density * handful.len() as f64;
            if gain > explanation.held(&candidates, &handful) + POOR_GAIN {
                looks.push((gain, handful));
            }
        }
        looks.sort_by(|a, b| b.0.total_cmp(&a.0));
        looks.truncate(MOST_WEIGHED);
        for (gain, handful) in looks {
            assert!(chosen.contains(&handful), "{handful:?} gains {gain} and is left out: {chosen:?}");
        }
    }
    (looked, all)
}

/// All handfuls of an observation and those next to it, each ascending.
fn handfuls(context: &Context<'_>, kinds: &Kinds, observation: usize) -> Vec<Vec<usize>> {
    let window = window(context, kinds, observation);
    let of = |mask: usize| {
        let rest = window.iter().enumerate().filter(|(bit, _)| mask >> bit & 1 == 1).map(|(_, &spot)| spot);
        let mut handful: Vec<usize> = rest.chain([observation]).collect();
        handful.sort_unstable();
        handful
    };
    (0usize..1 << window.len()).map(of).filter(|handful| handful.len() <= kinds.most_visible()).collect()
}

/// What is next to an observation.
fn window(context: &Context<'_>, kinds: &Kinds, observation: usize) -> Vec<usize> {
    let reach_rad = kinds.widest_rad(&context.sightings[observation]);
    let nearest = context.near.beside(observation).take(NEAREST);
    nearest.filter(|(gap2, _)| *gap2 < reach_rad * reach_rad).map(|(_, spot)| spot).collect()
}

fn is_around(context: &Context<'_>, kinds: &Kinds, observation: usize, handful: &[usize]) -> bool {
    let window = window(context, kinds, observation);
    handful.iter().all(|spot| *spot == observation || window.contains(spot))
}
