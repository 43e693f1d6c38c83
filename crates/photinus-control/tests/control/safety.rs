//! No collision under the assumptions, collisions where one of them is broken.

use nalgebra::{Rotation3, UnitVector3, Vector3};
use photinus::locator::Distance;
use photinus::ranging::Interval;
use photinus_control::safety::{Basis, Limits, Obstacle, Safety, Watch};
use photinus_control::{Motion, Normal, OwnState, Seen, Setpoint};
use rand_pcg::Pcg64Mcg;

use crate::flight::{Flight, Sight, Wish, between, in_ball, uniform};

/// Where a vehicle is at times in a row while it keeps a commitment: told `before`, then `next`, then straight braking.
fn path(
    limits: &Limits,
    mut p: Vector3<f64>,
    mut v: Vector3<f64>,
    told: &[(Vector3<f64>, f64)],
) -> Option<Vec<Vector3<f64>>> {
    let step = 0.01;
    let mut places = vec![p];
    for (u, time_s) in told {
        let steps = (time_s / step).ceil();
        for _ in 0..steps as usize {
            let h = time_s / steps;
            p += v * h + u * (0.5 * h * h);
            v += u * h;
            places.push(p);
            if v.norm() > limits.speed_m_s + 1e-6 {
                return None;
            }
        }
    }
    let (time_s, u) = (v.norm() / limits.braking_m_s2, v * (-limits.braking_m_s2 / v.norm().max(1e-12)));
    for k in 1..=20 {
        let t = time_s * f64::from(k) / 20.0;
        places.push(p + v * t + u * (0.5 * t * t));
    }
    Some(places)
}

/// The smallest distance of two paths, whatever the times.
fn apart(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().flat_map(|p| b.iter().map(move |q| (p - q).norm())).fold(f64::INFINITY, f64::min)
}

/// The step of the proof by induction: two vehicles are committed and clear of each other, in any state; one renews. Whatever
/// the layer allowed is clear of all that the other is committed to, at any pair of times. Returns how often it renewed.
fn renew(states: u64, seed: u64) -> u64 {
    let mut rng = Pcg64Mcg::new(u128::from(seed) * 2 + 1);
    let limits = Limits { stray_m: 0.0, velocity_error_m_s: 0.0, ..Limits::small_multirotor() };
    let watch = Watch::empty_to(1e3);
    let (mut tried, mut renewed) = (0, 0);
    while tried < states {
        let rng = &mut rng;
        let [v, w] = [in_ball(rng, limits.speed_m_s), in_ball(rng, limits.speed_m_s)];
        let [told, next] = [0; 2].map(|_| in_ball(rng, limits.acceleration_m_s2));
        // Three set-points are underway: the delay is three periods.
        let before = [0; 3].map(|_| (in_ball(rng, limits.acceleration_m_s2), limits.period_s));
        let place =
            in_ball(rng, 1.0).normalize() * between(rng, limits.separation_m(), limits.clearance_m() + 2.5);
        let left_s = between(rng, 0.0, limits.delay_s);
        let Some(own) = path(&limits, Vector3::zeros(), v, &before) else { continue };
        let Some(other) = path(&limits, place, w, &[(told, left_s), (next, limits.period_s)]) else {
            continue;
        };
        if apart(&own, &other) < limits.separation_m() {
            continue;
        }
        tried += 1;
        let mut safety = Safety::new(limits).unwrap();
        let own_state = |v| OwnState { velocity_m_s: Some(Normal::exactly(v)), ..OwnState::resting() };
        // Far from everybody the layer passes on what it is told.
        for (u, time_s) in before {
            let first = Setpoint::acceleration(u);
            let passed = safety.guard(&own_state(Vector3::zeros()), &[], &watch, &[], &first, time_s);
            let Motion::Acceleration(passed) = passed.setpoint.motion else { unreachable!() };
            assert!((passed - u).norm() < 1e-9);
        }
        let loose = between(rng, 0.0, 0.3);
        let range = place.norm();
        let bearing_bound_rad = between(rng, 0.0, 0.5);
        let axis = UnitVector3::new_normalize(place.cross(&in_ball(rng, 1.0)));
        let turn = Rotation3::from_axis_angle(&axis, bearing_bound_rad * uniform(rng));
        let seen = Seen {
            track: 0,
            identity: None,
            bearing: UnitVector3::new_normalize(turn * place),
            bearing_bound_rad,
            distance: Distance {
                estimate: None,
                bounds: Interval::new(range * (1.0 - loose * uniform(rng)), range * (1.0 + loose)).unwrap(),
                perpendicular_m: None,
                inline_m: None,
            },
            position_m: None,
            velocity_m_s: None,
            heading: None,
            probability: 1.0,
            spot_px: None,
            age_s: 0.0,
        };
        let wanted = Setpoint::acceleration(in_ball(rng, 2.0 * limits.acceleration_m_s2));
        let guarded = safety.guard(&own_state(v), &[seen], &watch, &[], &wanted, limits.period_s);
        if guarded.basis == Basis::Braking {
            continue;
        }
        assert_eq!(guarded.basis, Basis::Proven);
        renewed += 1;
        let Motion::Acceleration(u) = guarded.setpoint.motion else { unreachable!() };
        let own =
            path(&limits, Vector3::zeros(), v, &[before[0], before[1], before[2], (u, limits.period_s)])
                .unwrap();
        let smallest = apart(&own, &other);
        assert!(smallest >= limits.separation_m(), "state {tried}: {smallest} m");
    }
    renewed
}

