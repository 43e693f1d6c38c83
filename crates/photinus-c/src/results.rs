//! What a locator told of its last image -> arrays of the caller's. Each function puts as many as fit, and the number of all in `count`.

use photinus::locator::Neighbour as Located;
use photinus::tracking;

use crate::border::{Refusal, Result, Status, cross};
use crate::handles::Locator;
use crate::locator::State;
use crate::pointers::Places;
use crate::records::{Mode, Neighbour, Rejected, Spot, Track};

/// The neighbours: the first `capacity` of them, and in `count` how many there are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_neighbours(
    locator: Locator,
    neighbours: *mut Neighbour,
    capacity: usize,
    count: *mut usize,
) -> Status {
    // SAFETY: as the header asks of its pointers.
    let places = || unsafe { Places::new(neighbours, capacity, count, "the neighbours") };
    tell(locator, places, |state, places| {
        let located = state.locator.located();
        places.fill(located.neighbours.iter().map(Neighbour::from));
        Ok(())
    })
}

/// Which spots are neighbour number `neighbour`: their numbers, ascending.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_members(
    locator: Locator,
    neighbour: usize,
    spots: *mut usize,
    capacity: usize,
    count: *mut usize,
) -> Status {
    // SAFETY: as the header asks of its pointers.
    let places = || unsafe { Places::new(spots, capacity, count, "the numbers of spots") };
    tell(locator, places, |state, places| {
        places.fill(state.neighbour(neighbour)?.sightings.iter().copied());
        Ok(())
    })
}

/// The ways in which the spots of neighbour number `neighbour` can be its airframe, the likeliest first.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_modes(
    locator: Locator,
    neighbour: usize,
    modes: *mut Mode,
    capacity: usize,
    count: *mut usize,
) -> Status {
    // SAFETY: as the header asks of its pointers.
    let places = || unsafe { Places::new(modes, capacity, count, "the modes") };
    tell(locator, places, |state, places| {
        places.fill(state.neighbour(neighbour)?.modes.iter().map(Mode::from));
        Ok(())
    })
}

/// What is bright and may be a marker.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_spots(
    locator: Locator,
    spots: *mut Spot,
    capacity: usize,
    count: *mut usize,
) -> Status {
    // SAFETY: as the header asks of its pointers.
    let places = || unsafe { Places::new(spots, capacity, count, "the spots") };
    tell(locator, places, |state, places| {
        places.fill(state.locator.located().sightings.iter().map(Spot::from));
        Ok(())
    })
}

/// What is bright and is no marker, and why.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_rejected(
    locator: Locator,
    rejected: *mut Rejected,
    capacity: usize,
    count: *mut usize,
) -> Status {
    // SAFETY: as the header asks of its pointers.
    let places = || unsafe { Places::new(rejected, capacity, count, "what was rejected") };
    tell(locator, places, |state, places| {
        places.fill(state.locator.located().rejected.iter().map(Rejected::from));
        Ok(())
    })
}

/// The vehicles that are followed, those who were there first before the others; none where the option `tracks` is 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_tracks(
    locator: Locator,
    tracks: *mut Track,
    capacity: usize,
    count: *mut usize,
) -> Status {
    // SAFETY: as the header asks of its pointers.
    let places = || unsafe { Places::new(tracks, capacity, count, "the tracks") };
    tell(locator, places, |state, places| {
        match &state.lookout {
            Some(lookout) => {
                let tracked = lookout.tracked();
                places.fill(tracked.tracks.iter().map(|track| Track::new(track, tracked)));
            }
            None => places.fill(std::iter::empty()),
        }
        Ok(())
    })
}

/// Which spots of the last image updated track number `track` of the list: their numbers, ascending.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_track_members(
    locator: Locator,
    track: usize,
    spots: *mut usize,
    capacity: usize,
    count: *mut usize,
) -> Status {
    // SAFETY: as the header asks of its pointers.
    let places = || unsafe { Places::new(spots, capacity, count, "the numbers of spots") };
    tell(locator, places, |state, places| {
        places.fill(state.members_of_track(track)?.iter().copied());
        Ok(())
    })
}

/// Looks up a locator, and tells something of what it knows.
fn tell<T>(
    locator: Locator,
    places: impl FnOnce() -> Result<Places<T>>,
    put: impl FnOnce(&State, Places<T>) -> Result<()>,
) -> Status {
    cross(|| {
        let places = places()?;
        let session = locator.get()?;
        put(&*session.state()?, places)
    })
}

impl State {
    fn neighbour(&self, index: usize) -> Result<&Located> {
        at(&self.locator.located().neighbours, index, "neighbour")
    }

    fn members_of_track(&self, index: usize) -> Result<&[usize]> {
        let tracked = self.lookout.as_ref().map(|lookout| lookout.tracked());
        let tracks: &[tracking::Track] = tracked.map_or(&[], |tracked| &tracked.tracks);
        let track = at(tracks, index, "track")?;
        Ok(tracked.map_or(&[], |tracked| tracked.members(track)))
    }
}

fn at<'a, T>(list: &'a [T], index: usize, what: &str) -> Result<&'a T> {
    list.get(index).ok_or_else(|| {
        Refusal::new(Status::Index, format!("there is no {what} {index}: the last image has {}", list.len()))
    })
}
