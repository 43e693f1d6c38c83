//! When during an exposure an LED shines.

/// When an LED shines: how it begins, and the instants at which it switches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lit {
    at_start: bool,
    switches_s: Vec<f64>,
}

impl Lit {
    /// All the time.
    pub fn always() -> Self {
        Self { at_start: true, switches_s: Vec::new() }
    }

    /// Not at all.
    pub fn never() -> Self {
        Self::default()
    }

    /// Begins anew: lit or dark at the start of the exposure, without switches.
    pub fn restart(&mut self, at_start: bool) {
        self.at_start = at_start;
        self.switches_s.clear();
    }

    /// Switches, `after_s` seconds after the start of the exposure; not before the switch that was said last.
    pub fn switch(&mut self, after_s: f64) {
        let last_s = self.switches_s.last().copied().unwrap_or(f64::NEG_INFINITY);
        self.switches_s.push(after_s.max(last_s));
    }

    /// Which share of the time between two instants it shines, 0 to 1; the instants are seconds after the start of the
    /// exposure.
    pub fn share(&self, from_s: f64, to_s: f64) -> f64 {
        if self.switches_s.is_empty() {
            return if self.at_start { 1.0 } else { 0.0 };
        }
        if to_s <= from_s {
            return 0.0;
        }
        let (mut lit, mut since_s, mut on_s) = (self.at_start, from_s, 0.0);
        for at_s in self.switches_s.iter().map(|at_s| at_s.clamp(from_s, to_s)).chain([to_s]) {
            if lit {
                on_s += at_s - since_s;
            }
            (lit, since_s) = (!lit, at_s);
        }
        (on_s / (to_s - from_s)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_those_of_counting_instants() {
        let mut lit = Lit::always();
        for at_s in [0.1, 0.25, 0.3, 0.7] {
            lit.switch(at_s);
        }
        let shines = |at_s: f64| !(0.1..0.25).contains(&at_s) && !(0.3..0.7).contains(&at_s);
        for (from_s, to_s) in [(0.0, 1.0), (0.05, 0.2), (0.12, 0.24), (0.28, 0.31), (0.6, 0.9), (0.8, 0.9)] {
            let counted = (0..100_000)
                .filter(|&i| shines(from_s + (to_s - from_s) * (f64::from(i) + 0.5) / 1e5))
                .count() as f64;
            let share = lit.share(from_s, to_s);
            assert!((share - counted / 1e5).abs() < 3e-5, "{from_s} to {to_s}: {share} not {counted}");
        }
    }

    #[test]
    fn what_does_not_switch_shines_always_or_never() {
        assert!((Lit::always().share(0.2, 0.4) - 1.0).abs() <= 0.0 && Lit::never().share(0.2, 0.4) <= 0.0);
        let mut lit = Lit::always();
        lit.switch(0.5);
        lit.restart(false);
        assert_eq!(lit, Lit::never());
    }
}
