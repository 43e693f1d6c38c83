//! What a handful can be worth at most, told before it is looked at, against looks and full estimates: of neighbours and of clutter.

use super::*;
use crate::locator::candidates::Candidates;
use crate::locator::context::Context;
use crate::locator::kinds::Kinds;
use crate::locator::near::Near;
use crate::pose::LogLight;

/// The evidence of a full estimate is a sum over slices, nats.
const SLICES_NATS: f64 = 0.5;

#[test]
fn no_look_is_worth_more_than_is_told_before_it_is_taken() {
    for (airframe, down) in [(hexarotor(), Some(level())), (quadrotor(), Some(level())), (hexarotor(), None)]
    {
        let settings = Settings::default();
        let mut kinds = Kinds::new(&[Kind::new(airframe.clone(), &settings.pose)], &settings).unwrap();
        let mut rng = Pcg64::new(77, 5);
        let (mut looks, mut closest) = (0, [f64::INFINITY; 2]);
        for round in 0..60 {
            let mut uniform = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut rng);
            let place_m = ahead(uniform(1.5, 12.0), uniform(-0.5, 0.5), uniform(-0.3, 0.3));
            let tilt = Vector3::new(uniform(-0.1, 0.1), 0.0, uniform(-0.1, 0.1));
            let placed = Placed::new(place_m, uniform(0.0, TAU), tilt);
            let (u, v, apart_px) = (uniform(100.0, 600.0), uniform(100.0, 400.0), uniform(3.0, 60.0));
            let mut anywhere = || {
                let centre = Pixel::new(u + uniform(0.0, apart_px), v + uniform(0.0, apart_px));
                super::spot(centre, uniform(0.1, 1.0), uniform(1.0, 15.0))
            };
            let clutter = [(); 3].map(|()| anywhere());
            let spots =
                if round % 2 == 0 { placed.spots(&airframe, &camera(), &mut rng) } else { clutter.to_vec() };
            looks += check(&mut kinds, &spots, down.as_ref(), &mut closest);
        }
        // What is told is of some use, and not only large.
        assert!(looks > 100 && closest.iter().all(|&closest| closest < 7.0), "{looks} {closest:?}");
    }
}

/// Checks every handful of some spots; how many there were. Tells how much less than was told the best of looks and of full estimates were worth.
fn check(
    kinds: &mut Kinds,
    spots: &[Spot],
    down: Option<&Unit<Vector3<f64>>>,
    closest: &mut [f64; 2],
) -> usize {
    let camera = camera();
    let (sightings, near) = sighted(&camera, spots);
    let density = vec![0.0; sightings.len()];
    let mut handfuls = 0;
    for power in [None, Some(LogLight { value: libm::log(POWER), sigma: 0.35 })] {
        let context = Context {
            sightings: &sightings,
            near: &near,
            gravity: down,
            watched: Watched::new(&camera, None),
            power,
            detection_limit: limit(FAINTEST),
            clutter: &density,
            miss_rate: pose::Settings::default().missed,
            tilt_sigma_rad: pose::Settings::default().tilt_sigma_rad,
            light_times: 1.0,
            log_neighbours: 0.0,
            known: None,
        };
        kinds.begin();
        for mask in (1usize..1 << sightings.len()).filter(|mask| mask.count_ones() > 1) {
            let group: Vec<usize> = (0..sightings.len()).filter(|spot| mask >> spot & 1 == 1).collect();
            let direction = |spot: usize| sightings[spot].bearing.vector();
            let gaps = group.iter().flat_map(|&a| group.iter().map(move |&b| (a, b)));
            let widest2 = gaps.map(|(a, b)| (direction(a) - direction(b)).norm_squared()).fold(0.0, f64::max);
            let Some(look) = kinds.log_density(&context, &group) else { continue };
            handfuls += 1;
            let [most, further] = kinds.most_of_look(&context, group.len(), widest2, true);
            assert!(look <= most, "{group:?}: {look}, at most {most}");
            for (place, &a) in group.iter().enumerate().filter(|_| group.len() > 2) {
                for &b in &group[..place] {
                    let most = kinds.most_of_pair(&context, &[b, a]) + (group.len() - 2) as f64 * further;
                    assert!(look <= most, "{group:?}: {look}, of {b} and {a} at most {most}");
                }
            }
            closest[0] = closest[0].min(most - look);
            let mut candidates = Candidates::with_room(4);
            kinds.weigh(&context, &group, &mut candidates, || true);
            if let Some(full) = candidates.log_density(&group) {
                let most = kinds.most_in_full(&context, &group);
                assert!(full <= most + SLICES_NATS, "{group:?}: {full}, at most {most}");
                closest[1] = closest[1].min(most - full);
            }
        }
    }
    handfuls
}

/// The spots as a frame's observations.
pub(super) fn sighted(camera: &Camera, spots: &[Spot]) -> (Vec<Sighting>, Near) {
    let sight = |spot: &Spot| sighting::sight(camera, None, spot, None);
    let mut sightings: Vec<Sighting> = spots.iter().filter_map(sight).collect();
    brightness::tell(&mut sightings, None, usize::MAX, [752, 480], &mut ByCell::default());
    let mut near = Near::default();
    near.sort(&sightings, 16);
    (sightings, near)
}
