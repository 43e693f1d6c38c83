//! What the method tells -> structures of C, by the names of the results' files. NaN where nothing is known.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use photinus::locator::{self, Located, Sighting};
use photinus::tracking::{self, Tracked};
use photinus::{pose, spots};

/// How much one frame told.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// When it was taken, s; NaN where that was not told.
    pub time_s: f64,
    /// How many neighbours there are.
    pub neighbours: usize,
    /// How many spots may be markers.
    pub spots: usize,
    /// How many bright regions are no markers.
    pub rejected: usize,
    /// How many vehicles are followed.
    pub tracks: usize,
    /// Whether the frame was explained within the budget; if not, neighbours may be missing.
    pub is_complete: bool,
}

/// A neighbour, in the camera frame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Neighbour {
    /// Unit vector towards it.
    pub bearing: [f64; 3],
    /// From the camera's centre to its origin, m: the likeliest; NaN where only bounds are known.
    pub distance_m: f64,
    /// Standard deviation of that.
    pub distance_sigma_m: f64,
    /// It is never nearer, under the stated assumptions.
    pub distance_min_m: f64,
    /// It is never farther; infinite where nothing bounds it.
    pub distance_max_m: f64,
    /// The paper's l_A, two markers side by side.
    pub perpendicular_m: f64,
    /// The paper's l_B, two markers one behind the other.
    pub inline_m: f64,
    /// Its origin, m.
    pub position_m: [f64; 3],
    /// Covariance of the position, m^2.
    pub position_covariance_m2: [f64; 9],
    /// Its attitude, camera_from_body: one of those that the airframe's symmetry makes equal.
    pub orientation_xyzw: [f64; 4],
    /// Covariance of the attitude as a small rotation in the body frame, the third axis yaw, rad^2.
    pub orientation_covariance_rad2: [f64; 9],
    /// How likely it is there at all, 0 to 1.
    pub probability: f64,
    /// How well its best pose fits: sum of the squared residuals, each over its variance.
    pub misfit_chi2: f64,
    /// How often a right answer fits no better, 0 to 1.
    pub misfit_p: f64,
    /// How many residuals are left when the pose is fitted.
    pub misfit_dof: u32,
    /// How likely the likeliest other explanation of its spots is.
    pub runner_up_probability: f64,
    /// How far the neighbour is that they are then, m; NaN where they are clutter.
    pub runner_up_distance_m: f64,
    /// How many spots are it: `photinus_members`.
    pub members: usize,
    /// In how many ways these can be its airframe: `photinus_modes`.
    pub modes: usize,
}

/// One way in which spots can be the airframe, in the camera frame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Mode {
    /// Its share of the probability, 0 to 1.
    pub weight: f64,
    /// Origin, m.
    pub position_m: [f64; 3],
    /// Covariance of the position, m^2.
    pub position_covariance_m2: [f64; 9],
    /// Attitude, camera_from_body.
    pub orientation_xyzw: [f64; 4],
    /// Covariance of the attitude as a small rotation in the body frame, rad^2.
    pub orientation_covariance_rad2: [f64; 9],
}

/// Something bright that may be a marker.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// Column of the centre, px.
    pub u_px: f64,
    /// Row of the centre, px.
    pub v_px: f64,
    /// Covariance of the centre, px^2.
    pub covariance_px2: [f64; 4],
    /// Unit vector towards it in the camera frame.
    pub bearing: [f64; 3],
    /// Truth is never farther from the bearing, rad.
    pub bound_rad: f64,
    /// Truth is never nearer by the size of the spot, m; NaN without a spot curve.
    pub range_min_m: f64,
    /// Truth is never farther by it; infinite where nothing bounds it.
    pub range_max_m: f64,
    /// Sum of its pixels above the background, grey levels.
    pub flux: f64,
    /// Grey level around it.
    pub background: f64,
    /// The probability that it is the light of markers, from how it looks in its frame alone.
    pub probability: f64,
    /// Pixels that it covers.
    pub area_px: u32,
    /// Pixels of 255.
    pub saturated_px: u32,
    /// Its brightest pixel.
    pub peak: u8,
}

/// Why something bright is no marker.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// One that this version has no name for.
    Other = 0,
    /// The mask says not to look there.
    Mask = 1,
    /// The sun.
    Sun = 2,
    /// Long and thin: light off an edge, a wire, a ripple.
    Streak = 3,
    /// A lit surface.
    Reflection = 4,
    /// The edge of a brighter background.
    Background = 5,
    /// Outside the calibrated field of the camera.
    Outside = 6,
}

/// Something bright that is no marker.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Rejected {
    /// Column of its middle, px.
    pub u_px: f64,
    /// Row of its middle, px.
    pub v_px: f64,
    /// Pixels that it covers.
    pub area_px: u32,
    /// Why.
    pub reason: Reason,
}

/// A vehicle that is followed from frame to frame: relative to the camera, in axes that do not rotate and are the camera's at the time of the frame.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Track {
    /// The same as long as it is followed; never given to another.
    pub track: u64,
    /// How likely it exists, 0 to 1.
    pub probability: f64,
    /// Its origin, m.
    pub position_m: [f64; 3],
    /// Covariance of the position, m^2.
    pub position_covariance_m2: [f64; 9],
    /// How that changes, m/s.
    pub velocity_m_s: [f64; 3],
    /// Covariance of the velocity, m^2/s^2.
    pub velocity_covariance_m2_s2: [f64; 9],
    /// Its attitude, camera_from_body.
    pub orientation_xyzw: [f64; 4],
    /// Covariance of the attitude as a small rotation in the body frame, rad^2.
    pub orientation_covariance_rad2: [f64; 9],
    /// How many spots of the frame it was seen by: `photinus_track_members`.
    pub members: usize,
    /// Whether nothing of it was seen in this frame: it coasts.
    pub predicted: bool,
}

