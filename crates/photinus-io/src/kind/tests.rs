use super::*;
use crate::scratch::Folder;

#[test]
fn each_kind_is_told_by_its_content() {
    use CameraFormat as C;
    for (bytes, kind) in [
        (&b"YUV4MPEG2 W1 H1\n"[..], Kind::Video),
        (b"\x89PNG\r\n\x1a\n", Kind::Image),
        (b"\xff\xd8\xff\xe0", Kind::Image),
        (b"P5\n1 1\n255\n", Kind::Image),
        (b"\0\0\0\x20ftypisom", Kind::Foreign(Foreign::Mp4)),
        (b"\x1a\x45\xdf\xa3", Kind::Foreign(Foreign::Matroska)),
        (b"RIFF\0\0\0\0AVI LIST", Kind::Foreign(Foreign::Avi)),
        (b"#ROSBAG V2.0\n", Kind::Bag),
        (b"\x89MCAP0\r\n", Kind::Recording),
        (b"\x1f\x8b\x08", Kind::Foreign(Foreign::Gzip)),
        (b"a\0b", Kind::Binary),
        (b"\xfe\xff", Kind::Binary),
        (b"# gr\xc3", Kind::Empty),
        (b"", Kind::Empty),
        (b"# only\n\n", Kind::Empty),
        (b"# Photinus\n\nPhotinus (the fireflies: yes) tells\nname: x\n", Kind::Text),
        (b"hello\n", Kind::Text),
        (b"{\"frame\":1,\"spots\":[{\"neighbours\":1}]}\n{", Kind::Results),
        (b"{\"frame\":0,\"time_s\":0,\"neighbours\":[{\"spots\":1}]}\n", Kind::Truth),
        (b"{\n \"dataset\": \"a\\\"}\", \"settings\": {}, \"frames\": {}, \"spots\": {}\n", Kind::Scores),
        (b"{\"photos_given\": 18, \"photos_used\": 1", Kind::CalibrationReport),
        (b"[\n {\"exposure_us\": 1000}]", Kind::SpotSizeReport),
        (b"{\n\"taylor_coefficient\": [1]}", Kind::Camera(C::Pyocamcalib)),
        (b"{\"a\": {\"spots\": 1}}", Kind::Keys(Syntax::Json)),
        (b"# words\n0,1,1\n", Kind::Blink),
        (b"# X Y Z\n0.1 0.1 0 0 0.0 1.5 0\n", Kind::Airframe),
        (b"6 -259.5 0 1.6e-3 -2.3e-6 6.6e-9 1e-12\n", Kind::Camera(C::OcamText)),
        (b"5 -259.5 0 1.6e-3 -2.3e-6 6.6e-9\n", Kind::Camera(C::OcamText)),
        (b"name = \"hexa\"\n[[led]]\n", Kind::Airframe),
        (b"name = \"hexa\"\nring = { arms = 6 }\n", Kind::Airframe),
        (b"camera = \"c\"\nairframe = \"a\"\nexposure_us = 1.0\n", Kind::DatasetTable),
        (b"rate_hz = 1\n[[camera]] # one\nname = \"front\"\n", Kind::DatasetTable),
        (b"[[vehicle]]\nid = 7\nairframe = \"a\"\n", Kind::Vehicles),
        (b"\xef\xbb\xbfmodel = \"ocam\"\n", Kind::Camera(C::Toml)),
        (b"exposure_us = 1000\n[upper]\nscale_px_m2 = 3\n", Kind::SpotCurve),
        (b"body_from_camera_xyzw = [0, 0, 0, 1]\n", Kind::Mounting),
        (b"name = \"a\"\npreset = \"b\"\n[[camera]]\n", Kind::Scene),
        (b"samples_per_px = 4\n", Kind::PointSpread),
        (b"# coma\nspread = { gaussian = { sigma_px = 0.5 } }\n", Kind::PointSpread),
        (b"<!DOCTYPE html>\n<html lang=\"en\">\n<svg>", Kind::Page),
        (b"<?xml version=\"1.0\"?>\n<svg width=\"1\">", Kind::Drawing),
        (b"<other>\n", Kind::Text),
        (b"nmae = \"hexa\"\n", Kind::Keys(Syntax::Toml)),
        (b"---\ncalibration_model: ocamcalib\n", Kind::Camera(C::UvdarYaml)),
        (b"cam0:\n  camera_model: pinhole\n", Kind::Camera(C::Kalibr)),
        (b"image_width: 640\ncamera_matrix:\n", Kind::Camera(C::CameraInfo)),
        (b"width: 3\nK: []\n", Kind::Camera(C::CameraInfo)),
        (b"detector: 3\ntracking: 4\n", Kind::Keys(Syntax::Yaml)),
        (b"frame,time_s,image,gx,gy,gz\n", Kind::Table(Table::Frames)),
        (b"time_s,wx_rad_s,wy_rad_s,wz_rad_s\n", Kind::Table(Table::Gyro)),
        (b"time_s,gx,gy,gz\n", Kind::Table(Table::Gravity)),
        (b"photo,led,u_px,v_px\n", Kind::Table(Table::LedSightings)),
        (b"a,b,c\n1,2,3\n", Kind::Table(Table::Unknown)),
    ] {
        assert_eq!(Kind::of_content(bytes), kind, "{}", String::from_utf8_lossy(bytes));
    }
}

#[test]
fn a_folder_is_a_dataset_or_images_or_nothing() {
    let folder = Folder::new("kinds");
    let kind = || Kind::of(folder.path()).unwrap();
    folder.file(".hidden.png", b"");
    folder.file("notes.txt", b"");
    assert_eq!(kind(), Kind::Folder);
    folder.file("b.PNG", b"");
    folder.file("a.jpg", b"");
    assert_eq!(kind(), Kind::ImageFolder);
    let names: Vec<_> = images_in(folder.path()).unwrap();
    assert_eq!(names, [folder.path().join("a.jpg"), folder.path().join("b.PNG")]);
    folder.file("dataset.toml", b"");
    assert_eq!(kind(), Kind::Dataset);
}

#[test]
fn what_is_another_kind_is_refused_and_what_is_unknown_is_not() {
    let expect = |bytes: &[u8]| Kind::of_content(bytes).expect(Kind::Mounting, Path::new("m"), "KNOWN");
    assert!(expect(b"body_from_camera = 3\n").is_ok());
    let refused = expect(b"model = \"ocam\"\n").unwrap_err().to_string();
    assert_eq!(refused, "m: this is a camera in Photinus TOML, not the mounting of a camera; KNOWN");
    let refused = Kind::Foreign(Foreign::Mp4).refuse(Path::new("v.mp4"), "an image", "KNOWN").to_string();
    assert!(
        refused.starts_with(
            "v.mp4: this is an MP4 video, not an image; decode it into a pipe: `ffmpeg -i v.mp4 "
        )
    );
}
