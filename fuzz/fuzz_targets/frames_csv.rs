//! Any text as frames.csv, imu.csv, odometry.csv, a log of poses and one of gravity; a measurement that is read is written and read back.
#![no_main]

use photinus_io::dataset::{GravityLog, parse_frames_csv, parse_imu, parse_odometry, parse_poses};

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = (parse_frames_csv(text, "fuzz"), parse_poses(text, "fuzz"));
    if let Ok(log) = GravityLog::parse(text, "fuzz") {
        let _ = log.at(0.5);
    }
    let header =
        |text: &str| text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default().to_owned();
    if let Ok(rows) = parse_imu(text, "fuzz") {
        let again = rows.iter().fold(header(text), |text, row| text + "\n" + &row.line());
        assert_eq!(parse_imu(&again, "fuzz").expect("what was written is read"), rows);
    }
    if let Ok(rows) = parse_odometry(text, "fuzz") {
        let again = rows.iter().fold(header(text), |text, row| text + "\n" + &row.line());
        assert_eq!(parse_odometry(&again, "fuzz").expect("what was written is read"), rows);
    }
});
