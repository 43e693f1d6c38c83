//! ROS 2 topics are heard by cyclonedds, with the definitions that rosbags ships, and images of cyclonedds are heard here.

use std::io::{BufRead, BufReader};
use std::net::UdpSocket;
use std::process::Stdio;
use std::sync::mpsc::{TryRecvError, channel};
use std::time::{Duration, Instant};

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use photinus_io::calibration::MountingFile;
use photinus_link::messages::{Messages, Uvdar, Viewpoint};
use photinus_link::ros;
use photinus_link::ros2::{
    ImageSource, MotionTopics, Node, PointSource, Publisher, Quality, Settings, Topics, UvdarTopics,
};
use photinus_link::topics;
use photinus_run::Entry;
use photinus_run::motion::Motion;
use photinus_run::source::{Next, Source};
use photinus_testing::python_with;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use serde_json::{Value, json};

use crate::read_by_others::{definitions, flat, health};
use crate::sample;

const SCRIPT: &str = concat!(include_str!("wire_types.py"), include_str!("dds_listener.py"));
/// Domains that nobody uses: two runs of this test at once have different ones.
const FIRST_DOMAIN: u32 = 20;
const DOMAINS: u32 = 40;

#[test]
fn cyclonedds_hears_every_topic_and_its_images_are_heard() {
    let Some(mut python) = python_with(&["cyclonedds", "rosbags"]) else { return };
    let domain = FIRST_DOMAIN + std::process::id() % DOMAINS;
    let mut settings = Settings::default();
    settings.domain = domain as u16;
    settings.namespace = "/uav1".to_owned();
    let mut node = Node::new(settings.clone()).expect("there is a network");
    let mut published = Topics::new(&mut node).expect("names");
    let mut source = ImageSource::new(settings.clone(), "/camera/image").expect("a name");
    let end_of_source = source.interrupter().expect("it waits");
    let (came, images) = channel();
    let taking = std::thread::spawn(move || {
        while let Next::Frame(entry) = source.next()
            && came.send(entry).is_ok()
        {}
    });

    let mut points = PointSource::new(settings, "/points").expect("a name");
    let end_of_points = points.interrupter().expect("it waits");
    let (said, spots) = channel();
    let taking_points = std::thread::spawn(move || {
        while let Next::Frame(entry) = points.next()
            && said.send(entry).is_ok()
        {}
    });
    let motion = Motion::default();
    let topics_of_motion =
        MotionTopics { imu: Some("/imu".to_owned()), odometry: Some("/odom".to_owned()), tf: None };
    let only_tf =
        MotionTopics { tf: Some(["odom", "uav1/base_link"].map(str::to_owned)), ..MotionTopics::default() };
    let motion_of_tf = Motion::default();
    let mut of_tf = only_tf.subscribe(&mut node, motion_of_tf.clone()).expect("names");
    let mut own = topics_of_motion.subscribe(&mut node, motion.clone()).expect("names");
    let uvdar = UvdarTopics::new(&mut node, ["left"]).expect("names");

    let view = Viewpoint::new(Some("left"), Some(1e-3));
    let mut record = sample::record(17, 1_700_000_000.25);
    record.tracks[0].id = Some(1);
    let mounting = MountingFile {
        body_from_camera: UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3),
        rotation_covariance_rad2: Matrix3::zeros(),
        position_m: Some(Vector3::new(0.1, 0.2, 0.3)),
        position_covariance_m2: None,
    };
    // Before anybody listens: who comes later hears it all the same.
    published.tell_mountings("uav1/base_link", &[(view.header(None), mounting)]);

    let kinds = [
        ("/uav1/photinus/detections", "vision_msgs/Detection3DArray"),
        ("/uav1/photinus/neighbours", "photinus_msgs/NeighbourArray"),
        ("/uav1/photinus/tracks", "photinus_msgs/NeighbourArray"),
        ("/uav1/photinus/markers", "visualization_msgs/MarkerArray"),
        (topics::TRANSFORMS, "tf2_msgs/TFMessage"),
        (topics::STATIC_TRANSFORMS, "tf2_msgs/TFMessage"),
        (topics::DIAGNOSTICS, "diagnostic_msgs/DiagnosticArray"),
        ("/uav1/uvdar/left/detector/points_seen", "uvdar_core/ImagePointsWithCovariancesStamped"),
        ("/uav1/uvdar/left/detector/points_seen/sun", "uvdar_core/ImagePointsWithCovariancesStamped"),
        ("/uav1/uvdar/bearing/left/observations", "uvdar_core/BearingObservationArrayStamped"),
        ("/uav1/uvdar/measuredPoses", "uvdar_core/PoseWithCovarianceArrayStamped"),
        ("/uav1/uvdar/filteredPoses", "uvdar_core/PoseWithCovarianceArrayStamped"),
        ("/uav1/uvdar/filteredPoses/tentative", "uvdar_core/PoseWithCovarianceArrayStamped"),
    ];
    let asked: serde_json::Map<String, Value> = kinds
        .iter()
        .map(|(topic, kind)| ((*topic).to_owned(), kind.replacen('/', "/msg/", 1).into()))
        .collect();
    let defined: serde_json::Map<String, Value> = kinds
        .iter()
        .map(|(_, kind)| *kind)
        .chain(["sensor_msgs/Imu", "nav_msgs/Odometry"])
        .flat_map(definitions)
        .map(|(name, text)| (name, text.into()))
        .collect();
    let asked = json!({"topics": asked, "definitions": defined}).to_string();
    let mut child = python
        .args(["-c", SCRIPT, &domain.to_string(), &asked])
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python runs");
    let out = BufReader::new(child.stdout.take().expect("a pipe"));
    let (said, heard) = channel();
    std::thread::spawn(move || said.send(out.lines().next()));
    let (end, mut image) = (Instant::now() + Duration::from_secs(60), None);
    let mut line = None;
    let (mut spot, mut clock_s) = (None, 50.0);
    while (line.is_none()
        || image.is_none()
        || spot.is_none()
        || motion.attitudes().is_empty()
        || motion_of_tf.attitudes().is_empty())
        && Instant::now() < end
    {
        // Frames of a clock that is another than that of the stamps, and goes alike.
        clock_s += 0.02;
        for heard in [&mut own, &mut of_tf] {
            heard
                .frame(&Entry { taken: Some(Instant::now()), ..Entry::of_spots(0, clock_s, "", Vec::new()) });
            heard.hear();
        }
        spot = spot.or_else(|| spots.try_recv().ok());
        let messages = Messages::of(&record, &view);
        assert_eq!(uvdar.tell(0, Uvdar::of(&record, &messages, &view, [752, 480])), 0);
        published.tell(messages);
        published.tell_health(health());
        image = image.or_else(|| images.try_recv().ok());
        match heard.try_recv() {
            Ok(said) => line = said,
            Err(TryRecvError::Disconnected) if line.is_none() => break,
            Err(_) => {}
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    end_of_points();
    drop(spots);
    taking_points.join().expect("it ends when it is told to");
    end_of_source();
    drop(images);
    taking.join().expect("it ends when it is told to");
    let _ = child.kill();
    let _ = child.wait();
    let line = line.expect("it says something").expect("text");
    let read: Value = serde_json::from_str(&line).expect("JSON");
    let told = Messages::of(&record, &view);
    let fixed = &read[topics::STATIC_TRANSFORMS]["transforms"][0];
    assert_eq!(
        (&fixed["child_frame_id"], &fixed["header"]["frame_id"]),
        (&json!("left_optical_frame"), &json!("uav1/base_link"))
    );
    let expected = flat(json!({
        "/uav1/photinus/detections": told.detections, "/uav1/photinus/neighbours": told.neighbours,
        "/uav1/photinus/tracks": told.tracks, "/uav1/photinus/markers": told.markers, topics::TRANSFORMS: told.transforms,
        topics::DIAGNOSTICS: health(),
    }));
    let told = Uvdar::of(&record, &Messages::of(&record, &view), &view, [752, 480]);
    let of_uvdar = flat(json!({
        "/uav1/uvdar/left/detector/points_seen": told.points, "/uav1/uvdar/left/detector/points_seen/sun": told.sun,
        "/uav1/uvdar/bearing/left/observations": told.bearings, "/uav1/uvdar/measuredPoses": told.measured,
        "/uav1/uvdar/filteredPoses": told.filtered, "/uav1/uvdar/filteredPoses/tentative": told.tentative,
    }));
    for (topic, message) in of_uvdar.as_object().expect("topics") {
        assert_eq!(&read[topic], message, "{topic}");
    }
    let spot = spot.expect("points were sent");
    assert_eq!((spot.record.time_s, spot.record.spots.len()), (Some(12.5), 1));
    assert!(
        (spot.record.spots[0].u_px - 20.5).abs() < 1e-12 && (spot.record.spots[0].v_px - 30.25).abs() < 1e-12
    );
    // The imu has no attitude and the odometry no rate: each says what the other does not. Times are on the clock of the frames.
    let (rate_s, rate) = motion.rates()[0];
    let (attitude_s, attitude) = motion.attitudes()[0];
    assert!((rate - Vector3::new(0.1, 0.2, 0.3)).norm() < 1e-12);
    assert!(attitude.angle_to(&UnitQuaternion::from_euler_angles(2.0 * libm::asin(0.6), 0.0, 0.0)) < 1e-9);
    for time_s in [rate_s, attitude_s] {
        assert!((40.0..=clock_s + 1.0).contains(&time_s), "{time_s} of {clock_s}");
    }
    let (_, of_tf) = motion_of_tf.attitudes()[0];
    // By way of a frame between them, whose transform was told once on /tf_static.
    let turned = attitude * UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
    assert!(of_tf.angle_to(&turned) < 1e-9 && motion_of_tf.rates().is_empty());
    let told = own.health("topics");
    assert!(told.values.iter().any(|(name, _)| name == "clock_offset_ms"), "{told:?}");
    for (topic, message) in expected.as_object().expect("topics") {
        assert_eq!(&read[topic], message, "{topic}");
    }
    let entry = image.expect("images were sent");
    assert_eq!((entry.record.time_s, entry.record.source.as_str()), (Some(12.5), "/camera/image"));
    let image = entry.image.expect("pixels");
    let pixel = |u: usize, v: usize| ((7 * (24 * v + u)) % 256) as u8;
    let sent: Vec<u8> = (0..16).flat_map(|v| (0..20).map(move |u| pixel(u, v))).collect();
    assert_eq!(image.pixels(), sent, "the rows end with four bytes that are no pixels");
}

/// Resident memory of this program, MB.
fn memory_mb() -> f64 {
    let pages = std::fs::read_to_string("/proc/self/statm").expect("Linux says");
    pages.split(' ').nth(1).and_then(|pages| pages.parse::<f64>().ok()).expect("a number") * 4096e-6
}

#[test]
fn datagrams_that_mean_nothing_stop_nobody_and_cost_no_memory() {
    let domain = FIRST_DOMAIN + DOMAINS + std::process::id() % DOMAINS;
    let mut settings = Settings::default();
    settings.domain = domain as u16;
    let mut node = Node::new(settings.clone()).expect("there is a network");
    let publisher = node.publisher::<ros::Image<'static>>("/camera/image", Quality::Sensor).expect("a name");
    let mut images = node.images("/camera/image").expect("a name");
    let mut passes = || {
        let end = Instant::now() + Duration::from_secs(20);
        while Instant::now() < end {
            let image = ros::Image {
                height: 1,
                width: 2,
                step: 2,
                encoding: "mono8".to_owned(),
                data: vec![1, 2].into(),
                ..ros::Image::default()
            };
            publisher.publish(image).expect("it is taken");
            std::thread::sleep(Duration::from_millis(10));
            if let Some(image) = images.take() {
                return image.expect("grey").1.pixels() == [1, 2];
            }
        }
        false
    };
    assert!(passes(), "before");
    let before_mb = memory_mb();
    let mouth = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let (mut random, mut bytes) = (Pcg64::new(9, 9), vec![0_u8; 60_000]);
    for case in 0..100_000_u32 {
        // Now and then as large as a datagram can be.
        let most = if case % 1000 == 0 { bytes.len() } else { 600 };
        let length = 24 + random.next_u32() as usize % (most - 24);
        random.fill_bytes(&mut bytes[..length]);
        // RTPS 2.3, and the beginning of a submessage of a kind that there is.
        bytes[..6].copy_from_slice(b"RTPS\x02\x03");
        bytes[20] = [0x15, 0x16, 0x06, 0x07, 0x08, 0x09, 0x0e, 0x12][case as usize % 8];
        bytes[21] = 1;
        // Discovery and users' data of the first participants of a machine (RTPS 2.3, 9.6.1.1).
        for port in 0..4 {
            let port = 7400 + 250 * domain + 10 + port;
            mouth.send_to(&bytes[..length], ("127.0.0.1", port as u16)).expect("it is sent");
        }
    }
    assert!(passes(), "after");
    let grown_mb = memory_mb() - before_mb;
    assert!(grown_mb < 100.0, "{grown_mb} MB more");
}
