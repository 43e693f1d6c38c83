//! Any bytes as an MCAP recording: its frames are read, and it is recovered; and as the messages that come over a network.
#![no_main]

use photinus_link::cdr;
use photinus_link::recording::{Frames, recover};
use photinus_link::ros::{CompressedImage, Image, Imu, NeighbourArray};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let folder = std::env::temp_dir();
    let [file, mended] = ["fuzz.mcap", "fuzz.mended.mcap"]
        .map(|name| folder.join(format!("photinus-{}-{name}", std::process::id())));
    std::fs::write(&file, bytes).expect("there is room");
    if let Ok(frames) = Frames::open(&file, None) {
        frames.take(10).for_each(drop);
    }
    let _ = std::fs::remove_file(&mended);
    let _ = recover(&file, &mended);
    if let Ok(image) = cdr::decode::<Image<'_>>(bytes) {
        let _ = image.grey();
    }
    let _ = cdr::decode::<CompressedImage<'_>>(bytes);
    let _ = cdr::decode::<Imu>(bytes);
    let _ = cdr::decode::<NeighbourArray>(bytes);
});
