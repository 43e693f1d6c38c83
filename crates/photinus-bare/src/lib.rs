//! The frames of the test `same_everywhere` through a core that was built without the standard library: `try-bare` runs it as
//! WebAssembly, which has no operating system to ask. (This crate's allocator is that of the target.)

#[path = "../../photinus/tests/flow/mod.rs"]
mod flow;
#[path = "../../photinus/tests/hash/mod.rs"]
mod hash;
#[path = "../../photinus/tests/paper/mod.rs"]
mod paper;

/// The hash of all that was told of the frames.
#[expect(unsafe_code, reason = "a name to be called by from outside")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_told() -> u64 {
    let flow::Told { hash, neighbours, modes, posed } = flow::locate();
    if neighbours.min(modes).min(posed) > 0 { hash } else { 0 }
}

/// The hash as the test has it.
#[expect(unsafe_code, reason = "a name to be called by from outside")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_pinned() -> u64 {
    flow::PINNED
}
