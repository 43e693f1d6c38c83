//! The same bits on every machine, from pixels to neighbours: a hash of all that is located in a fixed set of frames is
//! written down here. Spots alone have theirs in `detection/determinism.rs`.
//!
//! A hash that differs between two machines or two profiles is a bug; one that differs after a change of the method is
//! written down anew, and says in review that results changed. `crates/photinus-bare` runs the same frames without an operating system.

mod flow;
mod hash;
mod paper;

#[test]
fn neighbours_are_the_same_bit_for_bit_on_every_machine() {
    let flow::Told { neighbours, modes, posed, hash } = flow::locate();
    println!("{neighbours} neighbours, {posed} with an attitude, {modes} modes, {hash:#018x}");
    assert!(neighbours > 20 && posed > 15 && modes > neighbours);
    assert_eq!(hash, flow::PINNED);
}
