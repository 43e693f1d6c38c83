//! Whole flights against what must come out of them.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::path::Path;

use photinus_swarm::scenario::carried;
use photinus_swarm::{Grade, Metrics, Run, Scenario};

/// Vehicles of no wind and no noise, with these groups.
fn text(more: &str) -> String {
    let calm = [
        "tilt_bias_deg",
        "tilt_noise_deg",
        "heading_bias_deg",
        "gyro_bias_rad_s",
        "gyro_noise_rad_s",
        "velocity_bias_m_s",
        "velocity_noise_m_s",
        "height_noise_m",
    ];
    let calm: String = calm.iter().map(|key| format!("{key} = 0.0\n")).collect();
    format!(
        "name = \"t\"\nduration_s = 8.0\nrate_hz = 20.0\nperception = \"perfect\"\n[instruments]\n{calm}\
         [[kind]]\nname = \"hexarotor\"\nairframe = \"airframes/hexarotor-0.4.toml\"\n\
         [[kind.camera]]\nname = \"front\"\nfile = \"cameras/bluefox-dsl215.toml\"\nposition_m = [0.1, 0.0, 0.0]\n{more}"
    )
}

fn group(positions: &str, headings: &str, controller: &str) -> String {
    let count = positions.matches('[').count();
    format!(
        "[[group]]\nkind = \"hexarotor\"\ncount = {count}\n\
         place = {{ at = {{ positions_m = [{positions}], headings_deg = [{headings}] }} }}\ncontroller = {controller}\n"
    )
}

fn run(text: &str, grade: Grade) -> Run {
    let path = Path::new("t.toml");
    let scenario = Scenario::parse(text, path).unwrap_or_else(|error| panic!("{error}"));
    Run::new(scenario, path, grade)
}

fn fly(run: &Run, threads: usize) -> Metrics {
    run.fly(threads, |_| Ok(())).unwrap_or_else(|error| panic!("{error}"))
}

fn of(name: &str, seconds: f64, grade: Grade) -> Run {
    let mut scenario = carried(name).unwrap().read().unwrap();
    scenario.duration_s = seconds;
    Run::new(scenario, "t.toml", grade)
}

#[test]
fn two_that_fly_past_each_other_are_as_near_as_their_courses() {
    // from 6 m to either side at 1.5 m/s each, 1.3 m apart: no collision; 0.5 m apart: one
    for (apart_m, collisions) in [(1.3, 0), (0.5, 1)] {
        let more = group("[-6.0, 0.0, 5.0]", "0.0", "{ cruise = { velocity_m_s = [1.5, 0.0, 0.0] } }")
            + &group(
                &format!("[6.0, {apart_m}, 5.0]"),
                "180.0",
                "{ cruise = { velocity_m_s = [-1.5, 0.0, 0.0] } }",
            );
        let metrics = fly(&run(&text(&more), Grade::Perfect), 1);
        let smallest_m = metrics.smallest_distance_m.unwrap();
        assert!((smallest_m - apart_m).abs() < 0.02, "{smallest_m}");
        assert!((metrics.smallest_clearance_m.unwrap() - (smallest_m - 0.8)).abs() < 1e-9);
        assert_eq!(metrics.collisions, collisions);
        // they fly in opposite directions
        assert!(metrics.final_order.unwrap() < 0.05);
    }
}

#[test]
fn one_that_flies_into_a_mast_has_collided_with_it_once() {
    let more = group("[-4.0, 0.0, 5.0]", "0.0", "{ cruise = { velocity_m_s = [2.0, 0.0, 0.0] } }")
        + "[[obstacle]]\npillar = { foot_m = [2.0, 0.1, 0.0], height_m = 9.0, radius_m = 0.2 }\n";
    let metrics = fly(&run(&text(&more), Grade::Perfect), 1);
    assert_eq!((metrics.collisions, metrics.obstacle_collisions), (0, 1));
    let touch = metrics.touches[0];
    assert_eq!((touch.vehicle, touch.other, touch.obstacle), (0, None, Some(0)));
    // 5.4 m to the surface of two balls' sum at up to 2 m/s, after a start from rest
    assert!((2.5..4.0).contains(&touch.time_s), "{}", touch.time_s);
}

#[test]
fn what_stands_in_between_or_behind_is_not_seen() {
    let pair = |headings: &str, more: &str| {
        let text = text(&(group("[0.0, 0.0, 5.0], [6.0, 0.0, 5.0]", headings, "{ hover = {} }") + more));
        fly(&run(&text, Grade::Perfect), 1)
    };
    let facing = pair("0.0, 180.0", "");
    assert!(facing.contact_with_anybody.unwrap() > 0.999 && facing.connected > 0.999);
    let away = pair("180.0, 0.0", "");
    assert!(away.contact_with_anybody.unwrap() <= 0.0 && away.connected <= 0.0);
    let hidden = pair(
        "0.0, 180.0",
        "[[obstacle]]\npillar = { foot_m = [3.0, 0.0, 0.0], height_m = 9.0, radius_m = 0.6 }\n",
    );
    assert!(hidden.contact_with_anybody.unwrap() <= 0.0 && hidden.contact.is_none());
    let failing = pair("0.0, 180.0", "[[event]]\nat_s = 4.0\nvehicle = 0\ncamera_fails = \"front\"\n");
    // one of two sees nobody in the second half
    assert!((failing.contact_with_anybody.unwrap() - 0.75).abs() < 0.01);
}

