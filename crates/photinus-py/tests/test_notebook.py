"""The notebook runs, and tells what it told when its pictures were made."""

import re
from pathlib import Path
from typing import Any

import pytest

NOTEBOOK = Path(__file__).resolve().parents[1] / "examples" / "first_look.ipynb"
nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")


def told(notebook: Any) -> str:
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    return "".join(output["text"] for output in outputs if output["output_type"] == "stream")


def pictures(notebook: Any) -> int:
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    return sum("image/png" in output.get("data", {}) for output in outputs)


def test_the_notebook() -> None:
    pytest.importorskip("ipykernel")
    pytest.importorskip("matplotlib")
    shipped, run = nbformat.read(NOTEBOOK, 4), nbformat.read(NOTEBOOK, 4)
    for cell in run.cells:
        cell.get("outputs", []).clear()
    nbclient.NotebookClient(run, timeout=300, resources={"metadata": {"path": str(NOTEBOOK.parent)}}).execute()
    assert pictures(run) == pictures(shipped) == 3
    numbers = [[float(number) for number in re.findall(r"\d+\.?\d*", told(notebook))] for notebook in (run, shipped)]
    # Whoever makes neighbours tell something else runs the notebook anew: `just notebook`.
    assert numbers[0] == pytest.approx(numbers[1], rel=0.3, abs=0.05)
