//! Whatever the bytes, a parser gives a value or an error, never a panic; and what it gives, it takes back.
//!
//! The targets in `fuzz/` check the same without an end; these are the part that fits a test run.

use std::io::Cursor;
use std::path::Path;

use photinus::ranging::{Envelope, SpotCurve};
use photinus_io::airframe::{Tolerances, layout_text, parse_airframe, toml_text};
use photinus_io::calibration::{
    mounting_text, parse_known_sightings, parse_led_sightings, parse_mounting, parse_spot_sizes,
};
use photinus_io::camera::{parse_camera, write_camera_toml};
use photinus_io::codes::{codes_text, parse_codes};
use photinus_io::corners::parse_corners;
use photinus_io::dataset::{
    DatasetInfo, DatasetToml, GravityLog, ImuRow, OdometryRow, parse_frames_csv, parse_imu, parse_odometry,
    parse_poses, parse_truth, parse_vehicles, vehicles_text,
};
use photinus_io::image::decode_image;
use photinus_io::results::ResultsReader;
use photinus_io::spot_curve::{self, SpotCurveFile, parse_spot_curve};
use photinus_io::video::{RawFormat, RawFrames, Y4mFrames, Y4mWriter};
use photinus_testing::damage;
use proptest::prelude::*;

const DATASET: &str =
    "camera = \"c.txt\"\nairframe = \"a.toml\"\nexposure_us = 1000.0\nrate_hz = 60.0\nmask = \"m.png\"\n";
const RIG: &str = "airframe = \"a.toml\"\nexposure_us = 1000.0\nrate_hz = 60.0\ncodes = \"b.txt\"\n\
    vehicles = \"v.toml\"\n[[camera]]\nname = \"front\"\ncamera = \"c.txt\"\nmounting = \"front/m.toml\"\n\
    frames = \"front/frames.csv\"\nexposure_us = 500.0\n";
const VEHICLES: &str = "[[vehicle]]\nid = 7\nairframe = \"a.toml\"\nwords = [1, 0]\nbit_rate_hz = 60.0\n[[vehicle]]\nid = 9\nairframe = \"b.toml\"\n";
const IMU: &str = "time_s,wx_rad_s,wy_rad_s,wz_rad_s\n0.0,0.1,-0.25,3e-5\n0.005,0,0,1\n";
const ODOMETRY: &str =
    "time_s,x_m,y_m,z_m,qx,qy,qz,qw,vx_m_s,vy_m_s,vz_m_s\n0.5,1,-2,3,0,0.6,0,0.8,0,0,1.5\n";
const POSES: &str = "time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0.5,1,-2,3,0,0.6,0,0.8\n";
const GRAVITY: &str = "time_s,gx,gy,gz\n0,0,0.6,0.8\n1.5,0,1,0\n";
const FRAMES: &str = "frame,time_s,image,gx,gy,gz\n0,0.0,images/0.png,,,\n1,0.016,images/1.png,0.0,1.0,0.0\n";
const TRUTH: &str = "{\"frame\":0,\"time_s\":0.5,\"neighbours\":[{\"id\":1,\"position_m\":[1,2,3],\
    \"orientation_xyzw\":[0,0,0,1],\"distance_m\":3.7,\"leds\":[{\"u_px\":1.5,\"v_px\":2}]}]}\n";
const AIRFRAME: &str = "name = \"pair\"\n[[led]]\nposition_m = [0.4, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\n\
    lobe = \"lambertian\"\n[[led]]\nposition_m = [-0.4, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\nlobe = \"omni\"\n\
    signal = 3\n";
const RING: &str =
    "name = \"hexa\"\nring = { arms = 6, radius_m = 0.4, leds_per_arm = 2, splay_deg = 90.0 }\n";
const LAYOUT: &str =
    "# X Y Z Type Pitch Yaw signal_id\n0.2 0 0 0 0.1 0.5 0\n-0.2 0 0.1 1 0 3.1 1\n0 0.2 0 2 0 0 1\n";
const BLINK: &str = "# words\n0,1,1,0\n1,1,0,1\n";
const SPOT_CURVE: &str = "exposure_us = 1000.0\nthreshold = 200\nlimit_m = 20.0\n\
    upper = { offset_px = 1.3398, scale_px_m2 = 31.4704, shift_m = -0.0154 }\n\
    lower = { offset_px = 0.9, scale_px_m2 = 12.0, shift_m = 0.0 }\n";
