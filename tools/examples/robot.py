#!/usr/bin/env python3
"""A robot for Isthmus in Python: it drives in a circle in a room of 8 x 6 m, and is told where it is.

    lcm-gen -p --ppath . /usr/share/isthmus/lcmtypes/*.lcm     # once: the types, beside this file
    ./robot.py NAME BARCODE [SECONDS] [PORT]
"""
import math
import sys
import time

from bot_core.planar_lidar_t import planar_lidar_t
from bot_core.pose_t import pose_t
from isthmus.manifold_pose_t import manifold_pose_t
from isthmus.robot_t import robot_t
from small_lcm import Lcm

def range_m(x, y, direction):  # to the walls at x = -4 and 4, y = -3 and 3
    c, s = math.cos(direction), math.sin(direction)
    return min(((4 if c > 0 else -4) - x) / c if c else 1e9, ((3 if s > 0 else -3) - y) / s if s else 1e9)


def main(name, barcode, seconds=60, port=7667):
    lcm = Lcm(int(port))
    for i in range(int(10 * float(seconds))):
        now = time.time()
        utime, turned = int(now * 1e6), 0.05 * i
        x, y, yaw = math.cos(turned), math.sin(turned), turned + math.pi / 2
        if i % 20 == 0:  # who it is: at the start, and again for a server that comes later
            robot = robot_t()
            robot.utime, robot.name, robot.barcode = utime, name, int(barcode)
            robot.range_min_m, robot.range_max_m, robot.footprint_radius_m = 0.1, 20, 0.2
            lcm.publish(name + "_ROBOT", robot)
        odometry = pose_t()  # of the scan's own moment, just before the scan
        odometry.utime, odometry.pos = utime, [x, y, 0]
        odometry.orientation = [math.cos(yaw / 2), 0, 0, math.sin(yaw / 2)]
        lcm.publish(name + "_ODOMETRY", odometry)
        scan = planar_lidar_t()
        scan.utime, scan.nranges, scan.rad0, scan.radstep = utime, 181, -math.pi / 2, math.pi / 180
        scan.ranges = [range_m(x, y, yaw + scan.rad0 + k * scan.radstep) for k in range(181)]
        lcm.publish(name + "_SCAN", scan)
        while (left := now + 0.1 - time.time()) > 0:
            heard = lcm.receive(left)
            if heard and heard[0] == name + "_POSE":
                pose = manifold_pose_t.decode(heard[1])
                print(f"{name}: island {pose.island}, " + "{:.2f} m, {:.2f} m, {:.2f} rad".format(*pose.map_from_robot))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        print("usage: robot.py NAME BARCODE [SECONDS] [PORT]", file=sys.stderr)
        sys.exit(2)
    main(*sys.argv[1:])
