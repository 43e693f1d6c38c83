//! When what is recorded or simulated begins to fly, for all cameras of a vehicle: as soon as they are opened, not while the program still prepares.

use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// From the opening of the first camera until time 0: the others are open by then.
const RUN_UP: Duration = Duration::from_millis(50);

/// The moment at which clocks of recordings and scenes show 0, the same for all cameras that share it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Takeoff(Arc<OnceLock<Instant>>);

impl Takeoff {
    /// The moment; the first who asks sets it.
    pub fn at(&self) -> Instant {
        *self.0.get_or_init(|| Instant::now() + RUN_UP)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_cameras_take_off_together_and_not_before_the_first_is_opened() {
        let takeoff = Takeoff::default();
        std::thread::sleep(Duration::from_millis(2));
        let opened = Instant::now();
        let others = [takeoff.clone(), takeoff.clone()].map(|other| std::thread::spawn(move || other.at()));
        let [a, b] = others.map(|other| other.join().unwrap());
        assert_eq!([a, b], [takeoff.at(); 2]);
        assert!(a >= opened + RUN_UP);
    }
}
