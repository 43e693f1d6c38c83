"""The same points through SciPy's least squares and OpenCV's fisheye: their cameras, as JSON.

Standard input: {"size": [w, h], "board": [[x, y, z], ...], "photos": [[[u, v], ...], ...],
                 "focal": [fx, fy], "centre": [u, v], "k": [k1, k2], "poses": [[rx, ry, rz, tx, ty, tz], ...]}
"""

import json
import sys

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

given = json.load(sys.stdin)
board = np.array(given["board"])
photos = np.array(given["photos"])
count = len(photos)


def predicted(x):
    fx, fy, cx, cy, k1, k2, shear = x[:7]
    poses = x[7:].reshape(count, 6)
    pixels = []
    for pose in poses:
        p = Rotation.from_rotvec(pose[:3]).apply(board) + pose[3:]
        flat = np.hypot(p[:, 0], p[:, 1])
        angle = np.arctan2(flat, p[:, 2])
        radius = angle + k1 * angle**3 + k2 * angle**5
        x_, y_ = radius * p[:, 0] / flat, radius * p[:, 1] / flat
        pixels.append(np.stack([fx * x_ + cx, fy * y_ + shear * x_ + cy], axis=1))
    return np.array(pixels)


start = np.concatenate([given["focal"], given["centre"], given["k"], [0.0], np.ravel(given["poses"])])
start[:2] *= 1.01
start[2:4] += 1.0
found = least_squares(lambda x: (predicted(x) - photos).ravel(), start, x_scale="jac", xtol=1e-12, ftol=1e-12)
mean = np.linalg.norm(predicted(found.x) - photos, axis=2).mean()
result = {"scipy": {"parameters": found.x[:7].tolist(), "mean_px": mean}}

try:
    import cv2

    camera = np.array([[given["focal"][0], 0, given["centre"][0]], [0, given["focal"][1], given["centre"][1]], [0, 0, 1.0]])
    objects = [board.reshape(1, -1, 3) for _ in photos]
    images = [photo.reshape(1, -1, 2) for photo in photos]
    flags = cv2.fisheye.CALIB_RECOMPUTE_EXTRINSIC | cv2.fisheye.CALIB_USE_INTRINSIC_GUESS
    k = np.array([given["k"][0], given["k"][1], 0.0, 0.0]).reshape(4, 1)
    rms, camera, k, _, _ = cv2.fisheye.calibrate(
        objects, images, tuple(given["size"]), camera, k, flags=flags, criteria=(3, 200, 1e-12)
    )
    result["opencv"] = {"focal": [camera[0, 0], camera[1, 1]], "centre": [camera[0, 2], camera[1, 2]], "rms_px": rms}
except Exception as error:  # no OpenCV, one without fisheye, or one whose start fails
    result["opencv_skipped"] = str(error).splitlines()[0] if str(error) else type(error).__name__

json.dump(result, sys.stdout)
