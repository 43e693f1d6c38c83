//! Tables with named columns: how many rows, over which time, whether they can be read.

use std::path::Path;

use photinus_io::calibration::{read_known_sightings, read_led_sightings, read_spot_sizes};
use photinus_io::corners::read_corners;
use photinus_io::dataset::{GravityLog, parse_frames_csv, read_imu, read_odometry, read_poses};
use photinus_io::kind::{Kind, Table};
use photinus_io::{Error, Result};

use super::{Report, counted};

pub(super) fn report(path: &Path, table: Table) -> Result<Report> {
    let mut report = Report::new(Kind::Table(table).to_string());
    let span = |first_s: f64, last_s: f64| format!("{first_s:.3} to {last_s:.3} s");
    let times_s: Vec<f64> = match table {
        Table::Frames => parse_frames_csv(&text(path)?, path)?.iter().map(|row| row.time_s).collect(),
        Table::Gyro => read_imu(path)?.iter().map(|row| row.time_s).collect(),
        Table::Odometry => read_odometry(path)?.iter().map(|row| row.time_s).collect(),
        Table::Poses => read_poses(path)?.iter().map(|row| row.time_s).collect(),
        Table::Gravity => GravityLog::read(path)?.times_s().collect(),
        _ => Vec::new(),
    };
    let rows = match table {
        Table::Frames | Table::Gyro | Table::Odometry | Table::Poses | Table::Gravity => times_s.len(),
        Table::Corners => {
            let photos = read_corners(path)?;
            report.fact("photos", photos.len().to_string());
            photos.iter().map(|photo| photo.corners.len()).sum()
        }
        Table::SpotSizes => read_spot_sizes(path)?.len(),
        Table::LedSightings => read_led_sightings(path)?.len(),
        Table::KnownSightings => read_known_sightings(path)?.len(),
        Table::Results | Table::Figure | Table::Summary => {
            text(path)?.lines().skip(1).filter(|line| !line.trim().is_empty()).count()
        }
        Table::Unknown => {
            let columns = text(path)?.lines().next().unwrap_or_default().chars().take(80).collect::<String>();
            let refused = Error::format(path, format!("no table of Photinus has the columns `{columns}`"));
            return Err(refused.advise("docs/file-formats.md shows the columns of each table"));
        }
    };
    report.fact("rows", counted(rows, "row"));
    if let (Some(first_s), Some(last_s)) = (times_s.first(), times_s.last()) {
        report.fact("time", span(*first_s, *last_s));
    }
    Ok(report)
}

fn text(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|error| Error::io(path, error))
}
