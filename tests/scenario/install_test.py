#!/usr/bin/env python3
"""What `cmake --install` gives: programs that run, libraries that another project is built against, the types by
pkg-config, manuals, completions and the unit for systemd.

    tests/scenario/install_test.py --build .build/dev
"""

import argparse
import glob
import os
import shutil
import subprocess
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAMS = ("ask", "campaign", "command", "evaluate", "export", "import", "inspect", "replay", "server", "simulate", "snapshot")


def run(*command, **options):
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if result.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, command))}: {result.returncode}\n{result.stdout}{result.stderr}")
    return result.stdout


def check(condition, what):
    if not condition:
        raise SystemExit("not so: " + what)


def check_programs(prefix, work):
    """They find their scenarios beside themselves, and tell their manuals."""
    check("office" in run(f"{prefix}/bin/isthmus-simulate", "--list"), "scenarios are installed")
    for name in PROGRAMS:
        page = f"{prefix}/share/man/man1/isthmus-{name}.1"
        check(".SH OPTIONS" in open(page, encoding="utf-8").read(), page)
        if shutil.which("man"):
            warnings = subprocess.run(["man", "--warnings", "-l", page], capture_output=True, text=True, check=True,
                                      cwd=work, env={**os.environ, "LC_ALL": "C.UTF-8", "MANPAGER": "cat"}).stderr
            check(warnings == "", f"{page}: {warnings}")


def check_completion(prefix):
    script = """
        source "$1"
        COMP_WORDS=(isthmus-command with); COMP_CWORD=1
        _isthmus_command
        echo "${COMPREPLY[@]}"
    """
    file = f"{prefix}/share/bash-completion/completions/isthmus-command"
    completed = run("bash", "-c", script, "bash", file)
    check(completed.split() == ["withdraw"], f"'with' is completed to '{completed}'")


def check_unit(prefix):
    unit = f"{prefix}/lib/systemd/system/isthmus.service"
    text = open(unit, encoding="utf-8").read()
    check("ExecStart=isthmus-server" in text and "User=isthmus" in text, unit)


def check_libraries(prefix, work):
    run("cmake", "-S", os.path.join(ROOT, "tests", "scenario", "consumer"), "-B", f"{work}/consumer",
        f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_BUILD_TYPE=Debug")
    run("cmake", "--build", f"{work}/consumer")
    check(run(f"{work}/consumer/consumer") == "1 patch\n", "the engine is there")
    found = {**os.environ, "PKG_CONFIG_PATH": os.path.dirname(glob.glob(f"{prefix}/lib*/**/isthmus.pc", recursive=True)[0])}
    flags = run("pkg-config", "--cflags", "--libs", "isthmus", env=found).split()
    run("c++", "-std=c++17", f"{prefix}/share/isthmus/examples/robot.cpp", *flags, "-o", f"{work}/robot")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=".build/dev")
    build = parser.parse_args().build
    with tempfile.TemporaryDirectory() as work:
        prefix = f"{work}/usr"
        run("cmake", "--install", build, "--prefix", prefix)
        check_programs(prefix, work)
        check_completion(prefix)
        check_unit(prefix)
        check_libraries(prefix, work)
        check(os.path.exists(f"{prefix}/share/doc/isthmus/copyright"), "the licence is installed")
    print("what is installed is whole")


if __name__ == "__main__":
    main()
