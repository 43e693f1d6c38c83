//! The page from outside.

mod browser;
mod traffic;
