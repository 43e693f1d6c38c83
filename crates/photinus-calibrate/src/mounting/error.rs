//! Why observations give no mounting.

/// Why observations give no mounting.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MountingError {
    /// Too few of them.
    #[error("{given} observations: {needed} are needed")]
    TooFew {
        /// Observations given.
        given: usize,
        /// Observations needed.
        needed: usize,
    },
    /// Directions that are all alike: the turn about them shows nowhere.
    #[error("the directions are too much alike: about one axis the camera's rotation is known to {:.0} deg only", turn_rad.to_degrees().min(180.0))]
    Alike {
        /// Sigma of the rotation about its worst axis, rad.
        turn_rad: f64,
    },
    /// Positions that do not tell where the camera is.
    #[error(
        "the camera's place is known to {place_m:.1} m only: what is seen is too far away, or all on one side"
    )]
    PlaceUnknown {
        /// Sigma of the place along its worst axis, m.
        place_m: f64,
    },
    /// Something that lies in the camera itself.
    #[error("a position lies in the camera's centre")]
    AtTheCamera,
    /// Most observations contradict each other.
    #[error("{outliers} of {observations} observations do not fit the others")]
    DoNotFit {
        /// How many deviate too far.
        outliers: usize,
        /// How many there are.
        observations: usize,
    },
}
