//! Numbers on the command line: what a user wrote -> a number that has a meaning, or what to give instead.

use std::ops::RangeInclusive;

/// A number within limits; `what` says of what, such as "metres".
pub(crate) fn within(text: &str, limits: RangeInclusive<f64>, what: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok().filter(|number| limits.contains(number));
    number.ok_or_else(|| format!("give {what}, {} to {}", limits.start(), limits.end()))
}

/// A whole number above 0.
pub(crate) fn count(text: &str) -> Result<u64, String> {
    text.parse()
        .ok()
        .filter(|&count: &u64| count > 0)
        .ok_or_else(|| "give a whole number, 1 or more".to_owned())
}

/// A number above 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    above_0(text).ok_or_else(|| "give a number above 0".to_owned())
}

/// Metres, above 0.
pub(crate) fn metres(text: &str) -> Result<f64, String> {
    above_0(text).ok_or_else(|| "give metres, above 0, without the unit: 0.05".to_owned())
}

fn above_0(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_meaning_is_refused_with_what_to_give() {
        assert_eq!(within("0.5", 0.0..=1.0, "a share"), Ok(0.5));
        for text in ["", "1.5", "-1", "nan", "half"] {
            assert_eq!(within(text, 0.0..=1.0, "a share"), Err("give a share, 0 to 1".to_owned()));
        }
        assert_eq!(count("3"), Ok(3));
        for text in ["0", "-1", "0.1", "a"] {
            assert!(count(text).unwrap_err().contains("a whole number, 1 or more"), "{text}");
        }
        assert_eq!(metres("0.05"), Ok(0.05));
        for text in ["50mm", "0", "-1", "inf", "nan"] {
            assert!(metres(text).unwrap_err().contains("metres") && positive(text).is_err());
        }
    }
}
