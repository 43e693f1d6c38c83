//! Markers whose words are one vehicle's -> that vehicle with its pose, from all of them, also those that are dark at the time. Of one marker alone, as
//! far away as its light says.
//!
//! ```text
//! words      which vehicle's marker each followed one surely is, as which signal          directory
//! poses      upright at every yaw, which of the markers with that signal each may be,     starts
//!            and the place that fits; crate::pose makes them modes with weights
//! ```
//!
//! A frame shows about half of the markers of a vehicle whose signals differ, and what stands next to each other in it may be of several. Who is followed
//! marker by marker and heard needs no group in any frame.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{Unit, Vector3};

use super::Before;
use super::directory::Directory;
use super::starts::Starts;
use crate::airframe::Airframe;
use crate::following::MarkerTrack;
use crate::locator::Settings;
use crate::pose::{Estimator, Hypotheses, Known, LogLight, Observation, POWER_RANGE, SettingsError, Visible};
use crate::tracking::{Called, Calls};

/// A marker tells whose it is from this probability on, ...
const HEARD: f64 = 0.5;
/// ... and those of a vehicle together from this one on: they are wrong when each of them is.
const HEARD_TOGETHER: f64 = 0.95;
/// A vehicle is anywhere in a ball of so many of its radii.
const BALL_RADII: f64 = 60.0;
/// Closer than this, rad, markers tell nothing by their gap.
const LEAST_GAP_RAD: f64 = 0.01;
/// Whose place is less sure is no help to tell one, rad: half a small vehicle at 10 m.
const PLACED_RAD: f64 = 0.015;
/// Markers of one vehicle at most.
const MOST: usize = 16;
/// A marker whose misfit is larger is no marker of the vehicle, sigma.
const MOST_MISFIT_SIGMA: f64 = 6.0;
/// A marker that was not heard is lit so likely, where LEDs blink each for itself, and where all of a vehicle blink alike: it turned into view, or is dead.
const UNHEARD_LIT: f64 = 0.5;
const UNHEARD_LIT_ALIKE: f64 = 0.9;

/// Vehicle, signal, and place among the markers that are followed.
type Heard = (u32, Option<u32>, usize);

/// Vehicles that are heard. Keeps its room.
#[derive(Debug)]
pub(super) struct Calling {
    starts: Starts,
    estimator: Estimator,
    hypotheses: Hypotheses,
    lit: Vec<f64>,
    unit_sigma: f64,
    /// By marker that is followed: vehicle, signal and place among the followed.
    heard: Vec<Heard>,
    own: Vec<Heard>,
    /// Markers from which a vehicle is called.
    fewest: usize,
    observations: Vec<Observation>,
    called: Vec<Called>,
    count: usize,
}

impl Calling {
    /// Of vehicles with this airframe, by a locator with these settings.
    pub(super) fn new(
        airframe: &Airframe,
        settings: &Settings,
        blinks_alike: bool,
    ) -> Result<Self, SettingsError> {
        let lit = if blinks_alike { UNHEARD_LIT_ALIKE } else { UNHEARD_LIT };
        Ok(Self {
            fewest: if blinks_alike { 1 } else { 2 },
            starts: Starts::new(airframe),
            estimator: Estimator::new(airframe, settings.pose)?,
            hypotheses: Hypotheses::with_room(MOST),
            lit: vec![lit; airframe.markers().len()],
            unit_sigma: settings.pose.unit_sigma,
            heard: Vec::with_capacity(MOST),
            own: Vec::with_capacity(MOST),
            observations: Vec::with_capacity(MOST),
            called: Vec::new(),
            count: 0,
        })
    }

