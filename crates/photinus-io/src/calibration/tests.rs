use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::*;

#[test]
fn columns_may_come_in_any_order_and_comments_anywhere() {
    let text = "# a recording\narea_px, distance_m\n\n12, 1.5\n# far\n0,9\n";
    let rows = parse_spot_sizes(text, "t.csv").unwrap();
    assert_eq!(rows[0], SpotSizeRow { distance_m: 1.5, area_px: 12, exposure_us: None });
    assert_eq!(rows[1].area_px, 0);
    let with_exposure = parse_spot_sizes("distance_m,area_px,exposure_us\n1,2,500\n1,2,\n", "t.csv").unwrap();
    assert_eq!([with_exposure[0].exposure_us, with_exposure[1].exposure_us], [Some(500.0), None]);
}

#[test]
fn a_bad_table_is_named_by_line_with_reason_and_advice() {
    for (text, message) in [
        (
            "",
            "t.csv, line 1: unknown column ``; name the columns in the first line: distance_m, area_px, [exposure_us]",
        ),
        ("distance_m,size\n1,2\n", "t.csv, line 1: unknown column `size`; name the columns"),
        ("\ndistance_m\n1\n", "t.csv, line 2: there is no column `area_px`; name the columns"),
        ("distance_m,area_px,area_px\n1,2,3\n", "t.csv, line 1: there are two columns `area_px`; "),
        ("distance_m,area_px\n", "t.csv: it holds no measurement; add a line per measurement"),
        ("distance_m,area_px\n1,2\n1\n", "t.csv, line 3: 1 values for 2 columns; write one value per column"),
        ("distance_m,area_px\n1,2.5\n", "t.csv, line 2: area_px is `2.5`; give a whole number, 0 or more"),
        ("distance_m,area_px\n0,2\n", "t.csv, line 2: distance_m is `0`; give a number above 0"),
        ("distance_m,area_px\nnan,2\n", "t.csv, line 2: distance_m is `nan`; give a number"),
        ("distance_m,area_px\n,2\n", "t.csv, line 2: distance_m is ``; give a number"),
    ] {
        let told = parse_spot_sizes(text, "t.csv").unwrap_err().to_string();
        assert!(told.starts_with(message), "{told}\nnot {message}");
    }
}

#[test]
fn directions_and_positions_are_told_apart_by_their_columns() {
    let directions = parse_known_sightings("u_px,v_px,x,y,z\n1,2,0,0,3\n", "t.csv").unwrap();
    assert_eq!(directions[0].known, Known::Direction(Vector3::new(0.0, 0.0, 3.0)));
    let positions =
        parse_known_sightings("u_px,v_px,x_m,y_m,z_m,sigma_px\n1,2,1,2,3,0.1\n", "t.csv").unwrap();
    assert_eq!(positions[0].known, Known::Position(Vector3::new(1.0, 2.0, 3.0)));
    assert_eq!((positions[0].line, positions[0].sigma_px), (2, Some(0.1)));
    for (row, reason) in [
        ("1,2,,,,,,", "it says neither or both of direction and position; fill in"),
        ("1,2,1,0,0,1,0,0", "it says neither or both"),
        ("1,2,0,0,0,,,", "[0, 0, 0] has no direction; x is forward"),
        ("1,2,1,,0,,,", "y is ``; give a number"),
        ("inf,2,1,0,0,,,", "u_px is `inf`; give a number"),
    ] {
        let text = format!("u_px,v_px,x,y,z,x_m,y_m,z_m\n{row}\n");
        let told = parse_known_sightings(&text, "t.csv").unwrap_err().to_string();
        assert!(told.starts_with(&format!("t.csv, line 2: {reason}")), "{told}");
    }
}

#[test]
fn an_led_shows_once_in_a_photo() {
    let text = "photo,led,u_px,v_px\na.png,0,1,2\nb.png,0,1,2\na.png,1,1.5,2\n";
    assert_eq!(parse_led_sightings(text, "t.csv").unwrap()[2].led, 1);
    let told = parse_led_sightings(&format!("{text}a.png,1,3,4\n"), "t.csv").unwrap_err().to_string();
    assert_eq!(told, "t.csv, line 5: line 4 has LED 1 of photo a.png already; keep one of the two");
    let told = parse_led_sightings(&format!("{text},1,3,4\n"), "t.csv").unwrap_err().to_string();
    assert!(told.starts_with("t.csv, line 5: the photo has no name; "), "{told}");
    let told = parse_led_sightings(&format!("{text}c,-1,3,4\n"), "t.csv").unwrap_err().to_string();
    assert!(told.starts_with("t.csv, line 5: led is `-1`; "), "{told}");
}

#[test]
fn a_mounting_is_read_back_bit_for_bit() {
    let covariance = Matrix3::new(2.0, 0.1, 0.0, 0.1, 3.0, -0.2, 0.0, -0.2, 4.0) * 1e-7;
    let turned = MountingFile {
        body_from_camera: UnitQuaternion::new(Vector3::new(0.1, -1.2, 0.7)),
        rotation_covariance_rad2: covariance,
        position_m: None,
        position_covariance_m2: None,
    };
    let placed = MountingFile {
        position_m: Some(Vector3::new(0.1, 0.0, -0.05)),
        position_covariance_m2: Some(covariance),
        ..turned
    };
    for mounting in [turned, placed] {
        assert_eq!(parse_mounting(&mounting_text(&mounting), "m.toml").unwrap(), mounting);
    }
}

#[test]
fn a_mounting_that_is_none_is_refused_with_its_key() {
    let good = "body_from_camera_xyzw = [0.0, 0.0, 0.0, 1.0]\nrotation_covariance_rad2 = \
                [[1e-6, 0.0, 0.0], [0.0, 1e-6, 0.0], [0.0, 0.0, 1e-6]]\n";
    parse_mounting(good, "m.toml").unwrap();
    for (text, message) in [
        (
            good.replace("1.0]", "nan]"),
            "m.toml, `body_from_camera_xyzw`: this is no unit quaternion; give x, y, z, w",
        ),
        (
            good.replace("1e-6, 0.0, 0.0]", "-1e-6, 0.0, 0.0]"),
            "m.toml, `rotation_covariance_rad2`: this is no covariance",
        ),
        (
            good.replace("0.0, 1e-6]]", "nan, 1e-6]]"),
            "m.toml, `rotation_covariance_rad2`: this is no covariance",
        ),
        (format!("{good}position_m = [inf, 0.0, 0.0]\n"), "m.toml, `position_m`: a coordinate is not finite"),
        (format!("{good}position = [0.0, 0.0, 0.0]\n"), "m.toml, line 3: unknown key `position`"),
    ] {
        let told = parse_mounting(&text, "m.toml").unwrap_err().to_string();
        assert!(told.starts_with(message), "{told}");
    }
}
