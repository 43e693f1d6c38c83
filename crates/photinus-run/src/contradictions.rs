//! What frames tell of neighbours, one by one -> a remark where that is far more than was supposed, once: then what was told of the camera, of gravity or of the
//! airframe is wrong, or vehicles are not as they were supposed to be.

use photinus::locator::{Kind, Located, Settings};

/// So many times what was supposed is more than vehicles show that are as supposed.
const FAR: f64 = 2.0;
/// For so many frames on end.
const FRAMES: u32 = 20;

/// Watches over what frames tell against what was supposed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contradictions {
    tilt_rad: Watched,
    /// How many times as much as supposed the power of LEDs spreads.
    light_times: Watched,
    /// What is supposed of it, as a logarithm: of the kind of which that is most.
    unit_sigma: f64,
}

impl Contradictions {
    /// Of what is supposed of these kinds.
    pub(crate) fn of(settings: &Settings, kinds: &[Kind]) -> Self {
        Self {
            tilt_rad: Watched::new(settings.pose.tilt_sigma_rad),
            light_times: Watched::new(1.0),
            unit_sigma: kinds.iter().map(|kind| kind.unit_sigma).fold(0.0, f64::max),
        }
    }

    /// Takes in what a frame told.
    pub(crate) fn see(&mut self, located: &Located) {
        self.tilt_rad.see(located.tilt_sigma_rad);
        self.light_times.see(located.light_times);
    }

    /// What is the matter, each said once.
    pub(crate) fn remarks(&mut self) -> impl Iterator<Item = String> {
        let supposed_rad = self.tilt_rad.supposed;
        let tilt = self.tilt_rad.unsaid.take().map(|sigma_rad| {
            format!(
                "neighbours seem to tilt by {:.0} deg (one sigma) where {:.0} are supposed: check the direction of gravity and how the camera sits on its vehicle. If \
                 vehicles do fly like that, set the tilt sigma to it; claims are as wide as it makes them (said once)",
                sigma_rad.to_degrees(),
                supposed_rad.to_degrees(),
            )
        });
        let factor = |times: f64| libm::exp(times * self.unit_sigma);
        let light = self.light_times.unsaid.take().map(|times| {
            format!(
                "LEDs of neighbours do not shine as their airframe's file says: they differ by a factor of {:.1} (one sigma) where {:.1} is supposed. Check its lobes \
                 and powers, or learn them with photinus calibrate airframe; until then light tells little, and distances are as uncertain as that makes them (said once)",
                factor(times),
                factor(1.0),
            )
        });
        tilt.into_iter().chain(light)
    }
}

/// One number, which is told by each frame.
#[derive(Clone, Copy, Debug)]
struct Watched {
    supposed: f64,
    frames: u32,
    /// What is not said yet.
    unsaid: Option<f64>,
}

impl Watched {
    fn new(supposed: f64) -> Self {
        Self { supposed, frames: 0, unsaid: None }
    }

    fn see(&mut self, told: Option<f64>) {
        if self.frames >= FRAMES {
            return;
        }
        let far = told.filter(|told| *told > FAR * self.supposed);
        self.frames = if far.is_some() { self.frames + 1 } else { 0 };
        self.unsaid = far.filter(|_| self.frames == FRAMES);
    }
}

#[cfg(test)]
mod tests {
    use photinus::airframe::{Airframe, Ring};

    use super::*;

    fn supposed() -> Contradictions {
        let settings = Settings::default();
        let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
        let airframe = Airframe::from_ring("hexarotor", ring).unwrap();
        Contradictions::of(&settings, &[Kind::new(airframe, &settings.pose)])
    }

    /// What is said after each of these frames.
    fn said(contradictions: &mut Contradictions, frames: &[Located]) -> Vec<String> {
        let remarks = frames.iter().flat_map(|located| {
            contradictions.see(located);
            contradictions.remarks().collect::<Vec<_>>()
        });
        remarks.collect()
    }

    fn frames(tilt_deg: f64, light_times: f64, count: usize) -> Vec<Located> {
        let tilt_sigma_rad = Some(tilt_deg.to_radians());
        vec![Located { tilt_sigma_rad, light_times: Some(light_times), ..Located::default() }; count]
    }

    #[test]
    fn what_is_far_beyond_what_is_supposed_is_told_once() {
        let mut watched = supposed();
        let mut said = |tilt_deg: f64, light_times: f64, count: usize| {
            said(&mut watched, &frames(tilt_deg, light_times, count))
        };
        // Neither what is nearly as far, nor what does not last.
        assert!(said(9.0, 1.9, 100).is_empty());
        assert!(said(17.0, 3.0, 19).is_empty());
        assert!(said(5.0, 1.0, 1).is_empty());
        assert!(said(17.0, 1.0, 19).is_empty());
        let tilted = said(17.0, 1.0, 100);
        assert!(
            matches!(tilted.as_slice(), [once] if once.starts_with("neighbours seem to tilt by 17 deg")),
            "{tilted:?}"
        );
        let lit = said(17.0, 3.0, 100);
        assert!(
            matches!(lit.as_slice(), [once] if once.contains("by a factor of 1.8 (one sigma) where 1.2 is")),
            "{lit:?}"
        );
        assert!(said(5.0, 1.0, 5).is_empty() && said(17.0, 3.0, 100).is_empty());
    }

    #[test]
    fn frames_that_tell_nothing_are_no_remark() {
        let mut watched = supposed();
        assert!(said(&mut watched, &vec![Located::default(); 100]).is_empty());
    }
}