#[test]
fn what_is_renewed_is_clear_of_all_that_others_are_committed_to() {
    let renewed = renew(3_000, 1);
    assert!(renewed > 1_000, "{renewed} of 3000 states renewed: the rest proves nothing");
}

/// `cargo test --release -p photinus-control --test control million -- --ignored --nocapture`
#[test]
#[ignore = "a minute in release"]
fn a_million_states_renew_without_collision() {
    let renewed = renew(1_000_000, 2);
    println!("1000000 states, {renewed} renewed, all clear");
    assert!(renewed > 300_000);
}

/// Flies at another vehicle as fast as it can, or anywhere, turns meanwhile, and changes its mind.
fn attack(seed: u64) -> Wish {
    let mut rng = Pcg64Mcg::new(u128::from(seed) * 2 + 77);
    let (mut mood, mut left, mut random) = (0.0, 0, Vector3::zeros());
    Box::new(move |_, seen, _| {
        if left == 0 {
            (mood, left, random) =
                (uniform(&mut rng), 5 + (uniform(&mut rng) * 40.0) as u32, in_ball(&mut rng, 10.0));
        }
        left -= 1;
        let nearest =
            seen.iter().min_by(|a, b| a.distance.bounds.min_m().total_cmp(&b.distance.bounds.min_m()));
        let told = match nearest {
            Some(nearest) if mood < 0.5 => Setpoint::velocity(nearest.bearing.into_inner() * 10.0),
            Some(nearest) if mood < 0.7 => {
                Setpoint::acceleration(nearest.bearing.cross(&random) + nearest.bearing.into_inner() * 5.0)
            }
            _ => Setpoint::acceleration(random),
        };
        told.turning(0.3 * random.x)
    })
}

/// A crowd of `vehicles` in a ball, all of whom attack each other, with the layer.
fn brawl(seed: u64, vehicles: u64, limits: Limits, sight: Sight) -> Flight {
    let mut flight = Flight::new(seed, limits, sight);
    let mut k = 0;
    while k < vehicles {
        let p = in_ball(&mut flight.rng, 6.0);
        // At rest to begin with, apart by a separation and what they stray: two who stand are clear of each other.
        let least = limits.separation_m() + 0.5;
        if flight.vehicles.iter().all(|other| (other.p - p).norm() >= least) {
            flight.add(p, Vector3::zeros(), true, attack(seed * 100 + k));
            k += 1;
        }
    }
    flight
}

fn brawls(
    seeds: core::ops::Range<u64>,
    limits: Limits,
    sight: Sight,
    change: impl Fn(&mut Flight),
) -> (f64, usize) {
    let (mut smallest, mut collisions) = (f64::INFINITY, 0);
    for seed in seeds {
        let mut flight = brawl(seed, 2 + seed % 5, limits, sight);
        change(&mut flight);
        flight.fly(8.0);
        smallest = smallest.min(flight.smallest_m);
        collisions += usize::from(flight.smallest_m < limits.separation_m());
    }
    (smallest, collisions)
}

fn limits() -> Limits {
    Limits { period_s: 0.035, ..Limits::small_multirotor() }
}

#[test]
fn nobody_collides_however_they_attack() {
    let (smallest, collisions) = brawls(0..12, limits(), Sight::GOOD, |_| {});
    assert_eq!(collisions, 0, "{smallest} m");
    // The attacks do come near: without the layer they hit.
    assert!(smallest < limits().clearance_m() + 0.5, "{smallest} m");
    // The range of sight that the claim states is enough: who is further away need not be seen.
    let short = Sight { range_m: limits().sight_m(Sight::GOOD.most_age_s), ..Sight::GOOD };
    assert!(short.range_m < 3.0, "{}", short.range_m);
    assert_eq!(brawls(20..26, limits(), short, |_| {}).1, 0);
    // So are neighbours that are missed in three frames of ten, where that is known.
    let missing = Sight { missed: 0.3, honest: true, range_m: 15.0, ..Sight::GOOD };
    assert_eq!(brawls(30..36, limits(), missing, |_| {}).1, 0);
    let (_, hits) = brawls(0..6, limits(), Sight::GOOD, |flight| {
        flight.vehicles.iter_mut().for_each(|vehicle| vehicle.safety = None);
    });
    assert!(hits >= 4, "{hits} of 6");
}

