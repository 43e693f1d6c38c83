use photinus::airframe::Lobe;

use super::*;
use crate::scratch::files_in;
use photinus_testing::real_data;

const LIST: &str = r#"
name = "pair"
[[led]]
position_m = [0.4, 0.0, 0]
axis = [2.0, 0.0, 0.0]
lobe = "lambertian"
[[led]]
position_m = [-0.4, 0.0, 0.0]
axis = [-1.0, 0.0, 0.0]
lobe = "omni"
signal = 3
"#;
const LAYOUT: &str =
    "# X Y Z Type Pitch Yaw signal_id\n0.2 0 0 0 0.0 0 0\n-0.2 0 0.1 1 1.5707963267948966 0 2\n";

fn read(text: &str) -> AirframeFile {
    parse_airframe(text, "fleet/quad.txt").unwrap()
}

fn message(text: &str) -> String {
    parse_airframe(text, "quad").unwrap_err().to_string()
}

#[test]
fn a_list_of_leds_is_read_and_its_axes_normalised() {
    let AirframeFile { airframe, notes, .. } = read(LIST);
    assert_eq!((airframe.name(), airframe.leds().len(), notes.len()), ("pair", 2, 0));
    assert_eq!(airframe.leds()[0].axis.into_inner().as_slice(), [1.0, 0.0, 0.0]);
    assert_eq!((&airframe.leds()[1].lobe, airframe.leds()[1].signal), (&Lobe::Omni, Some(3)));
}

#[test]
fn a_ring_stands_for_a_list() {
    let ring = "name = \"hexa\"\nring = { arms = 6, radius_m = 0.4, leds_per_arm = 2, splay_deg = 90 }";
    let airframe = read(ring).airframe;
    assert_eq!((airframe.leds().len(), airframe.markers().len()), (12, 6));
    assert!(
        message(&ring.replace("6,", "2,"))
            .starts_with("quad, `ring`: a ring of 2 arm(s): it needs at least 3; ")
    );
    assert!(message(&ring.replace("0.4", "nan")).starts_with("quad, `ring`: a ring with a radius of NaN m"));
}

#[test]
fn both_forms_come_back_as_written() {
    let airframe = read(LIST).airframe;
    assert_eq!(read(&toml_text(&airframe, &Tolerances::default())).airframe, airframe);
    let airframe = read(LAYOUT).airframe;
    let again = read(&layout_text(&airframe, "t").unwrap()).airframe;
    for (a, b) in airframe.leds().iter().zip(again.leds()) {
        assert!((a.axis.into_inner() - b.axis.into_inner()).norm() < 1e-15);
        assert_eq!((a.position_m, &a.lobe, a.signal), (b.position_m, &b.lobe, b.signal));
    }
}

const SHINING: &str = r#"
name = "various"
position_sigma_m = 0.002
power_sigma = 0.03
[[led]]
position_m = [0.4, 0.0, 0]
axis = [1.0, 0.0, 0.0]
lobe = { cosine_power = 3.0 }
power = 0.8
[[led]]
position_m = [-0.4, 0.0, 0.0]
axis = [-1.0, 0.0, 0.0]
lobe = { table_deg = [0, 37.3, 90.1], intensity = [1.0, 0.5, 0.0] }
"#;

#[test]
fn lobes_powers_and_tolerances_are_read_and_come_back_as_written() {
    let file = read(SHINING);
    let leds = file.airframe.leds();
    assert_eq!((&leds[0].lobe, leds[0].power), (&Lobe::Cosine { power: 3.0 }, 0.8));
    let Lobe::Table(table) = &leds[1].lobe else { panic!("a table") };
    let entries = [(0.0, 1.0), (37.3_f64.to_radians(), 0.5), (90.1_f64.to_radians(), 0.0)];
    assert!(table.entries().eq(entries) && (leds[1].power - 1.0).abs() <= 0.0);
    assert_eq!(file.tolerances, Tolerances { position_sigma_m: Some(0.002), power_sigma: Some(0.03) });
    assert_eq!(read(&toml_text(&file.airframe, &file.tolerances)), file);
    assert!(!toml_text(&read(LIST).airframe, &Tolerances::default()).contains("power"));
    let error = layout_text(&file.airframe, "quad.txt").unwrap_err().to_string();
    assert!(
        error.starts_with("quad.txt: LED 0 shines by a power of the cosine")
            && error.contains("; write TOML")
    );
}

