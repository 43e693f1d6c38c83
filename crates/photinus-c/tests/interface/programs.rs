//! The examples and a program full of mistakes: they end well, and neither AddressSanitizer nor valgrind has anything to say.

use crate::compiled::{Program, Under};
use crate::shown::{Shown, airframe, camera};

#[test]
fn every_mistake_is_told() {
    if let Some(program) = Program::compile("tests/interface/mistakes.c", Under::Nothing) {
        program.run(&[]);
    }
}

#[test]
fn every_mistake_is_told_under_address_sanitizer() {
    if let Some(program) = Program::compile("tests/interface/mistakes.c", Under::AddressSanitizer) {
        program.run(&[]);
    }
}

#[test]
fn every_mistake_is_told_under_valgrind() {
    if let Some(program) = Program::compile("tests/interface/mistakes.c", Under::Valgrind) {
        program.run(&[]);
    }
}

#[test]
fn the_example_in_c_locates() {
    let Some(program) = Program::compile("examples/locate.c", Under::AddressSanitizer) else { return };
    let told = program.run(&[&camera(), &airframe(), &Shown::new().path()]);
    assert!(told.contains(" 1 neighbours\n"), "{told}");
}

#[test]
fn the_node_in_cpp_publishes() {
    let Some(program) = Program::compile("examples/node.cpp", Under::AddressSanitizer) else { return };
    let shown = Shown::new();
    let size = [shown.width.to_string(), shown.height.to_string()];
    let told = program.run(&[&camera(), &airframe(), &shown.path(), &size[0], &size[1]]);
    assert!(told.starts_with("1 neighbours at 1.5 s\n"), "{told}");
}
