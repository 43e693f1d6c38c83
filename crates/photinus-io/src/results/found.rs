//! What the method found, as records, and spots of a file as the method takes them.

use nalgebra::{Matrix2, Matrix3, Rotation3, UnitQuaternion};

use photinus::camera::Pixel;
use photinus::locator::{self, Located, Neighbour, Sighting};
use photinus::lookout::Name;
use photinus::optics::Measured;
use photinus::pose::Mode;
use photinus::spots::{Extent, Rejected, Spot};
use photinus::tracking::{Track, Tracked};

use super::record::Mode as ModeRecord;
use super::{
    Distance, FrameRecord, IdRecord, Misfit, NeighbourRecord, RejectedRecord, RunnerUp, SpotRecord,
    TrackRecord,
};

/// A vehicle has an id from this probability on.
const SURE: f64 = 0.99;

impl FrameRecord {
    /// Puts what was located in the place of the spots and neighbours that the record holds; what was rejected joins what
    /// another detector rejected before. `airframes` are the names of those that were looked for, by kind. Tracks are added afterwards.
    pub fn put_located(&mut self, located: &Located, airframes: &[impl AsRef<str>]) {
        self.incomplete = !located.is_complete;
        self.spots = located.sightings.iter().map(SpotRecord::from).collect();
        self.rejected.extend(located.rejected.iter().map(RejectedRecord::from));
        let record = |neighbour| NeighbourRecord::new(neighbour, airframes);
        self.neighbours = located.neighbours.iter().map(record).collect();
        self.tracks.clear();
    }

    /// Adds who is followed of a kind and who that may be, `None` where nobody blinks. `airframes` are as for [`Self::put_located`]: no two kinds share a name,
    /// nor numbers of tracks.
    pub fn add_tracked(
        &mut self,
        tracked: &Tracked,
        names: Option<&[Name]>,
        kind: usize,
        airframes: &[impl AsRef<str>],
    ) {
        let airframe = airframes.get(kind).map_or("", AsRef::as_ref);
        let number = |track: &Track| track.id * airframes.len() as u64 + kind as u64;
        let record =
            |track| TrackRecord { track: number(track), ..TrackRecord::new(track, tracked, names, airframe) };
        self.tracks.extend(tracked.tracks.iter().map(record));
    }

    /// Says of each neighbour which of the tracks it is: the one that was seen by most of its spots.
    pub fn name_neighbours(&mut self) {
        for neighbour in &mut self.neighbours {
            let common = |track: &TrackRecord| {
                track.spots.iter().filter(|spot| neighbour.spots.contains(spot)).count()
            };
            let most = self.tracks.iter().filter(|track| common(track) > 0).max_by_key(|track| common(track));
            neighbour.track = most.map(|track| track.track);
            neighbour.id = most.and_then(|track| track.id);
            neighbour.id_probability = most.and_then(|track| track.id_probability);
            neighbour.velocity_m_s = most.map(|track| track.velocity_m_s);
            neighbour.velocity_covariance_m2_s2 = most.map(|track| track.velocity_covariance_m2_s2);
        }
    }
}

impl TrackRecord {
    fn new(track: &Track, tracked: &Tracked, names: Option<&[Name]>, airframe: &str) -> Self {
        let own = names.unwrap_or(&[]).iter().filter(|name| name.track == track.id);
        let ids: Vec<IdRecord> = own.map(IdRecord::from).collect();
        let likeliest = ids.first().copied();
        Self {
            track: track.id,
            id: likeliest.filter(|first| first.probability >= SURE).map(|first| first.id),
            id_probability: names.map(|_| likeliest.map_or(0.0, |first| first.probability)),
            ids,
            airframe: airframe.to_owned(),
            probability: track.existence,
            predicted: track.is_predicted,
            spots: tracked.members(track).to_vec(),
            position_m: track.position_m.into(),
            position_covariance_m2: rows(&track.position_covariance_m2),
            position_body_m: None,
            position_body_covariance_m2: None,
            velocity_m_s: track.velocity_m_s.into(),
            velocity_covariance_m2_s2: rows(&track.velocity_covariance_m2_s2),
            orientation_xyzw: xyzw(&track.camera_from_body),
            orientation_covariance_rad2: rows(&track.orientation_covariance_rad2),
            position_orientation_covariance_m_rad: Some(rows(&track.position_orientation_covariance_m_rad)),
        }
    }
}

