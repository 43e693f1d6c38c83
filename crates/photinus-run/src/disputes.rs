//! Tracks of several kinds of vehicles -> those that are told. Each kind is followed by itself, so that one vehicle may be followed as two kinds.
//!
//! In: the tracks of a frame. Out: of any two that were seen by the same spots, as different kinds, the one that is told: who is named, then who more likely
//! exists, then who was there first. A track that lost such a dispute stays untold: it follows another kind's vehicle.

use photinus_io::results::TrackRecord;

/// The tracks that lost a dispute.
#[derive(Debug, Default)]
pub(crate) struct Disputes {
    lost: Vec<u64>,
}

impl Disputes {
    /// Leaves out of the tracks of all kinds those that follow another kind's vehicle.
    pub(crate) fn settle(&mut self, tracks: &mut Vec<TrackRecord>) {
        self.lost.retain(|lost| tracks.iter().any(|track| track.track == *lost));
        tracks.retain(|track| !self.lost.contains(&track.track));
        let lost = |own: &&TrackRecord| tracks.iter().any(|other| is_same(own, other) && is_told(other, own));
        let lost: Vec<u64> = tracks.iter().filter(lost).map(|track| track.track).collect();
        tracks.retain(|track| !lost.contains(&track.track));
        self.lost.extend(lost);
    }
}

/// Whether both were seen by the same spot, as different kinds.
fn is_same(one: &TrackRecord, other: &TrackRecord) -> bool {
    one.airframe != other.airframe && one.spots.iter().any(|spot| other.spots.contains(spot))
}

/// Whether the first of two is told, and not the second.
fn is_told(first: &TrackRecord, second: &TrackRecord) -> bool {
    let by_name = first.id.is_some().cmp(&second.id.is_some());
    let by_existence = || first.probability.total_cmp(&second.probability);
    by_name.then_with(by_existence).then(second.track.cmp(&first.track)).is_gt()
}

#[cfg(test)]
mod tests {
    use photinus_io::results::ResultsReader;

    use super::*;

    /// A track: number, airframe, id, probability, spots.
    type Told<'a> = (u64, &'a str, Option<u32>, f64, &'a [usize]);

    fn tracks(told: &[Told<'_>]) -> Vec<TrackRecord> {
        let one = |&(track, airframe, id, probability, spots): &Told<'_>| {
            let id = id.map_or("null".to_owned(), |id| id.to_string());
            format!(
                r#"{{"track":{track},"airframe":"{airframe}","probability":{probability},"id":{id},"ids":[],"predicted":false,"spots":{spots:?},"position_m":[0,0,1],"position_covariance_m2":[[1,0,0],[0,1,0],[0,0,1]],"velocity_m_s":[0,0,0],"velocity_covariance_m2_s2":[[1,0,0],[0,1,0],[0,0,1]],"orientation_xyzw":[0,0,0,1],"orientation_covariance_rad2":[[1,0,0],[0,1,0],[0,0,1]]}}"#
            )
        };
        let all: Vec<String> = told.iter().map(one).collect();
        let line = format!(r#"{{"spots":[],"neighbours":[],"tracks":[{}]}}"#, all.join(","));
        ResultsReader::new(line.as_bytes(), "t").next().unwrap().unwrap().tracks
    }

    fn settled(disputes: &mut Disputes, told: &[Told<'_>]) -> Vec<u64> {
        let mut tracks = tracks(told);
        disputes.settle(&mut tracks);
        tracks.iter().map(|track| track.track).collect()
    }

    #[test]
    fn one_vehicle_is_told_as_one_kind_and_stays_it() {
        let mut disputes = Disputes::default();
        // Who is named counts more than who more likely exists; of one kind nobody disputes.
        let first = settled(
            &mut disputes,
            &[
                (0, "hexa", Some(4), 0.9, &[0, 1]),
                (1, "quad", None, 0.99, &[1]),
                (2, "hexa", None, 0.9, &[5]),
                (4, "hexa", None, 0.8, &[5]),
            ],
        );
        assert_eq!(first, [0, 2, 4]);
        // The loser stays untold while it is followed, by whatever it is seen.
        assert_eq!(
            settled(&mut disputes, &[(0, "hexa", Some(4), 0.9, &[0]), (1, "quad", None, 1.0, &[7])]),
            [0]
        );
        // Its number may be another's after it ended, as where all begins anew.
        assert_eq!(settled(&mut disputes, &[(0, "hexa", Some(4), 0.9, &[0])]), [0]);
        assert_eq!(settled(&mut disputes, &[(1, "quad", None, 0.9, &[7])]), [1]);
    }

    #[test]
    fn without_names_the_likelier_is_told_then_the_older() {
        let told = |probability| {
            settled(
                &mut Disputes::default(),
                &[(3, "quad", None, 0.9, &[0]), (2, "hexa", None, probability, &[0])],
            )
        };
        assert_eq!(told(0.8), [3]);
        assert_eq!(told(0.95), [2]);
        assert_eq!(told(0.9), [2]);
    }
}
