//! From a level to a number: the bits of the converter, and what a frame of 8 bits keeps of them.
//!
//! A converter of b bits has codes 0 to 2^b - 1 over the range of 0 to 255 grey levels. A frame keeps the grey level nearest
//! to 255 code / (2^b - 1), as Photinus reads a file of b bits.

/// How many codes the converter tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Converter {
    bits: u32,
}

impl Converter {
    /// One code for each grey level.
    pub const EIGHT_BITS: Self = Self { bits: 8 };

    /// A converter of 8 to 12 bits.
    pub fn new(bits: u32) -> Option<Self> {
        (8..=12).contains(&bits).then_some(Self { bits })
    }

    /// Its bits.
    pub fn bits(&self) -> u32 {
        self.bits
    }

    /// The largest code.
    pub fn largest(&self) -> u16 {
        ((1_u32 << self.bits) - 1) as u16
    }

    /// The code of a level in grey levels of 0 to 255; the nearest of those there are.
    pub fn code(&self, level_dn: f32) -> u16 {
        let largest = f32::from(self.largest());
        // adding 2^23 leaves the rounded number in the low bits of a float
        ((level_dn.clamp(0.0, 255.0) * (largest / 255.0)).clamp(0.0, largest) + 8_388_608.0).to_bits() as u16
    }

    /// The grey level that a frame of 8 bits keeps of a code.
    pub fn grey(&self, code: u16) -> u8 {
        let largest = u32::from(self.largest());
        ((2 * 255 * u32::from(code.min(self.largest())) + largest) / (2 * largest)) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_the_nearest_ones_and_uniform_errors_have_a_twelfth_of_a_step() {
        assert_eq!((Converter::new(7), Converter::new(13)), (None, None));
        for bits in 8..=12 {
            let converter = Converter::new(bits).unwrap();
            let step = 255.0 / f64::from(converter.largest());
            let (mut square, count) = (0.0, 100_000);
            for index in 0..count {
                let level = 255.0 * (f64::from(index) + 0.5) / f64::from(count);
                let code = converter.code(level as f32);
                let error = f64::from(code) * step - level;
                assert!(error.abs() <= 0.5 * step + 1e-4, "{level} as {code} of {bits} bits");
                square += error * error / f64::from(count);
                let grey = (f64::from(code) * step).round();
                assert!((f64::from(converter.grey(code)) - grey).abs() < 1e-9);
            }
            assert!((square / (step * step / 12.0) - 1.0).abs() < 0.02, "{square} at {bits} bits");
        }
        assert_eq!([-1.0, f32::NAN, 1e9].map(|level| Converter::EIGHT_BITS.code(level)), [0, 0, 255]);
    }
}