impl NeighbourRecord {
    fn new(neighbour: &Neighbour, airframes: &[impl AsRef<str>]) -> Self {
        let airframe = airframes.get(neighbour.kind).map_or("", AsRef::as_ref);
        let orientation = neighbour.orientation;
        Self {
            track: None,
            id: None,
            id_probability: None,
            velocity_m_s: None,
            velocity_covariance_m2_s2: None,
            airframe: airframe.to_owned(),
            airframe_probability: (airframes.len() > 1).then_some(neighbour.kind_probability),
            spots: neighbour.sightings.clone(),
            bearing: (*neighbour.bearing.vector()).into(),
            distance_m: Distance::from(&neighbour.distance),
            position_m: neighbour.position.map(|position| position.mean_m.into()),
            position_covariance_m2: neighbour.position.map(|position| rows(&position.covariance_m2)),
            position_body_m: None,
            position_body_covariance_m2: None,
            orientation_xyzw: orientation.map(|turned| xyzw(&turned.camera_from_body)),
            orientation_covariance_rad2: orientation.map(|turned| rows(&turned.covariance_rad2)),
            position_orientation_covariance_m_rad: orientation
                .map(|turned| rows(&turned.position_covariance_m_rad)),
            probability: Some(neighbour.probability),
            misfit: Some(Misfit {
                chi2: neighbour.misfit.chi_square,
                dof: neighbour.misfit.degrees,
                p: neighbour.misfit.p_value(),
            }),
            runner_up: Some(RunnerUp {
                probability: neighbour.runner_up.probability,
                distance_m: neighbour.runner_up.distance_m,
            }),
            modes: neighbour.modes.iter().map(ModeRecord::from).collect(),
        }
    }
}

impl From<&Name> for IdRecord {
    fn from(name: &Name) -> Self {
        Self { id: name.id, probability: name.probability, contested: name.is_contested }
    }
}

impl From<&Mode> for ModeRecord {
    fn from(mode: &Mode) -> Self {
        Self {
            weight: mode.weight,
            position_m: mode.pose.position_m.into(),
            position_covariance_m2: rows(&mode.position_covariance_m2),
            orientation_xyzw: Some(xyzw(&mode.pose.camera_from_body)),
            orientation_covariance_rad2: Some(rows(&mode.orientation_covariance_rad2)),
            position_orientation_covariance_m_rad: Some(rows(&mode.position_orientation_covariance_m_rad)),
        }
    }
}

impl From<&locator::Distance> for Distance {
    fn from(distance: &locator::Distance) -> Self {
        Self {
            estimate: distance.estimate.map(|estimate| estimate.distance_m),
            sigma: distance.estimate.map(|estimate| estimate.sigma_m),
            min: distance.bounds.min_m(),
            max: finite(distance.bounds.max_m()),
            perpendicular: distance.perpendicular_m,
            inline: distance.inline_m,
        }
    }
}

impl From<&Sighting> for SpotRecord {
    fn from(sighting: &Sighting) -> Self {
        Self {
            bearing: Some((*sighting.bearing.vector()).into()),
            bound_rad: Some(sighting.bound_rad),
            range_m: sighting.range.map(|range| (range.min_m(), finite(range.max_m()))),
            signal: sighting.signal,
            ..Self::from(&sighting.spot)
        }
    }
}

