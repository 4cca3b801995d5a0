#!/usr/bin/env python3
"""What every program and script does with a command line: --version, --help, wrong usage, names that are nearly
right, and what is there already.

    tests/scenario/words_test.py --build .build/dev
"""

import argparse
import glob
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# Commands of programs that write what --output or --pictures says, and so do not write over it.
WRITES = {"isthmus-replay": [[]], "isthmus-export": [[]], "isthmus-simulate": [[]], "isthmus-server": [[]],
          "isthmus-import": [["carmen"], ["mrclam"]],
          "isthmus-campaign": [["wild"], ["evidence"], ["sightings"], ["explore"], ["home"], ["paths"]]}
# What CLI11 calls types and bounds.
RAW = re.compile(r"FLOAT|UINT|ENUM|\bINT\b|\bAND\b|Option Group| in \{")
UNKNOWN_START = '[robots.R2]\nstart = { with = "R7", x = 0.0, y = -1.2, yaw = 0.0 }\n'

failures = []


def expect(good, what, run):
    if not good:
        failures.append(f"{what}: exit code {run.returncode}\n{run.stdout}{run.stderr}")


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, stdin=subprocess.DEVNULL)


def of_commit():
    """What --version says after the version: nothing where no git tells what is built here."""
    try:
        known = run("git", "-C", ROOT, "rev-parse", "HEAD").returncode == 0
    except FileNotFoundError:
        known = False
    return r" \([0-9a-f]{7,}\+?\)" if known else ""


def judge_program(path):
    name = os.path.basename(path)
    version = run(path, "--version")
    expect(version.returncode == 0 and re.match(rf"{name} \d+\.\d+\.\d+{of_commit()}\n$", version.stdout),
           f"{name} --version tells version and commit", version)
    help_text = run(path, "--help")
    expect(help_text.returncode == 0 and "Usage: " in help_text.stdout, f"{name} --help is help", help_text)
    wrong = run(path, "--nonsense")
    expect(wrong.returncode == 2 and wrong.stderr.startswith(f"{name}: "), f"{name} --nonsense is wrong usage", wrong)
    nearly = run(path, "--versoin")
    expect(nearly.returncode == 2 and "did you mean '--version'?" in nearly.stderr, f"{name} suggests", nearly)
    man = run(path, "--man")
    expect(man.returncode == 0 and man.stdout.count("\\-\\-help") == 1, f"{name} --man has --help once", man)
    commands = re.findall(r"^\.SS ([\w\\-]+)$", man.stdout, re.MULTILINE)
    for command in [[], *([one.replace("\\", "")] for one in commands)]:
        told = run(path, *command, "--help")
        what = " ".join([name, *command])
        expect(told.returncode == 0 and not RAW.search(told.stdout), f"{what} --help is in plain words", told)
        expect("--output" not in told.stdout or "-o,--output" in told.stdout or "(with --output)" in told.stdout,
               f"{what} takes -o and --output", told)
    expect(not RAW.search(man.stdout), f"{name} --man is in plain words", man)
    for command in WRITES.get(name, []):
        written = run(path, *command, "--help")
        expect("--force" in written.stdout, f"{name} {command} takes --force", written)


def judge_script(path):
    name = os.path.basename(path)
    help_text = run(path, "--help")
    expect(help_text.returncode == 0 and f"tools/{name}" in help_text.stdout + help_text.stderr or "usage:" in help_text.stdout,
           f"{name} --help is help", help_text)
    wrong = run(path, "--nonsense")
    expect(wrong.returncode == 2, f"{name} --nonsense is wrong usage", wrong)


