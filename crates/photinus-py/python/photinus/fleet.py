"""Many recordings on many machines, by Dask: each is located by itself, wherever a core is free, as on one machine.

    client = distributed.Client("tcp://scheduler:8786")
    for outcome in fleet.locate(client, ["s3://flights/a", "s3://flights/b"], "s3://flights/located"):
        print(outcome)

Recordings are dataset folders of one camera; they and the results live wherever fsspec reads and writes. OUT gets, for
each recording,

    OUT/neighbours/recording=NAME/part.parquet   a row per neighbour, by the columns of the CSV table
    OUT/results/NAME.jsonl                       everything, a line per frame

The tables are one for DuckDB, Polars, pandas and Spark, with a column `recording`; NAME is the recording's address,
quoted. The second file is written last: where it is, the recording is done and not done again, so that the same call
goes on after whatever happened. A worker that dies costs the recording it was at, which another one does.
Wants `pip install photinus[fleet]`.
"""

import itertools
import posixpath
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote
from uuid import uuid4

import distributed
import fsspec
import pyarrow
from pyarrow import parquet

import photinus

# Frames whose neighbours are a group of rows, and all that is kept in memory.
GROUP_FRAMES = 1024


@dataclass(frozen=True)
class Outcome:
    """What became of a recording; `error` says why it has no results."""

    recording: str
    frames: int = 0
    failed_frames: int = 0
    done_before: bool = False
    error: str | None = None


def locate(
    client: distributed.Client, recordings: Sequence[str], out: str, *, retries: int = 2, **options: Any
) -> Iterator[Outcome]:
    """Locates every recording into the folder `out` and tells of each as it is done.

    `options` are those of photinus.Locator; `retries`: how often a recording is tried again after what is no error of
    Photinus, such as a lost connection. Raises ValueError for a recording that is named twice.
    """
    if len(set(recordings)) < len(recordings):
        raise ValueError("a recording is named twice: name each once")
    there = _names_in(f"{out}/results")
    waiting = []
    for recording in recordings:
        if f"{name_of(recording)}.jsonl" in there:
            yield Outcome(recording, done_before=True)
        else:
            waiting.append(recording)
    tasks = client.map(locate_recording, waiting, out=out, options=options, pure=False, retries=retries)
    recording_of = {task.key: recording for task, recording in zip(tasks, waiting, strict=True)}
    for task in distributed.as_completed(tasks):
        yield _told(task, recording_of[task.key])


def locate_recording(recording: str, out: str, options: dict[str, Any] | None = None) -> Outcome:
    """Locates one recording into the folder `out`, unless that was done: what each task of `locate` does."""
    name = name_of(recording)
    results, path = fsspec.core.url_to_fs(f"{out}/results/{name}.jsonl")
    if results.exists(path):
        return Outcome(recording, done_before=True)
    with tempfile.TemporaryDirectory(prefix="photinus-") as folder:
        lines, table = Path(folder) / "results.jsonl", Path(folder) / "part.parquet"
        try:
            source = _fetched(recording, Path(folder))
            frames, failed = _located(source, options or {}, lines, table)
        except photinus.PhotinusError as error:
            return Outcome(recording, error=str(error))
        if frames == 0:
            return Outcome(recording, failed_frames=failed, error=f"{recording}: it has no frame that could be used")
        _put(table, f"{out}/neighbours/recording={name}/part.parquet")
        _put(lines, f"{out}/results/{name}.jsonl")
    return Outcome(recording, frames=frames, failed_frames=failed)


def name_of(recording: str) -> str:
    """The recording's address as one part of a path."""
    return quote(recording.rstrip("/"), safe="")


def _located(folder: Path, options: dict[str, Any], lines: Path, table: Path) -> tuple[int, int]:
    """Writes what is in each frame; how many frames were used, and how many could not be."""
    failed = 0

    def records() -> Iterator[photinus.Record]:
        nonlocal failed
        recording = photinus.Dataset.read(folder)
        locator = photinus.Locator(recording.camera, recording.airframes, recording, **options)
        frames = iter(recording)
        while True:
            try:
                frame = next(frames)
                record = locator.locate(frame.image, gravity=frame.gravity, time=frame.time_s, frame=frame.frame)
            except StopIteration:
                return
            except photinus.PhotinusError:
                failed += 1
                continue
            yield record

    done, schema = 0, pyarrow.table(photinus.neighbours_table([])).schema
    with lines.open("w", encoding="utf-8") as text, parquet.ParquetWriter(table, schema) as rows:
        source = records()
        while group := list(itertools.islice(source, GROUP_FRAMES)):
            done += len(group)
            text.writelines(f"{record.to_json()}\n" for record in group)
            rows.write_table(pyarrow.table(photinus.neighbours_table(group)))
    return done, failed


def _fetched(recording: str, folder: Path) -> Path:
    """The recording's folder on this machine: itself, or a copy in `folder`."""
    files, path = fsspec.core.url_to_fs(recording)
    if _is_local(files):
        return Path(path)
    files.get(path, str(folder / "recording"), recursive=True)
    return folder / "recording"


def _put(file: Path, url: str) -> None:
    """Copies a file to where it has its name when it is whole: by a rename, or by the store itself."""
    files, path = fsspec.core.url_to_fs(url)
    if not _is_local(files):
        files.put_file(str(file), path)
        return
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(f".{uuid4().hex}.partial")
    shutil.copyfile(file, part)
    part.replace(target)


def _names_in(folder: str) -> set[str]:
    """The names of the files in a folder that need not be there."""
    files, path = fsspec.core.url_to_fs(folder)
    try:
        return {posixpath.basename(name) for name in files.ls(path, detail=False)}
    except FileNotFoundError:
        return set()


def _is_local(files: Any) -> bool:
    return "file" in files.protocol


def _told(task: distributed.Future, recording: str) -> Outcome:
    """The outcome of a task that is over."""
    if task.status != "finished":
        return Outcome(recording, error=repr(task.exception()))
    outcome = task.result()
    assert isinstance(outcome, Outcome)
    return outcome
