//! A located frame in the messages of UVDAR's own stack, and the points of its detector as spots.

use photinus_io::results::{FrameRecord, SpotRecord};

use super::{Messages, Viewpoint};
use crate::ros::{
    BearingObservation, BearingObservationArrayStamped, ImagePointsWithCovariancesStamped, Neighbour,
    NeighbourArray, Point, Point2DWithCovariance, PoseWithCovarianceArrayStamped,
    PoseWithCovarianceIdentified,
};

/// Who is not known.
const NOBODY: i32 = -1;
/// A track is taken for sure above this probability, as UVDAR's filter takes one after its first measurements.
const SURE: f64 = 0.9;

/// What UVDAR's nodes would tell of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Uvdar {
    /// Of the detector: `points_seen`.
    pub points: ImagePointsWithCovariancesStamped,
    /// Of the detector: `points_seen/sun`.
    pub sun: ImagePointsWithCovariancesStamped,
    /// Of the bearing node.
    pub bearings: BearingObservationArrayStamped,
    /// Of the pose estimator: `measuredPoses`.
    pub measured: PoseWithCovarianceArrayStamped,
    /// Of the filter: `filteredPoses`.
    pub filtered: PoseWithCovarianceArrayStamped,
    /// Of the filter: `filteredPoses/tentative`.
    pub tentative: PoseWithCovarianceArrayStamped,
}

impl Uvdar {
    /// The messages of a frame of `size_px` (width, height), by what `told` says of it. Poses and bearings stand in the camera's optical frame.
    #[must_use]
    pub fn of(record: &FrameRecord, told: &Messages, view: &Viewpoint, size_px: [usize; 2]) -> Self {
        let header = view.header(record.time_s);
        let points = |points: Vec<Point2DWithCovariance>| ImagePointsWithCovariancesStamped {
            stamp: header.stamp,
            image_height: u32::try_from(size_px[1]).unwrap_or(u32::MAX),
            image_width: u32::try_from(size_px[0]).unwrap_or(u32::MAX),
            points,
        };
        let sun = record.rejected.iter().filter(|rejected| rejected.reason == "sun");
        let sun = sun.map(|sun| Point2DWithCovariance {
            x: sun.u_px,
            y: sun.v_px,
            ..Point2DWithCovariance::default()
        });
        let poses =
            |neighbours: &NeighbourArray, wanted: fn(&Neighbour) -> bool| PoseWithCovarianceArrayStamped {
                header: header.clone(),
                poses: neighbours.neighbours.iter().filter(|neighbour| wanted(neighbour)).map(pose).collect(),
            };
        Self {
            points: points(record.spots.iter().map(point).collect()),
            sun: points(sun.collect()),
            bearings: BearingObservationArrayStamped {
                header: header.clone(),
                observations: told.neighbours.neighbours.iter().map(bearing).collect(),
            },
            measured: poses(&told.neighbours, |neighbour| neighbour.pose.pose.position.x.is_finite()),
            filtered: poses(&told.tracks, |track| track.probability >= SURE),
            tentative: poses(&told.tracks, |track| track.probability < SURE),
        }
    }
}

/// The points of UVDAR's detector as spots of another detector.
#[must_use]
pub fn spots_of(points: &ImagePointsWithCovariancesStamped) -> Vec<SpotRecord> {
    points.points.iter().filter_map(spot).collect()
}

fn spot(point: &Point2DWithCovariance) -> Option<SpotRecord> {
    // Its covariance is the extent of the spot, not what is known of its centre: the default for a place known to the pixel is nearer.
    let told = serde_json::json!({ "u_px": point.x, "v_px": point.y });
    serde_json::from_value(told).ok()
}

fn point(spot: &SpotRecord) -> Point2DWithCovariance {
    let [[covariance_00, covariance_01], [covariance_10, covariance_11]] = spot.covariance_px2;
    Point2DWithCovariance {
        x: spot.u_px,
        y: spot.v_px,
        covariance_00,
        covariance_01,
        covariance_10,
        covariance_11,
    }
}

fn id(neighbour: &Neighbour) -> i32 {
    neighbour.id.parse().unwrap_or(NOBODY)
}

fn bearing(neighbour: &Neighbour) -> BearingObservation {
    BearingObservation {
        id: id(neighbour),
        track_id: u32::try_from(neighbour.track).unwrap_or(u32::MAX),
        bearing: neighbour.bearing,
        origin: Point::default(),
        covariance: neighbour.bearing_covariance,
        predicted: neighbour.predicted,
    }
}

fn pose(neighbour: &Neighbour) -> PoseWithCovarianceIdentified {
    PoseWithCovarianceIdentified {
        id: id(neighbour),
        pose: neighbour.pose.pose,
        covariance: neighbour.pose.covariance,
    }
}

#[cfg(test)]
mod tests {
    use photinus_io::results::ResultsReader;

    use super::*;

    #[test]
    #[allow(clippy::float_cmp, reason = "numbers pass through unchanged")]
    fn points_poses_and_bearings_are_those_of_the_results() {
        let line = r#"{"spots":[{"u_px":3.5,"v_px":4,"covariance_px2":[[0.04,0.01],[0.01,0.09]]}],"rejected":[{"u_px":9,"v_px":8,"area_px":700,"reason":"sun"},
            {"u_px":1,"v_px":1,"area_px":1,"reason":"reflection"}],"neighbours":[{"id":3,"track":7,"airframe":"a","spots":[0],"bearing":[0,0,1],
            "distance_m":{"estimate":null,"sigma":null,"min":1,"max":null,"perpendicular":null,"inline":null}}]}"#;
        let record = ResultsReader::new(line.replace('\n', "").as_bytes(), "t").next().unwrap().unwrap();
        let view = Viewpoint::new(Some("left"), None);
        let told = Uvdar::of(&record, &Messages::of(&record, &view), &view, [752, 480]);
        let point = told.points.points[0];
        assert_eq!(
            [point.x, point.y, point.covariance_00, point.covariance_01, point.covariance_11],
            [3.5, 4.0, 0.04, 0.01, 0.09]
        );
        assert_eq!((told.points.image_width, told.points.image_height), (752, 480));
        assert_eq!(told.sun.points.iter().map(|sun| [sun.x, sun.y]).collect::<Vec<_>>(), [[9.0, 8.0]]);
        let seen = told.bearings.observations[0];
        assert_eq!((seen.id, seen.track_id, seen.predicted), (3, 7, false));
        // Who has bounds alone has no pose.
        assert!(told.measured.poses.is_empty() && told.filtered.poses.is_empty());
        let back = spots_of(&told.points);
        assert_eq!(
            (back.len(), back[0].u_px.to_bits(), back[0].v_px.to_bits()),
            (1, 3.5_f64.to_bits(), 4_f64.to_bits())
        );
    }

    #[test]
    fn a_point_that_is_nowhere_is_no_spot() {
        let nowhere = Point2DWithCovariance { x: f64::NAN, ..Point2DWithCovariance::default() };
        let points = ImagePointsWithCovariancesStamped { points: vec![nowhere], ..Default::default() };
        assert!(spots_of(&points).is_empty());
    }
}
