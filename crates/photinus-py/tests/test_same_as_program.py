"""The module and the program give the same numbers, bit for bit: lines of JSON, whose numbers have every digit."""

import inspect
import json
import re
from pathlib import Path

import numpy as np
import pytest

import photinus
from conftest import EXAMPLE, ROOT, Program, without_source


def lines(path: Path) -> list[str]:
    return [without_source(line) for line in path.read_text().splitlines()]


def test_a_dataset(program: Program, records: list[photinus.Record], tmp_path: Path) -> None:
    program("locate", EXAMPLE, "--out", tmp_path / "r.jsonl", "-q")
    assert [record.to_json() for record in records] == lines(tmp_path / "r.jsonl")
    assert sum(len(record.neighbours) for record in records) >= 3 * len(records)


def test_a_simulation(program: Program, tmp_path: Path) -> None:
    scene = ROOT / "scenes" / "swarm-12.toml"
    folder = tmp_path / "swarm"
    program("simulate", scene, "--frames", 4, "--seed", 7, "--out", folder, "-q")
    program("locate", folder, "--out", tmp_path / "r.jsonl", "-q")

    simulation = photinus.simulate(scene, frames=4, seed=7)
    dataset = photinus.Dataset.read(folder)
    assert simulation.airframe is not None
    locator = photinus.Locator(simulation.camera, simulation.airframe)
    ours, truth = [], []
    for frame, recorded in zip(simulation, dataset, strict=True):
        assert np.array_equal(frame.image, recorded.image)
        assert (frame.time_s, frame.gravity) == (recorded.time_s, recorded.gravity)
        record = locator.locate(frame.image, gravity=frame.gravity, time=frame.time_s, frame=frame.frame)
        ours.append(record.to_json())
        truth.append(frame.truth)
    assert ours == lines(tmp_path / "r.jsonl")
    assert truth == dataset.truth
    assert '"neighbours":[{' in ours[-1]


@pytest.mark.parametrize("faults", ["drop", "late"])
def test_what_goes_wrong_with_a_recording(program: Program, tmp_path: Path, faults: str) -> None:
    text = (ROOT / "scenes" / "crossing.toml").read_text()
    table = {"drop": "lost = 0.4", "late": "late = 0.5\nlate_by_ms = 5.0\nswapped = 0.5"}[faults]
    if "[recording]" in text:
        pytest.skip("the scene has faults of its own")
    scene = ROOT / "scenes" / f".{tmp_path.name}.toml"
    scene.write_text(f"{text}\n[recording]\n{table}\n")
    try:
        program("simulate", scene, "--frames", 6, "--out", tmp_path / "flight", "-q")
        frames = list(photinus.simulate(scene, frames=6))
    finally:
        scene.unlink()
    recorded = list(photinus.Dataset.read(tmp_path / "flight"))
    assert [f.frame for f in frames] == [f.frame for f in recorded]
    assert [(f.time_s, f.gravity) for f in frames] == [(f.time_s, f.gravity) for f in recorded]
    # Of a swapped pair the dataset names each other's file.
    assert all(np.array_equal(a.image, b.image) for a, b in zip(frames, recorded, strict=True))


def test_real_photos(program: Program, data: Path, tmp_path: Path) -> None:
    photos = sorted((data / "grid-752x480").glob("*.jpg"))
    camera = data / "ocamcalib" / "calib_results_bf_uv_25001954.txt"
    airframe = data / "airframes" / "quadrotor_foursided.txt"
    options = ["--camera", camera, "--airframe", airframe, "--gravity", "0.1,0.9,0.2", "--max-tilt", 20]
    program("locate", *photos, *options, "--out", tmp_path / "r.jsonl", "-q")
    locator = photinus.Locator(photinus.Camera.read(camera), photinus.Airframe.read(airframe), max_tilt=20)
    ours = [
        locator.locate(frame.image, gravity=(0.1, 0.9, 0.2), frame=frame.frame).to_json()
        for frame in photinus.frames(photos)
    ]
    assert ours == lines(tmp_path / "r.jsonl")
    assert '"neighbours":[{' in "".join(ours)


@pytest.mark.parametrize("folder", ["grid-960x600", "grid-752x480"])
def test_spots_of_real_photos(program: Program, data: Path, tmp_path: Path, folder: str) -> None:
    photos = sorted(path for path in (data / folder).iterdir() if path.suffix in (".png", ".jpg"))
    program("detect", *photos, "--threshold", 120, "--out", tmp_path / "r.jsonl", "-q")
    detector = photinus.Detector(threshold=120)
    ours = [detector.detect(f.image, frame=f.frame).to_json() for f in photinus.frames(photos)]
    assert ours == lines(tmp_path / "r.jsonl")


