#!/usr/bin/env python3
"""The log-odds of finds that the programs come with are what the labelled finds in the repository say.

    tests/scenario/evidence_fit_test.py --build .build/dev
"""

import argparse
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FIT = os.path.join(ROOT, "tools", "fit_evidence.py")
TABLE = os.path.join(ROOT, "tools", "simulate", "evidence", "finds.csv")


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


def settings(text):
    lines = [line.split(" = ") for line in text.splitlines() if line.startswith("find_evidence.")]
    return {name: float(value) for name, value in lines}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", required=True)
    arguments = parser.parse_args()
    fitted = run(sys.executable, FIT, TABLE)
    listed = run(os.path.join(arguments.build, "bin", "isthmus-replay"), "--list-tuning")
    failures = []
    if fitted.returncode != 0 or len(settings(fitted.stdout)) != 5:
        failures.append(f"no fit: {fitted.stdout}{fitted.stderr}")
    if settings(fitted.stdout) != settings(listed.stdout):
        failures.append(f"fitted {settings(fitted.stdout)}, listed {settings(listed.stdout)}")
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as alike:
        alike.write("run,true,way_m,search_score,carrier_score,seen_again,look_alikes\nwild 1,1,30,0.7,0.8,0.9,1\n")
        alike.flush()
        refused = run(sys.executable, FIT, alike.name)
        if refused.returncode != 1 or "true finds and false ones" not in refused.stderr:
            failures.append(f"true ones only: exit code {refused.returncode}, {refused.stderr}")
    print("\n".join(failures) or "as the data say")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
