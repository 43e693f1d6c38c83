//! What goes into a recording comes out, bit for bit.

use nalgebra::{Rotation3, Unit, Vector3};
use photinus::tracking::{Moving, Turned};
use photinus_io::frames::{Frame, Moved, Together};
use photinus_io::image::GreyImage;
use photinus_io::results::FrameRecord;
use photinus_link::messages::Viewpoint;
use photinus_link::recording::{
    Frames, Located, Pixels, Recorder, Recording, Settings, image_topics, recover,
};
use photinus_link::topics;
use proptest::prelude::*;

use crate::sample;

fn view() -> Viewpoint {
    Viewpoint::new(Some("left"), Some(1e-3))
}

fn image(seed: usize, width: usize, height: usize) -> GreyImage {
    let pixels = (0..width * height).map(|place| (place * 7 + seed * 31) as u8).collect();
    GreyImage::new(pixels, width, height).expect("it has a size")
}

fn write(recorder: &mut Recorder, frame: &Frame, arrived_ns: u64) {
    let record = FrameRecord { source: frame.source.clone(), ..sample::record(frame.index, 0.0) };
    let record = FrameRecord { time_s: frame.time_s, ..record };
    let located = Located {
        record: &record,
        image: Some(frame.image.view()),
        gravity: frame.gravity,
        moved: frame.moved,
    };
    recorder.located(&located, &view().exposed(frame.exposure_s), arrived_ns).expect("it is written");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn frames_come_back_bit_for_bit(
        times in proptest::collection::vec(-1e11..1e11_f64, 1..6),
        down in proptest::array::uniform3(0.1..1.0_f64),
        (width, height) in (16_usize..40, 16_usize..40),
        is_png in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("r.mcap");
        let mut settings = Settings::default();
        settings.pixels = if is_png { Pixels::Png } else { Pixels::Raw };
        let mut recorder = Recorder::create(&path, settings, None).expect("a file");
        let written: Vec<Frame> = times.iter().zip(0..).map(|(&time_s, index)| Frame {
            image: image(index, width, height),
            index: index as u64 * 3,
            time_s: (index != 2).then_some(time_s),
            source: format!("images/{index}.png"),
            gravity: (index != 1).then(|| Unit::new_normalize(Vector3::from(down))),
            moved: moved(index, &down),
            exposure_s: Some(1e-3 / (1 + index % 3) as f64),
            conversions: Vec::new(),
        }).collect();
        for (frame, arrived) in written.iter().zip(1..) {
            write(&mut recorder, frame, arrived * 1_000);
        }
        recorder.finish().expect("it ends");
        let frames = Frames::open(&path, None).expect("it is whole");
        prop_assert_eq!(frames.total(), Some(written.len() as u64));
        let read: Vec<Frame> = frames.map(|frame| frame.expect("a frame")).collect();
        prop_assert_eq!(read, written);
    }
}

/// Of some frames one thing is known, of some another, of some both.
fn moved(index: usize, by: &[f64; 3]) -> Moved {
    let vector = Vector3::from(*by);
    let turned = Turned { now_from_before: Rotation3::new(vector), sigma_rad: 1e-3 * by[0].abs() };
    let moving = Moving { velocity_m_s: vector / 3.0, sigma_m_s: 0.1 };
    let together = Together { order: index as u64, turned: (index != 2).then_some(turned) };
    Moved {
        turned: (index != 1).then_some(turned),
        moving: (!index.is_multiple_of(3)).then_some(moving),
        together: (!index.is_multiple_of(2)).then_some(together),
    }
}

fn frame(index: u64) -> Frame {
    let time_s = Some(index as f64 / 60.0);
    let source = "s".to_owned();
    Frame {
        image: image(index as usize, 16, 16),
        index,
        time_s,
        source,
        gravity: None,
        exposure_s: Some(1e-3),
        moved: Moved::default(),
        conversions: Vec::new(),
    }
}

#[test]
fn a_long_recording_goes_on_in_other_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("flight.mcap");
    let mut settings = Settings::default();
    settings.split.seconds = Some(2.0);
    let mut recorder = Recorder::create(&path, settings, None).expect("a file");
    for index in 0..10 {
        write(&mut recorder, &frame(index), index * 500_000_000);
    }
    recorder.finish().expect("it ends");
    let numbers = |name: &str| -> Vec<u64> {
        let frames = Frames::open(folder.path().join(name), None).expect("it is whole");
        frames.map(|frame| frame.expect("a frame").index).collect()
    };
    let all: Vec<Vec<u64>> = ["flight.mcap", "flight.1.mcap", "flight.2.mcap"].map(numbers).into();
    assert_eq!(all, [vec![0, 1, 2, 3], vec![4, 5, 6, 7], vec![8, 9]]);
    assert!(Recorder::create(&path, Settings::default(), None).is_err(), "it is there already");
}