def test_masks_and_curves(program: Program, tmp_path: Path, example: photinus.Dataset) -> None:
    frame = next(iter(example))
    mask = np.full_like(frame.image, 255)
    spot = photinus.detect(frame.image).spots[0]
    left, top, right, bottom = spot.extent_px or (0, 0, 0, 0)
    mask[top : bottom + 1, left : right + 1] = 0
    (tmp_path / "mask.pgm").write_bytes(b"P5 %d %d 255\n" % mask.shape[::-1] + mask.tobytes())
    options = ["--mask", tmp_path / "mask.pgm", "--spot-curve", "paper", "--threshold", 200, "--frames", 1]
    program("locate", EXAMPLE, *options, "--out", tmp_path / "r.jsonl", "-q")
    for given in (mask, tmp_path / "mask.pgm"):
        locator = photinus.Locator(example.camera, example.airframe, mask=given, spot_curve="paper", threshold=200)
        record = locator.locate(frame.image, gravity=frame.gravity, time=frame.time_s, frame=frame.frame)
        assert [record.to_json()] == lines(tmp_path / "r.jsonl")
        assert "mask" in [rejected.reason for rejected in record.rejected]


def test_spots_of_another_detector(program: Program, tmp_path: Path, example: photinus.Dataset) -> None:
    program("detect", EXAMPLE, "--out", tmp_path / "spots.jsonl", "-q")
    files = ["--camera", EXAMPLE / "camera.toml", "--airframe", EXAMPLE / "airframe.toml"]
    program("locate", "--spots", tmp_path / "spots.jsonl", *files, "--out", tmp_path / "r.jsonl", "-q")
    locator = photinus.Locator(example.camera, example.airframe)
    given = photinus.read_results(tmp_path / "spots.jsonl")
    assert [locator.locate_spots(record) for record in given] == photinus.read_results(tmp_path / "r.jsonl")


def test_a_calibration(program: Program, data: Path, tmp_path: Path) -> None:
    photos = sorted((data / "grid-960x600").glob("grid_*.png"))[:8]
    options = ["--grid", "7x5", "--model", "kannala-brandt:2", "--board", "flat", "--splits", 1, "--bootstraps", 1]
    program("calibrate", "camera", *photos, *options, "--out", tmp_path / "camera.toml", "-q")
    calibrated = photinus.calibrate_camera(photos, (7, 5), model="kannala-brandt:2", board="flat")
    calibrated.write(tmp_path / "ours.toml")
    assert (tmp_path / "ours.toml").read_bytes() == (tmp_path / "camera.toml").read_bytes()


def test_scores(program: Program, tmp_path: Path, example: photinus.Dataset) -> None:
    program("locate", EXAMPLE, "--out", tmp_path / "r.jsonl", "-q")
    theirs = json.loads(program("evaluate", EXAMPLE, tmp_path / "r.jsonl", "--bins", "5,10", "--json", "-"))
    ours = photinus.evaluate(EXAMPLE, tmp_path / "r.jsonl", bins=[5, 10])
    assert ours == {key: theirs[key] for key in ours}
    assert set(theirs) - set(ours) == {"dataset", "results", "settings"}
    assert example.truth is not None
    assert photinus.evaluate(example.truth, photinus.read_results(tmp_path / "r.jsonl"), bins=[5, 10]) == ours


def test_codes(program: Program) -> None:
    text = program("codes", "design", "--length", 10, "--distance", 3, "--longest-run", 3, "--duty", "0.3..0.7")
    book = photinus.CodeBook.design(10, 3, longest_run=3, duty=(0.3, 0.7))
    assert book.to_text().splitlines() == [line for line in text.splitlines() if not line.startswith("#")]
    assert book.at_most is not None and len(book) <= book.at_most


@pytest.mark.parametrize("command, function", [("locate", photinus.Locator), ("detect", photinus.Detector)])
def test_options_have_the_names_and_defaults_of_the_program(program: Program, command: str, function: type) -> None:
    help_text = program(command, "--help")
    for name, option in inspect.signature(function).parameters.items():
        if option.kind is not inspect.Parameter.KEYWORD_ONLY:
            continue
        flag = f"--{name.replace('_', '-')}"
        section = re.search(rf"{flag}\b(.*?)(?=\n\s*(?:-\w, )?--|\Z)", help_text, re.DOTALL)
        assert section, f"{command} has no {flag}"
        default = re.search(r"\[default: ([-\d.]+)\]", section[1])
        if name == "contrast":
            continue  # its default goes away where a threshold is given
        if isinstance(option.default, bool):
            assert not option.default and default is None, flag
        elif option.default is None:
            assert default is None, flag
        else:
            assert default and float(default[1]) == option.default, flag
