//! A mode that begins a track, and the frame that shows it -> which of its markers may be silent, and how bright its LEDs are.
//!
//! The mode's weight holds already that markers were missed in this frame. Were that forgotten, a pose that needs a dead LED would pay for it twice.

use super::super::component::Component;
use super::{Scene, Ways};

/// Not one of those that are followed.
const NOBODY: usize = usize::MAX;

impl Ways {
    /// Takes in what the frame says of a vehicle that begins with these spots besides where it is.
    pub(in crate::tracking) fn first_look(
        &mut self,
        scene: &Scene<'_>,
        members: &[usize],
        begun: &mut Component,
    ) {
        let (before, pose) = (begun.silent, begun.pose);
        let Some(pairs) = self.pairs_of(scene.model, members, &pose) else { return };
        self.assign(&pairs);
        self.gather_others(scene, &pose);
        self.whiten(0.0);
        let lit = scene.moment.others_lit.filter(|_| !scene.moment.blinks_alike).unwrap_or(1.0);
        self.lit.clear();
        self.lit.resize(scene.model.airframe.markers().len(), lit);
        self.dim(scene, NOBODY, begun, &pose);
        self.measured(scene, &pose, |measurement| {
            let log_power = measurement.at(&pose).log_power;
            begun.power.learn(scene.moment.camera, log_power);
            measurement.visibility(&pose, log_power, |marker, unseen| begun.silent.learn(marker, unseen));
        });
        begun.silent.blame(&before, &self.screened, self.others.is_empty());
    }
}