const SPOT_SIZES: &str = "distance_m,area_px,exposure_us\n1.5,12,1000\n# far\n9.0,0,\n";
const KNOWN: &str = "u_px,v_px,x,y,z,x_m,y_m,z_m,sigma_px\n1,2,0,0,1,,,,\n3,4,,,,0.5,-1,2,0.3\n";
const LEDS: &str = "photo,led,u_px,v_px\na.png,0,1.5,2\nb.png,0,3,4\na.png,1,5,6\n";
const MOUNTING: &str = "body_from_camera_xyzw = [0.0, 0.6, 0.0, 0.8]\nrotation_covariance_rad2 = [[1e-6, 0.0, 0.0], \
    [0.0, 1e-6, 0.0], [0.0, 0.0, 1e-6]]\nposition_m = [0.1, 0.0, -0.2]\n";
const CORNERS: &str = "image,u,v,grid_i,grid_j\na.png,101.25,77.5,0,0\na.png,120,77,1,0\nb.png,3,4,0,1\n";
const EQUIDISTANT: &str = "model = \"equidistant\"\nwidth_px = 96\nheight_px = 64\ncentre_px = [47.5, 31.5]\n\
    focal_px = [60.0, 60.0]\n";
const KANNALA_BRANDT: &str = "model = \"kannala_brandt\"\nwidth_px = 96\nheight_px = 64\ncentre_px = [47.5, 31.5]\n\
    focal_px = [60.0, 60.0]\nk = [-0.02, 0.003, 0.0, 0.0]\n";
const OCAM: &str = "5 -60 0 1.6e-3 0 0\n\n2 94 60\n\n31.5 47.5\n\n1 0 0\n\n64 96\n";
const CAMERA_INFO: &str = "image_width: 96\nimage_height: 64\ncamera_name: c\ndistortion_model: equidistant\n\
    camera_matrix:\n  rows: 3\n  cols: 3\n  data: [60, 0, 47.5, 0, 60, 31.5, 0, 0, 1]\n\
    distortion_coefficients:\n  rows: 1\n  cols: 4\n  data: [-0.02, 0.003, 0, 0]\n";
const KALIBR: &str = "cam0:\n  camera_model: pinhole\n  distortion_model: equidistant\n\
    \x20 distortion_coeffs: [-0.02, 0.003, 0.0, 0.0]\n  intrinsics: [60.0, 60.0, 47.5, 31.5]\n  resolution: [96, 64]\n";
const CAMERAS: [&str; 5] = [EQUIDISTANT, KANNALA_BRANDT, OCAM, CAMERA_INFO, KALIBR];
/// 16 x 9 pixels of grey, which no crate here writes.
const JPEG: &[u8] = include_bytes!("grey.jpg");
const RESULTS: &str = "{\"frame\":3,\"time_s\":null,\"source\":\"a\",\"spots\":[{\"u_px\":1.5,\"v_px\":2,\
    \"sigma_px\":[0.2,0.3],\"range_m\":[1,null]}],\"rejected\":[{\"u_px\":1,\"v_px\":1,\"area_px\":9,\
    \"reason\":\"sun\"}],\"neighbours\":[]}\n";

fn imu_text(rows: &[ImuRow]) -> String {
    let lines = rows.iter().map(|row| row.line() + "\n");
    lines.fold("time_s,wx_rad_s,wy_rad_s,wz_rad_s\n".to_owned(), |text, line| text + &line)
}

fn odometry_text(rows: &[OdometryRow]) -> String {
    let lines = rows.iter().map(|row| row.line() + "\n");
    let sigma = if rows[0].velocity_sigma_m_s.is_some() { ",velocity_sigma_m_s" } else { "" };
    let header = format!("time_s,x_m,y_m,z_m,qx,qy,qz,qw,vx_m_s,vy_m_s,vz_m_s{sigma}\n");
    lines.fold(header, |text, line| text + &line)
}

