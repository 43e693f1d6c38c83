"""What tests need of the machine: the program, the repository's files, real photos. Without it a test says so."""

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import photinus

ROOT = Path(__file__).resolve().parents[3]
EXAMPLE = ROOT / "examples" / "three-hexarotors"

Program = Callable[..., str]


@pytest.fixture(scope="session")
def program() -> Program:
    """The program of this checkout: called with arguments, it gives its standard output."""
    target = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")
    built = [target / profile / "photinus" for profile in ("debug", "release")]
    built = [path for path in built if path.exists()]
    named = os.environ.get("PHOTINUS_PROGRAM")
    path = named or (max(built, key=lambda path: path.stat().st_mtime) if built else None)
    if path is None:
        pytest.skip("the program is not built: cargo build -p photinus-cli, or name it in PHOTINUS_PROGRAM")

    def run(*arguments: object) -> str:
        done = subprocess.run([path, *map(str, arguments)], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def data() -> Path:
    """Real photos and calibrations that cannot be part of the repository."""
    path = Path(os.environ.get("PHOTINUS_DATA", ROOT.parent / "shared" / "data"))
    if not path.is_dir():
        pytest.skip("no real data: name its folder in PHOTINUS_DATA")
    return path


@pytest.fixture(scope="session")
def example() -> photinus.Dataset:
    """Four frames of three hexarotors."""
    return photinus.Dataset.read(EXAMPLE)


@pytest.fixture(scope="session")
def locator(example: photinus.Dataset) -> photinus.Locator:
    """One that fits the example."""
    return photinus.Locator(example.camera, example.airframe)


@pytest.fixture(scope="session")
def records(example: photinus.Dataset) -> list[photinus.Record]:
    """The example, located."""
    locator = photinus.Locator(example.camera, example.airframe, example)
    return [
        locator.locate(frame.image, gravity=frame.gravity, time=frame.time_s, frame=frame.frame) for frame in example
    ]


@pytest.fixture()
def image(example: photinus.Dataset) -> Any:
    """The first frame of the example."""
    return np.array(next(iter(example)).image)


def without_source(line: str) -> str:
    """A line of results but for the name of its image, which the module is not told; the digits stay as they are."""
    source = json.dumps(json.loads(line)["source"], ensure_ascii=False)
    return line.strip().replace(f'"source":{source}', '"source":""', 1)
