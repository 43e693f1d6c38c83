//! Datasets with several cameras, identities, gyro and odometry.

use nalgebra::{Isometry3, Matrix3, Unit, UnitQuaternion, Vector3};

use super::*;
use crate::calibration::{MountingFile, mounting_text};
use crate::frames::FrameSource;
use crate::image::GreyImage;
use crate::scratch::Folder;

const RIG: &str = r#"airframe = "airframe.toml"
exposure_us = 1000.0
rate_hz = 60
codes = "book.txt"
vehicles = "vehicles.toml"
[[camera]]
name = "front"
camera = "camera.toml"
mounting = "front/mounting.toml"
frames = "front/frames.csv"
[[camera]]
name = "back"
camera = "camera.toml"
mounting = "back/mounting.toml"
frames = "back/frames.csv"
mask = "back/mask.png"
exposure_us = 500.0
"#;
const QUAD: &str =
    "name = \"quad\"\nring = { arms = 4, radius_m = 0.3, leds_per_arm = 1, splay_deg = 0.0 }\n";
const VEHICLES: &str = "[[vehicle]]\nid = 7\nairframe = \"airframe.toml\"\nwords = [1]\nbit_rate_hz = 60.0\n\
[[vehicle]]\nid = 9\nairframe = \"airframe.toml\"\n";

fn rig() -> RigInfo {
    match DatasetToml::parse(RIG, "dataset.toml").unwrap() {
        DatasetToml::Rig(rig) => rig,
        DatasetToml::One(_) => panic!("two cameras"),
    }
}

fn mounting(x_m: f64) -> MountingFile {
    MountingFile {
        body_from_camera: UnitQuaternion::from_euler_angles(0.1, -0.2, x_m),
        rotation_covariance_rad2: Matrix3::identity() * 1e-6,
        position_m: Some(Vector3::new(x_m, 0.0, 0.05)),
        position_covariance_m2: None,
    }
}

fn image(seed: u8) -> GreyImage {
    GreyImage::new(vec![seed; 12], 4, 3).unwrap()
}

/// A folder with all that such a dataset can hold; of each camera frames 0 and 2.
fn written(test: &str) -> Folder {
    let scratch = Folder::new(test);
    let mut writer = DatasetWriter::create_rig(scratch.path(), &rig()).unwrap();
    for (camera, name) in ["front", "back"].into_iter().enumerate() {
        let text = mounting_text(&mounting(camera as f64));
        scratch.file(&format!("{name}/mounting.toml"), text.as_bytes());
        for number in [0, 2] {
            writer.image(camera, number, &image(10 * camera as u8 + number as u8).view()).unwrap();
            writer.row(camera, number, number as f64 + 0.1, Some(Vector3::y_axis()), number).unwrap();
        }
    }
    scratch.file("airframe.toml", QUAD.as_bytes());
    scratch.file("book.txt", b"0,1,1\n1,0,0\n");
    scratch.file("vehicles.toml", VEHICLES.as_bytes());
    for i in 0..3_u8 {
        let time_s = f64::from(i) / 3.0;
        let turn = Vector3::new(0.1, -0.2, 1.0 / 3.0);
        writer.imu(&ImuRow { time_s, turn_rad_s: turn }).unwrap();
        let pose = Isometry3::new(turn, turn * 3.0);
        writer.odometry(&OdometryRow { time_s, pose, velocity_m_s: turn, velocity_sigma_m_s: None }).unwrap();
    }
    scratch
}

