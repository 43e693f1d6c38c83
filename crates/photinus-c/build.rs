//! Names the shared library by its interface: programs that were linked with one version refuse another.

fn main() {
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libphotinus_c.so.0");
    }
}