#[test]
fn a_flight_is_the_same_on_any_number_of_threads_and_differs_by_seed() {
    let run = of("five", 3.0, Grade::StandIn);
    let one = fly(&run, 1);
    assert_eq!(one, fly(&run, 3));
    assert_ne!(one.smallest_distance_m, fly(&run.with_seed(7), 1).smallest_distance_m);
    let flights = |threads| run.monte_carlo(4, threads, |_| true).unwrap();
    assert_eq!(flights(1), flights(3));
    assert_eq!(flights(2)[0], one);
}

#[test]
fn seeds_stop_when_they_are_told_to() {
    let run = of("five", 60.0, Grade::StandIn);
    let mut heard = 0;
    let flights = run.monte_carlo(3, 2, |_| {
        heard += 1;
        heard < 10
    });
    assert!(flights.unwrap().len() < 3);
}

#[test]
fn by_frames_two_that_hover_see_each_other_where_they_are() {
    let more = group("[0.0, 0.0, 5.0], [6.0, 1.0, 5.3]", "0.0, 180.0", "{ hover = {} }");
    let text = text(&more).replace("duration_s = 8.0", "duration_s = 1.5");
    let run = run(&text, Grade::Rendered);
    let metrics = fly(&run, 2);
    assert!(metrics.contact.unwrap() > 0.85, "{metrics:?}");
    assert!(metrics.bounds > 30 && metrics.bounds_broken == 0, "{metrics:?}");
    assert!(metrics.range_error.unwrap() < 0.1, "{metrics:?}");
    assert_eq!(metrics, fly(&run, 1), "whatever the number of threads");
}

/// The theorem of docs/safety.md: where all that it assumes was so, a collision is an error of the layer or of the accounts.
#[test]
fn where_the_proof_applied_nobody_collided() {
    let mut applied = 0;
    for (name, grade) in [
        ("gate", Grade::Perfect),
        ("obstacles", Grade::Perfect),
        ("guarded-ten", Grade::Perfect),
        ("crossing-guarded", Grade::Perfect),
        ("gate", Grade::StandIn),
    ] {
        for metrics in of(name, 15.0, grade).monte_carlo(2, 2, |_| true).unwrap() {
            let contract = metrics.contract.clone().unwrap();
            if contract.proof_applied {
                applied += 1;
                assert!(contract.first_broken_s.is_none() && contract.slow == 0);
                let collided = metrics.collisions + metrics.obstacle_collisions;
                assert_eq!(collided, 0, "{name}, {grade:?}, seed {}: {contract:?}", metrics.seed);
            }
            // they do fly: standing is no proof of anything
            assert!(contract.proven * 20 > contract.decisions, "{name}, {grade:?}: {contract:?}");
        }
    }
    assert!(applied >= 5, "{applied} flights in which all assumptions were kept say something");
}

#[test]
fn each_assumption_that_is_broken_is_told() {
    let layer = |more: &str| {
        format!(
            "[group.safety]\nspeed_m_s = 2.0\nacceleration_m_s2 = 3.0\nbraking_m_s2 = 2.0\ndelay_s = 0.3\nstray_m = 0.3\n\
             velocity_error_m_s = 0.2\nunknown_speed_m_s = 0.0\n{more}\n"
        )
    };
    let boids = "{ boids = { near_m = 2.0, far_m = 4.0, cruise_m_s = [1.0, 0.0, 0.0] } }";
    let contract = |positions: &str, headings: &str, layer: &str| {
        let text = text(&(group(positions, headings, boids) + layer));
        fly(&run(&text, Grade::Perfect), 1).contract.unwrap()
    };
    let facing = "[0.0, 0.0, 5.0], [6.0, 0.0, 5.0]";
    let kept = contract(facing, "0.0, 180.0", &layer("empty_m = 12.0"));
    assert!(kept.proof_applied && kept.proven > 0, "{kept:?}");
    // back to back they do not see each other, and fly 6 m apart where nobody is said to be
    let unseen = contract(facing, "180.0, 0.0", &layer("empty_m = 12.0"));
    assert!(
        unseen.unseen_near > 0 && unseen.first_broken_s == Some(0.0) && !unseen.proof_applied,
        "{unseen:?}"
    );
    assert!((unseen.nearest_unseen_m.unwrap() - 6.0).abs() < 0.5, "{unseen:?}");
    // brakes that it has not, in front of a ball
    let boast = layer("empty_m = 12.0")
        .replace("acceleration_m_s2 = 3.0", "acceleration_m_s2 = 30.0")
        .replace("braking_m_s2 = 2.0", "braking_m_s2 = 20.0")
        .replace("stray_m = 0.3", "stray_m = 0.05");
    let ball = "[[obstacle]]\nball = { centre_m = [10.0, 0.0, 5.0], radius_m = 0.5 }\n";
    let strayed = contract(facing, "0.0, 180.0", &(boast + ball));
    assert!(strayed.strayed > 0 && !strayed.proof_applied, "{strayed:?}");
    let near = contract("[0.0, 0.0, 5.0], [1.1, 0.0, 5.0]", "0.0, 180.0", &layer("empty_m = 12.0"));
    assert!(near.began_too_near == 1 && !near.proof_applied, "{near:?}");
    let hunted = fly(&of("hostile", 14.0, Grade::Perfect), 1).contract.unwrap();
    assert!(hunted.strangers == 1 && hunted.first_broken_s == Some(10.0), "{hunted:?}");
}
