use super::*;
use crate::motion::Motion;

fn told(text: &str) -> String {
    Config::parse(text, "run.toml").unwrap_err().to_string()
}

const CAMERA: &str = "[[camera]]\nname = \"a\"\nsource = { dataset = \"rec\" }\n";

/// A line of the example that is commented out and is no sentence: a key or a table.
fn commented_out(line: &str) -> Option<&str> {
    let bare = line.strip_prefix("# ")?;
    let key = bare.split(" = ").next().filter(|key| *key != bare)?;
    let is_key = key.chars().all(|letter| letter.is_ascii_lowercase() || letter == '_');
    is_key.then_some(bare)
}

#[test]
fn the_example_is_a_configuration_also_with_every_key_that_is_commented_out() {
    Config::parse(EXAMPLE, "photinus.toml").unwrap();
    let is_table = |line: &str| line.starts_with("# [") && line.contains(']');
    let all = EXAMPLE.lines().map(|line| match commented_out(line) {
        Some(bare) if !bare.starts_with("source") => bare,
        _ if is_table(line) => &line[2..],
        _ => line,
    });
    let all: Vec<&str> = all.collect();
    let config = Config::parse(&all.join("\n"), "all.toml").unwrap();
    assert!(config.wanted_exposure().is_some() && config.files().len() == 2);
    let sources: Vec<&str> =
        EXAMPLE.lines().filter_map(commented_out).filter(|bare| bare.starts_with("source")).collect();
    assert!(sources.len() >= 7, "{sources:?}");
    for source in sources {
        let text = format!("[[camera]]\nname = \"a\"\n{source}\n");
        Config::parse(&text, "t").unwrap_or_else(|error| panic!("{source}: {error}"));
    }
}

#[test]
fn unknown_keys_are_refused_with_their_line() {
    let message = told(&format!("{CAMERA}[json]\nfiel = \"x\"\n"));
    assert!(message.starts_with("run.toml, line 5: unknown key `fiel`, expected one of `file`"), "{message}");
    let message = told(&format!("{CAMERA}[jsn]\nfile = \"x\"\n"));
    assert!(message.contains("line 4: unknown key `jsn`"), "{message}");
    let message = told("[[camera]]\nname = \"a\"\nsource = { dataste = \"rec\" }\n");
    assert!(message.contains("line 3: unknown key `dataste`"), "{message}");
}

