//! Any bytes as a bag of ROS 1 and as an MCAP recording with poses: what is read is in the order of its times.
#![no_main]

use photinus_io::dataset::TimedPose;
use photinus_link::bag::Bag;
use photinus_link::poses::read_poses;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let file = std::env::temp_dir().join(format!("photinus-{}-fuzz.bag", std::process::id()));
    std::fs::write(&file, bytes).expect("there is room");
    if let Ok(bag) = Bag::open(&file) {
        for topic in bag.topics() {
            let _ = bag.messages(&topic, |_| Ok(()));
        }
    }
    match read_poses(&file, None) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(poses) => assert!(poses.is_sorted_by(|a: &TimedPose, b| a.time_s < b.time_s)),
    }
});
