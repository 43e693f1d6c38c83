//! What each vehicle sees of the others, exchanged -> where all of them are and how they are turned, without compass or GNSS.
//!
//! ```text
//! reports (a few bytes a sight) -> who is who (identify.rs) -> first guess (chain.rs) -> least squares (group.rs) -> Group
//! ```
//!
//! Every vehicle knows where down is; what it does not know is how its level frame is turned against that of another. A's view of B
//! and B's view of A tell that: they look along the same line. Sights without identities are assigned to those who report, by the
//! only way in which all constellations agree; where two ways agree about as well, as in a symmetric constellation, that is the
//! answer (A. Franchi, G. Oriolo and P. Stegagno, "Mutual localization in multi-robot systems using anonymous relative measurements",
//! IJRR 2013).

mod assignment;
mod chain;
mod cholesky;
mod group;
mod heading;
mod hypotheses;
mod identify;
mod message;
mod report;

pub use heading::heading_from_bearing;
pub use report::{Group, Placed, Report, Sight, Unclear};

/// The place and heading of every reporter, in the level frame of `own`. All sights are of one time.
pub fn locate(own: &Report, others: &[Report]) -> Result<Group, Unclear> {
    let mut ids: Vec<u32> = core::iter::once(own).chain(others).map(|report| report.from).collect();
    ids.sort_unstable();
    if let Some(pair) = ids.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Unclear::TwoReportsFrom(pair[0]));
    }
    let reports: Vec<&Report> = core::iter::once(own).chain(others).collect();
    if reports.iter().all(|report| report.sights.iter().all(|sight| sight.identity.is_some())) {
        return group::fit(&group::named(&reports)).ok_or(Unclear::NoConnection);
    }
    identify::identify(&reports)
}
