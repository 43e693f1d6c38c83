"""What is no frame is refused by name, and a frame is borrowed, not copied."""

import re
import threading
import time
import tracemalloc
from typing import Any

import numpy as np
import pytest

import photinus

WRONG: dict[str, tuple[Any, str]] = {
    "another type of pixel": (np.zeros((480, 752), np.uint16), r"pixels are uint16: give uint8, 0 to 255"),
    "floats": (np.zeros((480, 752)), r"pixels are float64"),
    "truth values": (np.zeros((480, 752), bool), r"pixels are bool"),
    "signed bytes": (np.zeros((480, 752), np.int8), r"pixels are int8"),
    "objects": (np.full((480, 752), None), r"pixels are object"),
    "colour": (np.zeros((480, 752, 3), np.uint8), r"shape \[480, 752, 3\]"),
    "one row of numbers": (np.zeros(752, np.uint8), r"shape \[752\]"),
    "a number": (np.array(3, np.uint8), r"shape \[\]"),
    "another size": (np.zeros((480, 640), np.uint8), r"the frame is 640x480, the camera 752x480"),
    "rows and columns swapped": (np.zeros((752, 480), np.uint8), r"the frame is 480x752"),
    "no rows": (np.zeros((0, 752), np.uint8), r"752x0"),
    "no columns": (np.zeros((480, 0), np.uint8), r"0x480"),
    "rows backwards": (np.zeros((480, 752), np.uint8)[::-1], r"negative strides"),
    "columns backwards": (np.zeros((480, 752), np.uint8)[:, ::-1], r"negative strides"),
    "Fortran order": (np.zeros((480, 752), np.uint8, order="F"), r"Fortran order"),
    "a channel of colour": (np.zeros((480, 752, 3), np.uint8)[:, :, 0], r"not side by side"),
    "every second column": (np.zeros((480, 1504), np.uint8)[:, ::2], r"not side by side"),
    "one row for all": (np.broadcast_to(np.zeros(752, np.uint8), (480, 752)), r"rows overlap"),
    "a list": ([[0] * 752] * 480, r"not list"),
    "nothing": (None, r"not NoneType"),
    "bytes": (bytes(752 * 480), r"not bytes"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_frame_is_refused_by_name(locator: photinus.Locator, name: str) -> None:
    image, words = WRONG[name]
    with pytest.raises(photinus.ImageError, match=words):
        locator.locate(image)


def test_an_error_says_what_to_do() -> None:
    with pytest.raises(photinus.ImageError, match=re.escape("give numpy.ascontiguousarray(image)")):
        photinus.detect(np.zeros((480, 752), np.uint8, order="F"))
    with pytest.raises(photinus.PhotinusError):
        photinus.detect(np.zeros((4, 40_000), np.uint8))


@pytest.mark.parametrize("shape", [(1, 1), (1, 752), (480, 1), (2, 2)])
def test_small_images_are_images(shape: tuple[int, int]) -> None:
    """A single row or column is in every order at once."""
    assert photinus.detect(np.zeros(shape, np.uint8)).spots == ()
    if 1 in shape:
        assert photinus.detect(np.zeros(shape, np.uint8, order="F")).spots == ()


def test_padded_rows_are_read_in_place(image: Any) -> None:
    padded = np.full((482, 800), 255, np.uint8)
    crop = padded[1:481, 20:772]
    crop[:] = image
    assert photinus.detect(crop).to_json() == photinus.detect(image).to_json()
    crop.flags.writeable = False
    assert photinus.detect(crop).to_json() == photinus.detect(image).to_json()


def test_the_frame_is_not_copied() -> None:
    """A gigabyte of frame, of which the system gives pages only where they are written, makes the process no larger."""
    image = np.zeros((32_000, 32_000), np.uint8)
    photinus.detect(image[:480, :752])
    before = peak_bytes()
    tracemalloc.start()
    photinus.detect(image)
    traced = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    grown = peak_bytes() - before
    print(f"a frame of {image.nbytes >> 20} MiB: peak grew by {grown >> 20} MiB, Python's by {traced} bytes")
    # Pages of zeros that are read are all one page: a copy would have its own.
    assert grown < image.nbytes / 2 and traced < 1e6


def peak_bytes() -> int:
    with open("/proc/self/status") as status:
        (line,) = [line for line in status if line.startswith("VmHWM")]
    return int(line.split()[1]) * 1024


def test_other_threads_run_meanwhile(locator: photinus.Locator, image: Any) -> None:
    """While one thread waits inside of a call, another one goes on."""
    noise = np.random.default_rng(1).integers(0, 256, (4000, 4000), np.uint8)
    counted, done = 0, threading.Event()

    def work() -> None:
        photinus.detect(noise)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        counted += 1
        time.sleep(0)
    thread.join()
    print(f"another thread went round {counted} times meanwhile")
    assert counted > 10


def test_threads_may_share_a_locator(locator: photinus.Locator, image: Any) -> None:
    alone = photinus.Locator(locator.camera, locator.airframe)
    for _ in range(3):
        expected = alone.locate(image).to_json()
    found: list[str] = []
    threads = [
        threading.Thread(target=lambda: found.extend(locator.locate(image).to_json() for _ in range(5)))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 20
    assert {len(photinus.Record.from_json(text).neighbours) for text in found} == {
        len(photinus.Record.from_json(expected).neighbours)
    }


def test_overhead_of_a_call_is_told(image: Any) -> None:
    """Printed, not asserted: a frame of one pixel is all call and no work."""
    dot, detector, rounds = np.zeros((1, 1), np.uint8), photinus.Detector(), 20_000
    began = time.perf_counter()
    for _ in range(rounds):
        detector.detect(dot)
    each = (time.perf_counter() - began) / rounds
    print(f"a call on a frame of one pixel: {each * 1e6:.2f} us")
