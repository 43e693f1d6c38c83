//! Ways to see one vehicle by the same spots -> how likely each of them is beside the others, with what frames repeat counted once.
//!
//! Of two places where a vehicle may be, the farther one has narrower predictions: its accelerations are smaller angles. Where a vehicle flies as briskly as the
//! priors have it, that is paid by how far its spots then lie from where they are expected. Who hovers pays nothing, and the farther place would gain in every
//! frame until nothing is left of the nearer one. Frames that err alike tell of the same even flight: how wide a prediction is counts once for all of them, as what
//! is unsure of lobes and merged centres does. What the spots are worth to other vehicles stays as it is.

use super::Ways;

impl Ways {
    /// Shares what ways with the same spots have together out between them anew. `probability` is by place among the choices.
    pub(in crate::tracking) fn count_once(&self, vehicle: usize, probability: &mut [f64]) {
        let spots = |place: usize| self.choices[place].spots;
        for (first, _) in self.of(vehicle) {
            let group = || self.of(vehicle).filter(|&(place, _)| spots(place) == spots(first));
            if group().next().is_some_and(|before| before.0 < first) {
                continue;
            }
            let least = group().map(|(_, way)| way.repeated_nats).fold(f64::INFINITY, f64::min);
            let (mut before, mut after) = (0.0, 0.0);
            for (place, way) in group() {
                before += probability[place];
                probability[place] *= libm::exp(least - way.repeated_nats);
                after += probability[place];
            }
            if after > 0.0 {
                group().for_each(|(place, _)| probability[place] *= before / after);
            }
        }
    }
}
