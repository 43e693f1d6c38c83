"""Tables: what pyarrow, pandas and Polars take is what the records and the program's CSV say, in the same memory."""

import gc
import json
from pathlib import Path
from typing import Any

import pytest

import photinus
from conftest import EXAMPLE, Program

pyarrow: Any = pytest.importorskip("pyarrow")
csv: Any = pytest.importorskip("pyarrow.csv")


def test_neighbours_are_the_programs_csv(program: Program, records: list[photinus.Record], tmp_path: Path) -> None:
    program("locate", EXAMPLE, "--csv", tmp_path / "r.csv", "-q")
    table = pyarrow.table(photinus.neighbours_table(records))
    theirs = csv.read_csv(
        tmp_path / "r.csv",
        convert_options=csv.ConvertOptions(column_types=table.schema, strings_can_be_null=True),
    )
    assert table.column_names == theirs.column_names
    for name in table.column_names:
        if name != "source":
            assert table[name].to_pylist() == theirs[name].to_pylist(), name


def test_a_row_per_neighbour_and_spot(records: list[photinus.Record]) -> None:
    table = pyarrow.table(photinus.neighbours_table(records))
    table.validate(full=True)
    neighbours = [n for record in records for n in record.neighbours]
    assert table["distance_m"].to_pylist() == [n.distance_m.estimate for n in neighbours]
    assert table["track"].to_pylist() == [n.track for n in neighbours] and table["id"].null_count == len(neighbours)
    spots = pyarrow.table(photinus.spots_table(records))
    spots.validate(full=True)
    assert spots["u_px"].to_pylist() == [spot.u_px for record in records for spot in record.spots]
    assert spots["spot"].to_pylist() == [k for record in records for k in range(len(record.spots))]


def test_nothing_makes_an_empty_table() -> None:
    table = pyarrow.table(photinus.neighbours_table([]))
    table.validate(full=True)
    assert table.num_rows == 0 and table.column_names == photinus.neighbours_table([]).column_names


def test_texts_of_any_kind_and_many_rows() -> None:
    sources = [f"Bild {k} é火" * (k % 3) for k in range(1000)]
    records = [
        photinus.Record.from_json(json.dumps({"frame": frame, "source": source, "spots": [{"u_px": 1, "v_px": 2}]}))
        for frame, source in enumerate(sources)
    ]
    table = pyarrow.table(photinus.spots_table(records))
    table.validate(full=True)
    assert table["source"].to_pylist() == sources
    assert table["time_s"].null_count == 1000 and table["frame"].to_pylist() == list(range(1000))


def test_memory_is_shared_and_outlives_the_table(records: list[photinus.Record]) -> None:
    table = photinus.neighbours_table(records)
    first, second = pyarrow.table(table), pyarrow.table(table)
    addresses = [t["x_m"].chunk(0).buffers()[1].address for t in (first, second)]
    assert addresses[0] == addresses[1]
    expected = first["x_m"].to_pylist()
    del table, second
    gc.collect()
    assert first["x_m"].to_pylist() == expected


def test_what_nobody_takes_is_released(records: list[photinus.Record]) -> None:
    """Streams that are dropped, schemas that are read alone, one column of many: nothing is lost or freed twice."""
    big = records * 2000
    table = photinus.neighbours_table(big)
    for _ in range(50):
        table.__arrow_c_stream__()
        assert len(pyarrow.schema(table)) == len(table.column_names)
        reader = pyarrow.RecordBatchReader.from_stream(table)
        column = reader.read_next_batch().column("y_m")
        reader.close()
        assert len(column) == len(table)
    stream = table.__arrow_c_stream__()
    reader = pyarrow.RecordBatchReader._import_from_c_capsule(stream)
    with pytest.raises(ValueError):
        pyarrow.RecordBatchReader._import_from_c_capsule(stream)  # it was taken already
    reader.close()


def test_tables_leave_no_memory_behind(records: list[photinus.Record]) -> None:
    def resident() -> int:
        with open("/proc/self/statm") as statm:
            return int(statm.read().split()[1]) * 4096

    big = records * 3000
    for _ in range(3):
        pyarrow.table(photinus.neighbours_table(big))
    before = resident()
    for _ in range(20):
        pyarrow.table(photinus.neighbours_table(big))
    grown, one = resident() - before, pyarrow.table(photinus.neighbours_table(big)).nbytes
    print(f"20 tables of {one / 2**20:.0f} MiB: {grown / 2**20:.1f} MiB more")
    assert grown < 3 * one


def test_pandas_and_polars_take_it(records: list[photinus.Record]) -> None:
    table = photinus.neighbours_table(records)
    expected = [n.distance_m.estimate for record in records for n in record.neighbours]
    polars = pytest.importorskip("polars")
    assert polars.DataFrame(table)["distance_m"].to_list() == expected
    pandas = pytest.importorskip("pandas")
    assert pandas.DataFrame.from_arrow(table)["distance_m"].tolist() == expected