#[test]
fn a_frame_is_never_torn_between_two_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("flight.mcap");
    let mut settings = Settings::default();
    // Full after every message.
    settings.split.bytes = Some(1);
    let mut recorder = Recorder::create(&path, settings, None).expect("a file");
    (0..3).for_each(|index| write(&mut recorder, &frame(index), index));
    recorder.finish().expect("it ends");
    for (name, index) in ["flight.mcap", "flight.1.mcap", "flight.2.mcap"].iter().zip(0..) {
        let frames = Frames::open(folder.path().join(name), None).expect("it is whole");
        assert_eq!(frames.map(|frame| frame.expect("a frame")).collect::<Vec<_>>(), [frame(index)]);
    }
}

#[test]
fn a_file_cut_anywhere_is_mended_up_to_the_cut() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, cut, mended) =
        (folder.path().join("r.mcap"), folder.path().join("cut.mcap"), folder.path().join("mended.mcap"));
    let mut recorder = Recorder::create(&path, Settings::default(), None).expect("a file");
    let mut ends = Vec::new();
    for index in 0..20 {
        write(&mut recorder, &frame(index), index * 100_000_000);
        recorder.flush().expect("it is flushed");
        ends.push(std::fs::metadata(&path).expect("it is there").len());
    }
    recorder.finish().expect("it ends");
    let bytes = std::fs::read(&path).expect("it is there");
    for at in (200..bytes.len()).step_by(997).chain([bytes.len()]) {
        std::fs::write(&cut, &bytes[..at]).expect("it is written");
        let _ = std::fs::remove_file(&mended);
        let told = recover(&cut, &mended).expect("it is mended");
        let whole = ends.iter().filter(|&&end| end <= at as u64).count();
        if at < bytes.len() {
            assert!(Frames::open(&cut, None).is_err(), "cut at {at}");
        }
        if whole == 0 {
            continue;
        }
        let frames: Vec<_> = Frames::open(&mended, None)
            .unwrap_or_else(|error| panic!("cut at {at}: {error}"))
            .map(|frame| frame.expect("a frame"))
            .collect();
        assert!(frames.len() >= whole, "cut at {at}: {} of {whole}, {told:?}", frames.len());
        assert!(frames.iter().zip(0..).all(|(read, index)| *read == self::frame(index)), "cut at {at}");
    }
    std::fs::write(&cut, b"nothing").expect("it is written");
    std::fs::remove_file(&mended).expect("it is there");
    assert!(recover(&cut, &mended).is_err() && !mended.exists());
}

#[test]
fn damaged_recordings_are_errors_or_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("r.mcap");
    let mut recorder = Recorder::create(&path, Settings::default(), None).expect("a file");
    (0..3).for_each(|index| write(&mut recorder, &frame(index), index * 100_000_000));
    recorder.finish().expect("it ends");
    let bytes = std::fs::read(&path).expect("it is there");
    let (mut refused, mut read) = (0, 0);
    for case in 0..2_000_usize {
        let (kind, at, value) = ((case % 3) as u8, case.wrapping_mul(2_654_435_761), (case / 7) as u8);
        std::fs::write(&path, photinus_testing::damage(bytes.clone(), kind, at, value))
            .expect("it is written");
        match Frames::open(&path, None) {
            Err(error) => {
                assert!(!error.to_string().is_empty());
                refused += 1;
            }
            Ok(frames) => read += frames.take(10).filter(Result::is_ok).count(),
        }
        let mended = folder.path().join("mended.mcap");
        let _ = std::fs::remove_file(&mended);
        let _ = recover(&path, &mended);
    }
    assert!(refused > 500 && read > 500, "{refused} {read}");
}

#[test]
fn a_recording_tells_what_it_holds() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("r.mcap");
    let mut recorder = Recorder::create(&path, Settings::default(), None).expect("a file");
    write(&mut recorder, &frame(0), 5);
    recorder.finish().expect("it ends");
    let recording = Recording::open(&path).expect("it is whole");
    let names: Vec<String> = recording.topics().into_iter().map(|topic| topic.name).collect();
    assert!(names.iter().any(|name| name == topics::DETECTIONS), "{names:?}");
    let images = image_topics(&recording);
    assert_eq!(images.len(), 1);
    assert_eq!((images[0].name.as_str(), images[0].frames), ("/photinus/left/image/compressed", Some(1)));
    assert!(Frames::open(&path, Some("left")).is_ok() && Frames::open(&path, Some("right")).is_err());
}