#[test]
fn a_rig_written_is_read_back() {
    let scratch = written("rig");
    let dataset = Dataset::read(scratch.path()).unwrap();
    let [front, back] = dataset.cameras() else { panic!("two cameras") };
    assert_eq!((front.name.as_deref(), back.name.as_deref()), (Some("front"), Some("back")));
    assert_eq!((front.mounting, back.mounting), (Some(mounting(0.0)), Some(mounting(1.0))));
    assert_eq!(
        (front.exposure_us.to_bits(), back.exposure_us.to_bits()),
        (1000_f64.to_bits(), 500_f64.to_bits())
    );
    assert_eq!((&front.mask, back.mask.as_deref()), (&None, Some(Path::new("back/mask.png"))));
    assert_eq!(back.frames[1].image, Path::new("back/images/000002.png"));
    assert_eq!((dataset.info().mask.as_ref(), dataset.frames()), (None, front.frames.as_slice()));
    let frames: Vec<_> =
        FrameSource::dataset_camera(dataset.clone(), 1).map(|frame| frame.unwrap()).collect();
    assert_eq!((frames.len(), frames[1].index, &frames[1].image), (2, 2, &image(12)));
    assert_eq!(FrameSource::dataset_camera(dataset.clone(), 2).count(), 0);
    std::fs::remove_file(dataset.path("back/images/000002.png")).unwrap();
    let lost = FrameSource::dataset_camera(dataset.clone(), 1).nth(1).unwrap().unwrap_err().to_string();
    assert!(lost.ends_with("line 3 of back/frames.csv names it: restore it or remove that line"), "{lost}");

    assert_eq!(dataset.codes().unwrap().words().len(), 2);
    let [seven, nine] = dataset.vehicles() else { panic!("two vehicles") };
    assert_eq!((seven.id, seven.airframe.leds().len(), nine.blink.as_ref()), (7, 4, None));
    let blink = seven.blink.as_ref().unwrap();
    assert_eq!((blink.words.as_slice(), blink.bit_rate_hz.to_bits()), (&[1][..], 60_f64.to_bits()));
    let (imu, odometry) = (dataset.imu().unwrap().unwrap(), dataset.odometry().unwrap().unwrap());
    assert_eq!((imu.len(), imu[1].time_s, imu[2].turn_rad_s.z), (3, 1.0 / 3.0, 1.0 / 3.0));
    let pose = Isometry3::new(Vector3::new(0.1, -0.2, 1.0 / 3.0), Vector3::new(0.1, -0.2, 1.0 / 3.0) * 3.0);
    assert_eq!((odometry[2].pose, odometry[2].velocity_m_s.y), (pose, -0.2));
}

#[test]
fn a_plain_dataset_has_one_camera_without_a_name() {
    let scratch = Folder::new("rig-plain");
    let text =
        "camera = \"c.toml\"\nairframe = \"a.toml\"\nexposure_us = 1.0\nrate_hz = 9.0\nmask = \"m.png\"\n";
    let info = DatasetInfo::parse(text, "t").unwrap();
    let mut writer = DatasetWriter::create(scratch.path(), &info).unwrap();
    writer.frame(&image(1).view(), 0.0, Some(Unit::new_unchecked(Vector3::y()))).unwrap();
    let dataset = Dataset::read(scratch.path()).unwrap();
    let [camera] = dataset.cameras() else { panic!("one camera") };
    assert_eq!((&camera.name, &camera.mounting, &camera.mask), (&None, &None, &info.mask));
    assert_eq!((&camera.camera, camera.frames_file.as_path()), (&info.camera, Path::new("frames.csv")));
    assert_eq!((dataset.vehicles().len(), dataset.codes()), (0, None));
    assert_eq!((dataset.imu().unwrap(), dataset.odometry().unwrap()), (None, None));
    assert!(writer.row(1, 0, 0.0, None, 0).unwrap_err().to_string().ends_with("no camera number 1"));
}

#[test]
fn a_row_may_show_the_image_of_another_frame() {
    let scratch = Folder::new("rig-swapped");
    let mut writer = DatasetWriter::create_rig(scratch.path(), &rig()).unwrap();
    for (number, shown) in [(0, 1), (1, 0)] {
        writer.image(0, number, &image(number as u8).view()).unwrap();
        writer.row(0, number, number as f64, None, shown).unwrap();
    }
    let text = std::fs::read_to_string(scratch.path().join("front/frames.csv")).unwrap();
    assert!(text.ends_with("0,0,front/images/000001.png,,,\n1,1,front/images/000000.png,,,\n"), "{text}");
    assert!(writer.row(0, 1, 9.0, None, 1).unwrap_err().to_string().contains("number 1 does not come after"));
    assert!(writer.row(0, 9, 1.0, None, 9).unwrap_err().to_string().contains("1 s is no time after"));
}

