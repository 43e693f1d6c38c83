"""Many recordings on a cluster whose workers are killed: every result is there, once, as one machine makes it."""

import os
import random
import shutil
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from conftest import EXAMPLE, Program, without_source

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")
parquet = pytest.importorskip("pyarrow.parquet")
from photinus import fleet  # noqa: E402


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Two processes of one thread each; a recording may see many of them die."""
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 100}),
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Recordings of one to four frames of the example."""
    folder = tmp_path_factory.mktemp("flights")
    lines = (EXAMPLE / "frames.csv").read_text().splitlines(keepends=True)
    for number in range(24):
        flight = folder / f"day {number // 12}" / f"{number}"
        shutil.copytree(EXAMPLE, flight)
        (flight / "frames.csv").write_text("".join(lines[: 2 + number % 4]))
    return sorted(str(path.parent) for path in folder.glob("*/*/dataset.toml"))


def contents(out: Path) -> dict[str, bytes]:
    return {str(path.relative_to(out)): path.read_bytes() for path in sorted(out.rglob("*")) if path.is_file()}


def test_workers_are_killed_and_every_result_is_there_once(client: Any, recordings: list[str], tmp_path: Path) -> None:
    out, alone = tmp_path / "out", tmp_path / "alone"
    for recording in recordings:
        assert fleet.locate_recording(recording, str(alone)).error is None
    draw, over, killed = random.Random(1), threading.Event(), 0

    def kill() -> None:
        nonlocal killed
        while not over.wait(0.4) and killed < 4:
            pids = [nanny.pid for nanny in client.cluster.workers.values() if nanny.pid]
            if pids:
                os.kill(draw.choice(pids), signal.SIGKILL)
                killed += 1

    killer = threading.Thread(target=kill)
    killer.start()
    outcomes = list(fleet.locate(client, recordings, str(out)))
    over.set()
    killer.join()
    assert killed > 0, "nobody was killed: the test shows nothing"
    assert sorted(outcome.recording for outcome in outcomes) == recordings
    assert [outcome for outcome in outcomes if outcome.error] == []
    whole = {name: bytes for name, bytes in contents(out).items() if not name.endswith(".partial")}
    assert whole == contents(alone)

    again = list(fleet.locate(client, recordings, str(out)))
    assert all(outcome.done_before for outcome in again) and len(again) == len(recordings)
    table = parquet.read_table(out / "neighbours", filters=[("frame", "==", 0)])
    assert len(set(table.column("recording").to_pylist())) == len(recordings) and table.num_rows == 3 * len(recordings)


def test_a_bad_recording_costs_itself_alone(client: Any, recordings: list[str], tmp_path: Path) -> None:
    bad = tmp_path / "bad"
    bad.mkdir()
    (bad / "dataset.toml").write_text("nonsense")
    outcomes = {o.recording: o for o in fleet.locate(client, [*recordings[:2], str(bad)], str(tmp_path / "out"))}
    assert "dataset.toml, line 1" in (outcomes[str(bad)].error or "")
    assert all(outcomes[recording].error is None for recording in recordings[:2])
    with pytest.raises(ValueError, match="named twice"):
        list(fleet.locate(client, recordings[:1] * 2, str(tmp_path / "out")))


def test_results_are_those_of_the_program(program: Program, recordings: list[str], tmp_path: Path) -> None:
    program("locate", "-q", *recordings[:3], "--out-dir", tmp_path / "program", "--parquet")
    for recording in recordings[:3]:
        fleet.locate_recording(recording, str(tmp_path / "fleet"))
        theirs = Path(f"{tmp_path}/program{recording}.jsonl")
        ours = tmp_path / "fleet" / "results" / f"{fleet.name_of(recording)}.jsonl"
        assert ours.read_text().splitlines() == [without_source(line) for line in theirs.read_text().splitlines()]
        theirs_table = parquet.read_table(theirs.with_suffix(".parquet")).drop_columns("source")
        named = tmp_path / "fleet" / "neighbours" / f"recording={fleet.name_of(recording)}" / "part.parquet"
        assert parquet.ParquetFile(named).read().drop_columns("source") == theirs_table


def test_recordings_that_are_elsewhere(recordings: list[str], tmp_path: Path) -> None:
    import fsspec

    fsspec.filesystem("memory").put(recordings[0], "/flights/a", recursive=True)
    outcome = fleet.locate_recording("memory://flights/a", "memory://located")
    assert outcome.error is None and outcome.frames > 0
    fleet.locate_recording(recordings[0], str(tmp_path))
    theirs = fsspec.filesystem("memory").cat(f"/located/results/{fleet.name_of('memory://flights/a')}.jsonl")
    assert theirs == (tmp_path / "results" / f"{fleet.name_of(recordings[0])}.jsonl").read_bytes()
    assert fleet.locate_recording("memory://flights/a", "memory://located").done_before