#[test]
fn lobes_and_powers_that_cannot_be_are_refused_with_their_key() {
    for (from, to, reason) in [
        (
            "cosine_power = 3.0",
            "cosine_power = -1",
            "quad, `led[0].lobe`: LED 0: a power of the cosine of -1: ",
        ),
        (
            "cosine_power = 3.0",
            "cosine = 3.0",
            "quad, line 8: unknown key `cosine`, expected one of `cosine_power`",
        ),
        (
            "cosine_power = 3.0",
            "table_deg = [0, 90]",
            "quad, line 8: a lobe has a `cosine_power`, or `table_deg`",
        ),
        ("power = 0.8", "power = 0", "quad, `led[0].power`: LED 0 has a power of 0: "),
        ("90.1]", "90.1, 3]", "quad, `led[1].lobe`: LED 1: 4 angles and 3 intensities: "),
        (
            "0.5, 0.0]",
            "0.5, 0.2]",
            "quad, `led[1].lobe`: LED 1: a lobe ends with light at 90.1 deg: let it end",
        ),
        ("0.002", "-1", "quad, `position_sigma_m`: -1 is no standard deviation that can be; give metres"),
        ("0.03", "nan", "quad, `power_sigma`: NaN is no standard deviation that can be; give a share"),
        ("{ cosine_power = 3.0 }", "3", "quad, line 8: `3` where a name of a lobe"),
    ] {
        let message = message(&SHINING.replace(from, to));
        assert!(message.starts_with(reason), "{message}");
        assert!(message.contains("; "), "no advice: {message}");
    }
}

#[test]
fn a_layout_points_down_with_positive_pitch_and_is_named_by_its_file() {
    let AirframeFile { airframe, notes, .. } = read(LAYOUT);
    assert_eq!((airframe.name(), airframe.leds()[0].signal), ("quad", Some(0)));
    assert!((airframe.leds()[1].axis.z + 1.0).abs() < 1e-15);
    assert_eq!(airframe.leds()[1].lobe, Lobe::Omni);
    assert_eq!(notes, ["1 LED(s) of type 1 (ring) are taken as shining the same in every direction"]);
}

#[test]
fn other_units_than_metres_and_radians_are_told() {
    let row = |scale: f64, yaw: f64| {
        format!("{} 0 0 0 0.0 0.0 0\n-{} 0 0 0 0.0 {yaw} 1\n", 0.17 * scale, 0.17 * scale)
    };
    assert!(read(&row(1.0, core::f64::consts::PI)).notes.is_empty());
    let notes = read(&row(100.0, 3.0)).notes;
    assert!(notes[0].starts_with("its farthest marker is 17.00 m from the body's origin"), "{notes:?}");
    let notes = read(&row(1.0, 180.0)).notes;
    assert!(notes[0].starts_with("1 LED(s) have a pitch or yaw beyond a whole turn of 6.28"), "{notes:?}");
}

#[test]
fn another_kind_of_file_is_named() {
    for (text, kind) in [
        ("# c\n5 -259 0 1e-3 -2e-6 6e-9\n", "a camera in OCamCalib text"),
        ("width_px = 752\nmodel = \"ocam\"\n", "a camera in Photinus TOML"),
        ("0,1,1,0\n", "a list of blink sequences"),
        ("{\"spots\":[]}", "results, or spots in place of frames"),
        ("image_width: 752\n", "YAML with keys that Photinus does not know"),
        ("hello world\n", "text in no format that Photinus knows"),
    ] {
        let start = format!("quad: this is {kind}, not an airframe; an airframe is TOML with");
        assert!(message(text).starts_with(&start), "{}", message(text));
    }
}

