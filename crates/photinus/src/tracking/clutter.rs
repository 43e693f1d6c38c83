//! Spots that are no vehicle's, frame after frame -> persistent clutter: where such a spot is no news.
//!
//! One LED of a vehicle far off, a lamp, a vehicle of another kind: a light that nobody claims goes on. Were clutter new in every frame, each sight of it would be
//! a surprise, and a vehicle nearby that takes it for a marker would gain that much in every frame, while what speaks against that (errors that frames repeat)
//! counts once. So lights that were nobody's are expected again, no less surely than the markers of a vehicle nearby are.
//!
//! Each is followed by a Kalman filter of its direction and its rate, with one variance for both axes across the line of sight.

use alloc::vec::Vec;

use nalgebra::Vector3;

use super::look::{Moment, Signalled};
use super::motion::Motion;
use super::settings::Settings;
use super::state::State;
use super::step::Model;
use crate::normal;
use crate::pose::{LogLight, Observation};

/// Most lights that are remembered.
pub(super) const MOST: usize = 128;
/// What is rather somebody's is none, nor what was not seen for as long as that takes.
const LEAST: f64 = 0.5;
/// A light lasts so long on average, s.
const LASTS_S: f64 = 0.5;
/// Lights wander as those of vehicles so far off, m; and are no surer to be where they are expected than markers of one so near.
const AWAY_M: f64 = 10.0;
const NEAR_M: f64 = 5.0;
/// How far the light of a spot is off that of the frame before, as a logarithm.
const LIGHT_SIGMA: f64 = 0.5;
/// A light so far from where one is expected, squared and in variances, is another.
const GATE: f64 = 16.0;

/// A light that may be nobody's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ClutterPoint {
    /// Which camera sees it.
    camera: usize,
    /// Where, in the axes of what is believed, which are another camera's meanwhile.
    direction: Vector3<f64>,
    rate_rad_s: Vector3<f64>,
    /// Of the direction, of both, of the rate, per axis.
    variance: [f64; 3],
    log_light: Option<LogLight>,
    /// How likely it is nobody's, and is there.
    probability: f64,
}

/// The lights of nobody around a frame. Keeps its room.
#[derive(Debug, Default)]
pub(super) struct PersistentClutter {
    predicted: Vec<ClutterPoint>,
    /// Whether each of them is among the frame's spots.
    found: Vec<bool>,
    /// By spot: which of them it most likely is, and the density of such a spot by all of them, per sr and unit of the logarithm of its light.
    continues: Vec<Option<usize>>,
    density: Vec<f64>,
    /// By spot: how likely it is a vehicle's.
    somebodys: Vec<f64>,
}

impl PersistentClutter {
    pub(super) fn with_room() -> Self {
        Self { predicted: Vec::with_capacity(MOST), found: Vec::with_capacity(MOST), ..Self::default() }
    }

    /// Carries lights on to a frame, and tells how dense they make its spots, where a frame may count the place of a marker to this variance.
    pub(super) fn expect(
        &mut self,
        before: &[ClutterPoint],
        moment: &Moment,
        motion: &Motion,
        settings: &Settings,
        marker_m2: f64,
    ) -> &[f64] {
        let unsure_rad2 = marker_m2 / (NEAR_M * NEAR_M);
        self.predicted.clear();
        self.predicted.extend(before.iter().map(|own| own.after(motion, settings)));
        self.found.clear();
        self.found.resize(self.predicted.len(), false);
        self.continues.clear();
        self.density.clear();
        for seen in &moment.observations {
            let (mut density, mut best) = (0.0, None);
            for (place, own) in self.predicted.iter().enumerate().filter(|own| own.1.camera == moment.camera)
            {
                let there = own.density(seen, unsure_rad2);
                self.found[place] |= there > 0.0;
                density += there;
                if there > best.map_or(0.0, |(_, most)| most) {
                    best = Some((place, there));
                }
            }
            self.continues.push(best.map(|(place, _)| place));
            self.density.push(density);
        }
        &self.density
    }

