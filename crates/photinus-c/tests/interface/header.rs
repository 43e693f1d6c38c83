//! The header declares what the library exports, and is what its sources say.

use std::collections::BTreeSet;
use std::process::Command;

use photinus_testing::Skipped;

use crate::compiled::{crate_folder, has, library};

/// The names that are followed by a parenthesis.
fn declared(header: &str) -> BTreeSet<String> {
    let code = header.lines().filter(|line| !line.trim_start().starts_with("//"));
    let names = code.flat_map(|line| line.split([' ', '*'])).filter_map(|word| word.split_once('('));
    names.map(|(name, _)| name.to_owned()).filter(|name| name.starts_with("photinus_")).collect()
}

#[test]
fn what_is_declared_is_what_is_exported() {
    if !has("nm", "--version") || !cfg!(target_os = "linux") {
        return;
    }
    let header = std::fs::read_to_string(crate_folder().join("include/photinus.h")).unwrap();
    let output = Command::new("nm").args(["-D", "--defined-only"]).arg(library()).output().unwrap();
    let symbols = String::from_utf8(output.stdout).unwrap();
    let exported: BTreeSet<String> =
        symbols.lines().filter_map(|line| line.split_whitespace().nth(2)).map(str::to_owned).collect();
    let declared = declared(&header);
    assert!(declared.contains("photinus_locate") && declared.len() > 20, "{declared:?}");
    assert_eq!(declared, exported);
}

#[test]
fn the_header_is_what_the_sources_say() {
    let cbindgen = std::env::var("CBINDGEN").unwrap_or_else(|_| "cbindgen".to_owned());
    if Command::new(&cbindgen).arg("--version").output().is_err() {
        Skipped::current_test("there is no cbindgen (CBINDGEN names it)");
        return;
    }
    let output = Command::new(crate_folder().join("header")).arg("--check").output().unwrap();
    let told = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
}
