//! MCAP recordings as inputs and outputs: what is located in one is what is located in what it was made of.

use crate::stage::Stage;

#[test]
fn a_recording_replays_to_the_same_results_bit_for_bit() {
    let stage = Stage::new("recording");
    stage.dataset("flight", 12);
    let located = |input: &str, options: &str| {
        let done =
            stage.run(&format!("locate {input} -q {options} --camera camera.toml --airframe hexa.toml"));
        assert_eq!(done.code, 0, "{}", done.err);
        done.out
    };
    let expected = located("flight", "--out -");
    assert_eq!(expected.lines().count(), 12);
    let done = stage.run("convert flight flight.mcap");
    assert_eq!((done.code, done.out.as_str()), (0, ""), "{}", done.err);
    assert!(!stage.path("flight.mcap.part").exists());
    assert_eq!(located("flight.mcap", "--out -"), expected);
    assert_eq!(located("flight.mcap", "--out -"), expected, "and again");
    assert_eq!(stage.run("convert flight flight.mcap").code, 2, "it is there already");

    let told = stage.run("info flight.mcap").out;
    assert!(told.contains("an MCAP recording") && told.contains("sensor_msgs/CompressedImage"), "{told}");
}

#[test]
fn a_recording_that_was_cut_is_mended() {
    let stage = Stage::new("recover");
    stage.dataset("flight", 8);
    assert_eq!(stage.run("convert flight flight.mcap").code, 0);
    let bytes = std::fs::read(stage.path("flight.mcap")).unwrap();
    // The index is at the end.
    stage.file("cut.mcap", &bytes[..bytes.len() - bytes.len() / 5]);
    let refused = stage.run("locate cut.mcap --camera camera.toml --airframe hexa.toml");
    assert_eq!(refused.code, 2);
    assert!(refused.err.contains("photinus recover"), "{}", refused.err);
    let done = stage.run("recover cut.mcap");
    assert_eq!(done.code, 0, "{}", done.err);
    assert!(done.out.starts_with("cut.recovered.mcap: "), "{}", done.out);
    let mended = stage.run("locate cut.recovered.mcap -q --out - --camera camera.toml --airframe hexa.toml");
    assert_eq!(mended.code, 0, "{}", mended.err);
    assert!(mended.out.lines().count() > 0);
    assert_eq!(stage.run("recover cut.mcap").code, 2, "it is there already");
    assert_eq!(stage.run("recover camera.toml").code, 2);
}

#[test]
fn a_recording_made_by_a_run_replays_to_what_the_run_found() {
    let stage = Stage::new("run-record");
    stage.dataset("rec", 30);
    // What the vehicle says of its motion is in no image.
    let rate = |step: u32| format!("{},0.{},-0.2,0.1\n", f64::from(step) * 0.01, step % 7);
    let odometry = |step: u32| {
        let [time_s, along] = [0.02, 0.03].map(|by| f64::from(step) * by);
        format!("{time_s},{},0,5,0,0,0,1\n", along * along)
    };
    let (rates, odometry): (String, String) =
        ((0..300).map(rate).collect(), (0..120).map(odometry).collect());
    stage.file("rec/imu.csv", format!("time_s,wx_rad_s,wy_rad_s,wz_rad_s\n{rates}"));
    stage.file("rec/odometry.csv", format!("time_s,x_m,y_m,z_m,qx,qy,qz,qw\n{odometry}"));
    stage.file("mounting.toml", crate::rig::FORWARD);
    let located = |options: &str| stage.run(&format!("locate rec -q --out - {options}")).out;
    let known = located("--mounting mounting.toml");
    stage.file("rec/odometry.txt", stage.read("rec/odometry.csv"));
    std::fs::remove_file(stage.path("rec/odometry.csv")).unwrap();
    let without_odometry = located("--mounting mounting.toml");
    stage.file("rec/odometry.csv", stage.read("rec/odometry.txt"));
    assert!(known.lines().count() == 30 && known != without_odometry, "it says how fast the camera moves");
    stage.file(
        "run.toml",
        "pace = \"fast\"\n[[camera]]\nname = \"front\"\nsource = { dataset = \"rec\" }\nmounting = \"mounting.toml\"\n[json]\nfile = \"run.jsonl\"\n\
         [record]\nfile = \"run.mcap\"\n",
    );
    let check = stage.run("run --check run.toml");
    assert_eq!(check.code, 0, "{}", check.err);
    assert!(!stage.path("run.mcap").exists(), "a check leaves nothing behind");
    let told = stage.run("run run.toml");
    assert_eq!(told.code, 0, "{}", told.err);
    let found = stage.read("run.jsonl").replace("\"camera\":\"front\",", "");
    assert_eq!(found, known, "a run finds what is found in files");
    for _ in 0..2 {
        let replayed = stage.run(
            "locate run.mcap -q --out - --mounting mounting.toml --camera camera.toml --airframe hexa.toml",
        );
        assert_eq!((replayed.code, replayed.out.as_str()), (0, found.as_str()), "{}", replayed.err);
    }
    stage.file("wrong.toml", stage.read("run.toml").replace("run.mcap\"", "other.mcap\"\nspeed = 3"));
    let refused = stage.run("run wrong.toml");
    assert!(refused.code == 2 && refused.err.contains("speed"), "{}", refused.err);
}