/// Every parser on the same bytes. What is read must also stand being written.
fn parse_all(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let _ = decode_image(bytes, "t").map_err(|error| error.to_string());
    if let Ok(frames) = Y4mFrames::new(bytes, "t") {
        frames.take(8).for_each(drop);
    }
    let format = RawFormat { width: 5, height: 3, rate_hz: Some(60.0) };
    RawFrames::new(bytes, "t", format).expect("a size of frames").take(8).for_each(drop);
    if let Ok(file) = parse_camera(bytes, Path::new("t")) {
        let mut toml = Vec::new();
        write_camera_toml(&file.camera, &mut toml, Path::new("t")).expect("a vector takes it");
        let again = parse_camera(&toml, Path::new("t")).expect("what was written is read");
        assert_eq!(again.camera, file.camera);
    }
    let _ = parse_corners(&text, Path::new("t"));
    let _ = DatasetInfo::parse(&text, "t");
    let _ = DatasetToml::parse(&text, "t");
    if let Ok(vehicles) = parse_vehicles(&text, "t") {
        let again = parse_vehicles(&vehicles_text(&vehicles), "t").expect("what was written is read");
        assert_eq!(again, vehicles);
    }
    if let Ok(rows) = parse_imu(&text, "t") {
        assert_eq!(parse_imu(&imu_text(&rows), "t").expect("what was written is read"), rows);
    }
    if let Ok(rows) = parse_odometry(&text, "t") {
        assert_eq!(parse_odometry(&odometry_text(&rows), "t").expect("what was written is read"), rows);
    }
    if let Ok(rows) = parse_poses(&text, "t") {
        assert!(!rows.is_empty());
    }
    if let Ok(log) = GravityLog::parse(&text, "t") {
        let _ = [-1.0, 0.7, f64::NAN].map(|time_s| log.at(time_s));
    }
    let _ = parse_frames_csv(&text, "t");
    let _ = parse_truth(&text, "t");
    if let Ok(file) = parse_airframe(&text, "t") {
        let again = parse_airframe(&toml_text(&file.airframe, &file.tolerances), "t")
            .expect("what was written is read");
        assert_eq!(again.airframe, file.airframe);
    }
    if let Ok(codes) = parse_codes(&text, "t") {
        assert_eq!(parse_codes(&codes_text(&codes), "t").expect("what was written is read"), codes);
    }
    if let Ok(file) = parse_spot_curve(&text, "t") {
        assert_eq!(parse_spot_curve(&spot_curve::text(&file), "t").expect("what was written is read"), file);
    }
    let _ = parse_spot_sizes(&text, "t");
    let _ = parse_known_sightings(&text, "t");
    let _ = parse_led_sightings(&text, "t");
    if let Ok(file) = parse_mounting(&text, "t") {
        assert_eq!(parse_mounting(&mounting_text(&file), "t").expect("what was written is read"), file);
    }
    ResultsReader::new(bytes, "t").for_each(drop);
}

fn encoded(format: image::ImageFormat) -> Vec<u8> {
    let ramp = image::RgbImage::from_fn(16, 9, |u, v| image::Rgb([(u * 15) as u8, (v * 25) as u8, 99]));
    let mut bytes = Cursor::new(Vec::new());
    image::DynamicImage::ImageRgb8(ramp).write_to(&mut bytes, format).expect("a small image is encoded");
    bytes.into_inner()
}

fn y4m((width, height): (usize, usize), pixels: &[u8], frames: usize) -> Vec<u8> {
    let mut writer = Y4mWriter::new(Vec::new(), "t", (width, height), (60, 1)).expect("a vector takes it");
    let frame = photinus::frame::FrameView::packed(pixels, width, height).expect("the sizes match");
    (0..frames).for_each(|_| writer.write(&frame).expect("a vector takes it"));
    writer.finish().expect("a vector takes it")
}

fn valid_files() -> Vec<Vec<u8>> {
    use image::ImageFormat::{Bmp, Png, Pnm, Tiff};
    let texts = [
        DATASET, RIG, VEHICLES, IMU, ODOMETRY, POSES, GRAVITY, FRAMES, TRUTH, AIRFRAME, RING, LAYOUT, BLINK,
        SPOT_CURVE, RESULTS,
    ];
    let calibrations = [SPOT_SIZES, KNOWN, LEDS, MOUNTING, CORNERS];
    let texts = texts.into_iter().chain(calibrations).chain(CAMERAS).map(|text| text.as_bytes().to_vec());
    let images = [Png, Bmp, Tiff, Pnm].into_iter().map(encoded);
    texts.chain(images).chain([JPEG.to_vec(), y4m((8, 6), &[7; 48], 3)]).collect()
}