impl Frame {
    pub(crate) fn new(located: &Located, tracked: Option<&Tracked>, time_s: f64) -> Self {
        Self {
            time_s,
            neighbours: located.neighbours.len(),
            spots: located.sightings.len(),
            rejected: located.rejected.len(),
            tracks: tracked.map_or(0, |tracked| tracked.tracks.len()),
            is_complete: located.is_complete,
        }
    }
}

impl From<&locator::Neighbour> for Neighbour {
    fn from(neighbour: &locator::Neighbour) -> Self {
        let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let locator::Neighbour { distance, position, orientation, misfit, runner_up, .. } = neighbour;
        Self {
            bearing: (*neighbour.bearing.vector()).into(),
            distance_m: known(distance.estimate.map(|estimate| estimate.distance_m)),
            distance_sigma_m: known(distance.estimate.map(|estimate| estimate.sigma_m)),
            distance_min_m: distance.bounds.min_m(),
            distance_max_m: distance.bounds.max_m(),
            perpendicular_m: known(distance.perpendicular_m),
            inline_m: known(distance.inline_m),
            position_m: position.map_or([f64::NAN; 3], |position| position.mean_m.into()),
            position_covariance_m2: position.map_or([f64::NAN; 9], |position| rows(&position.covariance_m2)),
            orientation_xyzw: orientation.map_or([f64::NAN; 4], |turned| xyzw(&turned.camera_from_body)),
            orientation_covariance_rad2: orientation
                .map_or([f64::NAN; 9], |turned| rows(&turned.covariance_rad2)),
            probability: neighbour.probability,
            misfit_chi2: misfit.chi_square,
            misfit_p: misfit.p_value(),
            misfit_dof: misfit.degrees,
            runner_up_probability: runner_up.probability,
            runner_up_distance_m: known(runner_up.distance_m),
            members: neighbour.sightings.len(),
            modes: neighbour.modes.len(),
        }
    }
}

impl From<&pose::Mode> for Mode {
    fn from(mode: &pose::Mode) -> Self {
        Self {
            weight: mode.weight,
            position_m: mode.pose.position_m.into(),
            position_covariance_m2: rows(&mode.position_covariance_m2),
            orientation_xyzw: xyzw(&mode.pose.camera_from_body),
            orientation_covariance_rad2: rows(&mode.orientation_covariance_rad2),
        }
    }
}

impl From<&Sighting> for Spot {
    fn from(sighting: &Sighting) -> Self {
        let (spot, covariance) = (&sighting.spot, &sighting.spot.covariance_px2);
        Self {
            u_px: spot.centre.u,
            v_px: spot.centre.v,
            covariance_px2: [covariance.m11, covariance.m12, covariance.m21, covariance.m22],
            bearing: (*sighting.bearing.vector()).into(),
            bound_rad: sighting.bound_rad,
            range_min_m: sighting.range.map_or(f64::NAN, |range| range.min_m()),
            range_max_m: sighting.range.map_or(f64::NAN, |range| range.max_m()),
            flux: spot.flux,
            background: spot.background,
            probability: spot.probability(),
            area_px: spot.area_px,
            saturated_px: spot.saturated_px,
            peak: spot.peak,
        }
    }
}

impl From<&spots::Rejected> for Rejected {
    fn from(rejected: &spots::Rejected) -> Self {
        let reason = match rejected.reason {
            spots::Reason::Mask => Reason::Mask,
            spots::Reason::Sun => Reason::Sun,
            spots::Reason::Streak => Reason::Streak,
            spots::Reason::Reflection => Reason::Reflection,
            spots::Reason::Background => Reason::Background,
            spots::Reason::Outside => Reason::Outside,
            _ => Reason::Other,
        };
        Self { u_px: rejected.centre.u, v_px: rejected.centre.v, area_px: rejected.area_px, reason }
    }
}

impl Track {
    pub(crate) fn new(track: &tracking::Track, tracked: &Tracked) -> Self {
        Self {
            track: track.id,
            probability: track.existence,
            position_m: track.position_m.into(),
            position_covariance_m2: rows(&track.position_covariance_m2),
            velocity_m_s: track.velocity_m_s.into(),
            velocity_covariance_m2_s2: rows(&track.velocity_covariance_m2_s2),
            orientation_xyzw: xyzw(&track.camera_from_body),
            orientation_covariance_rad2: rows(&track.orientation_covariance_rad2),
            members: tracked.members(track).len(),
            predicted: track.is_predicted,
        }
    }
}

/// The quaternion of a rotation, its last number not negative.
fn xyzw(rotation: &Rotation3<f64>) -> [f64; 4] {
    let [x, y, z, w] = UnitQuaternion::from_rotation_matrix(rotation).into_inner().coords.into();
    if w < 0.0 { [-x, -y, -z, -w] } else { [x, y, z, w] }
}

/// A matrix row by row.
fn rows(matrix: &Matrix3<f64>) -> [f64; 9] {
    let [a, b, c]: [[f64; 3]; 3] = matrix.transpose().into();
    [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]]
}
