//! Any text as frames.csv, imu.csv and odometry.csv; a measurement that is read is written and read back.
#![no_main]

use photinus_io::dataset::{parse_frames_csv, parse_imu, parse_odometry};

libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = parse_frames_csv(text, "fuzz");
    let header = |text: &str| text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default().to_owned();
    if let Ok(rows) = parse_imu(text, "fuzz") {
        let again = rows.iter().fold(header(text), |text, row| text + "\n" + &row.line());
        assert_eq!(parse_imu(&again, "fuzz").expect("what was written is read"), rows);
    }
    if let Ok(rows) = parse_odometry(text, "fuzz") {
        let again = rows.iter().fold(header(text), |text, row| text + "\n" + &row.line());
        assert_eq!(parse_odometry(&again, "fuzz").expect("what was written is read"), rows);
    }
});
