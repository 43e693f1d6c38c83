"""The worked examples run, and end as they say."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import EXAMPLE

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def run(name: str, *arguments: object) -> str:
    command = [sys.executable, "-W", "error", EXAMPLES / name, *arguments]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, env={"MPLBACKEND": "agg"})
    assert done.returncode == 0, done.stderr
    return done.stdout


def number(pattern: str, text: str) -> float:
    found = re.search(pattern, text, re.MULTILINE)
    assert found, text
    return float(found[1])


def test_locate_a_recording(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    told = run("locate_recording.py", EXAMPLE, "--pictures", tmp_path / "seen")
    assert "12 neighbours in 4 frames" in told and "found 100%" in told
    assert number(r"error ([\d.]+) % RMS", told) < 3
    assert {path.name for path in (tmp_path / "seen").iterdir()} == {"from-above.png", "overlay.png"}


def test_calibrate_a_camera(tmp_path: Path) -> None:
    told = run("calibrate_camera.py", "--out", tmp_path / "camera.toml")
    assert number(r"^(\d+) of 20 photos", told) >= 15
    assert number(r"off by ([\d.]+) mrad", told) < 2
    assert (tmp_path / "camera.toml").exists()


def test_design_a_set_up() -> None:
    rows = run("design_setup.py", "--frames", 60).splitlines()[1:]
    found = [int(row.split("%")[0].split()[-1]) for row in rows]
    assert len(rows) >= 6 and min(found[:3]) >= 90


def test_a_day() -> None:
    told = run("a_day.py", "--frames", 40)
    assert all(
        number(rf"^{row} +([\d.]+)$", told) > 0
        for row in ("spots with covariances, by Photinus", "neighbours, by Photinus")
    )
    assert "a data frame of 480 neighbours" in told or "is not installed" in told


def test_a_fleet_on_this_machine() -> None:
    pytest.importorskip("distributed")
    small = ("--recordings", 4, "--frames", 2, "--processes", 2, "--kill-every", 0)
    told = run("fleet_on_this_machine.py", *small)
    assert "2 processes, 0 killed" in told and "all there, once, identical" in told
