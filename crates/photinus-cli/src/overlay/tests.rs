use std::path::PathBuf;

use nalgebra::Vector3;
use photinus::camera::{Bearing, Ideal, IdealLaw, Model, Pixel};
use photinus_io::image::{GreyImage, read_image};
use photinus_io::results::{Distance, NeighbourRecord, RejectedRecord, SpotRecord, TrackRecord};

use super::*;

/// The camera of the paper: 3.767 mrad per pixel.
fn camera() -> Camera {
    let lens = Ideal::new(IdealLaw::Equidistant, [1.0 / 3.767e-3; 2], Pixel::new(375.5, 239.5)).unwrap();
    Camera::new(Model::Ideal(lens), 752, 480, None).unwrap()
}

fn spot(u_px: f64, v_px: f64) -> SpotRecord {
    SpotRecord {
        u_px,
        v_px,
        area_px: 4,
        peak: 255,
        saturated_px: 0,
        flux: 700.0,
        light: None,
        sigma_px: 0.1,
        covariance_px2: [[0.01, 0.0], [0.0, 0.01]],
        middle_px: [u_px as u32, v_px as u32],
        extent_px: None,
        background: 4.0,
        probability: 0.5,
        marker_log_odds: 0.0,
        bearing: None,
        bound_rad: None,
        range_m: None,
        signal: None,
    }
}

fn neighbour(spots: Vec<usize>, bearing: Vector3<f64>, distance_m: Distance) -> NeighbourRecord {
    NeighbourRecord {
        track: None,
        id: None,
        id_probability: None,
        velocity_m_s: None,
        velocity_covariance_m2_s2: None,
        airframe: "hexarotor-0.4".to_owned(),
        spots,
        bearing: (*Bearing::new(bearing).unwrap().vector()).into(),
        distance_m,
        position_m: None,
        position_covariance_m2: None,
        position_body_m: None,
        position_body_covariance_m2: None,
        orientation_xyzw: None,
        orientation_covariance_rad2: None,
        position_orientation_covariance_m_rad: None,
        probability: None,
        misfit: None,
        airframe_probability: None,
        runner_up: None,
        modes: Vec::new(),
    }
}

/// Three neighbours of every kind: bounded, unbounded, without an estimate; two rejected spots, one lonely.
fn record() -> FrameRecord {
    let distance =
        |estimate, sigma, min, max| Distance { estimate, sigma, min, max, perpendicular: None, inline: None };
    FrameRecord {
        frame: Some(17),
        camera: None,
        time_s: Some(0.283),
        latency_s: None,
        tracks: Vec::new(),
        source: "images/000017.png".to_owned(),
        incomplete: false,
        spots: vec![
            spot(280.0, 231.0),
            spot(297.0, 236.0),
            spot(306.0, 238.0),
            spot(520.0, 180.0),
            spot(529.0, 182.0),
            spot(690.0, 250.0),
            spot(120.0, 420.0),
        ],
        rejected: vec![
            RejectedRecord { u_px: 600.0, v_px: 60.0, area_px: 1300, reason: "sun".to_owned() },
            RejectedRecord { u_px: 640.0, v_px: 75.0, area_px: 3, reason: "glare".to_owned() },
        ],
        neighbours: vec![
            neighbour(
                vec![2, 0, 1],
                Vector3::new(-0.31, -0.02, 0.95),
                distance(Some(5.24), Some(0.4), 3.9, Some(7.6)),
            ),
            neighbour(vec![3, 4], Vector3::new(0.5, -0.2, 0.8), distance(Some(8.1), Some(1.3), 5.2, None)),
            neighbour(vec![5], Vector3::new(0.95, 0.0, 0.4), distance(None, None, 2.0, None)),
        ],
    }
}

fn night() -> GreyImage {
    let level = |i: usize| 4 + ((i * 7919) % 5) as u8;
    let mut pixels: Vec<u8> = (0..752 * 480).map(level).collect();
    for spot in &record().spots {
        for (du, dv) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            pixels[(spot.v_px as usize + dv) * 752 + spot.u_px as usize + du] = 230;
        }
    }
    GreyImage::new(pixels, 752, 480).unwrap()
}

