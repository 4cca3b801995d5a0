#!/usr/bin/env python3
"""Puts errors into a copy of the code, one at a time, and tells whether the tests notice.

    tools/mutate.py [--list] [--module relations ...] [--only ID ...] [--jobs N] [--most-survivors N]

The errors are in tests/mutations.toml, each with the tests that should notice it. The copy is of the files as they
are now, with a build of its own (.build/mutation): the first run builds the test programs, with ccache what others
have built already. The exit code is 1 if more survive than --most-survivors (3), or if one is of no use: its text
is not in the file, it does not compile, or its tests fail without it.
"""

import argparse
import os
import shutil
import subprocess
import sys
import time
import tomllib

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def is_in(mutation, directories):
    """Whether its file is below one of them: patches, server/engine, server/engine/map, ..."""
    return any(mutation["file"].startswith(directory.rstrip("/") + "/") for directory in directories)


def programs_of(mutations):
    return sorted({test.split(":", 1)[0] for mutation in mutations for test in mutation["tests"]})


class Copy:
    """The files of the repository elsewhere, and a build of them."""

    def __init__(self, directory, jobs, build_s, test_s):
        self.directory = directory
        self.build_directory = os.path.join(directory, ".build", "dev")
        self.jobs = jobs
        self.build_s = build_s
        self.test_s = test_s

    def path(self, file):
        return os.path.join(self.directory, file)

    def update(self):
        """Copies what differs, so that only that is built again, and removes what is gone."""
        listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT,
                                capture_output=True, check=True).stdout.decode().split("\0")
        files = {file for file in listed if file and os.path.isfile(os.path.join(ROOT, file))}
        for file in files:
            source, target = os.path.join(ROOT, file), self.path(file)
            if os.path.exists(target) and read(source) == read(target):
                continue
            os.makedirs(os.path.dirname(target), exist_ok=True)
            shutil.copyfile(source, target)
            shutil.copymode(source, target)
        for directory, below, names in os.walk(self.directory):
            below[:] = [name for name in below if name != ".build"]
            for name in names:
                path = os.path.join(directory, name)
                if os.path.relpath(path, self.directory) not in files:
                    os.remove(path)

    def configure(self):
        environment = dict(os.environ)
        if shutil.which("ccache"):
            environment.setdefault("CMAKE_CXX_COMPILER_LAUNCHER", "ccache")
        subprocess.run(["cmake", "--preset", "dev"], cwd=self.directory, env=environment, check=True,
                       stdout=subprocess.DEVNULL)

    def build(self, programs, limit_s=None):
        """What the compiler said, where it failed."""
        command = ["ninja", "-C", self.build_directory, "-j", str(self.jobs), *programs]
        result = run(command, self.directory, limit_s)
        return None if result.returncode == 0 else result.stdout

    def failing(self, tests):
        """Those of `tests` (program:filter) with a test that fails, or that do not end in time."""
        failed = []
        for test in tests:
            program, pattern = test.split(":", 1)
            command = [os.path.join(self.build_directory, "tests", program), "--gtest_brief=1", "--gtest_fail_fast",
                       "--gtest_filter=" + pattern]
            result = run(command, self.directory, self.test_s)
            if result.returncode != 0:
                failed.append(test)
                break
            if "Running 0 tests" in result.stdout or "[  PASSED  ] 0 tests" in result.stdout:
                raise RuntimeError(f"{test}: there is no such test")
        return failed


def read(path):
    with open(path, "rb") as file:
        return file.read()


def run(command, directory, limit_s):
    try:
        return subprocess.run(command, cwd=directory, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", timeout=limit_s)
    except subprocess.TimeoutExpired as error:
        said = error.stdout or b""
        return subprocess.CompletedProcess(command, -1, said.decode(errors="replace") if isinstance(said, bytes) else said)


def try_mutation(copy, mutation):
    """(verdict, by which test or why)."""
    path = copy.path(mutation["file"])
    original = read(path)
    text = original.decode()
    if text.count(mutation["before"]) != 1:
        return "not found", f"its text stands {text.count(mutation['before'])} times in {mutation['file']}"
    try:
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace(mutation["before"], mutation["after"]))
        said = copy.build(programs_of([mutation]), copy.build_s)
        if said is not None:
            errors = [line for line in said.splitlines() if "error:" in line]
            return "does not compile", errors[0] if errors else "not built in time"
        failed = copy.failing(mutation["tests"])
        return ("killed", failed[0]) if failed else ("SURVIVED", ", ".join(mutation["tests"]))
    finally:
        with open(path, "wb") as file:
            file.write(original)


def table(results):
    lines = [f"{'id':26} {'file':36} {'verdict':17} by"]
    for mutation, verdict, why, _ in results:
        lines.append(f"{mutation['id']:26} {mutation['file']:36} {verdict:17} {why}")
    counts = {}
    for _, verdict, _, _ in results:
        counts[verdict] = counts.get(verdict, 0) + 1
    lines.append(f"{len(results)} mutations: " + ", ".join(f"{n} {verdict}" for verdict, n in sorted(counts.items())))
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", action="store_true", help="only list the mutations")
    parser.add_argument("--module", nargs="+", default=[], metavar="DIR", help="those of files below these directories")
    parser.add_argument("--only", nargs="+", default=[], metavar="ID", help="these")
    parser.add_argument("--jobs", type=int, default=1, help="of the build (1)")
    parser.add_argument("--most-survivors", type=int, default=3, help="more of them are a failure (3)")
    parser.add_argument("--build-s", type=float, default=600, help="a build that takes longer is given up (600)")
    parser.add_argument("--test-s", type=float, default=120, help="a test that takes longer has failed (120)")
    parser.add_argument("--directory", default=os.path.join(ROOT, ".build", "mutation"), help="for the copy")
    arguments = parser.parse_args()

    with open(os.path.join(ROOT, "tests", "mutations.toml"), "rb") as file:
        mutations = tomllib.load(file)["mutation"]
    unknown = set(arguments.only) - {m["id"] for m in mutations}
    if unknown:
        parser.error("no such mutation: " + ", ".join(sorted(unknown)))
    mutations = [m for m in mutations if (not arguments.module or is_in(m, arguments.module)) and
                 (not arguments.only or m["id"] in arguments.only)]
    if not mutations:
        parser.error("there is no such mutation")
    if arguments.list:
        for mutation in mutations:
            print(f"{mutation['id']:26} {mutation['file']:36} {', '.join(mutation['tests'])}")
        return 0

    copy = Copy(arguments.directory, arguments.jobs, arguments.build_s, arguments.test_s)
    copy.update()
    copy.configure()
    said = copy.build(programs_of(mutations))
    if said is not None:
        sys.exit("the tests do not build as they are:\n" + said)
    for test in sorted({test for mutation in mutations for test in mutation["tests"]}):
        if copy.failing([test]):
            sys.exit(f"{test} fails as it is")

    results = []
    for mutation in mutations:
        start = time.monotonic()
        verdict, why = try_mutation(copy, mutation)
        results.append((mutation, verdict, why, time.monotonic() - start))
        print(f"{mutation['id']:26} {verdict:17} {results[-1][3]:6.1f} s  {why}", file=sys.stderr, flush=True)
    print(table(results))
    survivors = sum(verdict == "SURVIVED" for _, verdict, _, _ in results)
    useless = sum(verdict not in ("killed", "SURVIVED") for _, verdict, _, _ in results)
    return 1 if survivors > arguments.most_survivors or useless else 0


if __name__ == "__main__":
    sys.exit(main())
