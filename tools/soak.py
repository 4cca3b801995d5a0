#!/usr/bin/env python3
"""Maps hours of robots that drive about in a fixed building, and tells how resident memory grows.

    tools/soak.py [--robots 10] [--hours 6] [--most 1.0] [--build DIR] [--keep DIR]

The run is simulated (isthmus-simulate --scenario floor; scans once a second) and replayed with the memory sampled by
minutes of event time (isthmus-replay --memory). The growth is the slope of a line through the last half.
"""

import argparse
import csv
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def simulate(arguments, log):
    seconds = 3600 * arguments.hours  # at 0.5 m/s at most, the tours are long enough
    settings = [f"floor.robots={arguments.robots}", f"floor.area_m2={arguments.area}", f"floor.tour_m={seconds}",
                "laser.rate_hz=1", "odometry.rate_hz=4", f"camera.rate_hz={arguments.camera_rate}",
                f"duration_s={seconds}"]
    overrides = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([os.path.join(arguments.build, "bin", "isthmus-simulate"), "--scenario", "floor", "--seed",
                    str(arguments.seed), "-o", log, *overrides], check=True)


def slope(points):
    """Of the line through points (x, y) with the least squares."""
    mean_x, mean_y = (sum(values) / len(points) for values in zip(*points))
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=10)
    parser.add_argument("--hours", type=float, default=6)
    parser.add_argument("--area", type=float, default=1000, help="of the building, square metres")
    parser.add_argument("--camera-rate", type=float, default=0.2, help="looks for barcodes a second")
    parser.add_argument("--most", type=float, default=1.0, help="MB an hour; more is a failure")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--build", default=os.path.join(ROOT, ".build", "release"))
    parser.add_argument("--keep", metavar="DIR", help="keep log, map and samples in this directory")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.keep or scratch
        os.makedirs(work, exist_ok=True)
        log, samples = os.path.join(work, "soak.lcm"), os.path.join(work, "memory.csv")
        simulate(arguments, log)
        subprocess.run([os.path.join(arguments.build, "bin", "isthmus-replay"), log, "--output",
                        os.path.join(work, "map"), "--memory", samples], check=True)
        with open(samples, encoding="utf-8") as file:
            rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    half = [row for row in rows if row["event_s"] >= 1800 * arguments.hours]
    print("hour  resident MB  patches  relations  sightings")
    for row in rows[:: max(1, len(rows) // 12)]:
        print(f"{row['event_s'] / 3600:4.1f}  {row['resident_mb']:11.1f}  {row['patches']:7.0f}  "
              f"{row['relations']:9.0f}  {row['sightings']:9.0f}")
    growth = slope([(row["event_s"] / 3600, row["resident_mb"]) for row in half])
    print(f"last half: {growth:.2f} MB an hour; "
          f"{half[-1]['patches'] - half[0]['patches']:.0f} patches, "
          f"{half[-1]['sightings'] - half[0]['sightings']:.0f} sightings more")
    return 1 if growth > arguments.most else 0


if __name__ == "__main__":
    sys.exit(main())