#[test]
fn a_file_that_cannot_be_read_is_told_with_the_key_that_names_it() {
    let folder = std::env::temp_dir().join(format!("photinus-config-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("run.toml");
    let told = |text: &str| {
        let config = Config::parse(text, &path).unwrap();
        config.cameras(&Motion::default(), &|_, _| Ok(None), &mut |_| {}).err().unwrap().to_string()
    };
    let missing = told(CAMERA);
    let [config, dataset] = [path.clone(), folder.join("rec")].map(|path| path.display().to_string());
    let begins = format!("{config}, `camera[0].source.dataset`: {dataset}: ");
    let ends = "check the path, which is taken from the folder of the configuration";
    assert!(missing.starts_with(&begins) && missing.ends_with(ends), "{missing}");
    let file = told("[[camera]]\nname = \"a\"\nsource = { tcp = \"b:1\" }\n[airframe]\nfile = \"a.toml\"\n");
    assert!(file.contains("`airframe.file`") && file.ends_with(ends), "{file}");
    std::fs::create_dir_all(folder.join("rec")).unwrap();
    let empty = told(CAMERA);
    assert!(
        empty.starts_with(&begins) && empty.contains("holds no dataset.toml; name the folder of"),
        "{empty}"
    );
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_has_no_meaning_is_refused_with_what_to_do() {
    assert!(told("").contains("there is no camera; add a table [[camera]]"));
    assert!(told(&format!("{CAMERA}{CAMERA}")).contains("`camera[1].name`: cameras need names of their own"));
    let of = |source: &str| told(&format!("[[camera]]\nname = \"a\"\nsource = {{ {source} }}\n"));
    assert!(of("").contains("exactly one source"));
    assert!(of("dataset = \"a\", tcp = \"b:1\"").contains("exactly one source"));
    assert!(of("v4l2 = \"/dev/video0\", spots = true").contains("do not go together"));
    assert!(of("stdin = true, gain = 3").contains("do not go together"));
    assert!(of("v4l2 = \"/dev/video0\", format = \"H264\"").contains("no grey frame is known to be in H264"));
    assert!(of("v4l2 = \"/dev/video0\", rate_hz = 0").contains("no camera has this rate"));
    assert!(of("tcp = \"b:1\", camera = \"left\"").contains("do not go together"));
    assert!(of("scene = \"s.toml\", dataset = \"rec\"").contains("exactly one source"));
    assert!(of("scene = \"s.toml\", raw = { width = 8, height = 8 }").contains("do not go together"));
    Config::parse(
        &CAMERA.replace("dataset = \"rec\"", "scene = \"s.toml\", camera = \"left\", repeat = true"),
        "t",
    )
    .unwrap();
    assert!(
        told(&format!("{CAMERA}[exposure]\nreach_m = -1\nshortest_us = 1\nlongest_us = 2\n"))
            .contains("`exposure`")
    );
}

#[test]
fn a_page_that_others_can_reach_needs_a_token() {
    let page = |keys: &str| Config::parse(&format!("{CAMERA}[page]\n{keys}\n"), "run.toml");
    assert_eq!(page("listen = \"127.0.0.1:8080\"").unwrap().page().unwrap().token, None);
    assert!(page("listen = \"[::1]:8080\"").is_ok());
    for open in ["listen = \"0.0.0.0:8080\"", "listen = \"192.168.1.5:80\"\ntoken = \"short\""] {
        assert!(page(open).unwrap_err().to_string().contains("`page.token`"), "{open}");
    }
    assert!(page("listen = \"0.0.0.0:8080\"\ntoken = \"long enough\"").is_ok());
}

#[test]
fn tables_of_protocols_are_handed_on() {
    let config =
        Config::parse(&format!("{CAMERA}[mavlink]\nto = \"udp\"\n[record]\nfile = \"x.mcap\"\n"), "t")
            .unwrap();
    assert_eq!(config.protocols().collect::<Vec<_>>(), ["record", "mavlink"]);
}

const SKY: &str =
    "[sky]\nlatitude_deg = 50.08\nlongitude_deg = 14.42\ntime = 2018-05-10T10:00:00Z\nheading_deg = 90.0\n";

#[test]
fn a_sky_is_refused_with_its_key_or_line_where_it_has_no_meaning() {
    Config::parse(&format!("{CAMERA}{SKY}"), "run.toml").unwrap();
    for (from, to, expected) in [
        ("50.08", "95.0", "run.toml, `sky.latitude_deg`: 95.0 is out of range"),
        ("10:00:00Z", "10:00:00", "`sky.time`: 2018-05-10T10:00:00 is no date and time in UTC"),
        ("heading_deg = 90.0", "heading_sigma_deg = -1.0", "`sky.heading_sigma_deg`: -1.0 is out of range"),
        (
            "heading_deg",
            "headin_deg",
            "run.toml, line 8: unknown key `headin_deg`, expected one of `latitude_deg`",
        ),
        ("longitude_deg = 14.42\n", "", "missing key `longitude_deg`; add it"),
    ] {
        let message = told(&format!("{CAMERA}{}", SKY.replace(from, to)));
        assert!(message.contains(expected), "{to}: {message}");
    }
    let two = format!("{CAMERA}{}{SKY}", CAMERA.replace("\"a\"", "\"b\""));
    assert!(told(&two).contains("`sky.heading_deg`: it is not said of which camera; leave it out"));
}

#[test]
fn times_of_frames_are_seconds_since_1970_where_the_sky_says_no_time() {
    let sky = |text: &str| Config::parse(&format!("{CAMERA}{text}"), "t").unwrap().sky().unwrap().unwrap();
    let began = sky(SKY);
    let since_1970 = sky(&SKY.replace("time = 2018-05-10T10:00:00Z\n", ""));
    // 2018-05-10T10:00:00Z by `date -u +%s`, and a night.
    for passed_s in [0.0, 3600.25, 12.0 * 3600.0] {
        let [expected, told] = [began.direction(passed_s), since_1970.direction(1_525_946_400.0 + passed_s)];
        match (expected, told) {
            (Some(expected), Some(told)) => assert!(expected.angle(&told) < 1e-5, "{expected:?} {told:?}"),
            (expected, told) => assert_eq!((expected, told), (None, None)),
        }
    }
    assert!(began.direction(0.0).is_some() && began.direction(12.0 * 3600.0).is_none());
}
