//! The tables of a configuration become sinks, and a run that hands them frames is in the recording, bit for bit.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use photinus::camera::{Camera as Lens, Model, Pinhole, Pixel};
use photinus_io::calibration::MountingFile;
use photinus_io::frames::{Frame, Moved};
use photinus_io::image::GreyImage;
use photinus_link::config::{Camera, Record};
use photinus_link::messages::Viewpoint;
use photinus_link::recording::{Frames, Recording};
use photinus_run::Entry;
use photinus_run::health::{Health, Level, Notice};

use crate::sample;

pub(crate) fn camera() -> Camera {
    let lens = Pinhole::new([300.0, 300.0], Pixel::new(15.5, 15.5), [0.0; 6], [0.0; 2]).expect("a lens");
    let mounting = MountingFile {
        body_from_camera: UnitQuaternion::identity(),
        rotation_covariance_rad2: Matrix3::zeros(),
        position_m: Some(Vector3::zeros()),
        position_covariance_m2: None,
    };
    Camera {
        view: Viewpoint::new(Some("left"), None),
        lens: Lens::new(Model::Pinhole(lens), 32, 32, None).expect("a camera"),
        mask: None,
        mounting: Some(mounting),
    }
}

pub(crate) fn table<T: serde::de::DeserializeOwned>(text: &str) -> T {
    toml::from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

#[test]
fn a_run_is_in_its_recording() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    let mut sink =
        table::<Record>(&format!("file = {path:?}\npixels = \"raw\"")).open(&[camera()]).expect("a file");
    let frame = |index: u64| Frame {
        image: GreyImage::new(vec![index as u8; 32 * 32], 32, 32).expect("a size"),
        index,
        time_s: Some(index as f64 / 60.0),
        source: format!("frame {index}"),
        gravity: None,
        exposure_s: None,
        moved: Moved::default(),
        conversions: Vec::new(),
    };
    for index in 0..5 {
        let mut entry = Entry::from_frame(frame(index));
        entry.record.neighbours = sample::record(0, 0.0).neighbours;
        sink.frame(&entry).expect("it is written");
    }
    sink.health(&Health { up_s: 1.0, cameras: Vec::new(), sinks: Vec::new(), wake_up_ms: None })
        .expect("it is written");
    let text = "the camera is gone".to_owned();
    sink.notice(&Notice { level: Level::Error, up_s: 1.0, text }).expect("it is written");
    sink.finish().expect("it ends");
    let read: Vec<Frame> =
        Frames::open(&path, None).expect("whole").map(|frame| frame.expect("good")).collect();
    assert_eq!(read, (0..5).map(frame).collect::<Vec<_>>());
    let counted = |name: &str| {
        let topics = Recording::open(&path).expect("whole").topics();
        topics.into_iter().find(|topic| topic.name == name).and_then(|topic| topic.messages)
    };
    assert_eq!(
        ["/photinus/results", "/tf_static", "/photinus/notices", "/diagnostics"].map(counted),
        [Some(5), Some(1), Some(1), Some(1)]
    );
}

#[test]
fn what_has_no_meaning_is_refused() {
    assert!(toml::from_str::<Record>("file = \"a.mcap\"\nspeed = 3").is_err());
    let split = table::<Record>("file = \"never.mcap\"\nsplit_s = -1.0");
    assert!(split.open(&[camera()]).is_err());
}

#[test]
fn a_recording_of_nothing_is_not_left_behind() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("{time}.mcap");
    let sink = table::<Record>(&format!("file = {path:?}")).open(&[camera()]).expect("a file");
    let count = || std::fs::read_dir(folder.path()).expect("it is there").count();
    assert_eq!(count(), 1);
    drop(sink);
    assert_eq!(count(), 0);
}

#[cfg(feature = "mavlink")]
#[test]
fn an_autopilot_needs_to_know_how_cameras_sit() {
    use photinus_link::config::Mavlink;
    use photinus_run::motion::Motion;
    let link: Mavlink = table("peer = \"127.0.0.1:14540\"\nradius_m = 0.4");
    assert!(link.open(&[camera()], Motion::default()).is_ok());
    let unknown = Camera { mounting: None, ..camera() };
    assert!(
        link.open(&[unknown], Motion::default())
            .is_err_and(|error| error.to_string().contains("give its mounting"))
    );
    let none: Mavlink = table("peer = \"nowhere\"");
    assert!(none.open(&[camera()], Motion::default()).is_err());
}
