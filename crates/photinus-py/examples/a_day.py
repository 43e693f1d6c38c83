"""A day with recordings, timed: spots, beside OpenCV and beside NumPy as one writes it; neighbours; a data frame.

python examples/a_day.py [--frames 1000]

Frames of a scene are rendered, twelve hexarotors, 752x480; every row is timed on the same frames in the same run.
OpenCV and pandas are used where they are installed.
"""

import argparse
import importlib
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import photinus

SCENE = Path(__file__).resolve().parents[3] / "scenes" / "swarm-12.toml"
# So many frames of the scene are seen again and again.
DISTINCT = 40
# Grey levels from which a pixel is bright to OpenCV and NumPy here.
THRESHOLD = 60

Image = NDArray[np.uint8]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--frames", type=int, default=1000, help="how many frames are searched for spots (1000)")
    count = parser.parse_args().frames

    print(f"{'import photinus, beyond NumPy':50} {1e3 * import_s():9.2f} ms")
    recording = photinus.simulate(SCENE, frames=DISTINCT)
    frames = list(recording)
    images = [frame.image for frame in frames]
    looks = [images[number % len(images)] for number in range(count)]
    noise = [np.random.default_rng(1).integers(0, 256, images[0].shape, np.uint8)] * 3
    airframe = recording.airframe
    assert airframe is not None
    detector, locator = photinus.Detector(), photinus.Locator(recording.camera, airframe)

    print(f"\n{count} frames, {images[0].shape[1]}x{images[0].shape[0]}, milliseconds for each")
    told("the largest pixel, by NumPy", np.max, looks)
    told("spots with covariances, by Photinus", detector.detect, looks)
    if cv2 := found("cv2"):
        told("threshold and components, by OpenCV", lambda image: components(cv2, image), looks)
    told("threshold and components, by NumPy", by_numpy, looks[: count // 20 + 1])
    records: list[photinus.Record] = []
    told(
        "neighbours, by Photinus",
        lambda frame: records.append(locator.locate(frame.image, gravity=frame.gravity)),
        frames,
    )
    told("spots in noise, by Photinus", detector.detect, noise)
    told("neighbours in noise, by Photinus", photinus.Locator(recording.camera, airframe).locate, noise)

    # pandas takes tables by PyArrow, which is imported here so that it is not timed
    if (pandas := found("pandas")) and found("pyarrow"):
        began = time.perf_counter()
        frame = pandas.DataFrame.from_arrow(photinus.neighbours_table(records))
        print(f"\na data frame of {len(frame)} neighbours in {1e3 * (time.perf_counter() - began):.2f} ms")
        print(frame[["distance_m", "distance_sigma_m", "distance_min_m", "distance_max_m"]].describe().round(3))


def told(what: str, do: Callable[[Any], Any], things: Sequence[Any]) -> None:
    """Does it with each thing, and says how long one takes."""
    began = time.perf_counter()
    for thing in things:
        do(thing)
    print(f"{what:50} {1e3 * (time.perf_counter() - began) / len(things):9.3f}", flush=True)


def found(module: str) -> Any:
    """A module, if it is installed."""
    try:
        return importlib.import_module(module)
    except ImportError:
        print(f"{module} is not installed: skipped")
        return None


def import_s() -> float:
    """How long the import takes in a fresh interpreter that has NumPy: the least of five."""
    program = "import numpy, time; b = time.perf_counter(); import photinus; print(time.perf_counter() - b)"
    return min(float(subprocess.check_output([sys.executable, "-c", program])) for _ in range(5))


def components(cv2: Any, image: Image) -> Any:
    """Centroids of bright regions, as OpenCV has them."""
    _, bright = cv2.threshold(image, THRESHOLD, 255, cv2.THRESH_BINARY)
    return cv2.connectedComponentsWithStats(bright)[3][1:]


def by_numpy(image: Image) -> list[tuple[float, float]]:
    """Centroids of bright regions, as one writes it in Python: bright pixels that touch, from one to the next."""
    left = {(int(v), int(u)) for v, u in zip(*np.nonzero(image > THRESHOLD), strict=True)}
    centroids = []
    while left:
        region = [left.pop()]
        for v, u in region:
            beside = {(v + dv, u + du) for dv in (-1, 0, 1) for du in (-1, 0, 1)} & left
            left -= beside
            region.extend(beside)
        weights = [int(image[place]) for place in region]
        centroids.append(
            (
                sum(weight * u for weight, (_, u) in zip(weights, region, strict=True)) / sum(weights),
                sum(weight * v for weight, (v, _) in zip(weights, region, strict=True)) / sum(weights),
            )
        )
    return centroids


if __name__ == "__main__":
    main()