#[test]
fn what_is_wrong_with_a_rig_is_named() {
    let both = "camera = \"c.toml\"\n";
    for (from, to, message) in [
        ("name = \"back\"", "name = \"front\"", "`camera[1].name`: another camera is called `front`"),
        ("name = \"back\"", "name = \"../x\"", "`camera[1].name`: `../x` is no name"),
        ("back/frames.csv", "front/frames.csv", "`camera[1].frames`: another camera has the frames of "),
        ("front/mounting.toml", "", "`camera[0].mounting`: the path is empty"),
        ("exposure_us = 500.0", "exposure_us = 1e300", "`camera[1].exposure_us`: 1e300 is"),
        ("mask = \"back", "masks = \"back", "line 16: unknown key `masks`"),
        ("mounting = \"back/mounting.toml\"\n", "", "missing key `mounting`"),
        ("codes =", "mask =", "`mask`: it is not said of which camera"),
        ("airframe = \"airframe", both, "line "),
        ("rate_hz = 60", "rate_hz = 1e-308", "`rate_hz`: 1e-308 is"),
    ] {
        let text = RIG.replacen(from, to, 1);
        assert_ne!(text, RIG, "{from}");
        let error = DatasetToml::parse(&text, "d/dataset.toml").unwrap_err().to_string();
        assert!(error.contains(message), "{error}\nnot {message}");
    }
    let error = DatasetInfo::parse(RIG, "d/dataset.toml").unwrap_err().to_string();
    assert!(error.starts_with("d/dataset.toml, `camera`: it lists cameras of a rig"), "{error}");
    let error = DatasetToml::parse("camera = 3\n", "d/dataset.toml").unwrap_err().to_string();
    assert!(error.contains("line 1: ") && error.contains("where a camera file"), "{error}");
}

#[test]
fn what_is_wrong_with_vehicles_is_named() {
    for (from, to, message) in [
        ("id = 9", "id = 7", "`vehicle[1].id`: vehicle 7 stands twice"),
        ("words = [1]", "words = [2]", "`vehicle[0].words`: word 2 of 2 words"),
        ("words = [1]", "words = [0, 1]", "`vehicle[0].words`: 2 words for 1 signals"),
        ("words = [1]\n", "", "`vehicle[0].words`: there is none"),
        ("bit_rate_hz = 60.0\n", "", "`vehicle[0].bit_rate_hz`: it is missing"),
        ("60.0", "1e9", "`vehicle[0].bit_rate_hz`: 1000000000.0 is out of range"),
        ("id = 9", "id = 9\nword = 3", "unknown key `word`"),
    ] {
        let scratch = written("rig-vehicles");
        scratch.file("vehicles.toml", VEHICLES.replacen(from, to, 1).as_bytes());
        let error = Dataset::read(scratch.path()).unwrap_err().to_string();
        assert!(error.contains("vehicles.toml, ") && error.contains(message), "{error}\nnot {message}");
    }
    let scratch = written("rig-no-book");
    scratch.file("dataset.toml", RIG.replace("codes = \"book.txt\"\n", "").as_bytes());
    let error = Dataset::read(scratch.path()).unwrap_err().to_string();
    assert!(error.contains("`vehicle[0].words`: there is no book of words; name it as codes"), "{error}");
}

