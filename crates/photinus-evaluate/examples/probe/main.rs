#![allow(dead_code, unused, clippy::all, missing_docs)]
#[path = "../time/fault.rs"]
mod fault;
#[path = "../time/flight.rs"]
mod flight;
#[path = "../time/scene.rs"]
mod scene;
#[path = "../time/score.rs"]
mod score;
use fault::FAULTS;
use photinus::locator::Input;
use photinus::lookout::*;
use photinus_sim::{Scene, Simulator};
use scene::AIRFRAMES;
fn main() {
    let arg = |n: usize| std::env::args().nth(n).unwrap();
    let seed: u64 = arg(1).parse().unwrap();
    let airframe = AIRFRAMES[arg(2).parse::<usize>().unwrap()];
    let fault = FAULTS.iter().find(|f| f.name == arg(3)).unwrap();
    let every: usize = arg(4).parse().unwrap();
    let scene = scene::four(seed, airframe, fault);
    let (camera, airframe) = (scene.cameras[0].camera.clone(), scene.targets[0].airframe.clone());
    let book = scene.targets[0].blink.as_ref().unwrap().codes.clone();
    let vehicles = scene
        .targets
        .iter()
        .map(|t| (Vehicle { id: t.id, words: t.blink.as_ref().unwrap().words[..1].to_vec() }, 60.0));
    let fleet = Fleet::new(book, vehicles).unwrap();
    for v in fleet.vehicles() {
        println!("{v:?}");
    }
    let (mut locator, mut lookout) = flight::observer(&camera, &airframe, Some(&fleet));
    let mut simulator = Simulator::new(&scene, 0).unwrap();
    for (number, rendered) in simulator.frames().enumerate() {
        let (view, gravity) = (rendered.image.view(), Some(rendered.gravity));
        let located = locator.locate(Input::frame(&view).gravity(gravity.as_ref())).unwrap();
        let glance = Glance {
            exposure_s: scene.exposure_us * 1e-6,
            gravity,
            ..Glance::new(rendered.truth.time_s, located)
        };
        lookout.look(&glance).unwrap();
        if number % every != 0 {
            continue;
        }
        println!("--- {number}");
        for n in &rendered.truth.neighbours {
            let leds: Vec<_> = n.leds.iter().map(|l| (l.led, (l.u_px * 10.0).round() / 10.0)).collect();
            println!("  true {} {:.2?} leds {:?}", n.id, n.position_m, leds);
        }
        for n in &located.neighbours {
            println!(
                "  nb p{:.2} {:?} d{:.2?}",
                n.probability,
                n.sightings,
                n.modes
                    .iter()
                    .map(|m| (m.weight * 100.0).round() / 100.0)
                    .zip(n.modes.iter().map(|m| (m.pose.position_m.norm() * 100.0).round() / 100.0))
                    .collect::<Vec<_>>()
            );
        }
        let tracked = lookout.tracked();
        for t in &tracked.tracks {
            let near = rendered
                .truth
                .neighbours
                .iter()
                .map(|n| {
                    let e = t.position_m - nalgebra::Vector3::from(n.position_m);
                    (n.id, e.norm(), (e.transpose() * t.position_covariance_m2.try_inverse().unwrap() * e)[0])
                })
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap();
            println!(
                "  track {} at {:.2?} sig {:.2} e{:.2} near {} off {:.2} nees {:.1} name {:?} members {:?} markers {:?}",
                t.id,
                t.position_m.as_slice(),
                t.position_covariance_m2.trace().sqrt(),
                t.existence,
                near.0,
                near.1,
                near.2,
                lookout.name(t.id).map(|n| (n.id, (n.probability * 1000.0).round() / 1000.0)),
                tracked.members(t),
                tracked.markers(t)
            );
        }
        for m in lookout.markers(0) {
            let v = m.bearing.vector();
            println!(
                "    m{} az {:.4} lit {:.2} {:?} s {:?} e{:.2}",
                m.number,
                v.x / v.z,
                m.lit,
                m.identity.map(|i| (i.who, (i.probability * 1000.0).round() / 1000.0)),
                m.sighting,
                m.existence
            );
        }
    }
}
