"""Pictures: what is drawn stands where the record says."""

from typing import Any

import numpy as np
import pytest

import photinus

matplotlib: Any = pytest.importorskip("matplotlib")
matplotlib.use("agg")


def test_the_view_from_above_holds_every_neighbour(records: list[photinus.Record], example: photinus.Dataset) -> None:
    from photinus import plots

    assert example.truth is not None
    axes: Any = plots.from_above(records[0], truth=example.truth[0], sigmas=3.0)
    ellipses = [patch for patch in axes.patches if hasattr(patch, "angle")]
    assert len(ellipses) == len(records[0].neighbours)
    for ellipse, neighbour in zip(ellipses, records[0].neighbours, strict=True):
        assert neighbour.position_m is not None and neighbour.position_covariance_m2 is not None
        assert np.allclose(ellipse.center, neighbour.position_m[[0, 2]])
        # every point of its edge is 3 sigma from its middle
        path = ellipse.get_patch_transform().transform(ellipse.get_path().vertices) - ellipse.center
        inverse = np.linalg.inv(neighbour.position_covariance_m2[np.ix_([0, 2], [0, 2])])
        sigmas = np.sqrt(np.einsum("ni,ij,nj->n", path, inverse, path))
        assert sigmas.min() == pytest.approx(3.0, rel=0.02)
    matplotlib.pyplot.close("all")


def test_the_overlay_frames_every_spot(records: list[photinus.Record], image: Any) -> None:
    from photinus import plots

    axes: Any = plots.overlay(image, records[0])
    assert len(axes.patches) == len(records[0].spots)
    assert len(axes.texts) == len(records[0].neighbours)
    axes.figure.canvas.draw()
    for patch, spot in zip(axes.patches, records[0].spots, strict=True):
        assert patch.contains_point(axes.transData.transform((spot.u_px, spot.v_px)))
    matplotlib.pyplot.close("all")