#[test]
fn errors_of_a_toml_name_the_key() {
    for (from, to, reason) in [
        (
            "[0.4, 0.0, 0]",
            "[nan, 0.0, 0.0]",
            "quad, `led[0].position_m`: LED 0 has a coordinate that is not finite; ",
        ),
        ("[0.4, 0.0, 0]", "[400, 0, 0]", "quad, `led[0].position_m`: LED 0 sits 400 m from the origin"),
        (
            "[-1.0, 0.0, 0.0]",
            "[0, 0, 0]",
            "quad, `led[1].axis`: [0.0, 0.0, 0.0] points nowhere; give the direction",
        ),
        ("[-1.0, 0.0, 0.0]", "[inf, 0, 0]", "quad, `led[1].axis`: [inf, 0.0, 0.0] points nowhere"),
        (
            "signal",
            "sginal",
            "quad, line 11: unknown key `sginal`, expected one of `position_m`, `axis`, `lobe`, `signal`",
        ),
        ("signal = 3", "signal = -3", "quad, line 11: `-3` where a whole number, 0 or more, is expected"),
        ("\"omni\"", "\"ring\"", "quad, line 10: unknown name `ring`, expected `lambertian` or `omni`"),
        ("lobe = \"omni\"", "", "quad, line 7: missing key `lobe`; add it"),
        ("name = \"pair\"", "name = \"\"", "quad, `name`: the name is empty; name the airframe"),
        ("[0.4, 0.0, 0]", "[0.4, 0.0]", "quad, line 4: a list of 2 where a list of 3 is expected"),
        (
            "name = \"pair\"",
            "name = \"a\"\nring = {arms=3,radius_m=1,leds_per_arm=1,splay_deg=0}",
            "quad: it gives both",
        ),
    ] {
        let message = message(&LIST.replace(from, to));
        assert!(message.starts_with(reason), "{message}");
        assert!(message.contains("; "), "no advice: {message}");
    }
    let one = LIST.split_inclusive("lambertian\"\n").next().unwrap();
    assert_eq!(parse_airframe(one, "lamp.toml").unwrap().airframe.markers().len(), 1);
    let twice = format!("{LIST}[[led]]\nposition_m = [0.4, 0, 0]\naxis = [1, 0, 0]\nlobe = \"omni\"\n");
    let message = message(&twice);
    assert!(
        message.starts_with("quad, `led[2]`: LEDs 0 and 2 have the same position and axis: remove one; ")
    );
}

#[test]
fn errors_of_a_layout_name_the_line() {
    for (row, reason) in [
        ("0 0 0 0 0 0", "6 values where 7 must stand; give X Y Z Type Pitch Yaw signal_id"),
        ("0 0 nan 0 0 0 0", "Z `nan` is not a number; give metres"),
        ("0 0 0 3 0 0 0", "there is no type `3`; give 0 directional"),
        ("0 0 0 0 inf 0 0", "Pitch `inf` is not a number; give radians"),
        ("0 0 0 0 0 0 -1", "signal_id `-1` is not a number; give a whole number"),
        ("0.2 0 0 0 0 0 0", "LEDs 0 and 2 have the same position and axis: remove one"),
        ("900 0 0 0 0 0 0", "LED 2 sits 900 m from the origin"),
    ] {
        let message = message(&format!("{LAYOUT}{row}\n"));
        assert!(message.starts_with(&format!("quad, line 4: {reason}")), "{message}");
    }
    assert_eq!(read("0.2 0 0 0 0 0 0\n").airframe.markers().len(), 1);
    assert!(message("# nothing\n").starts_with("quad: it holds no LED; "));
}

#[test]
fn every_real_layout_is_read() {
    let Some(folder) = real_data("airframes") else { return };
    for path in files_in(&folder) {
        let AirframeFile { airframe, notes, .. } = read_airframe(&path).unwrap();
        let has_beacon = path.to_string_lossy().contains("beacon");
        assert_eq!(airframe.markers().len(), if has_beacon { 5 } else { 4 }, "{path:?}");
        assert_eq!(notes.len(), usize::from(has_beacon), "{path:?} {notes:?}");
    }
}