    /// Those that call among the markers that are followed: of the vehicles for which `may_call` says so, and whose tracks they are.
    pub(super) fn listen(
        &mut self,
        markers: &[MarkerTrack],
        directory: &Directory,
        gravity: Option<Unit<Vector3<f64>>>,
        before: &Before<'_>,
        may_call: impl Fn(u32) -> Option<Calls>,
    ) {
        self.count = 0;
        self.heard.clear();
        let is_placed = |marker: &MarkerTrack| {
            marker.covariance.fixed_view::<2, 2>(0, 0).trace() < 2.0 * PLACED_RAD * PLACED_RAD
        };
        for (place, marker) in markers.iter().enumerate().filter(|own| is_placed(own.1)) {
            let entry = marker.identity.filter(|own| own.probability > HEARD);
            if let Some(entry) =
                entry.and_then(|own| directory.entry(own.who)).filter(|own| may_call(own.vehicle).is_some())
            {
                self.heard.push((entry.vehicle, entry.signal, place));
            }
        }
        self.heard.sort_unstable_by_key(|&(vehicle, _, place)| (vehicle, place));
        let heard = core::mem::take(&mut self.heard);
        for own in heard.chunk_by(|a, b| a.0 == b.0) {
            self.own.clear();
            for &one in own {
                add(&mut self.own, one, markers);
            }
            leave_strays_out(&mut self.own, markers, &self.starts);
            let call = may_call(own[0].0).filter(|_| (self.fewest..=MOST).contains(&self.own.len()));
            if let Some(call) = call {
                let own = core::mem::take(&mut self.own);
                self.call(markers, (&own, call), gravity.map(|down| -down), before);
                self.own = own;
            }
        }
        self.heard = heard;
    }

    /// Those that called.
    pub(super) fn called(&self) -> &[Called] {
        &self.called[..self.count]
    }

    /// Adds a vehicle that has these markers, if they have a pose.
    fn call(
        &mut self,
        markers: &[MarkerTrack],
        (own, as_track): (&[Heard], Calls),
        up: Option<Unit<Vector3<f64>>>,
        before: &Before<'_>,
    ) {
        let of = |&(.., place): &Heard| &markers[place];
        let probability = 1.0 - own.iter().map(|own| 1.0 - sure(of(own))).product::<f64>();
        if probability < HEARD_TOGETHER {
            return;
        }
        self.observations.clear();
        self.observations.extend(own.iter().map(|&(_, signal, place)| observe(&markers[place], signal)));
        let size = match self.observations.as_slice() {
            [only] => {
                // How far one marker is only light can tell.
                if before.power.is_none() || only.log_light.is_none() {
                    return;
                }
                let distance = self.starts.any_distance();
                self.starts.offer_lone(only, up, distance, &mut self.hypotheses);
                Some(distance)
            }
            all => {
                self.starts.offer(all, up, &mut self.hypotheses);
                None
            }
        };
        let visible = Visible {
            detection_limit: before.detection_limit,
            miss_rate: before.miss_rate,
            watched: Some(before.watched),
            others: &[],
            lit: &self.lit,
        };
        let known = Known {
            up,
            bounds: self.starts.reach(),
            size,
            power: before.power,
            tilt_sigma_rad: before.tilt_sigma_rad,
            unit_sigma: before.light_times.map(|times| times * self.unit_sigma),
            visible,
        };
        let posterior = self.estimator.estimate(&self.observations, &mut self.hypotheses, &known);
        if posterior.summary.is_none() || posterior.worst_sigma > MOST_MISFIT_SIGMA {
            return;
        }
        if self.count == self.called.len() {
            self.called.push(Called::default());
        }
        let called = &mut self.called[self.count];
        self.count += 1;
        called.vehicle = own[0].0;
        called.as_track = as_track;
        called.probability = probability;
        called.members.clear();
        called.members.extend(own.iter().filter_map(|own| of(own).sighting));
        called.members.sort_unstable();
        called.members.dedup();
        called.modes.clone_from(&posterior.modes);
    }
}

