#!/usr/bin/env python3
"""A live server tells of places and zones on ISTHMUS_ZONES, to who listens and to who comes late.

    tests/scenario/zones_test.py --build .build/dev
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time

from live import LIMIT_S, ROOT, Server, check, free_lcm_port, generate_types, lcm_url

sys.path.insert(0, os.path.join(ROOT, "tools", "examples"))
from small_lcm import Lcm  # pylint: disable=wrong-import-position


class Listener:
    """What is said on ISTHMUS_ZONES."""

    def __init__(self, port, types):
        self.network = Lcm(port)
        self.types = types

    def next(self, is_it, what):
        """The next message that is the one waited for; those of a whole map may come at any time."""
        end = time.monotonic() + LIMIT_S
        while time.monotonic() < end:
            got = self.network.receive(1)
            if got is not None and got[0] == "ISTHMUS_ZONES":
                zones = self.types.zones_t.decode(got[1])
                if is_it(zones):
                    return zones
        raise SystemExit(f"no ISTHMUS_ZONES came: {what}")


def watch(build, port, types):
    def command(*words):
        subprocess.run([os.path.join(build, "bin", "isthmus-command"), "--lcm-url", lcm_url(port), *words], check=True,
                       stdout=subprocess.DEVNULL)

    listener = Listener(port, types)
    with subprocess.Popen([os.path.join(build, "examples", "example-robot"), "R1", "1", "4", lcm_url(port)],
                          stdout=subprocess.DEVNULL) as robot:
        check(robot.wait(timeout=LIMIT_S) == 0, "the robot has driven")
    command("keep-out", "Stairs", "--island", "0", "--corners", "1,1 2,1 2,3")
    (zone,) = listener.next(lambda zones: zones.nzones == 1, "a zone is drawn").zones
    check((zone.kind, zone.name, zone.island, zone.ncorners) == ("keep_out", "Stairs", 0, 3), "it is the one drawn")
    corners = list(zip(zone.x_m, zone.y_m))
    check(all(abs(x - ex) < 0.05 and abs(y - ey) < 0.05 for (x, y), (ex, ey) in zip(corners, [(1, 1), (2, 1), (2, 3)])),
          f"it is where it was drawn: {corners}")
    command("speed", "Ramp", "--island", "0", "--max", "0.4", "--corners", "0,0 1,0 1,1")
    ramp = next(zone for zone in listener.next(lambda zones: zones.nzones == 2, "another").zones if zone.kind == "speed")
    check(ramp.max_speed == 0.4 and ramp.id != zone.id, "it has its speed and an id of its own")
    late = Listener(port, types)
    command("send_map")
    late.next(lambda zones: zones.nzones == 2, "one that comes late asks for the map")
    command("erase", "Stairs")
    (left,) = listener.next(lambda zones: zones.nzones == 1, "one is erased").zones
    check(left.id == ramp.id, "the other stays what it is")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=".build/dev")
    arguments = parser.parse_args()
    port = free_lcm_port()
    with tempfile.TemporaryDirectory() as work:
        generate_types(work)
        sys.path.insert(0, work)
        import isthmus as types  # pylint: disable=import-error,import-outside-toplevel
        for again in (False, True):
            with Server(arguments.build, lcm_url(port), work) as server:
                server.start("--journal", os.path.join(work, "journal"))
                if again:  # from the journal, without anybody's asking
                    Listener(port, types).next(lambda zones: zones.nzones == 1, "after a restart")
                else:
                    watch(arguments.build, port, types)
    print("zones are told to who listens, to who comes late, and after a restart")


if __name__ == "__main__":
    main()
