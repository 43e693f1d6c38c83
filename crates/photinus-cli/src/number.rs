//! Numbers on the command line: what a user wrote -> a number that has a meaning, or what to give instead.

use std::ops::RangeInclusive;

/// A number within limits; `what` says of what, such as "metres".
pub(crate) fn within(text: &str, limits: RangeInclusive<f64>, what: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok().filter(|number| limits.contains(number));
    number.ok_or_else(|| format!("give {what}, {} to {}", limits.start(), limits.end()))
}

/// A whole number within limits; `what` says of what, such as "words".
pub(crate) fn whole<T: TryFrom<u64>>(
    text: &str,
    limits: RangeInclusive<u64>,
    what: &str,
) -> Result<T, String> {
    let number = text.parse().ok().filter(|number| limits.contains(number));
    let told = || format!("give {what}, a whole number of {} to {}", limits.start(), limits.end());
    number.and_then(|number| T::try_from(number).ok()).ok_or_else(told)
}

/// Grey levels, 1 to 255. Whoever gives a share of full scale is told which level that is.
pub(crate) fn level(text: &str) -> Result<u8, String> {
    whole(text, 1..=255, "grey levels").map_err(|told| match text.parse::<f64>() {
        Ok(share) if share > 0.0 && share < 1.0 => {
            format!("{told}: {share} of full scale is {:.0}", (255.0 * share).max(1.0))
        }
        _ => told,
    })
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
        assert_eq!((level("30"), level("255")), (Ok(30), Ok(255)));
        assert_eq!(
            level("0.1"),
            Err("give grey levels, a whole number of 1 to 255: 0.1 of full scale is 26".to_owned())
        );
        for text in ["0", "256", "-1", "2.5", "30dn"] {
            assert_eq!(level(text), Err("give grey levels, a whole number of 1 to 255".to_owned()), "{text}");
        }
        assert_eq!(whole::<u32>("7", 1..=9, "words"), Ok(7));
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