/// A folder of the system's temporary folder, gone with the value.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        Self(std::env::temp_dir().join(format!("photinus-overlay-{}-{test}", std::process::id())))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if std::env::var_os("PHOTINUS_KEEP").is_none() {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

fn picture(
    folder: &Folder,
    record: &FrameRecord,
    frame: Option<FrameView<'_>>,
    camera: Option<Camera>,
) -> GreyImage {
    std::fs::create_dir_all(&folder.0).unwrap();
    let mut overlay = Overlay::new(Place::folder(folder.0.clone()), camera.into_iter().collect()).unwrap();
    overlay.draw(0, record, frame, None, &[]).unwrap();
    read_image(folder.0.join("overlay-000017.png")).unwrap().image
}

#[test]
fn the_same_record_gives_the_same_picture_and_another_one_another() {
    let (folder, night, mut record) = (Folder::new("same"), night(), record());
    let first = picture(&folder, &record, Some(night.view()), Some(camera()));
    assert_eq!(first, picture(&folder, &record, Some(night.view()), Some(camera())));
    assert!(first.width() > 2 * 752 && first.height() > 2 * 480, "frame and map");
    record.neighbours[0].distance_m.estimate = Some(5.4);
    assert!(first != picture(&folder, &record, Some(night.view()), Some(camera())));
}

#[test]
fn a_spot_stays_visible_inside_its_circle() {
    let (folder, night, record) = (Folder::new("visible"), night(), record());
    let layout = Layout::new((752, 480), false);
    let picture = picture(&folder, &record, Some(night.view()), None);
    let level = |u_px: usize, v_px: usize| {
        let (x, y) = (layout.frame.left as usize + 2 * u_px, layout.frame.top as usize + 2 * v_px);
        picture.pixels()[y * picture.width() + x]
    };
    for spot in &record.spots {
        assert!(level(spot.u_px as usize, spot.v_px as usize) > 200);
        assert!(
            (20..90).contains(&level(spot.u_px as usize + 2, spot.v_px as usize)),
            "lifted sky around it"
        );
    }
}

#[test]
fn a_picture_has_a_bound_whatever_the_frame() {
    let sizes = [(1, 32_767), (32_767, 1), (64, 4096), (1, 1), (32_767, 32_767), (4096, 4096), (752, 480)];
    for (columns, rows) in sizes {
        for has_map in [false, true] {
            let layout = Layout::new((columns, rows), has_map);
            let area_px = u64::from(layout.width) * u64::from(layout.height);
            assert!(layout.width <= 6800 && layout.height <= 4400, "{columns}x{rows}: {}", layout.width);
            assert!(4 * area_px <= 120_000_000, "{columns}x{rows} takes {} bytes", 4 * area_px);
        }
    }
}

#[test]
fn narrow_frames_are_drawn_whole() {
    for (columns, rows) in [(1, 32_767), (32_767, 1), (64, 4096), (1, 1)] {
        let mut pixels = vec![9; columns * rows];
        *pixels.last_mut().unwrap() = 255;
        let frame = GreyImage::new(pixels, columns, rows).unwrap();
        let record =
            FrameRecord { spots: Vec::new(), rejected: Vec::new(), neighbours: Vec::new(), ..record() };
        let folder = Folder::new(&format!("narrow-{columns}-{rows}"));
        let picture = picture(&folder, &record, Some(frame.view()), Some(camera()));
        let layout = Layout::new((columns as u32, rows as u32), true);
        assert_eq!((picture.width(), picture.height()), (layout.width as usize, layout.height as usize));
        let panel = layout.frame;
        let right = panel.left + panel.zoom.drawn_px(columns as u32) - 1;
        let bottom = panel.top + panel.zoom.drawn_px(rows as u32) - 1;
        // The last pixel of the frame is the brightest, in the last corner of its panel.
        let level = |x: u32, y: u32| picture.pixels()[y as usize * picture.width() + x as usize];
        assert_eq!(level(right, bottom), 255, "{columns}x{rows}");
        if columns * rows > 1 {
            assert!(level(panel.left, panel.top) < 200, "{columns}x{rows}");
        }
    }
}

