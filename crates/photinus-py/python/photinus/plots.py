"""Pictures of records by matplotlib: a view from above, and an overlay on the frame. Install with photinus[plots].

Both draw into the axes that are given, or into new ones, and hand them back: titles, limits and files are the caller's.
"""

from __future__ import annotations

import numpy as np
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.patches import Ellipse, Rectangle
from numpy.typing import NDArray

from photinus import Neighbour, Record, Truth

__all__ = ["from_above", "overlay"]

_RIGHT_FORWARD = [0, 2]


def from_above(record: Record, *, truth: Truth | None = None, sigmas: float = 2.0, axes: Axes | None = None) -> Axes:
    """Neighbours in the camera's plane of x (right) and z (forward), m: each with the ellipse of its covariance at so
    many sigmas, and the strict bounds of its distance as a line. `truth` is drawn as crosses.

    Neighbours of which only bounds are known have no ellipse; where nothing bounds the distance, the line is dotted
    and ends at 1.5 times its beginning.
    """
    axes = axes or _new_axes()
    axes.plot(0, 0, marker="^", color="black")
    for number, neighbour in enumerate(record.neighbours):
        _from_above(axes, neighbour, f"C{number % 10}", sigmas)
    for was in truth.neighbours if truth else ():
        axes.plot(*was.position_m[_RIGHT_FORWARD], marker="+", color="black", markersize=10)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x, right (m)")
    axes.set_ylabel("z, forward (m)")
    axes.autoscale_view()
    return axes


def overlay(image: NDArray[np.uint8], record: Record, *, axes: Axes | None = None) -> Axes:
    """The frame with its spots as boxes in the colour of their neighbour, the distance of each neighbour with its sigma
    and bounds, and what was rejected as grey crosses."""
    axes = axes or _new_axes()
    axes.imshow(image, cmap="gray", vmin=0, vmax=255)
    for rejected in record.rejected:
        axes.plot(rejected.u_px, rejected.v_px, marker="x", color="grey")
    colours = dict.fromkeys(range(len(record.spots)), "white")
    for number, neighbour in enumerate(record.neighbours):
        colours.update(dict.fromkeys(neighbour.spots, f"C{number % 10}"))
        highest = min((record.spots[index] for index in neighbour.spots), key=lambda spot: spot.v_px)
        label, place = _distance(neighbour), (highest.u_px, highest.v_px - 6)
        axes.annotate(label, place, color=f"C{number % 10}", ha="center", va="bottom", fontsize="small")
    for index, spot in enumerate(record.spots):
        left, top, right, bottom = spot.extent_px or (*spot.middle_px, *spot.middle_px)
        corner, width, height = (left - 1.5, top - 1.5), right - left + 3, bottom - top + 3
        axes.add_patch(Rectangle(corner, width, height, fill=False, color=colours[index]))
    axes.set_xlim(-0.5, image.shape[1] - 0.5)
    axes.set_ylim(image.shape[0] - 0.5, -0.5)
    return axes


def _new_axes() -> Axes:
    return pyplot.subplots(layout="constrained")[1]


def _from_above(axes: Axes, neighbour: Neighbour, colour: str, sigmas: float) -> None:
    bounds = neighbour.distance_m
    ends = np.array([bounds.min, bounds.max or 1.5 * bounds.min])
    towards = neighbour.bearing[_RIGHT_FORWARD]
    axes.plot(*np.outer(towards, ends), color=colour, linewidth=1, linestyle="-" if bounds.max else ":")
    if neighbour.position_m is None or neighbour.position_covariance_m2 is None:
        return
    place = neighbour.position_m[_RIGHT_FORWARD]
    covariance = neighbour.position_covariance_m2[np.ix_(_RIGHT_FORWARD, _RIGHT_FORWARD)]
    variances, directions = np.linalg.eigh(covariance)
    width, height = 2 * sigmas * np.sqrt(np.maximum(variances, 0))
    turned_deg = float(np.degrees(np.arctan2(directions[1, 0], directions[0, 0])))
    middle = (float(place[0]), float(place[1]))
    axes.add_patch(Ellipse(middle, width, height, angle=turned_deg, facecolor=colour, alpha=0.3, edgecolor=colour))
    axes.plot(*place, marker=".", color=colour)
    label = neighbour.airframe if neighbour.id is None else str(neighbour.id)
    axes.annotate(label, middle, (8, 4), textcoords="offset points", color=colour)


def _distance(neighbour: Neighbour) -> str:
    told = neighbour.distance_m
    bounds = f"{told.min:.1f} to {told.max:.1f} m" if told.max else f"{told.min:.1f} m or more"
    return bounds if told.estimate is None else f"{told.estimate:.2f} ± {told.sigma:.2f} m\n({bounds})"
