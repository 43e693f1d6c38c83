//! Which curve a lens follows, and its names.

use std::fmt;
use std::str::FromStr;

/// A curve between the angle off the axis and the radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LensModel(Law);

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Law {
    KannalaBrandt { terms: u8 },
    OCam { degree: u8 },
}

impl LensModel {
    /// r = f t, the paper's linear law.
    pub const EQUIDISTANT: Self = Self(Law::KannalaBrandt { terms: 0 });

    /// r = f (t + k1 t^3 + ...) with 1 to 4 terms behind the first.
    pub fn kannala_brandt(terms: u8) -> Option<Self> {
        (1..=4).contains(&terms).then_some(Self(Law::KannalaBrandt { terms }))
    }

    /// Scaramuzza's z(r), a polynomial of degree 4 to 10 without a linear term.
    pub fn ocam(degree: u8) -> Option<Self> {
        (4..=10).contains(&degree).then_some(Self(Law::OCam { degree }))
    }

    /// The models that a name stands for: `auto` all of them, `kannala-brandt` those with 1 to 4 terms, `ocam` those of degree 4 to
    /// 10, any other that one.
    ///
    /// # Errors
    /// [`UnknownModel`] when no model has that name.
    pub fn candidates(name: &str) -> Result<Vec<Self>, UnknownModel> {
        let kannala_brandt = || (1..=4).filter_map(Self::kannala_brandt);
        let ocam = || (4..=10).filter_map(Self::ocam);
        Ok(match name {
            "auto" => [Self::EQUIDISTANT].into_iter().chain(kannala_brandt()).chain(ocam()).collect(),
            "kannala-brandt" => kannala_brandt().collect(),
            "ocam" => ocam().collect(),
            _ => vec![name.parse()?],
        })
    }

    /// The degree of an OCam polynomial; `None` for Kannala-Brandt.
    pub fn ocam_degree(self) -> Option<usize> {
        match self.0 {
            Law::OCam { degree } => Some(usize::from(degree)),
            Law::KannalaBrandt { .. } => None,
        }
    }

    /// Numbers of the curve.
    pub(crate) fn radial(self) -> usize {
        match self.0 {
            Law::KannalaBrandt { terms } => 1 + usize::from(terms),
            Law::OCam { degree } => usize::from(degree),
        }
    }

    /// Numbers in all: those of the curve, the centre, c and d.
    pub fn parameters(self) -> usize {
        super::RADIAL + self.radial()
    }

    /// Names of the parameters, in their order.
    pub fn parameter_names(self) -> Vec<String> {
        let affine = ["centre_u_px", "centre_v_px", "c", "d"].map(String::from);
        let radial = (0..self.radial()).map(|k| match self.0 {
            Law::KannalaBrandt { .. } if k == 0 => "f".to_owned(),
            Law::KannalaBrandt { .. } => format!("k{k}"),
            Law::OCam { .. } => format!("b{}", if k == 0 { 0 } else { k + 1 }),
        });
        affine.into_iter().chain(radial).collect()
    }
}

impl fmt::Display for LensModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Law::KannalaBrandt { terms: 0 } => write!(f, "equidistant"),
            Law::KannalaBrandt { terms } => write!(f, "kannala-brandt:{terms}"),
            Law::OCam { degree } => write!(f, "ocam:{degree}"),
        }
    }
}

/// A name that no model has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no model: give equidistant, kannala-brandt:1 to kannala-brandt:4, or ocam:4 to ocam:10")]
pub struct UnknownModel(pub String);

impl FromStr for LensModel {
    type Err = UnknownModel;

    fn from_str(name: &str) -> Result<Self, UnknownModel> {
        let number = |digits: &str| digits.parse::<u8>().ok();
        match name.split_once(':') {
            None if name == "equidistant" => Some(Self::EQUIDISTANT),
            Some(("kannala-brandt", terms)) => number(terms).and_then(Self::kannala_brandt),
            Some(("ocam", degree)) => number(degree).and_then(Self::ocam),
            _ => None,
        }
        .ok_or_else(|| UnknownModel(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_may_stand_for_several() {
        let count = |name: &str| LensModel::candidates(name).map(|models| models.len());
        assert_eq!(["auto", "kannala-brandt", "ocam", "ocam:4"].map(count), [Ok(12), Ok(4), Ok(7), Ok(1)]);
        assert_eq!(count("fish"), Err(UnknownModel("fish".to_owned())));
    }

    #[test]
    fn names_are_read_as_they_are_written() {
        let mut models = vec![LensModel::EQUIDISTANT];
        models.extend((0..=12).filter_map(LensModel::kannala_brandt));
        models.extend((0..=12).filter_map(LensModel::ocam));
        assert_eq!(models.len(), 1 + 4 + 7);
        for model in models {
            assert_eq!(model.to_string().parse(), Ok(model));
            assert_eq!(model.parameter_names().len(), model.parameters());
        }
        for wrong in
            ["", "ocam", "ocam:3", "ocam:11", "ocam:-4", "kannala-brandt:0", "kannala-brandt:5", "fish"]
        {
            assert!(wrong.parse::<LensModel>().unwrap_err().to_string().contains(wrong));
        }
    }
}
