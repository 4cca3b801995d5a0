#!/usr/bin/env python3
"""The robots of tools/examples, in C++ and in Python, drive for a live server, which maps them.

    tests/scenario/examples_test.py --build .build/dev [--port 7697]
"""

import argparse
import glob
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SECONDS = 8
LIMIT_S = 60


def python_robot(work):
    """robot.py with the generated types beside it, as its first lines tell."""
    for file in ("robot.py", "small_lcm.py"):
        shutil.copy(os.path.join(ROOT, "tools", "examples", file), work)
    subprocess.run(["lcm-gen", "-p", "--ppath", work, *glob.glob(os.path.join(ROOT, "lcmtypes", "*.lcm"))], check=True)
    return os.path.join(work, "robot.py")


def start_server(build, url, work):
    log = open(os.path.join(work, "server.log"), "w+", encoding="utf-8")
    server = subprocess.Popen([os.path.join(build, "bin", "isthmus-server"), "--lcm-url", url, "--output",
                               os.path.join(work, "map")], stderr=log)
    end = time.monotonic() + LIMIT_S
    while time.monotonic() < end and server.poll() is None:
        if "msg=listening" in open(log.name, encoding="utf-8").read():
            return server
        time.sleep(0.05)
    raise SystemExit("the server does not listen:\n" + open(log.name, encoding="utf-8").read())


def check(condition, what):
    if not condition:
        raise SystemExit("not so: " + what)


def check_told(name, output):
    """Of 10 scans a second, most are answered; the circle has a radius of 1 m, and begins at the origin."""
    poses = [line.split() for line in output.splitlines() if line.startswith(name + ": island ")]
    check(len(poses) > 7 * SECONDS, f"{name} was told {len(poses)} poses")
    farthest = max((float(pose[3]) ** 2 + float(pose[5]) ** 2) ** 0.5 for pose in poses)
    check(1.5 < farthest < 2.2, f"{name} was at most {farthest} m from where it began")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=".build/dev")
    parser.add_argument("--port", type=int, default=7697)
    arguments = parser.parse_args()
    url = f"udpm://239.255.76.67:{arguments.port}?ttl=0"
    with tempfile.TemporaryDirectory() as work:
        commands = {
            "R1": [os.path.join(arguments.build, "examples", "example-robot"), "R1", "1", str(SECONDS), url],
            "R2": [sys.executable, python_robot(work), "R2", "2", str(SECONDS), str(arguments.port)],
        }
        server = start_server(arguments.build, url, work)
        robots = {name: subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
                  for name, command in commands.items()}
        try:
            for name, robot in robots.items():
                output, _ = robot.communicate(timeout=LIMIT_S)
                check(robot.returncode == 0, f"{name} ended well")
                check_told(name, output)
        finally:
            server.send_signal(signal.SIGINT)
            check(server.wait(timeout=LIMIT_S) == 0, "the server ended well")
        with open(os.path.join(work, "map", "report.json"), encoding="utf-8") as file:
            report = json.load(file)
        check(report["warnings"] == {}, f"nothing looks wrong: {report['warnings']}")
        check(report["dropped"] == {}, f"nothing was dropped: {report['dropped']}")
        for name in commands:
            check(os.path.exists(os.path.join(work, "map", "trajectories", name + ".tum")), f"{name} has a trajectory")
    print("both robots were mapped")


if __name__ == "__main__":
    main()