/// The same flight, bit for bit, on every machine.
#[test]
fn a_brawl_is_the_same_everywhere() {
    let mut flight = brawl(3, 5, limits(), Sight::GOOD);
    flight.fly(4.0);
    let bits =
        flight.vehicles.iter().flat_map(|v| [v.p, v.v]).flat_map(|v| [v.x, v.y, v.z]).map(f64::to_bits);
    let hash =
        bits.fold(0xcbf2_9ce4_8422_2325_u64, |hash, bits| (hash ^ bits).wrapping_mul(0x0100_0000_01b3));
    assert_eq!(hash, 0xd496_e45f_e984_16f0, "{hash:#x}");
}

/// `cargo test --release -p photinus-control --test control thousand_brawls -- --ignored --nocapture`
#[test]
#[ignore = "minutes in release"]
fn a_thousand_brawls_without_collision() {
    for (name, limits) in [
        ("2 m/s", limits()),
        ("5 m/s", Limits { speed_m_s: 5.0, acceleration_m_s2: 8.0, braking_m_s2: 6.0, ..limits() }),
    ] {
        let (smallest, collisions) = brawls(1000..1500, limits, Sight::GOOD, |_| {});
        println!(
            "{name}: 500 brawls of 2 to 6, smallest distance {smallest:.3} m, separation {} m",
            limits.separation_m()
        );
        assert_eq!(collisions, 0);
    }
}

#[test]
fn broken_assumptions_end_in_collisions() {
    let count = |sight: Sight, change: &dyn Fn(&mut Flight)| brawls(0..16, limits(), sight, change).1;
    let nothing = |_: &mut Flight| {};
    // Bounds that do not hold: everybody seems to be three times as far.
    assert!(count(Sight { lie: 3.0, ..Sight::GOOD }, &nothing) > 0, "lying bounds");
    // Neighbours that are not seen, while absence is claimed.
    let missed = [0.8, 0.9, 0.95].map(|missed| count(Sight { missed, ..Sight::GOOD }, &nothing));
    assert!(missed.iter().any(|collisions| *collisions > 0), "missed neighbours");
    // Brakes that do less than said.
    assert!(
        count(Sight::GOOD, &|flight| flight.vehicles.iter_mut().for_each(|v| v.brakes = 0.3)) > 0,
        "weak brakes"
    );
    // One who is faster than said, and has no layer.
    let hostile = |flight: &mut Flight| {
        flight.vehicles[0].safety = None;
        flight.vehicles[0].top_m_s = 6.0;
    };
    assert!(count(Sight::GOOD, &hostile) > 0, "hostile");
}

/// Two who want to be in each other's place, and one wall with a gate: the map enters the same layer.
#[test]
fn obstacles_of_a_map_are_not_touched() {
    let limits = limits();
    let mut flight = Flight::new(5, limits, Sight::GOOD);
    let pole = |x: f64, y: f64| Obstacle::Capsule {
        from: Vector3::new(x, y, -5.0),
        to: Vector3::new(x, y, 5.0),
        radius_m: 0.3,
    };
    flight.obstacles =
        vec![pole(0.0, 1.2), pole(0.0, -1.2), Obstacle::Face { normal: Vector3::z_axis(), height_m: 1.0 }];
    flight.add(Vector3::new(-4.0, 0.3, 0.0), Vector3::zeros(), true, Box::new(|_, _, _| Setpoint::stand()));
    // In the axes of the world: the wish is turned into the vehicle's own.
    let heading = flight.vehicles[0].heading;
    flight.vehicles[0].wish = Box::new(move |_, _, _| {
        let level_from_world = Rotation3::from_axis_angle(&Vector3::z_axis(), -heading);
        Setpoint::velocity(level_from_world * Vector3::new(1.5, 0.0, -0.5))
    });
    let mut least = f64::INFINITY;
    for _ in 0..1200 {
        flight.fly(0.01);
        let p = flight.vehicles[0].p;
        let gap = flight.obstacles.iter().map(|body| body.distance_m(&p)).fold(f64::INFINITY, f64::min);
        least = least.min(gap);
    }
    assert!(least >= limits.radius_m, "{least}");
    assert!(
        flight.vehicles[0].p.x > 1.0,
        "it did not get through the gate: {:?} {:?}",
        flight.vehicles[0].p,
        flight.vehicles[0].bases
    );
}

