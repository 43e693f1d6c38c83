//! What `install` puts into a folder is enough for pkg-config and CMake to build the example, shared and static, also where the folder was moved.

use std::path::Path;
use std::process::Command;

use photinus_testing::Skipped;
use tempfile::TempDir;

use crate::compiled::{crate_folder, has, library};
use crate::shown::{Shown, airframe, camera};

const CMAKE: &str = "cmake_minimum_required(VERSION 3.16)\nproject(example C)\nfind_package(photinus 0.1 REQUIRED)\n\
                     add_executable(shared locate.c)\ntarget_link_libraries(shared PRIVATE photinus::photinus)\n\
                     add_executable(static locate.c)\ntarget_link_libraries(static PRIVATE photinus::static)\n";

fn must(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{command:?}\n{told}\n{}", String::from_utf8_lossy(&output.stderr));
    told
}

/// An installation that was moved after it was made; `None` where this machine cannot use one.
fn moved(folder: &TempDir) -> Option<std::path::PathBuf> {
    if !cfg!(target_os = "linux") {
        Skipped::current_test("the library is installed on Linux only");
        return None;
    }
    let (first, second) = (folder.path().join("first"), folder.path().join("second"));
    let mut install = Command::new(crate_folder().join("install"));
    must(install.arg(&first).env("LIBRARIES", library().parent().unwrap()));
    std::fs::rename(&first, &second).unwrap();
    Some(second)
}

fn locates(program: &Path) {
    let told = must(Command::new(program).args([camera(), airframe(), Shown::new().path()]));
    assert!(told.contains(" 1 neighbours\n"), "{told}");
}

#[test]
fn pkg_config_finds_what_was_installed() {
    if !has("cc", "--version") || !has("pkg-config", "--version") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let Some(prefix) = moved(&folder) else { return };
    let flags = |kind: &str| {
        let mut command = Command::new("pkg-config");
        command.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig")).args(["--cflags", "--libs", kind]);
        let told = must(command.arg("photinus"));
        told.split_whitespace().map(str::to_owned).collect::<Vec<_>>()
    };
    let source = crate_folder().join("examples/locate.c");
    let (shared, fixed) = (folder.path().join("shared"), folder.path().join("static"));
    let rpath = format!("-Wl,-rpath,{}", prefix.join("lib").display());
    must(Command::new("cc").arg(&source).args(flags("--print-errors")).arg(rpath).arg("-o").arg(&shared));
    locates(&shared);
    let archive =
        flags("--static").into_iter().map(|flag| flag.replace("-lphotinus_c", "-l:libphotinus_c.a"));
    must(Command::new("cc").arg(&source).args(archive).arg("-o").arg(&fixed));
    locates(&fixed);
}

#[test]
fn cmake_finds_what_was_installed() {
    if !has("cc", "--version") || !has("cmake", "--version") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let Some(prefix) = moved(&folder) else { return };
    let (source, build) = (folder.path().join("source"), folder.path().join("build"));
    std::fs::create_dir(&source).unwrap();
    std::fs::write(source.join("CMakeLists.txt"), CMAKE).unwrap();
    std::fs::copy(crate_folder().join("examples/locate.c"), source.join("locate.c")).unwrap();
    let found = format!("-DCMAKE_PREFIX_PATH={}", prefix.display());
    must(Command::new("cmake").arg("-S").arg(&source).arg("-B").arg(&build).arg(found));
    must(Command::new("cmake").arg("--build").arg(&build));
    locates(&build.join("shared"));
    locates(&build.join("static"));
}
