"""Calibrates a camera from photos of a flat grid of LEDs; without photos, from simulated ones, whose camera is known.

python examples/calibrate_camera.py photos/*.png --grid 7 5 --out camera.toml
python examples/calibrate_camera.py
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import photinus

SCENES = Path(__file__).resolve().parents[3] / "scenes"

# A board that somebody carries about in front of the camera, held still for each photo.
SCENE = """\
name = "photos-of-a-board"
preset = "small-fisheye-960x600"
rate_hz = 1.0
duration_s = {photos}.0
exposure_us = 1400.0

[observer]
motion = {{ hover = {{ position_m = [0.0, 0.0, 0.0] }} }}

[[camera]]
name = "front"
file = "{scenes}/cameras/small-fisheye-960x600.toml"

[[target]]
id = 1
airframe = "{scenes}/airframes/led-board-7x5.toml"
motion = {{ recorded = {{ file = "poses.csv" }} }}
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("photos", nargs="*", type=Path)
    parser.add_argument("--grid", nargs=2, type=int, default=(7, 5), metavar=("COLUMNS", "ROWS"))
    parser.add_argument("--pitch", type=float, default=0.05, help="between neighbouring LEDs, m")
    parser.add_argument("--model", default="kannala-brandt:2", help="auto compares all of them, which takes longer")
    parser.add_argument("--out", type=Path, help="where to write the camera")
    args = parser.parse_args()

    simulation = None if args.photos else simulated_photos()
    photos = args.photos or [frame.image for frame in simulation or ()]
    columns, rows = args.grid
    calibrated = photinus.calibrate_camera(photos, (columns, rows), args.pitch, model=args.model)

    print(f"{calibrated.photos_used} of {len(photos)} photos used; LEDs are {calibrated.mean_px:.3f} px off on average")
    for name, reason in calibrated.refused.items():
        print(f"photo {name} was not used: {reason}")
    for warning in calibrated.warnings:
        print(f"doubtful: {warning}")
    if simulation:
        print(f"bearings are off by {off_mrad(calibrated.camera, simulation.camera):.2f} mrad, median")
    if args.out:
        calibrated.write(args.out)


def simulated_photos(photos: int = 20) -> photinus.Simulation:
    """Photos of the board near and far, all over the image, tilted."""
    random = np.random.default_rng(3)
    with tempfile.TemporaryDirectory() as folder:
        lines = ["time_s,x_m,y_m,z_m,qx,qy,qz,qw"]
        for second in range(photos):
            azimuth, elevation = random.uniform(-0.9, 0.9), random.uniform(-0.5, 0.5)
            level = np.cos(elevation)
            away = np.array([np.cos(azimuth) * level, np.sin(azimuth) * level, np.sin(elevation)])
            place = random.uniform(0.35, 0.9) * away
            tilts = random.uniform(-0.5, 0.5, 3)
            pose = [*place, *facing(azimuth + np.pi + tilts[0], elevation + tilts[1], tilts[2])]
            for time_s in (second, second + 0.9):
                lines.append(",".join(map(str, [time_s, *pose])))
        (Path(folder) / "poses.csv").write_text("\n".join(lines) + "\n")
        scene = Path(folder) / "scene.toml"
        scene.write_text(SCENE.format(photos=photos, scenes=SCENES))
        return photinus.simulate(scene)


def facing(yaw: float, pitch: float, roll: float) -> NDArray[np.float64]:
    """Rz(yaw) Ry(pitch) Rx(roll) as x, y, z, w."""
    (cy, cp, cr), (sy, sp, sr) = np.cos([yaw / 2, pitch / 2, roll / 2]), np.sin([yaw / 2, pitch / 2, roll / 2])
    return np.array(
        [
            cy * cp * sr - sy * sp * cr,
            cy * sp * cr + sy * cp * sr,
            sy * cp * cr - cy * sp * sr,
            cy * cp * cr + sy * sp * sr,
        ]
    )


def off_mrad(camera: photinus.Camera, truth: photinus.Camera) -> float:
    """Median angle between the bearings of two cameras, mrad, but for a turn that is common to all of them."""
    u, v = np.meshgrid(np.arange(150, camera.width_px - 150, 20), np.arange(100, camera.height_px - 100, 20))
    pixels = np.column_stack([u.ravel(), v.ravel()])
    ours, theirs = camera.bearings(pixels), truth.bearings(pixels)
    known = np.isfinite(ours).all(axis=1) & np.isfinite(theirs).all(axis=1)
    left, _, right = np.linalg.svd(theirs[known].T @ ours[known])
    turned = ours[known] @ (left @ right).T
    return float(1e3 * np.median(np.linalg.norm(turned - theirs[known], axis=1)))


if __name__ == "__main__":
    main()