#[test]
fn what_is_wrong_with_measurements_is_named_by_its_line() {
    let imu = "time_s,wx_rad_s,wy_rad_s,wz_rad_s\n0,0,0,0\n";
    for (row, message) in [
        ("1,0,0", "3 values for 4 columns"),
        ("0,0,0,0", "0 s does not come after the line before"),
        ("1,0,1e300,0", "wy_rad_s 1e300 is"),
        ("1,0,nan,0", "wy_rad_s `nan` is not a number"),
        ("1e300,0,0,0", "time_s 1e300 is"),
        ("one,0,0,0", "time_s `one` is not a number"),
    ] {
        let error = parse_imu(&format!("{imu}{row}\n"), "d/imu.csv").unwrap_err().to_string();
        assert!(error.starts_with(&format!("d/imu.csv, line 3: {message}")), "{error}");
    }
    assert!(
        parse_imu("t,x\n", "d/imu.csv").unwrap_err().to_string().contains("they must be `time_s,wx_rad_s")
    );
    assert!(parse_imu("", "d/imu.csv").unwrap_err().to_string().contains("line 1: the columns are ``"));
    let head = "time_s,x_m,y_m,z_m,qx,qy,qz,qw,vx_m_s,vy_m_s,vz_m_s\n";
    assert!(parse_imu(head, "d/imu.csv").is_err());
    for (row, message) in [
        ("0,0,0,0,0,0,0,0.5,0,0,0", "line 2: the quaternion has length 0.5, not 1"),
        ("0,0,1e7,0,0,0,0,1,0,0,0", "line 2: y_m 10000000.0 is out of range; give -1000000 to 1000000"),
    ] {
        let error = parse_odometry(&format!("{head}{row}\n"), "d/odometry.csv").unwrap_err().to_string();
        assert!(error.starts_with(&format!("d/odometry.csv, {message}")), "{error}");
    }
    // Without velocities they are the slope of the places.
    let slopes = |rows: &str| {
        let rows = parse_odometry(&format!("time_s,x_m,y_m,z_m,qx,qy,qz,qw\n{rows}"), "d/o.csv").unwrap();
        rows.iter().map(|row| row.velocity_m_s.x).collect::<Vec<_>>()
    };
    assert_eq!(slopes("0,0,0,0,0,0,0,1\n1,1,0,0,0,0,0,1\n3,7,0,0,0,0,0,1\n"), [1.0, 7.0 / 3.0, 3.0]);
    assert_eq!(slopes("2,5,0,0,0,0,0,1\n"), [0.0]);
    // What velocities are off by may be told; nothing is off by nothing.
    let with_sigma = head.replace('\n', ",velocity_sigma_m_s\n");
    let row = "0,0,0,0,0,0,0,1,2,0,0";
    let sigma = |cell: &str| {
        let rows = parse_odometry(&format!("{with_sigma}{row},{cell}\n"), "d/o.csv");
        rows.map(|rows| (rows[0].velocity_m_s.x, rows[0].velocity_sigma_m_s))
    };
    assert_eq!(sigma("0.25").unwrap(), (2.0, Some(0.25)));
    assert!(sigma("0").unwrap_err().to_string().contains("velocity_sigma_m_s 0.0 is out of range"));
    assert_eq!(parse_odometry(&format!("{head}{row}\n"), "d/o.csv").unwrap()[0].velocity_sigma_m_s, None);
    assert!(parse_odometry(head, "d/o.csv").unwrap_err().to_string().contains("it holds no measurement"));
}

#[test]
fn truth_says_its_camera_and_refuses_what_is_not_of_this_world() {
    let line = "{\"frame\":3,\"camera\":\"front\",\"time_s\":0.25,\"true_time_s\":0.125,\"neighbours\":[]}\n";
    let truth = &parse_truth(line, "t").unwrap()[0];
    assert_eq!((truth.camera.as_deref(), truth.true_time_s), (Some("front"), Some(0.125)));
    assert_eq!(serde_json::to_string(truth).unwrap() + "\n", line);
    let error = parse_truth(&line.replace("0.25", "1e300"), "t.jsonl").unwrap_err().to_string();
    assert!(error.starts_with("t.jsonl, line 1: column ") && error.contains(" is out of range"), "{error}");
    let far = "{\"frame\":0,\"time_s\":0,\"neighbours\":[{\"id\":1,\"position_m\":[1e9,2,3],\
               \"orientation_xyzw\":[0,0,0,1],\"distance_m\":3.7,\"leds\":[]}]}";
    assert!(parse_truth(far, "t").unwrap_err().to_string().contains("1000000000.0 is out of range"));
}
