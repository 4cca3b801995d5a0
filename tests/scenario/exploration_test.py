#!/usr/bin/env python3
"""Two simulated robots explore a small office by the goals of a live server, in processes of their own over LCM.

    tests/scenario/exploration_test.py --build .build/dev
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile

from live import LIMIT_S, Server, free_lcm_port, lcm_url

LEAST_SEEN = 95  # per cent


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, help="build directory")
    options = parser.parse_args()
    programs = os.path.join(os.path.abspath(options.build), "bin")
    url = lcm_url(free_lcm_port())
    with tempfile.TemporaryDirectory() as directory:
        configuration, output = os.path.join(directory, "explore.toml"), os.path.join(directory, "map")
        pictures = os.path.join(directory, "pictures")
        with open(configuration, "w", encoding="utf-8") as file:
            file.write("[exploration]\nenabled = true\n")
        with Server(options.build, url, directory) as server:
            server.start("--config", configuration, "--output", output, "--status-period", "0.25")
            drive = subprocess.run([f"{programs}/isthmus-simulate", "--scenario", "meeting", "--live", "--lcm-url", url,
                                    "--speed", "8", "--max-time", str(8 * LIMIT_S), "--pictures", pictures],
                                   capture_output=True, text=True, timeout=3 * LIMIT_S, check=False)
        print(drive.stdout, drive.stderr)
        wrong = []
        told = re.match(r"seen ([\d.]+) % .* (\d+) goals, walls touched (\d+), robots touched (\d+)", drive.stdout)
        if drive.returncode != 0 or not told:
            sys.exit("the simulator did not drive")
        if float(told[1]) < LEAST_SEEN:
            wrong.append(f"only {told[1]} % was seen")
        if int(told[3]) or int(told[4]):
            wrong.append("something was touched")
        if not os.listdir(pictures):
            wrong.append("no picture")
        with open(os.path.join(output, "report.json"), encoding="utf-8") as file:
            if json.load(file)["islands"] != 1:
                wrong.append("the robots' maps did not merge")
        if wrong:
            sys.exit("; ".join(wrong))


if __name__ == "__main__":
    main()
