use proptest::prelude::*;

use super::*;
use crate::Result;

fn spot() -> SpotRecord {
    SpotRecord {
        u_px: 100.25,
        v_px: 50.5,
        area_px: 4,
        peak: 255,
        saturated_px: 2,
        flux: 812.5,
        light: None,
        sigma_px: 0.2,
        covariance_px2: [[0.05, 0.01], [0.01, 0.03]],
        middle_px: [100, 51],
        extent_px: Some([99, 50, 101, 51]),
        background: 3.5,
        probability: 0.5,
        marker_log_odds: 0.0,
        bearing: Some([0.1, 0.2, -0.97]),
        bound_rad: Some(0.002),
        range_m: Some((1.0, None)),
        signal: Some(2),
    }
}

fn neighbour() -> NeighbourRecord {
    NeighbourRecord {
        track: None,
        id: Some(3),
        id_probability: None,
        velocity_m_s: None,
        velocity_covariance_m2_s2: None,
        airframe: "hexarotor, 0.4".to_owned(),
        spots: vec![0],
        bearing: [0.0, 0.0, 1.0],
        distance_m: Distance {
            estimate: Some(7.25),
            sigma: Some(0.5),
            min: 5.0,
            max: None,
            perpendicular: Some(7.5),
            inline: Some(5.0),
        },
        position_m: Some([0.0, 0.0, 7.25]),
        position_covariance_m2: Some([[0.25, 0.0, 0.125], [0.0, 0.5, 0.0], [0.125, 0.0, 1.0]]),
        position_body_m: None,
        position_body_covariance_m2: None,
        orientation_xyzw: None,
        orientation_covariance_rad2: None,
        position_orientation_covariance_m_rad: None,
        probability: None,
        misfit: None,
        airframe_probability: None,
        runner_up: None,
        modes: vec![],
    }
}

fn record() -> FrameRecord {
    let rejected = RejectedRecord { u_px: 1.0, v_px: 2.0, area_px: 900, reason: "sun".to_owned() };
    FrameRecord {
        frame: Some(17),
        camera: None,
        time_s: Some(0.283),
        latency_s: None,
        tracks: Vec::new(),
        source: "images/000017.png".to_owned(),
        incomplete: false,
        spots: vec![spot()],
        rejected: vec![rejected],
        neighbours: vec![neighbour()],
    }
}

fn json(record: &FrameRecord) -> String {
    let mut bytes = Vec::new();
    ResultsWriter::new(&mut bytes, "t").write(record).unwrap();
    String::from_utf8(bytes).unwrap()
}

fn read(text: &str) -> Vec<Result<FrameRecord>> {
    ResultsReader::new(text.as_bytes(), "spots.jsonl").collect()
}

#[test]
fn results_are_one_line_with_the_documented_names() {
    let line = json(&record());
    assert_eq!(line.matches('\n').count(), 1);
    let value: serde_json::Value = serde_json::from_str(&line).unwrap();
    let keys =
        |value: &serde_json::Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>().join(" ");
    assert_eq!(keys(&value), "frame neighbours rejected source spots time_s");
    assert_eq!(
        keys(&value["spots"][0]),
        "area_px background bearing bound_rad covariance_px2 extent_px flux marker_log_odds middle_px peak probability range_m saturated_px sigma_px signal u_px v_px"
    );
    assert_eq!(keys(&value["rejected"][0]), "area_px reason u_px v_px");
    assert_eq!(
        keys(&value["neighbours"][0]),
        "airframe bearing distance_m id modes orientation_covariance_rad2 orientation_xyzw position_covariance_m2 \
         position_m spots track"
    );
    assert_eq!(keys(&value["neighbours"][0]["distance_m"]), "estimate inline max min perpendicular sigma");
    assert_eq!(value["spots"][0]["range_m"], serde_json::json!([1.0, null]));
    assert!(value["neighbours"][0]["distance_m"]["max"].is_null());
}

#[test]
fn results_are_read_back() {
    let read = read(&json(&record()).repeat(2));
    assert_eq!(read.len(), 2);
    assert_eq!(*read[1].as_ref().unwrap(), record());
}

proptest! {
    #[test]
    fn numbers_are_read_back_bit_for_bit(numbers in proptest::array::uniform8(proptest::num::f64::NORMAL)) {
        let [flux, background, x, y, z, time_s, estimate, perpendicular] = numbers;
        let mut written = record();
        (written.spots[0].flux, written.spots[0].background) = (flux, background);
        (written.spots[0].bearing, written.time_s) = (Some([x, y, z]), Some(time_s));
        written.neighbours[0].distance_m.estimate = Some(estimate);
        written.neighbours[0].distance_m.perpendicular = Some(perpendicular);
        prop_assert_eq!(read(&json(&written)).remove(0).unwrap(), written);
    }
}

