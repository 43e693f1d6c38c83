"""Locates the neighbours of a recording: a table of them, how good they are where truth is known, and two pictures.

python examples/locate_recording.py ../../examples/three-hexarotors --pictures seen
"""

import argparse
from pathlib import Path

import photinus


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("recording", type=Path, help="a dataset folder")
    parser.add_argument("--pictures", type=Path, help="a folder for pictures of the first frame; wants matplotlib")
    args = parser.parse_args()

    recording = photinus.Dataset.read(args.recording)
    locator = photinus.Locator(recording.camera, recording.airframes, recording)
    records = [
        locator.locate(frame.image, gravity=frame.gravity, time=frame.time_s, frame=frame.frame) for frame in recording
    ]
    for record in records:
        for neighbour in record.neighbours:
            told = neighbour.distance_m
            print(f"frame {record.frame}: {told.estimate:.3f} m, sigma {told.sigma:.3f} m, {told.min:.2f} m or more")

    # The same as a table: pandas.DataFrame.from_arrow(table), polars.DataFrame(table), pyarrow.table(table)
    table = photinus.neighbours_table(records)
    print(f"{len(table)} neighbours in {len(records)} frames")

    if recording.truth is not None:
        scores = photinus.evaluate(recording.truth, records)
        found, error = scores["neighbours"]["overall"], scores["distance"]["overall"]["relative_error"]
        print(f"found {found['recall']:.0%}, distance error {100 * error['rms']:.2f} % RMS")
    if args.pictures:
        draw(recording, records[0], args.pictures)


def draw(recording: photinus.Dataset, record: photinus.Record, folder: Path) -> None:
    from matplotlib import pyplot

    from photinus import plots

    folder.mkdir(parents=True, exist_ok=True)
    truth = recording.truth[0] if recording.truth else None
    plots.from_above(record, truth=truth)
    pyplot.savefig(folder / "from-above.png", dpi=150)
    plots.overlay(next(iter(recording)).image, record)
    pyplot.savefig(folder / "overlay.png", dpi=150)


if __name__ == "__main__":
    main()