fn damages() -> impl Strategy<Value = Vec<(u8, usize, u8)>> {
    proptest::collection::vec((0..4_u8, any::<usize>(), any::<u8>()), 1..4)
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        parse_all(&bytes);
    }

    #[test]
    fn no_damaged_file_panics(file in proptest::sample::select(valid_files()), damages in damages()) {
        parse_all(&damages.into_iter().fold(file, |bytes, (kind, at, value)| damage(bytes, kind, at, value)));
    }

    #[test]
    fn codes_round_trip(words in (1..40_usize).prop_flat_map(|bits| {
        proptest::collection::vec(proptest::collection::vec(any::<bool>(), bits), 1..20)
    })) {
        let bit = |&on: &bool| if on { "1" } else { "0" };
        let line = |word: &Vec<bool>| word.iter().map(bit).collect::<Vec<_>>().join(" , ") + "\r\n";
        let codes = parse_codes(&words.iter().map(line).collect::<String>(), "t").expect("valid words");
        let read: Vec<Vec<bool>> = codes.words().iter().map(|word| word.bits().collect()).collect();
        prop_assert_eq!(read, words);
    }

    #[test]
    fn frames_round_trip_bit_for_bit(size in (1..40_usize, 1..40_usize), seed in any::<u8>()) {
        let pixels: Vec<u8> = (0..size.0 * size.1).map(|i| (i as u8).wrapping_mul(37) ^ seed).collect();
        let bytes = y4m(size, &pixels, 1);
        let mut frames = Y4mFrames::new(bytes.as_slice(), "t").expect("a stream");
        let read = frames.next().expect("a frame").expect("whole").image;
        prop_assert_eq!(read.pixels(), &pixels);
    }

    #[test]
    fn spot_curves_round_trip_bit_for_bit(
        [offset_px, scale_px_m2, below] in proptest::array::uniform3(0.001..100.0_f64),
        shift_m in -0.1..0.1_f64,
        with_lower in any::<bool>(),
        limit_m in proptest::option::of(1e-3..1e6_f64),
        exposure_us in proptest::option::of(1e-3..1e6_f64),
        threshold in proptest::option::of(1..=255_u8),
    ) {
        let upper = Envelope { offset_px, scale_px_m2, shift_m };
        let lower = Envelope { scale_px_m2: scale_px_m2 / (1.0 + below), ..upper };
        let curve = SpotCurve::new(upper, with_lower.then_some(lower), limit_m).expect("a curve");
        let file = SpotCurveFile { curve, exposure_us, threshold };
        prop_assert_eq!(parse_spot_curve(&spot_curve::text(&file), "t").expect("what was written is read"), file);
    }

    #[test]
    fn airframes_round_trip_bit_for_bit(
        leds in proptest::collection::vec(
            (proptest::array::uniform3(-1.0..1.0_f64), proptest::array::uniform3(0.1..1.0_f64), any::<Option<u32>>()),
            3..12,
        ),
    ) {
        let mut text = "name = \"random\"\n".to_owned();
        for (position, axis, signal) in leds {
            let signal = signal.map_or(String::new(), |signal| format!("signal = {signal}\n"));
            text += &format!("[[led]]\nposition_m = {position:?}\naxis = {axis:?}\nlobe = \"omni\"\n{signal}");
        }
        let read = parse_airframe(&text, "t").expect("valid LEDs").airframe;
        prop_assert_eq!(&parse_airframe(&toml_text(&read, &Tolerances::default()), "t").expect("valid LEDs").airframe, &read);
        let layout = parse_airframe(&layout_text(&read, "t").expect("omni has a type"), "t").expect("valid LEDs").airframe;
        for (a, b) in read.leds().iter().zip(layout.leds()) {
            prop_assert_eq!(a.position_m, b.position_m);
            prop_assert!((a.axis.into_inner() - b.axis.into_inner()).norm() < 1e-15);
        }
    }
}

#[test]
fn the_files_to_damage_are_valid() {
    DatasetInfo::parse(DATASET, "t").unwrap();
    assert!(matches!(DatasetToml::parse(RIG, "t").unwrap(), DatasetToml::Rig(_)));
    parse_vehicles(VEHICLES, "t").unwrap();
    parse_imu(IMU, "t").unwrap();
    parse_odometry(ODOMETRY, "t").unwrap();
    assert_eq!(parse_poses(ODOMETRY, "t").unwrap(), parse_poses(POSES, "t").unwrap());
    GravityLog::parse(GRAVITY, "t").unwrap();
    parse_frames_csv(FRAMES, "t").unwrap();
    parse_truth(TRUTH, "t").unwrap();
    for text in [AIRFRAME, RING, LAYOUT] {
        parse_airframe(text, "t").unwrap();
    }
    parse_codes(BLINK, "t").unwrap();
    parse_spot_curve(SPOT_CURVE, "t").unwrap();
    parse_spot_sizes(SPOT_SIZES, "t").unwrap();
    parse_known_sightings(KNOWN, "t").unwrap();
    parse_led_sightings(LEDS, "t").unwrap();
    parse_mounting(MOUNTING, "t").unwrap();
    assert_eq!(parse_corners(CORNERS, Path::new("t")).unwrap().len(), 2);
    for camera in CAMERAS {
        let file = parse_camera(camera.as_bytes(), Path::new("t")).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((file.camera.width(), file.camera.height()), (96, 64));
    }
    let jpeg = decode_image(JPEG, "t").unwrap().image;
    assert_eq!((jpeg.width(), jpeg.height()), (16, 9));
    assert!(ResultsReader::new(RESULTS.as_bytes(), "t").all(|record| record.is_ok()));
    for format in [image::ImageFormat::Png, image::ImageFormat::Bmp, image::ImageFormat::Tiff] {
        decode_image(&encoded(format), "t").unwrap();
    }
}