impl From<&Spot> for SpotRecord {
    fn from(spot: &Spot) -> Self {
        let c = &spot.covariance_px2;
        Self {
            u_px: spot.centre.u,
            v_px: spot.centre.v,
            area_px: spot.area_px,
            peak: spot.peak,
            saturated_px: spot.saturated_px,
            flux: spot.flux,
            light: spot.light.map(|light| [light.value, light.sigma]),
            sigma_px: spot.sigma_px(),
            covariance_px2: [[c.m11, c.m12], [c.m21, c.m22]],
            middle_px: [spot.middle.0, spot.middle.1],
            extent_px: Some([spot.extent.left, spot.extent.top, spot.extent.right, spot.extent.bottom]),
            background: spot.background,
            probability: spot.probability(),
            marker_log_odds: spot.marker_log_odds,
            bearing: None,
            bound_rad: None,
            range_m: None,
            signal: None,
        }
    }
}

impl From<&SpotRecord> for Spot {
    /// A spot that states only its area gets the box that no spot of that area leaves.
    fn from(record: &SpotRecord) -> Self {
        let [[uu, uv], [vu, vv]] = record.covariance_px2;
        let [u, v] = record.middle_px;
        let centre = Pixel::new(record.u_px, record.v_px);
        let extent = match record.extent_px {
            Some([left, top, right, bottom]) => Extent { left, top, right, bottom },
            None => widest_extent(centre, record.area_px),
        };
        Self {
            centre,
            covariance_px2: Matrix2::new(uu, uv, vu, vv),
            area_px: record.area_px,
            peak: record.peak,
            saturated_px: record.saturated_px,
            flux: record.flux,
            light: record.light.map(|[value, sigma]| Measured { value, sigma }),
            background: record.background,
            marker_log_odds: record.marker_log_odds,
            middle: (u, v),
            extent,
        }
    }
}

/// The pixels within half of `area_px` of the centre, along either axis. S pixels that touch, if only at a corner, and
/// whose mean is the centre reach no farther: the longest such chain is a straight line.
fn widest_extent(centre: Pixel, area_px: u32) -> Extent {
    let reach_px = f64::from(area_px.max(1)) / 2.0;
    // Saturates: no pixel is left of 0.
    let first = |at: f64| (at - reach_px + 0.5).floor() as u32;
    let last = |at: f64| (at + reach_px - 0.5).ceil() as u32;
    Extent { left: first(centre.u), top: first(centre.v), right: last(centre.u), bottom: last(centre.v) }
}

impl From<&Rejected> for RejectedRecord {
    fn from(rejected: &Rejected) -> Self {
        Self {
            u_px: rejected.centre.u,
            v_px: rejected.centre.v,
            area_px: rejected.area_px,
            reason: rejected.reason.as_str().to_owned(),
        }
    }
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// The quaternion of a rotation, its last number not negative.
fn xyzw(rotation: &Rotation3<f64>) -> [f64; 4] {
    let [x, y, z, w] = UnitQuaternion::from_rotation_matrix(rotation).into_inner().coords.into();
    if w < 0.0 { [-x, -y, -z, -w] } else { [x, y, z, w] }
}

pub(super) fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    matrix.transpose().into()
}

#[cfg(test)]
mod tests {
    use photinus::airframe::{Airframe, Ring};
    use photinus::camera::{Camera, Ideal, IdealLaw, Model};
    use photinus::locator::{Input, Locator, Settings};
    use photinus::ranging::SpotCurve;
    use proptest::prelude::*;
    use proptest::{collection, sample::Index};

    use super::*;

    #[test]
    fn what_was_located_stands_in_the_record() {
        let lens = Ideal::new(IdealLaw::Equidistant, [250.0; 2], Pixel::new(375.5, 239.5)).unwrap();
        let camera = Camera::new(Model::Ideal(lens), 752, 480, None).unwrap();
        let ring = Ring { arms: 4, radius_m: 0.3, leds_per_arm: 1, splay_rad: 0.0 };
        let quad = Airframe::from_ring("quad", ring).unwrap();
        let curve = Some(SpotCurve::paper_1000_us());
        let mut locator = Locator::new(camera, &quad, curve, Settings::default()).unwrap();
        let text = r#"{"spots":[{"u_px":370,"v_px":240},{"u_px":381,"v_px":240},{"u_px":0,"v_px":0}],
            "rejected":[{"u_px":1,"v_px":2,"area_px":900,"reason":"sun"}]}"#;
        let mut record: FrameRecord = serde_json::from_str(text).unwrap();
        let spots: Vec<Spot> = record.spots.iter().map(Spot::from).collect();
        let located = locator.locate(Input::spots(&spots)).expect("spots have no size");
        record.put_located(located, &["quad"]);

