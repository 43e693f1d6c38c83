//! A source in C or C++ -> a program that is linked with the library, if this machine has a compiler.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use photinus_testing::Skipped;
use tempfile::TempDir;

/// What a compiler is told: whatever it warns of is an error.
const STRICT: [&str; 5] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];

/// How a program is run.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Under {
    Nothing,
    AddressSanitizer,
    Valgrind,
}

/// A program in a folder of its own, beside the library under its names.
pub(crate) struct Program {
    folder: TempDir,
    under: Under,
}

pub(crate) fn crate_folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The shared library that Cargo has built for this test.
pub(crate) fn library() -> PathBuf {
    let program = std::env::current_exe().unwrap();
    program.parent().unwrap().join("libphotinus_c.so")
}

/// Whether a command runs at all; where it does not, the calling test is listed as skipped.
pub(crate) fn has(command: &str, argument: &str) -> bool {
    let runs = Command::new(command).arg(argument).output().is_ok_and(|output| output.status.success());
    if !runs {
        Skipped::current_test(&format!("there is no {command}"));
    }
    runs
}

fn compiler(source: &Path) -> (OsString, &'static str) {
    let (variable, default, standard) = match source.extension().is_some_and(|kind| kind == "cpp") {
        true => ("CXX", "c++", "-std=c++17"),
        false => ("CC", "cc", "-std=c11"),
    };
    (std::env::var_os(variable).unwrap_or_else(|| default.into()), standard)
}

impl Program {
    /// Compiles a source of this crate; `None` where the machine lacks what that takes, which is listed.
    pub(crate) fn compile(source: &str, under: Under) -> Option<Self> {
        let source = crate_folder().join(source);
        let (compiler, standard) = compiler(&source);
        if !cfg!(target_os = "linux") {
            Skipped::current_test("programs in C are compiled on Linux only");
            return None;
        }
        if !has(&compiler.to_string_lossy(), "--version")
            || (under == Under::Valgrind && !has("valgrind", "--version"))
        {
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let program = Self { folder, under };
        for name in ["libphotinus_c.so", "libphotinus_c.so.0"] {
            #[cfg(unix)]
            std::os::unix::fs::symlink(library(), program.path(name)).unwrap();
        }
        let mut command = Command::new(compiler);
        command.arg(standard).args(STRICT).arg("-g").arg(source).arg("-o").arg(program.path("program"));
        if under == Under::AddressSanitizer {
            if !program.sanitizes(&command) {
                Skipped::current_test("the compiler has no AddressSanitizer");
                return None;
            }
            command.args(["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]);
        }
        command.arg("-I").arg(crate_folder().join("include")).arg("-L").arg(program.folder.path());
        let rpath = format!("-Wl,-rpath,{}", program.folder.path().display());
        let output = command.args([&rpath, "-lphotinus_c", "-lpthread", "-lm"]).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(program)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Whether an empty program can be sanitized.
    fn sanitizes(&self, compiler: &Command) -> bool {
        let empty = self.path("empty.c");
        std::fs::write(&empty, "int main(void) { return 0; }\n").unwrap();
        let mut command = Command::new(compiler.get_program());
        command.arg("-x").arg("c").arg(empty).arg("-o").arg(self.path("empty"));
        command.arg("-fsanitize=address,undefined").output().unwrap().status.success()
    }

    /// Runs it to its end, and returns what it printed.
    pub(crate) fn run(&self, arguments: &[&str]) -> String {
        let mut command = match self.under {
            Under::Valgrind => {
                let mut valgrind = Command::new("valgrind");
                valgrind.args(["-q", "--error-exitcode=99", "--leak-check=full"]).arg(self.path("program"));
                valgrind
            }
            _ => Command::new(self.path("program")),
        };
        let Output { status, stdout, stderr } = command.args(arguments).output().unwrap();
        let (told, wrong) = (String::from_utf8_lossy(&stdout), String::from_utf8_lossy(&stderr));
        assert!(status.success(), "{status}\n{told}\n{wrong}");
        assert!(wrong.is_empty(), "{wrong}");
        told.into_owned()
    }
}
