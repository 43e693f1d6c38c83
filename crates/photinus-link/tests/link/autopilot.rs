//! An autopilot by pymavlink hears what is told, and is heard; random datagrams mean nothing.

use std::io::{BufRead, BufReader};
use std::net::UdpSocket;
use std::process::Stdio;
use std::time::{Duration, Instant};

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use photinus::camera::{Camera, Model, Pinhole, Pixel};
use photinus_link::mavlink::{Autopilot, Heard, Obstacles, Outlook, SECTORS, Settings, UNKNOWN_CM};
use photinus_run::motion::Velocity;
use photinus_testing::python_with;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use serde_json::Value;

use crate::sample;

const SCRIPT: &str = include_str!("autopilot.py");

fn settings() -> Settings {
    let mut settings = Settings::default();
    settings.system = 7;
    settings.obstacles = Obstacles { radius_m: 0.5, reach_m: 20.0, tells_free: true };
    settings
}

/// It looks ahead, 45 deg to both sides.
fn outlook() -> (Outlook, UnitQuaternion<f64>) {
    let lens = Pinhole::new([300.0, 300.0], Pixel::new(299.5, 239.5), [0.0; 6], [0.0; 2]).expect("a lens");
    let camera = Camera::new(Model::Pinhole(lens), 600, 480, None).expect("a camera");
    let body_from_camera =
        UnitQuaternion::from_matrix(&Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0));
    (Outlook::new(&camera, (body_from_camera, Vector3::zeros()), None), body_from_camera)
}

/// Of type `kind`, in the order of their coming.
fn of<'a>(heard: &'a [Value], kind: &'a str) -> impl Iterator<Item = &'a Value> {
    heard.iter().filter(move |message| message["mavpackettype"] == kind)
}

