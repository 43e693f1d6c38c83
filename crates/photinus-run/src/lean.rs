//! How far neighbours tilt, frame by frame -> a remark where that is more than vehicles are supposed to: then the gravity that is given is wrong, or how the
//! camera sits, or vehicles fly as they were not supposed to.

/// So many times the sigma that was believed is more than vehicles that fly as supposed show.
const FAR: f64 = 2.0;
/// For so many frames on end.
const FRAMES: u32 = 20;

/// Watches over the tilts of neighbours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lean {
    believed_rad: f64,
    frames: u32,
    /// What is not said yet.
    unsaid_rad: Option<f64>,
}

impl Lean {
    /// For vehicles that are believed to tilt by so much, one sigma.
    pub(crate) fn beyond(believed_rad: f64) -> Self {
        Self { believed_rad, frames: 0, unsaid_rad: None }
    }

    /// Takes in what is believed since a frame, if anything.
    pub(crate) fn see(&mut self, tilt_sigma_rad: Option<f64>) {
        if self.frames >= FRAMES {
            return;
        }
        let far_rad = tilt_sigma_rad.filter(|sigma_rad| *sigma_rad > FAR * self.believed_rad);
        self.frames = if far_rad.is_some() { self.frames + 1 } else { 0 };
        self.unsaid_rad = far_rad.filter(|_| self.frames == FRAMES);
    }

    /// What is the matter, said once.
    pub(crate) fn remark(&mut self) -> Option<String> {
        let sigma_rad = self.unsaid_rad.take()?;
        Some(format!(
            "neighbours seem to tilt by {:.0} deg (one sigma) where {:.0} are supposed: check the direction of gravity and how the camera sits on its vehicle. If \
             vehicles do fly like that, set the tilt sigma to it; claims are as wide as it makes them (said once)",
            sigma_rad.to_degrees(),
            self.believed_rad.to_degrees(),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tilts_far_beyond_what_is_believed_are_told_once() {
        let mut lean = Lean::beyond(0.1);
        let mut said = |tilts: &[f64]| {
            let told = tilts.iter().filter_map(|&tilt| {
                lean.see(Some(tilt));
                lean.remark()
            });
            told.collect::<Vec<_>>()
        };
        // Neither what is nearly as far, nor what does not last.
        assert!(said(&[0.19; 100]).is_empty());
        assert!(said(&[0.3; 19]).is_empty());
        assert!(said(&[0.1]).is_empty());
        assert!(said(&[0.3; 19]).is_empty());
        let told = said(&[0.3; 100]);
        assert!(
            matches!(told.as_slice(), [once] if once.starts_with("neighbours seem to tilt by 17 deg")),
            "{told:?}"
        );
        assert!(said(&[0.1; 5]).is_empty() && said(&[0.3; 100]).is_empty());
    }

    #[test]
    fn frames_that_tell_nothing_are_no_remark() {
        let mut lean = Lean::beyond(0.1);
        (0..100).for_each(|_| lean.see(None));
        assert_eq!(lean.remark(), None);
    }
}