    /// Remembers the spots of a frame that no vehicle claims, and lights that it does not show.
    pub(super) fn remember(&mut self, model: &Model, moment: &Moment, claimed: &[f64], after: &mut State) {
        self.find_owners(model, moment, claimed, after);
        let Self { predicted, found, continues, somebodys, .. } = self;
        let seen = moment.observations.iter().enumerate().map(|(spot, seen)| {
            let new = || ClutterPoint::new(moment.camera, seen, &model.settings);
            let here = continues[spot].map_or_else(new, |place| predicted[place].with(seen));
            ClutterPoint { probability: 1.0 - somebodys[spot], ..here }
        });
        let unseen = predicted.iter().zip(&*found).filter(|own| !own.1).map(|own| *own.0);
        after.persistent.clear();
        after.persistent.extend(seen.chain(unseen).filter(|own| own.probability > LEAST).take(MOST));
    }

    /// Says how likely each spot is somebody's: whose who claims it, also who has just appeared, or is located only, or was heard to blink there; and who is missing may show again there.
    fn find_owners(&mut self, model: &Model, moment: &Moment, claimed: &[f64], after: &State) {
        let somebodys = &mut self.somebodys;
        somebodys.clear();
        somebodys.extend_from_slice(claimed);
        let mut belong = |spot: usize, probability: f64| somebodys[spot] = somebodys[spot].max(probability);
        for target in &after.targets {
            after.members(target).iter().for_each(|&spot| belong(spot, target.existence));
        }
        for appearance in &moment.appearances {
            moment.members(appearance).iter().for_each(|&spot| belong(spot, appearance.probability));
        }
        for (spot, heard) in moment.signals.iter().enumerate() {
            if let Some(Signalled { vehicle: Some(_), probability, .. }) = *heard {
                belong(spot, probability);
            }
        }
        for target in after.targets.iter().filter(|target| target.is_predicted) {
            for component in after.components(target) {
                let may_be_there = model.may_be_at(component);
                let spots = moment.observations.iter().enumerate().filter(|(_, seen)| may_be_there(seen));
                spots.for_each(|(spot, _)| belong(spot, target.existence));
            }
        }
    }
}

impl ClutterPoint {
    /// A spot that was never seen before.
    fn new(camera: usize, seen: &Observation, settings: &Settings) -> Self {
        let rate_sigma = settings.velocity_sigma_m_s / AWAY_M;
        Self {
            camera,
            direction: *seen.bearing.vector(),
            rate_rad_s: Vector3::zeros(),
            variance: [noise_rad2(seen), 0.0, rate_sigma * rate_sigma],
            log_light: seen.log_light,
            probability: 1.0,
        }
    }

    /// The same with a spot that is this light.
    fn with(&self, seen: &Observation) -> Self {
        let [own, both, rate] = self.variance;
        let noise = noise_rad2(seen);
        let [by, by_rate] = [own, both].map(|variance| variance / (own + noise));
        let off = seen.bearing.vector() - self.direction;
        Self {
            direction: (self.direction + off * by).normalize(),
            rate_rad_s: self.rate_rad_s + off * by_rate,
            variance: [own * (1.0 - by), both * (1.0 - by), rate - by_rate * both],
            log_light: seen.log_light,
            ..*self
        }
    }

    /// The same a while later.
    fn after(&self, motion: &Motion, settings: &Settings) -> Self {
        let (interval_s, turn) = (motion.interval_s, &motion.turn);
        let [own, both, rate] = self.variance;
        let density = (settings.acceleration / AWAY_M) * (settings.acceleration / AWAY_M);
        let (square, cube) = (interval_s * interval_s, interval_s * interval_s * interval_s);
        Self {
            direction: turn.now_from_before * (self.direction + self.rate_rad_s * interval_s).normalize(),
            rate_rad_s: turn.now_from_before * self.rate_rad_s,
            variance: [
                own + 2.0 * both * interval_s
                    + rate * square
                    + density * cube / 3.0
                    + turn.sigma_rad * turn.sigma_rad,
                both + rate * interval_s + density * square / 2.0,
                rate + density * interval_s,
            ],
            probability: self.probability * libm::exp(-interval_s / LASTS_S),
            ..*self
        }
    }

