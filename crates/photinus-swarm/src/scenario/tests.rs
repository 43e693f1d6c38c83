//! Every carried scenario reads; what makes no sense is refused with file, key and reason.

use std::path::Path;

use super::*;

fn three() -> &'static str {
    include_str!("test.toml")
}

fn refused(text: &str) -> String {
    Scenario::parse(text, Path::new("s.toml")).expect_err("nonsense").to_string()
}

#[test]
fn all_carried_scenarios_read_and_carry_their_own_names() {
    for carried in CARRIED {
        let scenario = carried.read().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scenario.name, carried.name);
        assert!(!scenario.about.is_empty(), "{} says what it shows", carried.name);
        assert!((1..=100).contains(&scenario.vehicles.len()));
    }
}

#[test]
fn what_makes_no_sense_is_refused_with_its_key() {
    let with = |from: &str, to: &str| {
        assert!(three().contains(from), "{from}");
        refused(&three().replacen(from, to, 1))
    };
    for (from, to, told) in [
        ("rate_hz = 20.0", "rate_hz = 20.0\nwings = 2", "s.toml, line 5: unknown key `wings`"),
        ("rate_hz = 20.0", "rate_hz = nan", "s.toml, `rate_hz`: NaN is out of range"),
        ("duration_s = 10.0", "duration_s = -1.0", "s.toml, `duration_s`: -1 is not a positive number"),
        ("{ hover = {} }", "{ flap = {} }", "s.toml, line 33: unknown name `flap`"),
        ("count = 3", "count = 0", "s.toml, `group`: 0 vehicles"),
        (
            "kind = \"quadrotor\"\ncount",
            "kind = \"kite\"\ncount",
            "s.toml, `group[0].kind`: there is no kind `kite`",
        ),
        ("radius_m = 4.0", "radius_m = 0.1", "begins inside vehicle 0"),
        (
            "quadrotor-0.245.toml",
            "none.toml",
            "s.toml, `kind[0].airframe`: there is no file airframes/none.toml",
        ),
        (
            "yaw_deg = 120.0",
            "yaw_deg = 1200.0",
            "s.toml, `kind[0].camera[1].yaw_deg`: 1200.0 is out of range",
        ),
        (
            "name = \"left\"",
            "name = \"front\"",
            "s.toml, `kind[0].camera[1].name`: another camera is called so",
        ),
    ] {
        let message = with(from, to);
        assert!(message.contains(told), "{told}\n{message}");
    }
    let body = |line: &str| {
        format!(
            "{}\n[[kind]]\nname = \"x\"\nairframe = \"airframes/quadrotor-0.245.toml\"\n[kind.body]\n{line}\n[[kind.camera]]\nname = \"a\"\nfile = \"cameras/bluefox-dsl215.toml\"\n",
            three()
        )
    };
    assert!(
        refused(&body("mass_kg = -2.0"))
            .contains("s.toml, `kind[1].body.mass_kg`: -2 is not a positive number")
    );
    assert!(refused(&body("thrust_n = 10.0")).contains("`kind[1].body.thrust_n`: 10 N hardly lift 19.6 N"));
    let blind =
        format!("{}\n[[kind]]\nname = \"x\"\nairframe = \"airframes/quadrotor-0.245.toml\"\n", three());
    assert!(refused(&blind).contains("s.toml, `kind[1].camera`: it has no camera"));
    let event = |line: &str| refused(&format!("{}\n[[event]]\nat_s = 1.0\n{line}\n", three()));
    assert!(event("vehicle = 3\nled_fails = 0").contains("`event[0].vehicle`: vehicle 3 of 3"));
    assert!(event("vehicle = 1\ncamera_fails = \"rear\"").contains("it has no camera `rear`"));
    assert!(event("vehicle = 1").contains("does not say one thing"));
    assert!(event("exposure_us = 1e6").contains("longer than 50000.0 us"));
}

#[test]
fn no_cut_and_no_strange_byte_makes_it_panic() {
    let text = three();
    for cut in (0..text.len()).step_by(7).filter(|cut| text.is_char_boundary(*cut)) {
        let _ = Scenario::parse(&text[..cut], Path::new("s.toml"));
        let mut bytes = text.as_bytes().to_vec();
        bytes[cut] = b'9';
        let _ = Scenario::parse(&String::from_utf8_lossy(&bytes), Path::new("s.toml"));
    }
}
