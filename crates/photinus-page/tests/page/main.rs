//! The page from outside.

mod browser;
mod traffic;

use std::sync::RwLock;

/// Memory is the whole program's: the test that measures it writes here, so that no other runs meanwhile; the others read.
static MEMORY: RwLock<()> = RwLock::new(());
