//! What was learned, to read.

use std::fmt;

use photinus_calibrate::airframe_light::{Flight, Known, KnownLobe, Light};

/// The text for the terminal.
pub(super) struct Told<'a> {
    pub(super) found: &'a Light,
    pub(super) flight: &'a Flight,
}

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { found, flight } = self;
        writeln!(f, "LED    power   sigma (%)")?;
        for (led, power) in found.powers.iter().enumerate() {
            match power {
                Some(power) => writeln!(f, "{led:<4} {:>7.3} {:>11.1}", power.value, 100.0 * power.sigma)?,
                None => writeln!(f, "{led:<4}         hardly seen: it keeps the power that it had")?,
            }
        }
        for known in &found.lobes {
            writeln!(f, "lobe       {}", lobe(known))?;
        }
        match found.position_sigma_m {
            Some(known) => writeln!(
                f,
                "positions  off by {:.1} ± {:.1} mm per axis from where the file has them",
                1e3 * known.value,
                1e3 * known.sigma
            )?,
            None => writeln!(f, "positions  not told: that takes frames that show more markers at once")?,
        }
        let [centres, light] = found.scatter;
        writeln!(f, "scatter    centres {centres:.2}, light {light:.2} of what is claimed")?;
        write!(f, "used       {} frames, the light of {} spots", found.frames, found.lights)?;
        if found.unturned > 0 {
            write!(f, "\nnot used   {} frames: nothing says which way it was turned", found.unturned)?;
        }
        if flight.not_alone() > 0 {
            write!(f, "\nnot used   {} frames without a neighbour, or with several", flight.not_alone())?;
        }
        if flight.turns() > 1 {
            write!(
                f,
                "\nnote       the airframe looks the same in {} turns: powers are in order, but nothing says which LED is the first",
                flight.turns()
            )?;
        }
        Ok(())
    }
}

fn lobe(known: &KnownLobe) -> String {
    let leds = match known.leds.as_slice() {
        [only] => format!("LED {only}"),
        leds => format!("{} LEDs", leds.len()),
    };
    match known.cosine_power {
        Some(Known { value, sigma }) => format!("of {leds}: cosine^{value:.2} ± {sigma:.2}"),
        None => {
            format!("of {leds}: as it was; the flight does not tell it, or they shine in every direction")
        }
    }
}

/// The head of the file.
pub(super) fn comment(found: &Light) -> String {
    format!(
        "# photinus calibrate airframe-light: lobes and powers from {} frames, {} spots; positions, axes and signals as before.\n",
        found.frames, found.lights
    )
}
