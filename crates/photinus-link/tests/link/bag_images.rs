//! Images of bags of ROS 1: as rosbags writes them, and damaged ones.

use photinus_link::bag::{Bag, BagFrames, image_topics};
use photinus_testing::{BagMessage, bag, python_with};
use rand_pcg::Pcg64;

use crate::malformed::{peak_mb, spoilt};

const SCRIPT: &str = include_str!("write_images.py");
const COUNT: usize = 25;

/// What the script draws.
fn pixels(number: usize) -> Vec<u8> {
    (0..20 * 16).map(|place| ((7 * place + number) % 256) as u8).collect()
}

#[test]
fn images_of_a_bag_are_read_as_rosbags_wrote_them() {
    let Some(mut python) = python_with(&["rosbags", "numpy"]) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let done =
        python.args(["-c", SCRIPT]).arg(folder.path()).arg(COUNT.to_string()).status().expect("Python runs");
    assert!(done.success());
    for name in ["mono8", "mono16", "mono16-big", "png"] {
        let path = folder.path().join(format!("{name}.bag"));
        let topics = image_topics(&Bag::open(&path).expect("a bag"));
        assert_eq!((topics.len(), topics[0].frames), (1, Some(COUNT as u64)), "{name}");
        let frames = BagFrames::open(&path, None).expect("it has images");
        assert_eq!(frames.total(), Some(COUNT as u64));
        let frames: Vec<_> = frames.map(|frame| frame.expect("an image")).collect();
        assert_eq!(frames.len(), COUNT, "{name}");
        for (number, frame) in frames.iter().enumerate() {
            assert_eq!(
                (frame.index, frame.time_s),
                (number as u64, Some(1_700_000_000.25 + number as f64)),
                "{name}"
            );
            assert_eq!(
                (frame.image.view().width(), frame.image.pixels()),
                (20, &pixels(number)[..]),
                "{name}"
            );
            assert!(frame.source.ends_with(":/camera/image_raw"), "{}", frame.source);
        }
        assert!(BagFrames::open(&path, Some("/said")).is_err(), "that is no image");
    }
}

/// What ROS 1 serializes of an image, by its definition.
fn image_of_ros1(number: u32) -> Vec<u8> {
    let bytes = |bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), bytes].concat();
    let numbers =
        |numbers: &[u32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    [
        numbers(&[number, 100 + number, 5]),
        bytes(b"cam"),
        numbers(&[4, 6]),
        bytes(b"mono8"),
        vec![0],
        numbers(&[6]),
        bytes(&[number as u8; 24]),
    ]
    .concat()
}

#[test]
fn damaged_bags_give_images_or_errors_and_come_to_an_end() {
    let of = |number| BagMessage {
        topic: "/image",
        kind: "sensor_msgs/Image",
        time: (100 + number, 9),
        bytes: image_of_ros1(number),
    };
    let whole = bag(&[(0..4).map(of).collect(), (4..8).map(of).collect()], |bytes| ("none", bytes));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.bag");
    std::fs::write(&path, &whole).expect("it is written");
    let frames: Vec<_> = BagFrames::open(&path, Some("/image")).expect("a bag").map(Result::unwrap).collect();
    assert_eq!((frames.len(), frames[7].image.pixels()), (8, &[7_u8; 24][..]));
    // What stands behind the first 4 KiB, which are padding.
    let start = whole.len().min(4100);
    let mut random = Pcg64::new(11, 1);
    let (before_mb, mut opened, mut read) = (peak_mb(), 0, 0);
    for _ in 0..3000 {
        let spoilt = [&whole[..start], &spoilt(&mut random, &whole[start..])].concat();
        std::fs::write(&path, &spoilt).expect("it is written");
        let Ok(frames) = BagFrames::open(&path, None) else { continue };
        opened += 1;
        let frames: Vec<_> = frames.take(1000).collect();
        assert!(frames.len() < 200, "{} frames of {} bytes", frames.len(), spoilt.len());
        read += frames.iter().filter(|frame| frame.is_ok()).count();
    }
    assert!(opened > 100 && read > 100, "{opened} {read}");
    assert!(peak_mb() - before_mb < 64.0);
}
