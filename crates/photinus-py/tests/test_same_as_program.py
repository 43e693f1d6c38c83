"""The module and the program give the same numbers, bit for bit: lines of JSON, whose numbers have every digit."""

import inspect
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import photinus
from conftest import EXAMPLE, ROOT, Program, without_source


def lines(path: Path) -> list[str]:
    return [without_source(line) for line in path.read_text().splitlines()]


def crossing(folder: Path, more: str) -> Path:
    """A scene of the repository with more in it."""
    text = (ROOT / "scenes" / "crossing.toml").read_text()
    scene = folder / "scene.toml"
    scene.write_text(re.sub(r'"(cameras|airframes|codes)/', rf'"{ROOT}/scenes/\1/', text) + f"\n{more}\n")
    return scene


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
    locator = photinus.Locator(simulation.camera, simulation.airframe, dataset)
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


def test_every_frame_by_itself(program: Program, tmp_path: Path, example: photinus.Dataset) -> None:
    program("locate", "--no-time", EXAMPLE, "--out", tmp_path / "r.jsonl", "-q")
    locator = photinus.Locator(example.camera, example.airframe, no_time=True)
    records = [locator.locate(f.image, gravity=f.gravity, time=f.time_s, frame=f.frame) for f in example]
    assert [record.to_json() for record in records] == lines(tmp_path / "r.jsonl")
    assert all(record.tracks == () for record in records)


def test_who_blinks(program: Program, tmp_path: Path) -> None:
    program("simulate", ROOT / "scenes" / "crossing.toml", "--frames", 60, "--out", tmp_path / "flight", "-q")
    program("locate", tmp_path / "flight", "--out", tmp_path / "r.jsonl", "-q")
    recording = photinus.Dataset.read(tmp_path / "flight")
    locator = photinus.Locator(recording.camera, recording.airframes, recording)
    records = [locator.locate(f.image, gravity=f.gravity, time=f.time_s, frame=f.frame) for f in recording]
    assert [record.to_json() for record in records] == lines(tmp_path / "r.jsonl")
    assert {track.id for track in records[-1].tracks} == {1, 2}
    for track in records[-1].tracks:
        (likeliest, *_) = track.ids
        assert likeliest.id == track.id and likeliest.probability == track.id_probability
        assert track.position_m.shape == track.velocity_m_s.shape == (3,) and not likeliest.contested


def test_the_sun_of_a_recording(program: Program, tmp_path: Path) -> None:
    """A spot that may be the sun is less likely a neighbour: a recording tells the module where it stood, too."""

    def located(sky: str) -> list[photinus.Record]:
        folder = tmp_path / ("day" if sky else "night")
        shutil.copytree(EXAMPLE, folder)
        with (folder / "dataset.toml").open("a") as toml:
            toml.write(sky)
        program("locate", folder, "--out", folder / "r.jsonl", "-q")
        recording = photinus.Dataset.read(folder)
        locator = photinus.Locator(recording.camera, recording.airframe, recording)
        records = [locator.locate(f.image, gravity=f.gravity, time=f.time_s, frame=f.frame) for f in recording]
        assert [record.to_json() for record in records] == lines(folder / "r.jsonl")
        return records

    # The sun rises where the camera looks.
    day = "latitude_deg = 0.0\nlongitude_deg = 0.0\ntime = 2024-03-20T06:08:00Z\nheading_deg = 90.0\n"
    with_sun, without = located(f"\n[sky]\n{day}"), located("")
    assert [record.to_json() for record in with_sun] != [record.to_json() for record in without]


def test_several_kinds(program: Program, tmp_path: Path, example: photinus.Dataset) -> None:
    quad = tmp_path / "quad.toml"
    ring = "{ arms = 4, radius_m = 0.2, leds_per_arm = 1, splay_deg = 0.0 }"
    quad.write_text(f'name = "quad"\nring = {ring}\n')
    kinds = ["--airframe", EXAMPLE / "airframe.toml", "--airframe", quad]
    program("locate", EXAMPLE, *kinds, "--out", tmp_path / "r.jsonl", "-q")
    locator = photinus.Locator(example.camera, [example.airframe, photinus.Airframe.read(quad)], example)
    records = [locator.locate(f.image, gravity=f.gravity, time=f.time_s, frame=f.frame) for f in example]
    assert [record.to_json() for record in records] == lines(tmp_path / "r.jsonl")
    assert [airframe.name for airframe in locator.airframes] == [example.airframe.name, "quad"]
    assert all(n.airframe_probability is not None for record in records for n in record.neighbours)
    with pytest.raises(photinus.SettingError, match="two airframes are called"):
        photinus.Locator(example.camera, [example.airframe, example.airframe])