def judge_outputs(build, work):
    """Nothing is written over without --force."""
    def program(name, *arguments):
        return run(os.path.join(build, "bin", name), *arguments)

    log, map_directory = os.path.join(work, "run.lcm"), os.path.join(work, "map")
    simulate = ("isthmus-simulate", "--scenario", "meeting", "--set", "duration_s=3", "false_sightings=0.1", "-o", log)
    first = program(*simulate)
    expect(first.returncode == 0, "--set takes several settings", first)
    replay = ("isthmus-replay", log, "-o", map_directory)
    first = program(*replay)
    expect(first.returncode == 0, "a log is replayed", first)
    truth = os.path.join(work, "truth")
    for command in (simulate, replay, ("isthmus-export", log, "-o", map_directory)):
        again = program(*command)
        expect(again.returncode == 1 and "--force" in again.stderr, f"{command[0]} does not write over", again)
    forced = program(*simulate, "--truth", truth, "--force")
    expect(forced.returncode == 0, "--force writes over", forced)
    expect(program(*replay, "--force").returncode == 0, "--force writes over", forced)

    again = program("isthmus-simulate", "--scenario", "meeting", "--set", "duration_s=3", "-o",
                    os.path.join(work, "other.lcm"), "--truth", truth)
    expect(again.returncode == 1 and "--force" in again.stderr, "--truth does not write over", again)
    table = os.path.join(work, "table.csv")
    with open(table, "w", encoding="utf-8") as file:
        file.write("a row\n")
    for campaign in (("sightings", "--scenario", "meeting", "-o", table), ("evidence", "--scenario", "meeting", "-o", table),
                     ("evidence", "--scenario", "meeting", "-o", os.path.join(work, "new.csv"), "--finds", table)):
        again = program("isthmus-campaign", *campaign, "--seeds", "1")
        expect(again.returncode == 1 and "--force" in again.stderr, f"{campaign} does not write over", again)

    mcap = os.path.join(work, "run.mcap")
    export = ("isthmus-export", log, "--mcap", mcap)
    expect(program(*export).returncode == 0 and os.path.exists(mcap), "--mcap writes, and needs no --output", forced)
    again = program(*export)
    expect(again.returncode == 1 and "--force" in again.stderr, "isthmus-export --mcap does not write over", again)
    expect(program(*export, "--force").returncode == 0, "--force writes over", forced)
    nowhere = program("isthmus-export", log)
    expect(nowhere.returncode == 2, "isthmus-export needs to know what to write", nowhere)
    bare = program("isthmus-export")
    expect(bare.returncode == 2 and "snapshot" in bare.stderr and "log" in bare.stderr,
           "a bare isthmus-export tells what it takes", bare)
    nobody = program("isthmus-evaluate", "--truth", truth, "-o", map_directory, "--robot", "R7")
    expect(nobody.returncode == 1 and "no robot R7" in nobody.stderr, "a robot that is not on the map", nobody)

    picture = os.path.join(work, "confidence.png")
    inspect = ("isthmus-inspect", map_directory, "--confidence", "0", "0", "--picture", picture)
    expect(program(*inspect).returncode == 0 and os.path.exists(picture), "--picture draws", forced)
    again = program(*inspect)
    expect(again.returncode == 1 and "--force" in again.stderr, "isthmus-inspect does not write over", again)
    evaluate = ("isthmus-evaluate", "--truth", truth, "-o", map_directory, "--pictures", os.path.join(work, "errors"))
    drawn = program(*evaluate)
    expect(drawn.returncode == 0 and os.path.exists(os.path.join(work, "errors", "island-0-errors.png")),
           "isthmus-evaluate --pictures draws", drawn)
    again = program(*evaluate)
    expect(again.returncode == 1 and "--force" in again.stderr, "isthmus-evaluate does not write over", again)


