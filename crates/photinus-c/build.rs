//! Names the shared library by its interface: programs that were linked with one version refuse another.

fn main() {
    let on_linux = std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux");
    if on_linux {
        #[expect(clippy::print_stdout, reason = "this is how a build script speaks")]
        {
            println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libphotinus_c.so.0");
        }
    }
}
