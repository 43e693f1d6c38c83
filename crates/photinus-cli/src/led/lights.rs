//! Spots, frame by frame -> lights that stay where they are, and in which frames each was lit. Vehicle and camera are at rest.

use photinus::spots::Spot;

/// Spots so near to a light are its own, px.
const SAME_PX: f64 = 3.0;
/// A light that was lit in a smaller share of the frames is none: a reflection, a bird.
const LEAST_LIT: f64 = 0.1;

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Light {
    /// The brightest of its spots, with the mean of their centres.
    pub(super) spot: Spot,
    /// Whether it was lit, of each frame.
    pub(super) lit: Vec<bool>,
}

/// The lights of these frames, from left to right.
pub(super) fn lights(frames: &[Vec<Spot>]) -> Vec<Light> {
    let mut lights: Vec<Gathered> = Vec::new();
    for (number, spots) in frames.iter().enumerate() {
        for spot in spots {
            let near = lights.iter_mut().filter(|light| light.distance_px(spot) < SAME_PX);
            match near.min_by(|a, b| a.distance_px(spot).total_cmp(&b.distance_px(spot))) {
                Some(light) => light.add(number, spot),
                None => lights.push(Gathered::new(number, spot, frames.len())),
            }
        }
    }
    let is_one = |light: &Light| {
        light.lit.iter().filter(|lit| **lit).count() as f64 >= LEAST_LIT * frames.len() as f64
    };
    let mut lights: Vec<Light> = lights.into_iter().map(Gathered::light).filter(is_one).collect();
    lights.sort_by(|a, b| a.spot.centre.u.total_cmp(&b.spot.centre.u));
    lights
}

struct Gathered {
    brightest: Spot,
    sum: [f64; 2],
    count: f64,
    lit: Vec<bool>,
}

impl Gathered {
    fn new(number: usize, spot: &Spot, frames: usize) -> Self {
        let mut new = Self { brightest: spot.clone(), sum: [0.0; 2], count: 0.0, lit: vec![false; frames] };
        new.add(number, spot);
        new
    }

    fn add(&mut self, number: usize, spot: &Spot) {
        self.lit[number] = true;
        self.sum[0] += spot.centre.u;
        self.sum[1] += spot.centre.v;
        self.count += 1.0;
        if spot.flux > self.brightest.flux {
            self.brightest = spot.clone();
        }
    }

    fn centre(&self) -> [f64; 2] {
        self.sum.map(|sum| sum / self.count)
    }

    fn distance_px(&self, spot: &Spot) -> f64 {
        let [u, v] = self.centre();
        libm::hypot(spot.centre.u - u, spot.centre.v - v)
    }

    fn light(self) -> Light {
        let [u, v] = self.centre();
        let mut spot = self.brightest;
        (spot.centre.u, spot.centre.v) = (u, v);
        Light { spot, lit: self.lit }
    }
}