        assert_eq!(record.rejected[0].reason, "sun", "what came in rejected stays");
        assert_eq!(record.spots.len() + record.rejected.len(), 4);
        let near = record.neighbours.iter().find(|neighbour| neighbour.spots == [0, 1]).unwrap();
        let (distance, estimate_m) = (&near.distance_m, near.distance_m.estimate.unwrap());
        assert!(distance.min < estimate_m && distance.max.is_none_or(|max| estimate_m < max));
        let along: f64 = (0..3).map(|i| near.position_m.unwrap()[i] * near.bearing[i]).sum();
        assert!((along / estimate_m - 1.0).abs() < 0.01, "{along} {estimate_m}");
        assert_eq!(record.spots[0].range_m.unwrap().1, None, "a spot of one pixel has no far end");
        assert!(record.spots[0].bearing.is_some() && record.spots[0].bound_rad.unwrap() > 0.0);
    }

    #[test]
    fn a_spot_survives_the_way_through_a_record() {
        let spot = Spot {
            centre: Pixel::new(100.25, 50.5),
            covariance_px2: Matrix2::new(0.05, 0.01, 0.01, 0.03),
            area_px: 9,
            peak: 255,
            saturated_px: 2,
            flux: 812.5,
            light: Some(Measured { value: 1030.0, sigma: 40.0 }),
            background: 3.5,
            marker_log_odds: -1.3,
            middle: (100, 51),
            extent: Extent { left: 99, top: 50, right: 101, bottom: 52 },
        };
        let record = SpotRecord::from(&spot);
        assert_eq!(Spot::from(&record), spot);
        assert!((record.sigma_px - 0.2).abs() < 1e-12);
    }

    fn stated(u_px: f64, v_px: f64, area_px: u32) -> Extent {
        let text = format!("{{\"u_px\":{u_px},\"v_px\":{v_px},\"area_px\":{area_px}}}");
        Spot::from(&serde_json::from_str::<SpotRecord>(&text).unwrap()).extent
    }

    #[test]
    fn a_spot_that_states_only_its_area_gets_a_box_of_that_side() {
        assert_eq!(stated(10.0, 20.0, 1), Extent { left: 10, top: 20, right: 10, bottom: 20 });
        assert_eq!(stated(10.0, 20.0, 5), Extent { left: 8, top: 18, right: 12, bottom: 22 });
        assert_eq!(stated(10.5, 20.0, 4), Extent { left: 9, top: 18, right: 12, bottom: 22 });
        assert_eq!(stated(-0.5, 0.2, 9).left, 0, "no pixel is left of the first");
        let all = Extent { left: 0, top: 0, right: 2_147_483_657, bottom: 2_147_483_667 };
        assert_eq!(stated(10.0, 20.0, u32::MAX), all);
    }

    proptest! {
        #[test]
        fn no_spot_leaves_the_box_of_its_area(steps in collection::vec((any::<Index>(), 0..8_usize), 0..40)) {
            const NEAR: [(i32, i32); 8] = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
            let mut pixels = vec![(100, 100)];
            for (at, to) in steps {
                let ((u, v), (du, dv)) = (*at.get(&pixels), NEAR[to]);
                if !pixels.contains(&(u + du, v + dv)) {
                    pixels.push((u + du, v + dv));
                }
            }
            let mean = |of: fn(&(i32, i32)) -> i32| {
                f64::from(pixels.iter().map(of).sum::<i32>()) / pixels.len() as f64
            };
            let extent = stated(mean(|p| p.0), mean(|p| p.1), pixels.len() as u32);
            for (u, v) in pixels.iter().map(|&(u, v)| (u as u32, v as u32)) {
                prop_assert!((extent.left..=extent.right).contains(&u) && (extent.top..=extent.bottom).contains(&v));
            }
        }
    }
}
