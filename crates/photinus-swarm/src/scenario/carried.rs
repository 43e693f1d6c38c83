//! The scenarios that the program carries.

use std::path::Path;

use photinus_io::Result;

use super::Scenario;

/// A scenario that the program carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Carried {
    /// By which it is called.
    pub name: &'static str,
    /// The file.
    pub text: &'static str,
}

/// The scenario of a name, by the file of that name.
macro_rules! own {
    ($name:literal) => {
        Carried { name: $name, text: include_str!(concat!("../../scenarios/", $name, ".toml")) }
    };
}

/// All of them.
pub const CARRIED: &[Carried] = &[
    own!("three"),
    own!("five"),
    own!("ten"),
    own!("twenty"),
    own!("fifty"),
    own!("hundred"),
    own!("guarded-ten"),
    own!("crossing"),
    own!("crossing-guarded"),
    own!("gate"),
    own!("obstacles"),
    own!("wind"),
    own!("day"),
    own!("sun-behind"),
    own!("night"),
    own!("failing-led"),
    own!("lost-camera"),
    own!("hostile"),
    own!("mixed"),
    own!("exposure"),
    own!("leader"),
    own!("leader-fast"),
    own!("formation"),
    own!("formation-plain"),
    own!("formation-bearings"),
    own!("consensus"),
];

/// The carried scenario of a name.
pub fn carried(name: &str) -> Option<&'static Carried> {
    CARRIED.iter().find(|carried| carried.name == name)
}

impl Carried {
    /// Reads it.
    ///
    /// # Errors
    /// None: a test reads them all.
    pub fn read(&self) -> Result<Scenario> {
        Scenario::parse(self.text, Path::new(&format!("{}.toml", self.name)))
    }
}
