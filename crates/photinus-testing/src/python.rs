//! A Python with the modules that an independent calculation is written in.

use std::process::{Command, Stdio};

use crate::Skipped;

/// Prints those of its arguments that are no modules of this Python.
const MISSING: &str = "import importlib.util as u, sys\n\
                       print(*[name for name in sys.argv[1:] if u.find_spec(name) is None])";

/// The Python that `PHOTINUS_PYTHON` names, `python3` otherwise, ready to be given a script; where it or one of `modules`
/// is missing, the calling test is listed as skipped. A module that is there and broken is the script's failure.
///
/// # Panics
/// When `PHOTINUS_PYTHON` names what does not run.
#[must_use]
pub fn python_with(modules: &[&str]) -> Option<Command> {
    let named = std::env::var_os("PHOTINUS_PYTHON");
    let python = named.clone().unwrap_or_else(|| "python3".into());
    let asked = Command::new(&python).args(["-c", MISSING]).args(modules).stderr(Stdio::null()).output();
    let missing = match asked {
        Ok(output) if output.status.success() => String::from_utf8_lossy(&output.stdout).trim().to_owned(),
        _ => {
            assert!(named.is_none(), "PHOTINUS_PYTHON names {}, which runs nothing", python.display());
            Skipped::current_test("there is no python3 (PHOTINUS_PYTHON names another)");
            return None;
        }
    };
    if !missing.is_empty() {
        let python = python.display();
        Skipped::current_test(&format!("{python} has no module {missing} (PHOTINUS_PYTHON names another)"));
        return None;
    }
    Some(Command::new(python))
}