/// Two who stand nearer than anybody may renew part, and fly on.
#[test]
fn two_who_stand_too_near_part() {
    let limits = limits();
    let sight = Sight { loose: 0.05, ..Sight::GOOD };
    let mut flight = Flight::new(9, limits, sight);
    for side in [-0.6, 0.6] {
        let flee: Wish = Box::new(|_, seen, _| Setpoint::velocity(seen[0].bearing.into_inner() * -1.0));
        flight.add(Vector3::new(side, 0.0, 0.0), Vector3::zeros(), true, flee);
    }
    let before = flight.limits.clearance_m();
    assert!(before > 1.2);
    flight.fly(15.0);
    let apart = (flight.vehicles[0].p - flight.vehicles[1].p).norm();
    assert!(apart > before + 1.0, "{apart}");
    assert!(flight.smallest_m >= limits.separation_m());
}

#[test]
fn nothing_known_means_slow() {
    let limits = Limits::small_multirotor();
    let own = |speed: f64| OwnState {
        velocity_m_s: Some(Normal::exactly(Vector3::x() * speed)),
        ..OwnState::resting()
    };
    let fast = Setpoint::velocity(Vector3::x() * 2.0);
    for (range_m, basis) in [(0.0, Basis::Slow), (30.0, Basis::Proven)] {
        let mut safety = Safety::new(limits).unwrap();
        let watch = Watch::empty_to(range_m);
        let (mut speed, mut underway) = (0.0, [0.0; 3]);
        let mut last = Basis::Braking;
        for _ in 0..90 {
            let guarded = safety.guard(&own(speed), &[], &watch, &[], &fast, limits.period_s);
            let Motion::Acceleration(u) = guarded.setpoint.motion else { panic!() };
            speed += underway[0] * limits.period_s;
            underway = [underway[1], underway[2], u.x];
            last = guarded.basis;
        }
        let most = if range_m > 0.0 { limits.speed_m_s } else { limits.unknown_speed_m_s };
        assert!(speed <= 1.05 * most && speed > 0.7 * most, "{range_m}: {speed}");
        assert!(range_m == 0.0 || last == basis);
    }
    // A vehicle that does not know how fast it is stands.
    let mut safety = Safety::new(limits).unwrap();
    let blind = OwnState { velocity_m_s: None, ..OwnState::resting() };
    let guarded = safety.guard(&blind, &[], &Watch::empty_to(30.0), &[], &fast, limits.period_s);
    assert_eq!(guarded.setpoint, Setpoint::stand());
}

/// What is no number is the worst that it could be.
#[test]
fn numbers_that_are_none_stop_a_vehicle() {
    let limits = Limits::small_multirotor();
    let (watch, nan) = (Watch::empty_to(1e3), f64::NAN);
    let mut flight = Flight::new(1, limits, Sight::GOOD);
    for x in [0.0, 30.0] {
        flight.add(Vector3::x() * x, Vector3::zeros(), false, Box::new(|_, _, _| Setpoint::stand()));
    }
    let far = flight.see(0, 1).unwrap();
    let wanted = Setpoint::acceleration(Vector3::x() * 5.0);
    let guard = |seen: Seen, obstacles: &[Obstacle], wanted: &Setpoint| {
        let mut safety = Safety::new(limits).unwrap();
        safety.guard(&OwnState::resting(), &[seen], &watch, obstacles, wanted, limits.period_s).basis
    };
    assert_eq!(guard(far, &[], &wanted), Basis::Proven);
    let pole = Obstacle::Capsule { from: Vector3::repeat(nan), to: Vector3::zeros(), radius_m: 0.1 };
    assert_eq!(guard(far, &[pole], &wanted), Basis::Braking);
    assert_eq!(guard(far, &[], &Setpoint::velocity(Vector3::repeat(nan))), Basis::Braking);
    assert_eq!(guard(Seen { age_s: nan, ..far }, &[], &wanted), Basis::Braking);
    // Just outside the clearance, who is behind allows to go ahead; who may be anywhere does not.
    let bounds = Interval::new(limits.clearance_m() + 0.03, 2.0).unwrap();
    let distance = Distance { bounds, ..far.distance };
    let behind = Seen { bearing: -Vector3::x_axis(), bearing_bound_rad: 0.1, distance, age_s: 0.0, ..far };
    let ahead = |seen: Seen| {
        let mut safety = Safety::new(limits).unwrap();
        let guarded = safety.guard(&OwnState::resting(), &[seen], &watch, &[], &wanted, limits.period_s);
        let Motion::Acceleration(u) = guarded.setpoint.motion else { unreachable!() };
        u.x
    };
    let nowhere = UnitVector3::new_unchecked(Vector3::repeat(nan));
    assert!(ahead(Seen { bearing_bound_rad: nan, ..behind }) < 4.0);
    assert!(ahead(Seen { bearing: nowhere, ..behind }) < 4.0);
    assert!(ahead(behind) > 4.0, "{}", ahead(behind));
}