/// Adds a marker, unless it is the light of one that is there: where two LEDs came so near that they are one spot, both are followed for a while. The
/// surer of the two stays.
fn add(own: &mut Vec<Heard>, one: Heard, markers: &[MarkerTrack]) {
    let of = |heard: &Heard| &markers[heard.2];
    let reach_rad = of(&one).resolution_rad;
    let spread = |heard: &Heard| of(heard).covariance.fixed_view::<2, 2>(0, 0).trace();
    let is_same = |other: &Heard| {
        let off_rad2 = (of(other).bearing.vector() - of(&one).bearing.vector()).norm_squared();
        other.1 == one.1 && off_rad2 < reach_rad * reach_rad + spread(other) + spread(&one)
    };
    match own.iter_mut().find(|other| is_same(other)) {
        Some(other) if spread(&one) < spread(other) => *other = one,
        Some(_) => {}
        None => own.push(one),
    }
}

/// Leaves out what is rather another's marker that was heard wrong: two of one vehicle are as far apart as few of those near are large, two lights of
/// whomever anyhow.
fn leave_strays_out(own: &mut Vec<Heard>, markers: &[MarkerTrack], starts: &Starts) {
    let of = |heard: &Heard| &markers[heard.2];
    let Some(surest) = own.iter().copied().max_by(|a, b| sure(of(a)).total_cmp(&sure(of(b)))) else { return };
    own.retain(|one| {
        let gap_rad = (of(one).bearing.vector() - of(&surest).bearing.vector()).norm();
        let is_own = sure(of(one)) / (1.0 - sure(of(one))).max(f64::MIN_POSITIVE);
        let odds = is_own * gap_odds(gap_rad, starts.apart_radii(surest.1, one.1));
        one.2 == surest.2 || odds * (1.0 - HEARD_TOGETHER) > HEARD_TOGETHER
    });
}

/// How surely a marker was heard.
fn sure(marker: &MarkerTrack) -> f64 {
    marker.identity.map_or(0.0, |identity| identity.probability)
}

/// How much likelier two markers of a vehicle, so many radii apart, have this gap, rad, than two lights that have nothing to do with each other.
fn gap_odds(gap_rad: f64, apart_radii: f64) -> f64 {
    let gap_rad = gap_rad.max(LEAST_GAP_RAD);
    // In a ball the distance r has the density 3 r^2 / R^3, and the gap is what they are apart over r; over the sphere that of a gap is as wide as it is.
    let share = apart_radii / (BALL_RADII * gap_rad);
    3.0 * share * share * share / (gap_rad * gap_rad)
}

