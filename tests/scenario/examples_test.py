#!/usr/bin/env python3
"""The robots of tools/examples, in C++ and in Python, drive for a live server, which maps them.

    tests/scenario/examples_test.py --build .build/dev
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile

from live import LIMIT_S, ROOT, Server, check, free_lcm_port, generate_types, lcm_url

SECONDS = 8


def python_robot(work):
    """robot.py with the generated types beside it, as its first lines tell."""
    for file in ("robot.py", "small_lcm.py"):
        shutil.copy(os.path.join(ROOT, "tools", "examples", file), work)
    generate_types(work)
    return os.path.join(work, "robot.py")


def check_told(name, output):
    """Of 10 scans a second, most are answered; the circle has a radius of 1 m, and begins at the origin."""
    poses = [line.split() for line in output.splitlines() if line.startswith(name + ": island ")]
    check(len(poses) > 7 * SECONDS, f"{name} was told {len(poses)} poses")
    farthest = max((float(pose[3]) ** 2 + float(pose[5]) ** 2) ** 0.5 for pose in poses)
    check(1.5 < farthest < 2.2, f"{name} was at most {farthest} m from where it began")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=".build/dev")
    arguments = parser.parse_args()
    port = free_lcm_port()
    url = lcm_url(port)
    with tempfile.TemporaryDirectory() as work:
        commands = {
            "R1": [os.path.join(arguments.build, "examples", "example-robot"), "R1", "1", str(SECONDS), url],
            "R2": [sys.executable, python_robot(work), "R2", "2", str(SECONDS), str(port)],
        }
        with Server(arguments.build, url, work) as server:
            server.start("--output", os.path.join(work, "map"))
            robots = {name: subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
                      for name, command in commands.items()}
            for name, robot in robots.items():
                output, _ = robot.communicate(timeout=LIMIT_S)
                check(robot.returncode == 0, f"{name} ended well")
                check_told(name, output)
        with open(os.path.join(work, "map", "report.json"), encoding="utf-8") as file:
            report = json.load(file)
        check(report["warnings"] == {}, f"nothing looks wrong: {report['warnings']}")
        check(report["dropped"] == {}, f"nothing was dropped: {report['dropped']}")
        for name in commands:
            check(os.path.exists(os.path.join(work, "map", "trajectories", name + ".tum")), f"{name} has a trajectory")
    print("both robots were mapped")


if __name__ == "__main__":
    main()
