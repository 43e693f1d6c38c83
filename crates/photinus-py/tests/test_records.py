"""Records: properties say what the JSON says; errors are those of photinus."""

import gc
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import photinus
from conftest import EXAMPLE

CLASSES = {"Record", "Spot", "Rejected", "Neighbour", "Distance", "Misfit", "RunnerUp", "Mode", "Track", "Identity"}


def shown(value: Any) -> Any:
    """An object by its properties, as JSON would have it."""
    if type(value).__name__ in CLASSES:
        names = [name for name in dir(value) if not name.startswith("_")]
        properties = {name: getattr(value, name) for name in names}
        return {name: shown(value) for name, value in properties.items() if not callable(value)}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [shown(item) for item in value] if isinstance(value, (tuple, list)) else value


def without_nulls(value: Any) -> Any:
    """JSON leaves some out that are not known."""
    if isinstance(value, dict):
        return {key: without_nulls(item) for key, item in value.items() if item is not None}
    return [without_nulls(item) for item in value] if isinstance(value, list) else value


def test_properties_are_the_fields_of_the_file(records: list[photinus.Record]) -> None:
    for record in records:
        assert record.neighbours and record.neighbours[0].modes
        of_file = {"incomplete": False} | record.to_dict()  # said where it is so
        of_file["tracks"] = [{"ids": []} | track for track in of_file["tracks"]]  # said where somebody blinks
        assert without_nulls(shown(record)) == without_nulls(of_file)


def test_arrays_have_the_shapes_that_docs_say(records: list[photinus.Record]) -> None:
    neighbour, spot = records[0].neighbours[0], records[0].spots[0]
    assert neighbour.position_m is not None and neighbour.position_covariance_m2 is not None
    assert neighbour.position_m.shape == (3,) and neighbour.position_covariance_m2.shape == (3, 3)
    assert neighbour.orientation_xyzw is not None and neighbour.orientation_xyzw.shape == (4,)
    assert spot.covariance_px2.shape == (2, 2)
    assert np.isclose(np.linalg.norm(neighbour.bearing), 1)
    assert neighbour.position_m @ neighbour.bearing == pytest.approx(neighbour.distance_m.estimate, rel=0.01)


def test_records_survive_text_and_pickle(records: list[photinus.Record]) -> None:
    for record in records:
        assert photinus.Record.from_json(record.to_json()) == record
        assert pickle.loads(pickle.dumps(record)) == record
    assert records[0] != records[1]


def test_parts_outlive_their_record(example: photinus.Dataset, locator: photinus.Locator) -> None:
    record = locator.locate(next(iter(example)).image)
    neighbour, words = record.neighbours[0], repr(record.neighbours[0])
    del record
    gc.collect()
    assert repr(neighbour) == words and neighbour.airframe


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"spots":[]}\n{"spots":[]}', '{"spots":[{"u_px":NaN}]}'])
def test_what_is_no_record_is_refused(text: str) -> None:
    with pytest.raises(photinus.FileError):
        photinus.Record.from_json(text)


def test_errors_name_file_place_and_remedy(tmp_path: Path) -> None:
    broken = tmp_path / "quad.toml"
    broken.write_text('name = "q"\n[[led]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 0]\nlobe = "omni"\n')
    with pytest.raises(photinus.FileError, match=r"quad\.toml, `led\[0\]\.axis`: .*points nowhere; give"):
        photinus.Airframe.read(broken)
    for read in (
        photinus.Camera.read,
        photinus.Airframe.read,
        photinus.Dataset.read,
        photinus.CodeBook.read,
        photinus.read_image,
        photinus.read_results,
        photinus.read_truth,
        photinus.simulate,
        photinus.frames,
    ):
        with pytest.raises(photinus.FileError, match=r"none: .*; (check the path|name the folder)"):
            read(tmp_path / "none")


def test_what_is_odd_about_a_file_is_a_warning(tmp_path: Path) -> None:
    layout = tmp_path / "quad.txt"
    layout.write_text("1 0 0 1 0 0 0\n0 1 0 1 0 0 0\n")
    with pytest.warns(photinus.PhotinusWarning, match="quad.txt: "):
        assert photinus.Airframe.read(layout).notes


@pytest.mark.parametrize(
    "options",
    [
        {"max_tilt": 181.0},
        {"min_probability": -0.1},
        {"miss_rate": 0.9},
        {"contrast": 20, "threshold": 200},
        {"threshold": 0},
        {"reflection_ratio": float("nan")},
        {"marker_sigma": -1.0},
        {"power_spread": 0.0},
        {"tilt_sigma": float("inf")},
    ],
)
def test_options_without_meaning_are_refused(example: photinus.Dataset, options: dict[str, Any]) -> None:
    with pytest.raises(photinus.SettingError):
        photinus.Locator(example.camera, example.airframe, **options)