/// A marker that is followed, as one frame would show it.
fn observe(marker: &MarkerTrack, signal: Option<u32>) -> Observation {
    let light =
        |level: crate::identity::Level| LogLight { value: libm::log(level.full()), sigma: level.spread() };
    let log_light = marker.level.map(light);
    Observation {
        bearing: marker.bearing,
        covariance_rad2: marker.bearing_covariance_rad2(),
        log_light,
        resolution_rad: marker.resolution_rad,
        signal,
        clutter_log_density: log_light.map_or(0.0, |_| -libm::log(POWER_RANGE)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Bearing, Watched};
    use crate::identity::Level;
    use crate::identity::decoder::{Identity, Who};
    use crate::lookout::tests::book;
    use crate::lookout::{Fleet, Vehicle};
    use crate::tracking::Tracked;
    use crate::tracking::tests::simulator::{camera, hexarotor, located_by};
    use nalgebra::{Matrix3x2, Matrix4};
    use rand_distr::{Distribution as _, StandardUniform};
    use rand_pcg::Pcg64Mcg;

    /// Vehicles drawn from a ball, and pairs of lights from the sphere: how many of each have such a gap.
    #[test]
    fn gaps_are_as_likely_as_those_of_vehicles_that_are_drawn() {
        let mut random = Pcg64Mcg::new(5);
        let mut uniform = || -> f64 { StandardUniform.sample(&mut random) };
        let bins = [[0.036, 0.044], [0.06, 0.075], [0.1, 0.13]];
        let (mut of_vehicles, mut of_lights) = ([0_u32; 3], [0_u32; 3]);
        let count = |counts: &mut [u32; 3], gap_rad: f64| {
            for (bin, count) in bins.iter().zip(counts) {
                *count += u32::from((bin[0]..bin[1]).contains(&gap_rad));
            }
        };
        for _ in 0..2_000_000 {
            let distance_radii = BALL_RADII * libm::cbrt(uniform());
            count(&mut of_vehicles, 2.0 / distance_radii);
            // Of two directions that are anywhere the cosine of their angle is anything.
            let cosine = 1.0 - 2.0 * uniform();
            count(&mut of_lights, libm::acos(cosine));
        }
        for ((bin, vehicles), lights) in bins.iter().zip(of_vehicles).zip(of_lights) {
            let drawn = f64::from(vehicles) / f64::from(lights);
            // Lights are anywhere in half of the sphere that a camera sees, which makes such a pair about twice as likely.
            let told = 2.0 * gap_odds((bin[0] * bin[1]).sqrt(), 2.0);
            assert!((0.6..1.7).contains(&(told / drawn)), "{bin:?}: {told} {drawn}");
        }
    }

    /// One that shows a single LED is as far away as its light says, and that as surely as frames found the power of LEDs alike.
    #[test]
    fn a_lone_marker_is_as_far_away_as_light_that_spreads_so_tells() {
        let fleet = Fleet::new(book(), [(Vehicle { id: 7, words: vec![0] }, 60.0)]).unwrap();
        let directory = Directory::of(&fleet);
        let mut level = Level::of_first(100.0).unwrap();
        (0..100).for_each(|_| level.see(100.0, 3.0, 1.0));
        let marker = MarkerTrack {
            number: 1,
            bearing: Bearing::new(Vector3::z()).unwrap(),
            rate_rad_s: Vector3::zeros(),
            axes: Matrix3x2::identity(),
            covariance: Matrix4::identity() * 1e-8,
            level: Some(level),
            resolution_rad: 0.005,
            sighting: Some(0),
            sighting_probability: 1.0,
            lit: 1.0,
            partly: 0.0,
            existence: 1.0,
            identity: Some(Identity { who: Who::Word(0), probability: 0.999 }),
        };
        let sigma_of_log_distance = |light_times: Option<f64>| {
            let mut calling = Calling::new(&hexarotor(), &located_by(), true).unwrap();
            let (camera, tracked) = (camera(), Tracked::default());
            let before = Before {
                watched: Watched::new(&camera, None),
                tracked: &tracked,
                detection_limit: None,
                miss_rate: None,
                tilt_sigma_rad: None,
                light_times,
                power: Some(LogLight { value: libm::log(100.0 * 49.0), sigma: 0.02 }),
            };
            calling.listen(&[marker], &directory, Some(Vector3::y_axis()), &before, |_| Some(Calls::New));
            let [called] = calling.called() else { panic!("one calls, not {}", calling.called().len()) };
            let log_distance = |mode: &crate::pose::Mode| libm::log(mode.pose.position_m.norm());
            let mean: f64 = called.modes.iter().map(|mode| mode.weight * log_distance(mode)).sum();
            let variance = |mode: &crate::pose::Mode| {
                let along = mode.pose.position_m / mode.pose.position_m.norm_squared();
                let off = log_distance(mode) - mean;
                mode.weight * (along.dot(&(mode.position_covariance_m2 * along)) + off * off)
            };
            called.modes.iter().map(variance).sum::<f64>().sqrt()
        };
        let [untold, once, six_times] = [None, Some(1.0), Some(6.0)].map(sigma_of_log_distance);
        assert!((untold - once).abs() < 1e-12, "{untold} is {once}");
        // Light goes with the square of the distance.
        let unit = 0.5 * located_by().pose.unit_sigma;
        let expected = (once * once + 35.0 * unit * unit).sqrt();
        assert!((six_times / expected - 1.0).abs() < 0.2, "{six_times} after {once}, not {expected}");
    }
}