#[test]
fn numbers_that_are_not_finite_become_null() {
    let mut record = record();
    record.neighbours[0].distance_m.max = Some(f64::INFINITY);
    record.time_s = Some(f64::NAN);
    record.latency_s = Some(f64::NAN);
    let read = read(&json(&record)).remove(0).unwrap();
    assert_eq!((read.time_s, read.latency_s, read.neighbours[0].distance_m.max), (None, None, None));
}

#[test]
fn spots_of_others_need_only_their_place() {
    let text = "{\"spots\":[{\"u_px\":10.4,\"v_px\":20}]}\n\n{\"spots\":[],\"later\":1}\n\
                {\"frame\":9,\"spots\":[{\"u_px\":1,\"v_px\":2,\"area_px\":3,\"peak\":100,\"sigma_px\":[0.3,0.4]},\
                {\"u_px\":1,\"v_px\":2,\"sigma_px\":0.5}]}";
    let frames: Vec<_> = read(text).into_iter().map(|frame| frame.unwrap()).collect();
    assert_eq!(frames.iter().map(|frame| frame.frame).collect::<Vec<_>>(), [Some(0), Some(1), Some(9)]);
    let spot = frames[0].spots[0];
    assert_eq!((spot.area_px, spot.peak, spot.flux, spot.middle_px), (1, 255, 0.0, [10, 20]));
    assert!((spot.covariance_px2[0][0] - 1.0 / 12.0).abs() < 1e-15);
    let spot = frames[2].spots[0];
    assert_eq!((spot.area_px, spot.covariance_px2), (3, [[0.3 * 0.3, 0.0], [0.0, 0.4 * 0.4]]));
    assert!((spot.sigma_px - 0.125_f64.sqrt()).abs() < 1e-15);
    assert_eq!(frames[2].spots[1].covariance_px2, [[0.25, 0.0], [0.0, 0.25]]);
}

#[test]
fn spots_that_are_none_are_refused_with_their_line() {
    for (spot, reason) in [
        ("{\"u_px\":1}", "missing key `v_px`"),
        ("{\"u_px\":-1e9,\"v_px\":2}", "a spot at (-1000000000, 2) px is in no image"),
        ("{\"u_px\":1e999,\"v_px\":2}", "`1e999` is no JSON"),
        ("{\"u_px\":null,\"v_px\":2}", "null where a number is expected"),
        ("{\"u_px\":1,\"v_px\":2,\"sigma_px\":0}", "sigma_px is not above 0"),
        ("{\"u_px\":1,\"v_px\":2,\"sigma_px\":\"a\"}", "sigma_px must be a number or [u, v]"),
        ("{\"u_px\":1,\"v_px\":2,\"covariance_px2\":[[1,2],[2,1]]}", "is no covariance"),
        ("{\"u_px\":1,\"v_px\":2,\"extent_px\":[3,2,1,2]}", "extent_px is no box"),
        ("{\"u_px\":1,\"v_px\":2,\"peak\":300}", "`300` where a whole number of 0 to 255 is expected"),
    ] {
        let frames = read(&format!("{{\"spots\":[]}}\n{{\"spots\":[{spot}]}}\n{{\"spots\":[]}}\n"));
        assert_eq!((frames.len(), frames[2].as_ref().unwrap().frame), (3, Some(2)));
        let message = frames[1].as_ref().unwrap_err().to_string();
        assert!(message.starts_with("spots.jsonl, line 2: column "), "{message}");
        assert!(
            message.contains(reason) && message.ends_with("; see docs/file-formats.md for an example"),
            "{message}"
        );
    }
}

#[test]
fn a_table_has_a_row_per_neighbour() {
    let mut bytes = Vec::new();
    let mut writer = CsvWriter::new(&mut bytes, "t").unwrap();
    let mut two = record();
    two.neighbours.push(NeighbourRecord { orientation_xyzw: Some([0.0, 0.0, 0.0, 1.0]), ..neighbour() });
    two.neighbours[1].distance_m.estimate = Some(f64::NAN);
    writer.write(&two).unwrap();
    writer.write(&FrameRecord { neighbours: vec![], ..record() }).unwrap();
    drop(writer);
    let text = String::from_utf8(bytes).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 3);
    assert!(lines[0].starts_with("frame,time_s,source,track,id,airframe,spots,bearing_x,"));
    assert_eq!(
        lines[1],
        "17,0.283,images/000017.png,,3,\"hexarotor, 0.4\",1,0,0,1,7.25,0.5,5,,7.5,5,0,0,7.25,\
         0.25,0,0.125,0.5,0,1,,,,,0,,,,,,"
    );
    assert_eq!(
        lines[2].matches(",1,0,0,1,,0.5,").count(),
        1,
        "an estimate of NaN is an empty cell: {}",
        lines[2]
    );
    assert!(lines[2].ends_with(",0,0,0,1,0,,,,,,"));
}