@pytest.mark.parametrize("gravity", [(0, 0, 0), (float("nan"), 0, 1), (float("inf"), 0, 0)])
def test_gravity_points_somewhere(locator: photinus.Locator, image: Any, gravity: Any) -> None:
    with pytest.raises(photinus.SettingError, match="points nowhere"):
        locator.locate(image, gravity=gravity)
    with pytest.raises(photinus.SettingError, match="time"):
        locator.locate(image, time=float("nan"))


def test_arguments_of_another_type_are_type_errors(locator: photinus.Locator, image: Any) -> None:
    for call in (
        lambda: locator.locate(image, gravity=(0, 1)),
        lambda: locator.locate(image, gravity="down"),  # type: ignore[arg-type]
        lambda: locator.locate(image, frame="first"),  # type: ignore[arg-type]
        lambda: photinus.Locator(1, 2),  # type: ignore[arg-type]
        lambda: photinus.neighbours_table([1]),  # type: ignore[list-item]
    ):
        with pytest.raises((TypeError, ValueError)):
            call()
    with pytest.raises(OverflowError):
        locator.locate(image, frame=-1)


def test_a_mask_is_of_the_cameras_size(example: photinus.Dataset) -> None:
    with pytest.raises(photinus.ImageError):
        photinus.Locator(example.camera, example.airframe, mask=np.ones((3, 3), np.uint8))


def test_bearings_and_pixels_go_forth_and_back(example: photinus.Dataset) -> None:
    camera = example.camera
    pixels = np.random.default_rng(2).uniform((200, 100), (550, 380), (100, 2))
    bearings = camera.bearings(pixels)
    assert np.allclose(np.linalg.norm(bearings, axis=1), 1)
    assert np.allclose(camera.pixels(2.5 * bearings), pixels, atol=1e-6)
    assert np.isnan(camera.pixels([[0, 0, -1.0]])).all()
    assert camera.bearings(np.empty((0, 2))).shape == (0, 3)
    with pytest.raises(photinus.SettingError, match="shape"):
        camera.bearings([[1, 2, 3]])


def test_an_airframe_is_a_ring_or_a_file(example: photinus.Dataset) -> None:
    ring = photinus.Airframe.ring("hexa", 6, 0.4)
    assert ring.positions_m.shape == (6, 3) and np.allclose(ring.positions_m, 0.4 * ring.axes)
    with pytest.raises(photinus.SettingError):
        photinus.Airframe.ring("two", 2, 0.4)


def test_a_camera_is_written_once(example: photinus.Dataset, tmp_path: Path) -> None:
    camera, path = example.camera, tmp_path / "camera.toml"
    camera.write(path)
    with pytest.raises(photinus.FileError):
        camera.write(path)
    camera.write(path, force=True)
    assert np.array_equal(photinus.Camera.read(path).bearings([[100, 90]]), camera.bearings([[100, 90]]))


def test_photos_that_tell_no_camera_say_why() -> None:
    dark = np.zeros((480, 752), np.uint8)
    with pytest.raises(photinus.CalibrationError, match=r"(?s)0 photos show the grid.*2: "):
        photinus.calibrate_camera([dark] * 3, (7, 5))
    with pytest.raises(photinus.CalibrationError):
        photinus.calibrate_camera([], (7, 5))
    with pytest.raises(photinus.CalibrationError, match="one size"):
        photinus.calibrate_camera([dark, dark[:100]], (7, 5))
    for wrong in ({"model": "fish"}, {"board": "bent"}, {"grid": (1, 1)}, {"pitch_m": -1.0}):
        with pytest.raises(photinus.SettingError):
            photinus.calibrate_camera(**{"photos": [dark], "grid": (7, 5), **wrong})  # type: ignore[arg-type]


def test_codes_are_what_they_claim() -> None:
    book = photinus.CodeBook.preset("l12-d3-r3")
    has = book.check()
    assert book.words.shape == (len(book), 12) and book.words.dtype == bool
    words = {tuple(np.roll(word, by)) for word in book.words for by in range(12)}
    assert len(words) == 12 * len(book)
    assert has.distance == 3 and max(has.longest_dark, has.longest_lit) == 3
    with pytest.raises(photinus.SettingError, match="there are l10-d3-r3"):
        photinus.CodeBook.preset("x")
    with pytest.raises(photinus.SettingError):
        photinus.CodeBook.design(8, 3, duty=(1, 0))
    with pytest.raises(photinus.CodeError):
        photinus.CodeBook.design(99, 3)


def test_evaluation_refuses_what_cannot_be_compared(records: list[photinus.Record]) -> None:
    with pytest.raises(photinus.EvaluationError):
        photinus.evaluate([], records)
    with pytest.raises(photinus.SettingError):
        photinus.evaluate(EXAMPLE, records, bins=[3, 2])
