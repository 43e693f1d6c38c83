# One command for each chore; `.ci/run` takes the same steps as `check`.

# Formatting, lints, documentation, tests: what must be green before a change lands.
check: format-check lint doc test bare python

test:
    cargo test --workspace --locked

lint:
    cargo clippy --workspace --all-targets --locked -- -D warnings

format:
    cargo fmt --all

format-check:
    cargo fmt --all -- --check

doc:
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked

# The core without an operating system: for a microcontroller, and as WebAssembly with the same bits; needs rustup and Node.
bare:
    crates/photinus-bare/try-bare

# The page for browsers, in one file that works from a folder: target/browser/index.html.
browser:
    crates/photinus-browser/build

# The Python wheel, built and tried in a virtual environment; arguments go to pytest.
python *arguments:
    cargo build -p photinus-cli --locked
    crates/photinus-py/try-wheel {{arguments}}

# The wheel for 64-bit Arm, built here and tried under qemu-user; arguments go to pytest.
python-aarch64 *arguments:
    cargo build -p photinus-cli --locked
    crates/photinus-py/try-wheel-aarch64 {{arguments}}

# The notebook with its pictures, run anew by the wheel that `just python` has built.
notebook:
    target/python/bin/python crates/photinus-py/run-notebook

# Static programs for x86_64 and aarch64, and whether they compute what this machine's own does, bit for bit; needs rustup and qemu-user.
static:
    packaging/static
    cargo build -p photinus-cli --locked
    packaging/try-static

# The Debian package, installed into a folder of its own; needs cargo-deb.
deb:
    packaging/deb
    packaging/try-deb

# Ten minutes of `photinus run` with every sink on; with `--soak 5000000` hours as fast as it goes. For a machine that does nothing else.
long *arguments:
    cargo build --release -p photinus-cli --features ros2,mavlink --locked
    crates/photinus-run/try-long {{arguments}}

# What becomes of accuracy when a constant is three times as large, or a third: about half an hour; arguments are parts of module paths.
vary *arguments:
    crates/photinus-evaluate/vary-constants {{arguments}}

# Times beside floors measured in the same run.
bench:
    cargo bench -p photinus -p photinus-sim

# Licences, duplicates and sources of dependencies; needs cargo-deny.
deny:
    cargo deny --locked check bans licenses sources

# The same and known holes; fetches the advisory database.
deny-advisories:
    cargo deny --locked check

# Whether the fuzz targets compile, without fuzzing.
fuzz-check:
    cargo check --manifest-path fuzz/Cargo.toml --locked

# A table of docs/world.md anew, e.g. `just world faults`; also `cameras`, `crowds` and `snapshot`, minutes each.
world table:
    cargo run --release -p photinus-evaluate --example world -- {{table}} --update

# Tables of docs/codes.md (`most`, `books`) or docs/identity.md (`decoding`) anew.
identity table:
    cargo run --release -p photinus-io --example identity -- {{table}} --update

# The tables of docs/swarm.md anew, printed; a hundred seeds take hours.
swarm seeds:
    cargo run --release -p photinus-swarm --example validate_stand_in -- 2 6 three wind leader formation
    cargo run --release -p photinus-swarm --example flights -- stand_in {{seeds}}
    cargo run --release -p photinus-swarm --example contracts -- perfect {{seeds}}
    cargo run --release -p photinus-swarm --example contracts -- stand_in {{seeds}}
    cargo run --release -p photinus-swarm --example exposures -- {{seeds}}
    cargo run --release -p photinus-swarm --example margins -- {{seeds}}

# A minute of fuzzing for one target, e.g. `just fuzz spots`; needs cargo-fuzz and a nightly toolchain.
fuzz target:
    cargo +nightly fuzz run {{target}} -- -max_total_time=60