    /// The density of a spot as this light, with its probability; 0 where it is none.
    fn density(&self, seen: &Observation, unsure_rad2: f64) -> f64 {
        let variance = self.variance[0] + noise_rad2(seen) + unsure_rad2;
        let square = (seen.bearing.vector() - self.direction).norm_squared() / variance;
        if square > GATE {
            return 0.0;
        }
        let of_light = match (self.log_light, seen.log_light) {
            (Some(own), Some(seen)) => {
                let sigma = libm::hypot(LIGHT_SIGMA, libm::hypot(own.sigma, seen.sigma));
                normal::density((seen.value - own.value) / sigma, sigma)
            }
            _ => 1.0,
        };
        self.probability * of_light * libm::exp(-0.5 * square) / (core::f64::consts::TAU * variance)
    }
}

/// The variance of a spot's direction, of one axis.
fn noise_rad2(seen: &Observation) -> f64 {
    0.5 * seen.covariance_rad2.trace()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Rotation3};

    use super::super::component::Component;
    use super::super::motion::Turn;
    use super::super::state::Target;
    use super::super::tests::simulator::model;
    use super::*;
    use crate::camera::Bearing;

    const INTERVAL_S: f64 = 1.0 / 30.0;
    const NOISE_RAD: f64 = 4e-4;
    const TURN_RAD: f64 = 0.05;
    /// Markers to 3 mm, whose errors last for 30 frames.
    const MARKER_M2: f64 = 30.0 * 0.003 * 0.003;

    fn spot(direction: Vector3<f64>) -> Observation {
        Observation {
            bearing: Bearing::new(direction).unwrap(),
            covariance_rad2: (Matrix3::identity() - direction * direction.transpose())
                * (NOISE_RAD * NOISE_RAD),
            log_light: Some(LogLight { value: 5.0, sigma: 0.05 }),
            resolution_rad: 0.0,
            signal: None,
            clutter_log_density: 0.0,
        }
    }

    /// Lights at these angles to the axis, rad, in a frame of a camera.
    fn frame(camera: usize, angles_rad: &[f64]) -> Moment {
        let mut moment = Moment::default();
        moment.camera = camera;
        moment.observations.extend(
            angles_rad
                .iter()
                .map(|&angle_rad| spot(Vector3::new(libm::sin(angle_rad), 0.0, libm::cos(angle_rad)))),
        );
        moment
    }

    /// A camera that turns.
    fn turning(turn_rad: f64, interval_s: f64) -> Motion {
        let now_from_before = Rotation3::from_axis_angle(&Vector3::y_axis(), turn_rad);
        Motion {
            interval_s,
            turn: Turn { now_from_before, ..Turn::none(Vector3::zeros()) },
            faster: None,
            up: None,
            tilt_sigma_rad: 0.1,
        }
    }

    /// How dense what is remembered makes the spots of the next frame.
    fn dense(before: &State, moment: &Moment) -> Vec<f64> {
        let (mut clutter, motion) = (PersistentClutter::with_room(), turning(TURN_RAD, INTERVAL_S));
        clutter.expect(&before.persistent, moment, &motion, &Settings::default(), MARKER_M2).to_vec()
    }

    /// What is remembered after frames of lights that wander at a rate, rad/s, while the camera turns evenly.
    fn remembered(frames: usize, rate_rad_s: f64, claimed: f64) -> (State, f64) {
        let mut state = State::empty(0.0, 0);
        let mut clutter = PersistentClutter::with_room();
        let at_rad = |frame: usize| frame as f64 * (TURN_RAD + rate_rad_s * INTERVAL_S);
        let motion = turning(TURN_RAD, INTERVAL_S);
        for number in 0..frames {
            let moment = frame(0, &[at_rad(number)]);
            let before = core::mem::take(&mut state.persistent);
            clutter.expect(&before, &moment, &motion, &Settings::default(), MARKER_M2);
            clutter.remember(&model(), &moment, &[claimed], &mut state);
        }
        (state, at_rad(frames))
    }

    #[test]
    fn a_light_that_wanders_is_expected_where_it_will_be() {
        let new = 0.1;
        for rate_rad_s in [-0.3, 0.0, 0.3] {
            let (state, next_rad) = remembered(12, rate_rad_s, 0.0);
            let there = dense(&state, &frame(0, &[next_rad, next_rad + 0.05]));
            assert!(there[0] > 1e4 * new && there[1] < new, "{rate_rad_s}: {there:?}");
            // A camera that looks elsewhere knows nothing of it.
            assert_eq!(dense(&state, &frame(1, &[next_rad])), [0.0]);
            // One that was seen once may wander anywhere near.
            let (state, next_rad) = remembered(1, rate_rad_s, 0.0);
            let once = dense(&state, &frame(0, &[next_rad]))[0];
            assert!(once > 10.0 * new && once < 0.2 * there[0], "{rate_rad_s}: {once}");
        }
    }

    #[test]
    fn what_is_somebodys_is_no_clutter() {
        assert_eq!(remembered(5, 0.0, 0.0).0.persistent.len(), 1);
        assert!(remembered(5, 0.0, 0.6).0.persistent.is_empty());
        // A vehicle that has just appeared has its spots, though none claimed them.
        let moment = frame(0, &[0.0, 0.1]);
        let mut state = State::empty(0.0, 0);
        state.members.push(1);
        state.targets.push(Target { existence: 0.9, members: 1, ..Target::somebody(0.0) });
        let mut clutter = PersistentClutter::with_room();
        clutter.continues.resize(2, None);
        clutter.remember(&model(), &moment, &[0.0; 2], &mut state);
        assert!(state.persistent.len() == 1 && state.persistent[0].direction.x.abs() < 1e-9);
        // Nor what may be a vehicle that is missing there.
        state.components.push(Component::somewhere(Vector3::z() * 9.0, 0.01));
        let missing = Target { components: 1, is_predicted: true, ..Target::somebody(0.0) };
        state.targets.push(missing);
        clutter.remember(&model(), &moment, &[0.0; 2], &mut state);
        assert!(state.persistent.is_empty());
    }

    /// Whichever place its track has.
    #[test]
    fn who_blinks_the_words_of_a_vehicle_is_no_clutter() {
        let mut moment = frame(0, &[0.0, 0.1]);
        let of = |vehicle| Some(Signalled { signal: Some(0), probability: 0.9, vehicle });
        moment.signals.extend([of(Some(3)), of(None)]);
        let mut state = State::empty(0.0, 0);
        let mut clutter = PersistentClutter::with_room();
        clutter.continues.resize(2, None);
        clutter.remember(&model(), &moment, &[0.0; 2], &mut state);
        assert!(state.persistent.len() == 1 && state.persistent[0].direction.x > 0.05);
    }

    #[test]
    fn a_light_that_goes_out_is_forgotten() {
        let (mut state, _) = remembered(5, 0.0, 0.0);
        let nothing = frame(0, &[]);
        let motion = turning(0.0, 0.1);
        let lasted = (0..20).take_while(|_| {
            let mut clutter = PersistentClutter::with_room();
            clutter.expect(&state.persistent, &nothing, &motion, &Settings::default(), MARKER_M2);
            clutter.remember(&model(), &nothing, &[], &mut state);
            !state.persistent.is_empty()
        });
        assert!((2..=4).contains(&lasted.count()));
    }
}