#[test]
fn pymavlink_hears_obstacles_targets_and_silence_and_is_heard() {
    let Some(mut python) = python_with(&["pymavlink"]) else { return };
    let mut child = python.args(["-c", SCRIPT, "4"]).stdout(Stdio::piped()).spawn().expect("Python runs");
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines().map_while(Result::ok);
    let port: u16 = lines.next().expect("a line").parse().expect("a port");
    let began = Instant::now();
    let now_s = || began.elapsed().as_secs_f64();
    let mut link = Autopilot::new("127.0.0.1:0", ("127.0.0.1", port), settings(), 0.0).expect("a socket");
    let (outlook, turn) = outlook();
    let camera = link.camera("front", outlook, (turn, Vector3::zeros()));
    let mut record = sample::record(1, 0.0);
    record.tracks[0].predicted = false;
    // Where its bearing is sure, it is in few directions.
    record.neighbours[0].position_covariance_m2 = None;
    let (mut attitude, mut rates, mut own, mut silent_s) = (None, None, None, None);
    let mut speeds = Vec::new();
    while now_s() < 3.0 {
        // The camera falls silent after 2 s.
        if now_s() < 2.0 {
            link.located(camera, &record, now_s() - 0.005, now_s());
            silent_s = Some(now_s());
        }
        link.tick(now_s());
        while let Some(heard) = link.hear(now_s()) {
            match heard {
                Heard::Attitude(heard) => attitude = Some((heard, now_s())),
                Heard::Turn(heard) => rates = Some(heard),
                Heard::Speed(heard) => speeds.push(heard.velocity),
                Heard::Own(heard) => own = Some(heard),
            }
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let heard: Vec<Value> = lines.map(|line| serde_json::from_str(&line).expect("JSON")).collect();
    child.wait().expect("it ends");
    assert!(silent_s.is_some() && of(&heard, "BAD_DATA").next().is_none());
    assert!(heard.iter().all(|message| message["from"] == serde_json::json!([7, 191])));

    let heartbeats: Vec<&Value> = of(&heard, "HEARTBEAT").collect();
    assert!((3..=6).contains(&heartbeats.len()), "{}", heartbeats.len());
    // MAV_TYPE_ONBOARD_CONTROLLER, MAV_STATE_ACTIVE and, at the end, MAV_STATE_CRITICAL.
    assert_eq!((&heartbeats[1]["type"], &heartbeats[1]["system_status"]), (&18.into(), &4.into()));
    assert_eq!(heartbeats[heartbeats.len() - 1]["system_status"], 5);

    let obstacles: Vec<&Value> = of(&heard, "OBSTACLE_DISTANCE").collect();
    // 2 s at 15 Hz, and the word of silence.
    assert!((10..=33).contains(&obstacles.len()), "{}", obstacles.len());
    let first = obstacles[0];
    // MAV_FRAME_BODY_FRD
    assert_eq!(
        (&first["frame"], &first["increment_f"], &first["max_distance"]),
        (&12.into(), &5.0.into(), &2000.into())
    );
    let distance = |sector: usize| first["distances"][sector].as_u64().expect("a number");
    // Strict minima to the hull: one ahead and below from 5 m, one to the right from 2.5 m.
    assert_eq!((distance(0), distance(18)), (450, 200));
    // Nobody is there at 40 deg to the left, and nobody looks behind.
    assert_eq!((distance(SECTORS - 8), distance(SECTORS / 2)), (2001, u64::from(UNKNOWN_CM)));
    let last = obstacles[obstacles.len() - 1];
    let unknown = last["distances"].as_array().expect("a list");
    assert!(unknown.iter().all(|cm| *cm == u64::from(UNKNOWN_CM)));
    let silence = of(&heard, "STATUSTEXT").last().expect("it is told");
    assert!(silence["text"].as_str().expect("text").starts_with("photinus: no answer of front"), "{silence}");

    let target = of(&heard, "FOLLOW_TARGET").next().expect("the own place is known");
    assert_eq!((&target["custom_state"], &target["est_capabilities"]), (&1.into(), &3.into()));
    let near = |name: &str, value: f64, off: f64| {
        let told = target[name].as_f64().expect("a number");
        assert!((told - value).abs() < off, "{name}: {told}, not {value}");
    };
    // 4 m ahead, which is east, and 3 m to the right, a little down: south.
    near("lat", 50.1e7 - 3.0 * 1e7 / 111_229.0, 8.0);
    near("lon", 14.4e7 + 4.0 * 1e7 / 71_700.0, 8.0);

    let (attitude, at_s) = attitude.expect("it was heard");
    // Down is on the right, which is against y.
    let down = attitude.down().into_inner();
    assert!((down - Vector3::new(0.0, -libm::sin(0.1), -libm::cos(0.1))).norm() < 1e-5, "{down}");
    assert!((attitude.turn_rad_s - Vector3::new(0.1, -0.2, -0.3)).norm() < 1e-6);
    assert!((attitude.time_s - at_s).abs() < 0.2, "{} {at_s}", attitude.time_s);
    assert!((rates.expect("heard").turn_rad_s - Vector3::new(0.4, -0.5, -0.6)).norm() < 1e-6);
    // Of the place by the attitude, of the odometry as it is.
    let of_place = attitude.enu_from_body.inverse() * Vector3::new(3.0, -2.0, -1.0);
    // Nobody says what the first is off by.
    for told in [Velocity::new(of_place, None), Velocity::new(Vector3::new(1.0, -2.0, -3.0), Some(0.2))] {
        let is_told = |heard: &Velocity| {
            (heard.velocity_m_s - told.velocity_m_s).norm() < 1e-5
                && (heard.sigma_m_s - told.sigma_m_s).abs() < 1e-6
        };
        assert!(speeds.iter().any(is_told), "{told:?} {speeds:?}");
    }
    assert!((own.expect("heard").altitude_m - 300.0).abs() < 1e-9);
}

#[test]
fn messages_of_one_datagram_are_all_heard_in_their_order() {
    use mavlink::dialects::common::{
        ATTITUDE_QUATERNION_DATA, HIGHRES_IMU_DATA, HighresImuUpdatedFlags, MavMessage,
    };
    use mavlink::{MavHeader, MavlinkVersion, write_versioned_msg};

    let mut link = Autopilot::new("127.0.0.1:0", "127.0.0.1:9", settings(), 0.0).expect("a socket");
    let mouth = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let header = MavHeader { system_id: settings().system.into(), component_id: 1, sequence: 0 };
    let attitude = ATTITUDE_QUATERNION_DATA { q1: 1.0, time_boot_ms: 1000, ..Default::default() };
    let imu = HIGHRES_IMU_DATA {
        time_usec: 1_000_000,
        fields_updated: HighresImuUpdatedFlags::all(),
        ..Default::default()
    };
    for _ in 0..2 {
        let mut datagram = Vec::new();
        for message in
            [MavMessage::ATTITUDE_QUATERNION(attitude.clone()), MavMessage::HIGHRES_IMU(imu.clone())]
        {
            write_versioned_msg(&mut datagram, MavlinkVersion::V2, header, &message).expect("it is written");
        }
        mouth.send_to(&datagram, link.local().expect("an address")).expect("it is sent");
    }
    std::thread::sleep(Duration::from_millis(50));
    for _ in 0..2 {
        assert!(matches!(link.hear(1.0), Some(Heard::Attitude(_))));
        assert!(matches!(link.hear(1.0), Some(Heard::Turn(_))));
    }
    assert_eq!(link.hear(1.0), None);
}

#[test]
fn silence_is_told_within_a_tenth_of_a_second_and_rates_have_a_limit() {
    let ear = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    ear.set_nonblocking(true).expect("it may");
    let heard = || {
        let mut bytes = [0; 600];
        std::iter::from_fn(|| {
            ear.recv_from(&mut bytes).ok().map(|(length, _)| {
                u32::from_le_bytes([bytes[7], bytes[8], bytes[9], 0]) + u32::from(length == 0)
            })
        })
        .collect::<Vec<u32>>()
    };
    const HEARTBEAT: u32 = 0;
    const OBSTACLES: u32 = 330;
    const TEXT: u32 = 253;
    let mut link =
        Autopilot::new("127.0.0.1:0", ear.local_addr().expect("a port"), settings(), 0.0).expect("a socket");
    let (outlook, turn) = outlook();
    let camera = link.camera("front", outlook, (turn, Vector3::zeros()));
    let record = sample::record(1, 0.0);
    for frame in 0..600 {
        // A thousand frames a second.
        link.located(camera, &record, f64::from(frame) * 1e-3, f64::from(frame) * 1e-3);
    }
    let told = heard();
    let count = |told: &[u32], kind| told.iter().filter(|&&told| told == kind).count();
    assert_eq!(count(&told, OBSTACLES), 9, "{told:?}");
    let mut told_s = None;
    for step in 1..30 {
        let now_s = 0.599 + 0.02 * f64::from(step);
        link.tick(now_s);
        let told = heard();
        if told_s.is_none() && [HEARTBEAT, OBSTACLES, TEXT].iter().all(|kind| told.contains(kind)) {
            told_s = Some(now_s - 0.599);
        }
    }
    assert!(told_s.is_some_and(|told_s| told_s <= 0.1), "{told_s:?}");
    // An old answer is no answer.
    link.located(camera, &record, 1.0, 1.5);
    assert_eq!(count(&heard(), TEXT), 0);
    link.located(camera, &record, 1.6, 1.6);
    assert_eq!(count(&heard(), TEXT), 1, "it is back");
}

#[test]
fn a_hundred_thousand_datagrams_that_mean_nothing_change_nothing() {
    let mouth = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let mut link = Autopilot::new("127.0.0.1:0", mouth.local_addr().expect("a port"), settings(), 0.0)
        .expect("a socket");
    let ear = link.local().expect("a port");
    let (mut random, mut bytes) = (Pcg64::new(5, 5), [0_u8; 400]);
    for case in 0..100_000_u32 {
        let length = random.next_u32() as usize % bytes.len();
        random.fill_bytes(&mut bytes[..length]);
        // Half of them begin as a message does, of those that are listened to.
        if case % 2 == 0 && length > 10 {
            let kind = [31_u32, 105, 33, 330][case as usize / 2 % 4].to_le_bytes();
            bytes[..10].copy_from_slice(&[
                0xfd,
                (length - 10).min(255) as u8,
                0,
                0,
                0,
                7,
                1,
                kind[0],
                kind[1],
                kind[2],
            ]);
        }
        mouth.send_to(&bytes[..length], ear).expect("it is sent");
        if case % 50 == 0 {
            assert_eq!(link.hear(0.0), None, "case {case}");
        }
    }
    assert!(link.refused() > 10_000, "{}", link.refused());
}