#[test]
fn numbers_that_are_none_do_no_harm() {
    let (folder, mut record) = (Folder::new("odd"), record());
    let odd = [f64::NAN, f64::INFINITY, -1e300, 1e300, 0.0];
    for (a, b) in odd.into_iter().zip([1e300, f64::NAN, 0.0, f64::INFINITY, -1e300]) {
        record.spots[0].u_px = a;
        record.rejected[0].v_px = b;
        record.neighbours[0].bearing = [a, b, 1.0];
        record.neighbours[1].distance_m.min = a;
        record.neighbours[1].distance_m.max = Some(b);
        record.neighbours[2].distance_m.estimate = Some(a);
        record.neighbours[2].distance_m.sigma = Some(b);
        record.neighbours[2].spots = vec![0, 999];
        record.rejected[1].area_px = u32::MAX;
        record.tracks = vec![TrackRecord { velocity_m_s: [b, a, 0.0], ..track([a, b, 2.0]) }];
        picture(&folder, &record, None, Some(camera()));
    }
}

fn track(position_m: [f64; 3]) -> TrackRecord {
    let covariance = [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.01]];
    TrackRecord {
        track: 4,
        airframe: "hexarotor-0.4".to_owned(),
        probability: 1.0,
        id: Some(7),
        id_probability: Some(1.0),
        ids: Vec::new(),
        predicted: true,
        spots: Vec::new(),
        position_m,
        position_covariance_m2: covariance,
        position_body_m: None,
        position_body_covariance_m2: None,
        velocity_m_s: [1.0, 0.0, 0.5],
        velocity_covariance_m2_s2: covariance,
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        orientation_covariance_rad2: covariance,
        position_orientation_covariance_m_rad: None,
    }
}

#[test]
fn who_is_followed_is_drawn_with_a_tail_also_unseen() {
    let folder = Folder::new("followed");
    std::fs::create_dir_all(&folder.0).unwrap();
    let mut overlay = Overlay::new(Place::folder(folder.0.clone()), vec![camera()]).unwrap();
    let followed = |frame: u64, time_s: f64, position_m: [f64; 3]| {
        let tracks = vec![track(position_m)];
        FrameRecord { frame: Some(frame), time_s: Some(time_s), source: String::new(), tracks, ..record() }
    };
    let drawn = |overlay: &mut Overlay, record: &FrameRecord| {
        overlay.draw(0, record, None, None, &[]).unwrap();
        let frame = record.frame.unwrap();
        read_image(folder.0.join(format!("overlay-{frame:06}.png"))).unwrap().image
    };
    let mut picture = |frame: u64, time_s: f64, position_m: [f64; 3]| {
        drawn(&mut overlay, &followed(frame, time_s, position_m))
    };
    let begun = picture(0, 0.0, [-1.0, 0.5, 4.0]);
    let gone_on = picture(1, 1.0, [0.0, 0.5, 4.5]);
    let later = picture(2, 3.5, [0.0, 0.5, 4.5]);
    let marked =
        |image: &GreyImage| image.pixels().iter().filter(|&&level| (90..200).contains(&level)).count();
    let [before, after] = [&begun, &gone_on].map(marked);
    assert!(after > before + 100, "the tail shows where it was: {before}, {after}");
    assert!(marked(&later) < marked(&gone_on), "and is forgotten after two seconds");

    let mut other = Overlay::new(Place::folder(folder.0.clone()), vec![camera()]).unwrap();
    other.pass(0, &followed(0, 0.0, [-1.0, 0.5, 4.0]));
    let passed = drawn(&mut other, &followed(3, 1.0, [0.0, 0.5, 4.5]));
    let tail = |image: &GreyImage| image.pixels()[image.width() * 40..].to_vec();
    assert!(tail(&passed) == tail(&gone_on), "where it was in a frame that was not drawn shows, too");
}