@pytest.mark.parametrize("faults", ["lost = 0.4", "late = 0.5\nlate_by_s = 0.005\nswapped = 0.5"])
def test_what_goes_wrong_with_a_recording(program: Program, tmp_path: Path, faults: str) -> None:
    scene = crossing(tmp_path, f"[recording]\n{faults}")
    program("simulate", scene, "--frames", 8, "--out", tmp_path / "flight", "-q")

    frames = list(photinus.simulate(scene, frames=8))
    recorded = list(photinus.Dataset.read(tmp_path / "flight"))
    assert [(f.frame, f.time_s, f.gravity) for f in frames] == [(f.frame, f.time_s, f.gravity) for f in recorded]
    assert all(np.array_equal(ours.image, theirs.image) for ours, theirs in zip(frames, recorded, strict=True))
    shown = [f"images/{f.frame:06}.png" == f.source for f in recorded]
    assert len(frames) < 8 or not all(shown), "nothing went wrong"


def test_one_of_several_cameras(program: Program, tmp_path: Path) -> None:
    left = f'name = "left"\nfile = "{ROOT}/scenes/cameras/bluefox-dsl215.toml"\nposition_m = [0, 0.1, 0]\nyaw_deg = 20'
    scene = crossing(tmp_path, f"[[camera]]\n{left}\nclock = {{ offset_s = 0.002, ppm = 20.0 }}")
    program("simulate", scene, "--frames", 3, "--out", tmp_path / "flight", "-q")
    # several are followed together; one by itself is the same here
    program("locate", tmp_path / "flight", "--only", "left", "--out", tmp_path / "r.jsonl", "-q")
    theirs = lines(tmp_path / "r.jsonl")
    assert all('"camera":"left"' in line for line in theirs)

    with pytest.raises(photinus.SettingError, match="front, left"):
        photinus.simulate(scene)
    with pytest.raises(photinus.SettingError, match="front, left"):
        photinus.Dataset.read(tmp_path / "flight")
    dataset = photinus.Dataset.read(tmp_path / "flight", camera="left")
    simulation = photinus.simulate(scene, frames=3, camera="left")
    assert dataset.mounting is not None and dataset.truth is not None and len(dataset) == 3
    locator = photinus.Locator(dataset.camera, dataset.airframe, dataset)
    ours = []
    for frame, simulated, truth in zip(dataset, simulation, dataset.truth, strict=True):
        assert np.array_equal(frame.image, simulated.image) and frame.time_s == simulated.time_s == truth.time_s
        record = locator.locate(frame.image, gravity=frame.gravity, time=frame.time_s, frame=frame.frame)
        ours.append(record.to_json())
    assert ours == [line.replace('"camera":"left",', "") for line in theirs]
    assert len(ours) == 3


