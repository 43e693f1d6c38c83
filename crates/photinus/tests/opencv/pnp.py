"""Poses by OpenCV, for the test beside this file.

Standard input, a line per view: the number of points n, then x y z (body, m) and x/z y/z (camera) for each.
Standard output, a line per view: the poses, each as a rotation vector (rad) and a translation (m); those of
solveP3P for three points, of solvePnP by SQPNP and refined iteratively for more. None where OpenCV refuses.
"""

import sys

import cv2
import numpy as np


def poses(points, image):
    camera = np.eye(3)
    if len(points) == 3:
        _, turns, shifts = cv2.solveP3P(points, image, camera, None, flags=cv2.SOLVEPNP_P3P)
        return list(zip(turns, shifts))
    try:
        _, turn, shift = cv2.solvePnP(points, image, camera, None, flags=cv2.SOLVEPNP_SQPNP)
    except cv2.error:
        return []
    refined = cv2.solvePnPRefineLM(points, image, camera, None, turn.copy(), shift.copy())
    return [(turn, shift), refined]


for line in sys.stdin.read().splitlines():
    numbers = np.array(line.split(), float)
    rows = numbers[1:].reshape(int(numbers[0]), 5)
    answer = poses(rows[:, :3].copy(), rows[:, 3:].copy().reshape(-1, 1, 2))
    print(*[repr(float(x)) for turn, shift in answer for x in [*np.ravel(turn), *np.ravel(shift)]])
