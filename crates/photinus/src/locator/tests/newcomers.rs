//! How many neighbours there were before, and who comes in addition: a vehicle at once, a light hardly.

use super::*;

/// A level vehicle somewhere 2 to 6 m ahead.
fn anywhere(rng: &mut Pcg64) -> Placed {
    let mut uniform = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(rng);
    let place_m = ahead(uniform(2.0, 6.0), uniform(-0.8, 0.8), uniform(-0.3, 0.3));
    let mut tilt = || 0.05 * uniform(-1.0, 1.0);
    let tilt = Vector3::new(tilt(), 0.0, tilt());
    Placed::new(place_m, uniform(0.0, TAU), tilt)
}

/// So many vehicles, apart from each other.
fn apart(number: usize, rng: &mut Pcg64) -> Vec<Placed> {
    let mut placed: Vec<Placed> = Vec::new();
    while placed.len() < number {
        let new = anywhere(rng);
        if placed.iter().all(|other| other.place_m.angle(&new.place_m) > 0.3) {
            placed.push(new);
        }
    }
    placed
}

/// A light as bright as a marker there.
fn a_light(there: &Placed, rng: &mut Pcg64) -> Vec<Spot> {
    let mut spots = there.spots(&hexarotor(), &camera(), rng);
    spots.truncate(1);
    spots
}

/// How likely a newcomer is told by the spots that are its own, in a frame after 80 with `before` vehicles that fly about, of which ten
/// have a light besides.
fn told_of(
    airframe: &Airframe,
    before: usize,
    rng: &mut Pcg64,
    newcomer: impl Fn(&Placed, &mut Pcg64) -> Vec<Spot>,
) -> f64 {
    let mut locator = locator(airframe);
    for frame in 0.. {
        let placed = apart(before + 1, rng);
        let (new, known) = placed.split_last().unwrap();
        let mut spots: Vec<Spot> =
            known.iter().flat_map(|placed| placed.spots(airframe, &camera(), rng)).collect();
        let others = spots.len();
        if frame == 80 {
            spots.extend(newcomer(new, rng));
        } else if frame % 8 == 0 {
            spots.extend(a_light(new, rng));
        }
        let located = locator.locate(Input::spots(&spots).gravity(Some(&level()))).unwrap();
        if frame == 80 {
            let of_new = located.neighbours.iter().filter(|neighbour| neighbour.sightings[0] >= others);
            return of_new.map(|neighbour| neighbour.probability).fold(0.0, f64::max);
        }
    }
    unreachable!("the last frame returns")
}

#[test]
fn a_vehicle_that_joins_is_told_at_once() {
    let mut rng = Pcg64::new(21, 3);
    for before in [1, 4] {
        let told = (0..30).map(|_| {
            told_of(&hexarotor(), before, &mut rng, |new, rng| new.spots(&hexarotor(), &camera(), rng))
        });
        let least = told.fold(1.0, f64::min);
        assert!(least > 0.97, "beside {before}: {least}");
    }
}

#[test]
fn a_light_beside_a_vehicle_that_was_always_alone_is_hardly_another() {
    let mut rng = Pcg64::new(22, 3);
    let told: Vec<f64> = (0..40).map(|_| told_of(&hexarotor(), 1, &mut rng, a_light)).collect();
    let mean = told.iter().sum::<f64>() / told.len() as f64;
    println!("a light: {mean:.3}");
    assert!(mean < 0.03, "{mean}");
}

#[test]
fn where_numbers_change_all_the_time_everybody_is_told() {
    let mut rng = Pcg64::new(23, 3);
    let airframe = hexarotor();
    let mut locator = locator(&airframe);
    let (mut there, mut told) = (0, 0);
    for frame in 0..300 {
        let number = Uniform::new(0, 6).unwrap().sample(&mut rng);
        let placed = apart(number, &mut rng);
        let spots: Vec<Spot> =
            placed.iter().flat_map(|placed| placed.spots(&airframe, &camera(), &mut rng)).collect();
        let located = locator.locate(Input::spots(&spots).gravity(Some(&level()))).unwrap();
        if frame >= 64 {
            there += number;
            told += located.neighbours.iter().filter(|neighbour| neighbour.probability > 0.9).count();
        }
    }
    println!("{told} told of {there}");
    assert!(told <= there + 2 && told as f64 > 0.99 * there as f64, "{told} of {there}");
}