# What is wrong, and how it is told.
REASONS = [
    (("isthmus-command", "speed", "S", "--island", "0", "--max", "0", "--corners", "1,1 2,1 2,2"),
     "--max: '0' is not a number from 0.01 to 100"),
    (("isthmus-command", "speed", "S", "--island", "0", "--max", "-1", "--corners", "1,1 2,1 2,2"),
     "--max: '-1' is not a number from 0.01 to 100"),
    (("isthmus-command", "forbid", "-1"), "ids are not negative: -1"),
    (("isthmus-command", "speed", "S", "--island", "0", "--corners", "1,1 2,1 2,2"), "--max is required"),
    (("isthmus-command", "keep-out", "Q", "--island", "0", "--corners", "1,1 2,1"), "bad_polygon"),
    (("isthmus-ask", "path", "R1", "--hmoe"), "there is no option --hmoe; did you mean '--home'?"),
    (("isthmus-campaign", "wild", "--seeds", "0"), "--seeds: '0' is not an integer of at least 1"),
    (("isthmus-inspect", "map", "--confidence", "0", "x"), "--confidence: 'x' is no patch's id: a number, as in patches.csv"),
    (("isthmus-evaluate", "--association", "jont", "--landmarks", "x"),
     "--association: 'jont' is none of joint, known, nearest; did you mean 'joint'?"),
    (("isthmus-server", "--log-level", "inof"), "did you mean 'info'?"),
    (("isthmus-server", "--http-port", "8080", "--http-bind", "0.0.0.0"), "needs a token (--http-token-file)"),
    (("isthmus-replay", "--estimator", "segmnts", "x", "-o", "y"), "did you mean 'segments'?"),
    (("isthmus-simulate", "--scenario", "metting", "-o", "z"), "did you mean 'meeting'?"),
    (("isthmus-campaign", "closures", "--scenario", "nope"), "isthmus-simulate --list names them"),
    (("isthmus-simulate", "--scenario", "meeting", "--set", "laps=x", "-o", "z"), "--set laps=x: laps must be an integer"),
    (("isthmus-simulate", "--scenario", "meeting", "--set", "duratoin_s=3", "-o", "z"), "did you mean 'duration_s'?"),
]


def judge_reasons(build):
    for (name, *arguments), reason in REASONS:
        told = run(os.path.join(build, "bin", name), *arguments)
        expect(told.returncode == 2 and reason in told.stderr, f"{name} {arguments} tells what is wrong", told)


def judge_words(build, work):
    bare = run(os.path.join(build, "bin", "isthmus-campaign"))
    expect(bare.returncode == 2 and "wild" in bare.stderr, "a bare isthmus-campaign tells the campaigns", bare)
    unset = run(os.path.join(build, "bin", "isthmus-campaign"), "wild", "--seeds", "1", "--config", os.path.join(work, "none.toml"))
    expect(unset.returncode == 1 and "none.toml: cannot be read" in unset.stderr and not unset.stdout,
           "isthmus-campaign tells which configuration it cannot read", unset)
    unread = run(os.path.join(build, "bin", "isthmus-command"), "--wait", "0", "withdraw", "x")
    expect(unread.returncode == 2 and "not a closure's id: 'x'" in unread.stderr, "an order that cannot be read is wrong usage", unread)
    config = os.path.join(work, "start.toml")
    with open(config, "w", encoding="utf-8") as file:
        file.write(UNKNOWN_START)
    checked = run(os.path.join(build, "bin", "isthmus-server"), "--check-config", config)
    expect("R7" in checked.stderr, "--check-config finds a start that is measured from nobody", checked)
    relations = os.path.join(work, "other.csv")
    with open(relations, "w", encoding="utf-8") as file:
        file.write("robot1,utime1_us,robot2,utime2_us,x_m,y_m,yaw_rad,kind\nR1,1,R1,2,0,0,0,intra\n")
    nothing = run(os.path.join(build, "bin", "isthmus-evaluate"), "--relations", relations, "--output",
                  os.path.join(work, "map"))
    expect(nothing.returncode == 1, "truth that matches nothing is an error", nothing)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default=".build/dev")
    build = os.path.abspath(parser.parse_args().build)
    programs = sorted(glob.glob(os.path.join(build, "bin", "isthmus-*")))
    scripts = sorted(glob.glob(os.path.join(ROOT, "tools", "*.sh")) + glob.glob(os.path.join(ROOT, "tools", "*.py")))
    if len(programs) < 11 or len(scripts) < 12:
        raise SystemExit(f"only {len(programs)} programs and {len(scripts)} scripts: is all built?")
    for path in programs:
        judge_program(path)
    for path in scripts:
        judge_script(path)
    with tempfile.TemporaryDirectory() as work:
        judge_outputs(build, work)
        judge_words(build, work)
        judge_reasons(build)
    print("\n".join(failures) if failures else f"{len(programs)} programs, {len(scripts)} scripts")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
