"""Many small recordings on a Dask cluster of this machine, whose workers are killed, beside a plain loop.

python examples/fleet_on_this_machine.py --recordings 200 --processes 2 4 --kill-every 3
"""

import argparse
import os
import random
import signal
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import dask
import distributed
import numpy as np

import photinus
from photinus import fleet

ROOT = Path(__file__).resolve().parents[3]

# What a recording of ten minutes at 60 Hz takes, times so many recordings, on so many cores.
COST_FRAMES, COST_RECORDINGS, COST_CORES = 36_000, 100_000, (2, 64, 1024)

# Dask's workers give memory back at every chance, and each frame's is new: a fifth slower. Bytes from which they do.
KEPT = {
    "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": 2**26,
    "distributed.nanny.pre-spawn-environ.MALLOC_MMAP_THRESHOLD_": 2**25,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--recordings", type=int, default=200)
    parser.add_argument("--frames", type=int, default=8, help="of each recording")
    parser.add_argument("--processes", type=int, nargs="+", default=[2, 4])
    parser.add_argument("--kill-every", type=float, default=3.0, help="s; 0: nobody is killed")
    args = parser.parse_args()

    with tempfile.TemporaryDirectory(prefix="photinus-fleet-") as folder:
        recordings = [record(Path(folder) / f"{number:04}", number, args.frames) for number in range(args.recordings)]
        began = time.perf_counter()
        for recording in recordings:
            fleet.locate_recording(recording, f"{folder}/alone")
        alone_s = time.perf_counter() - began
        frames = args.recordings * args.frames
        print(f"{args.recordings} recordings of {args.frames} frames, {os.cpu_count()} cores")
        print(f"a plain loop: {alone_s:.1f} s, {1e3 * alone_s / frames:.1f} ms a frame")
        for processes in args.processes:
            cluster(processes, 0.0, recordings, folder, alone_s)
            if args.kill_every > 0:
                cluster(processes, args.kill_every, recordings, folder, alone_s)
    print(
        f"\n{COST_RECORDINGS:,} recordings of {COST_FRAMES:,} frames, if each took as long (short ones mostly begin):"
    )
    for cores in COST_CORES:
        hours = alone_s / frames * COST_FRAMES * COST_RECORDINGS / cores / 3600
        print(f"{cores:>6} cores: {hours:12,.0f} h, {hours * cores:,.0f} core hours")


def record(folder: Path, seed: int, frames: int) -> str:
    """A recording of the scene of two robots that cross, its frames as PGM."""
    (folder / "images").mkdir(parents=True)
    rows = ["frame,time_s,image,gx,gy,gz"]
    for frame in photinus.simulate(ROOT / "scenes" / "crossing.toml", frames=frames, seed=seed):
        name, image = f"images/{frame.frame:06}.pgm", np.asarray(frame.image)
        (folder / name).write_bytes(b"P5 %d %d 255\n" % image.shape[::-1] + image.tobytes())
        x, y, z = frame.gravity or (0.0, 1.0, 0.0)
        rows.append(f"{frame.frame},{frame.time_s},{name},{x},{y},{z}")
    (folder / "frames.csv").write_text("\n".join(rows) + "\n")
    for name, source in [
        ("camera.toml", ROOT / "scenes" / "cameras" / "bluefox-dsl215.toml"),
        ("airframe.toml", ROOT / "scenes" / "airframes" / "hexarotor-0.4.toml"),
    ]:
        (folder / name).write_text(source.read_text())
    table = 'camera = "camera.toml"\nairframe = "airframe.toml"\nexposure_us = 1000.0\nrate_hz = 60.0\n'
    (folder / "dataset.toml").write_text(table)
    return str(folder)


def cluster(processes: int, kill_every_s: float, recordings: list[str], folder: str, alone_s: float) -> None:
    """Locates all on so many processes of one thread each and compares every file with that of the plain loop."""
    out = f"{folder}/{processes}-{kill_every_s}"
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 100, **KEPT}),
        distributed.LocalCluster(n_workers=processes, threads_per_worker=1, dashboard_address=None) as workers,
        distributed.Client(workers) as client,
    ):
        over, killed = threading.Event(), [0]
        killer = threading.Thread(target=kill, args=(client, kill_every_s, over, killed))
        if kill_every_s > 0:
            killer.start()
        began = time.perf_counter()
        outcomes = list(fleet.locate(client, recordings, out))
        took_s = time.perf_counter() - began
        over.set()
        if kill_every_s > 0:
            killer.join()
    assert sorted(outcome.recording for outcome in outcomes) == sorted(recordings), "one is missing, or there twice"
    assert not [outcome.error for outcome in outcomes if outcome.error]
    assert contents(Path(out)) == contents(Path(folder) / "alone"), "another result than that of the plain loop"
    speed = alone_s / took_s
    print(
        f"{processes} processes, {killed[0]} killed: {took_s:.1f} s, {speed:.2f} times the loop, "
        f"{speed / min(processes, os.cpu_count() or 1):.2f} of what the cores could; all there, once, identical"
    )


def kill(client: Any, every_s: float, over: threading.Event, killed: list[int]) -> None:
    """Kills a random worker now and then; Dask starts another in its place."""
    draw = random.Random(1)
    while not over.wait(every_s):
        pids = [nanny.pid for nanny in client.cluster.workers.values() if nanny.pid]
        if pids:
            os.kill(draw.choice(pids), signal.SIGKILL)
            killed[0] += 1


def contents(out: Path) -> dict[str, bytes]:
    """Every whole file of a folder of results."""
    files = (path for path in out.rglob("*") if path.is_file() and path.suffix != ".partial")
    return {str(path.relative_to(out)): path.read_bytes() for path in files}


if __name__ == "__main__":
    main()
