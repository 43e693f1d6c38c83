"""The same points through SciPy's least squares or OpenCV's fisheye: the camera, as JSON.

Argument: "scipy" or "opencv".
Standard input: {"size": [w, h], "board": [[x, y, z], ...], "photos": [[[u, v], ...], ...],
                 "focal": [fx, fy], "centre": [u, v], "k": [k1, k2], "poses": [[rx, ry, rz, tx, ty, tz], ...]}
Standard output: {"focal": [fx, fy], "centre": [u, v], "k": [k1, k2], "rms_px": r}, r over the photos' points.
"""

import json
import sys

import numpy as np


def by_scipy(given, board, photos):
    from scipy.optimize import least_squares
    from scipy.spatial.transform import Rotation

    def predicted(x):
        fx, fy, cx, cy, k1, k2, shear = x[:7]
        pixels = []
        for pose in x[7:].reshape(len(photos), 6):
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
    rms = np.sqrt((np.linalg.norm(predicted(found.x) - photos, axis=2) ** 2).mean())
    return {"focal": list(found.x[:2]), "centre": list(found.x[2:4]), "k": list(found.x[4:6]), "rms_px": rms}


def by_opencv(given, board, photos):
    import cv2

    start = np.array([[given["focal"][0] * 1.01, 0, given["centre"][0] + 1.0],
                      [0, given["focal"][1] * 1.01, given["centre"][1] + 1.0],
                      [0, 0, 1.0]])
    # A row of points: version 5 takes nothing else.
    objects = [board.reshape(1, -1, 3) for _ in photos]
    images = [photo.reshape(1, -1, 2) for photo in photos]
    # Version 5 has the flags outside the module.
    flag = lambda name: getattr(cv2.fisheye, name, None) or getattr(cv2, name)
    names = ["CALIB_RECOMPUTE_EXTRINSIC", "CALIB_USE_INTRINSIC_GUESS", "CALIB_FIX_SKEW", "CALIB_FIX_K3", "CALIB_FIX_K4"]
    k = np.array([given["k"][0], given["k"][1], 0.0, 0.0])
    rms, camera, k, _, _ = cv2.fisheye.calibrate(
        objects, images, tuple(given["size"]), start, k, flags=sum(map(flag, names)), criteria=(3, 500, 1e-14)
    )
    k = np.ravel(k)
    return {"focal": [camera[0, 0], camera[1, 1]], "centre": [camera[0, 2], camera[1, 2]], "k": list(k[:2]), "rms_px": rms}


given = json.load(sys.stdin)
method = {"scipy": by_scipy, "opencv": by_opencv}[sys.argv[1]]
json.dump(method(given, np.array(given["board"]), np.array(given["photos"])), sys.stdout)
