"""How far and how exactly a set-up sees: an airframe recedes in simulation while it turns, and each frame is located.

python examples/design_setup.py --arms 6 --radius 0.4
python examples/design_setup.py --arms 4 --leds-per-arm 2 --splay 90 --exposure 500
"""

import argparse
import tempfile
from pathlib import Path

import photinus

SCENES = Path(__file__).resolve().parents[3] / "scenes"

AIRFRAME = """\
name = "design"
ring = {{ arms = {arms}, radius_m = {radius}, leds_per_arm = {leds_per_arm}, splay_deg = {splay} }}
"""

SCENE = """\
name = "design"
preset = "bluefox-dsl215-bp365"
rate_hz = 10.0
duration_s = {duration_s}
exposure_us = {exposure}

[observer]
motion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}

[[camera]]
name = "front"
file = "{camera}"

[[target]]
id = 1
airframe = "airframe.toml"
motion = {{ line = {{ from_m = [2.0, 0.0, 5.3], to_m = [{farthest}, 0.5, 5.6], duration_s = {duration_s} }} }}
spin = [{{ start_s = 0.0, duration_s = {duration_s}, turns = 7.0 }}]
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--arms", type=int, default=6)
    parser.add_argument("--radius", type=float, default=0.4, help="of the LEDs, m")
    parser.add_argument("--leds-per-arm", type=int, default=1)
    parser.add_argument("--splay", type=float, default=0.0, help="between the two LEDs of an arm, deg")
    parser.add_argument("--exposure", type=float, default=1000.0, help="us")
    parser.add_argument("--camera", type=Path, default=SCENES / "cameras" / "bluefox-dsl215.toml")
    parser.add_argument("--farthest", type=float, default=20.0, help="m")
    parser.add_argument("--frames", type=int, default=200)
    args = parser.parse_args()

    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.toml"
        (Path(folder) / "airframe.toml").write_text(AIRFRAME.format(**vars(args)))
        options = {**vars(args), "camera": args.camera.resolve(), "duration_s": args.frames / 10}
        scene.write_text(SCENE.format(**options))
        simulation = photinus.simulate(scene)

    assert simulation.airframe is not None
    locator = photinus.Locator(simulation.camera, simulation.airframe)
    truth, records = [], []
    for frame in simulation:
        records.append(locator.locate(frame.image, gravity=frame.gravity, time=frame.time_s, frame=frame.frame))
        truth.append(frame.truth)

    scores = photinus.evaluate([was for was in truth if was], records, bins=[4, 6, 8, 10, 12, 15, 20])
    errors = {score["from_m"]: score["score"] for score in scores["distance"]["bins"]}
    print("   distance   found   distance error (RMS)")
    for part in scores["neighbours"]["bins"]:
        ends, found = f"{part['from_m']:.0f} to {part['to_m'] or args.farthest:.0f} m", part["score"]["recall"]
        error = errors.get(part["from_m"], {}).get("relative_error", {}).get("rms")
        told = "-" if error is None else f"{100 * error:.1f} %"
        print(f"{ends:>11}  {found or 0:6.0%}   {told:>20}")


if __name__ == "__main__":
    main()