def test_real_photos(program: Program, data: Path, tmp_path: Path) -> None:
    photos = sorted((data / "grid-752x480").glob("*.jpg"))
    camera = data / "ocamcalib" / "calib_results_bf_uv_25001954.txt"
    airframe = data / "airframes" / "quadrotor_foursided.txt"
    options = [
        "--camera",
        camera,
        "--airframe",
        airframe,
        "--gravity",
        "0.1,0.9,0.2",
        "--max-tilt",
        20,
        "--min-probability",
        0,
    ]
    program("locate", *photos, *options, "--out", tmp_path / "r.jsonl", "-q")
    with pytest.warns(photinus.PhotinusWarning, match="the inverse polynomial disagrees"):
        seen_by = photinus.Camera.read(camera)
    locator = photinus.Locator(seen_by, photinus.Airframe.read(airframe), max_tilt=20, min_probability=0)
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
    spot = photinus.detect(frame.image, threshold=200).spots[0]
    left, top, right, bottom = spot.extent_px or (0, 0, 0, 0)
    mask[top : bottom + 1, left : right + 1] = 0
    (tmp_path / "mask.pgm").write_bytes(b"P5 %d %d 255\n" % mask.shape[::-1] + mask.tobytes())
    options = ["--mask", tmp_path / "mask.pgm", "--spot-curve", "paper", "--threshold", 200, "--frames", 1]
    program("locate", EXAMPLE, *options, "--out", tmp_path / "r.jsonl", "-q")
    for given in (mask, tmp_path / "mask.pgm"):
        locator = photinus.Locator(
            example.camera, example.airframe, example, mask=given, spot_curve="paper", threshold=200
        )
        record = locator.locate(frame.image, gravity=frame.gravity, time=frame.time_s, frame=frame.frame)
        assert [record.to_json()] == lines(tmp_path / "r.jsonl")
        assert "mask" in [rejected.reason for rejected in record.rejected]


def test_a_mounting(program: Program, tmp_path: Path, example: photinus.Dataset) -> None:
    mounting = tmp_path / "mounting.toml"
    mounting.write_text(
        """
        body_from_camera_xyzw = [-0.5, 0.5, -0.5, 0.5]
        rotation_covariance_rad2 = [[1e-6, 0.0, 0.0], [0.0, 1e-6, 0.0], [0.0, 0.0, 1e-6]]
        position_m = [0.1, 0.0, 0.05]
        position_covariance_m2 = [[1e-6, 0.0, 0.0], [0.0, 1e-6, 0.0], [0.0, 0.0, 1e-6]]
        """
    )
    program("locate", EXAMPLE, "--mounting", mounting, "--frames", 1, "--out", tmp_path / "r.jsonl", "-q")
    locator, frame = photinus.Locator(example.camera, example.airframe, example, mounting=mounting), next(iter(example))
    record = locator.locate(frame.image, gravity=frame.gravity, time=frame.time_s, frame=frame.frame)
    assert [record.to_json()] == lines(tmp_path / "r.jsonl")
    neighbour = record.neighbours[0]
    assert neighbour.position_m is not None and neighbour.position_body_m is not None
    x, y, z = neighbour.position_m
    assert np.allclose(neighbour.position_body_m, [z + 0.1, -x, -y + 0.05])
    assert neighbour.position_body_covariance_m2 is not None and neighbour.position_covariance_m2 is not None
    assert np.trace(neighbour.position_body_covariance_m2) > np.trace(neighbour.position_covariance_m2)


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
    text = program("codes", "design", "--length", 6, "--distance", 2, "--longest-run", 3, "--duty", "0.3..0.7")
    book = photinus.CodeBook.design(6, 2, longest_run=3, duty=(0.3, 0.7))
    assert book.to_text().splitlines() == [line for line in text.splitlines() if not line.startswith("#")]
    assert book.at_most is not None and len(book) <= book.at_most


def test_a_plan(program: Program, tmp_path: Path) -> None:
    setup = tmp_path / "set-up.toml"
    setup.write_text(photinus.example_setup())
    assert program("plan", "--example").strip() == photinus.example_setup().strip()
    assert photinus.plan(setup) == json.loads(program("plan", setup, "--json"))
    setup.write_text("[led]\npart = 'none'\n")
    with pytest.raises(photinus.FileError, match="not known"):
        photinus.plan(setup)


@pytest.mark.parametrize("command, function", [("locate", photinus.Locator), ("detect", photinus.Detector)])
def test_options_have_the_names_and_defaults_of_the_program(program: Program, command: str, function: type) -> None:
    sections = re.split(r"\n\s+(?:-\w, )?--", program(command, "--help"))
    help_of = {section.split()[0].replace("-", "_"): " ".join(section.split()) for section in sections[1:]}
    for name, option in inspect.signature(function).parameters.items():
        if option.kind is not inspect.Parameter.KEYWORD_ONLY or name == "contrast":
            continue  # the contrast's default goes away where a threshold is given
        default = re.search(r"\[default: ([-\d.]+)\]", help_of[name])
        if option.default is None or option.default is False:
            assert default is None, name
        else:
            assert default and float(default[1]) == option.default, name
