"""The stubs say what the module has, and what uses it type-checks."""

import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
pytest.importorskip("mypy")


def run(*arguments: object) -> None:
    done = subprocess.run([sys.executable, "-m", *map(str, arguments)], capture_output=True, text=True, cwd=HERE)
    assert done.returncode == 0, done.stdout + done.stderr


def test_stubs_are_the_module() -> None:
    allowed = HERE / "stubtest-allowed.txt"
    settings = ("--mypy-config-file", HERE.parent / "pyproject.toml")
    run("mypy.stubtest", "photinus", "--ignore-disjoint-bases", *settings, "--allowlist", allowed)


def test_what_uses_it_type_checks() -> None:
    settings = ("--config-file", HERE.parent / "pyproject.toml")
    run("mypy", *settings, "-p", "photinus")
    run("mypy", *settings, HERE, HERE.parent / "examples")
