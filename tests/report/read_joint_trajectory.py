#!/usr/bin/python3
"""Reads a trajectory_msgs/msg/JointTrajectory in YAML, strictly: unknown or missing keys, numbers that are no floating-point numbers, times
that do not rise and lists of another length than the joints' end it with a message.

    read_joint_trajectory.py FOLDER      FOLDER holds trajectory.yaml

The independent reader of what a motion exports. Prints what it has read as JSON: {"joints", "points", "duration_s", "first", "last"}."""
import json
import pathlib
import sys

import yaml

from read_ros2_control import StrictLoader, require, take


def main():
    text = (pathlib.Path(sys.argv[1]) / "trajectory.yaml").read_text(encoding="ascii")
    names, points = take(yaml.load(text, StrictLoader), "the message", ["joint_names", "points"])
    require(names and all(isinstance(name, str) for name in names) and len(set(names)) == len(names), "joint_names")
    last_ns = -1
    for number, point in enumerate(points):
        where = f"point {number}"
        *lists, time = take(point, where, ["positions", "velocities", "accelerations", "time_from_start"])
        for values in lists:
            require(len(values) == len(names) and all(type(value) is float for value in values), f"{where}: {values}")
        sec, nanosec = take(time, where, ["sec", "nanosec"])
        require(type(sec) is int and type(nanosec) is int and 0 <= nanosec < 10**9, f"{where}: its time")
        require(sec * 10**9 + nanosec > last_ns, f"{where}: times must rise")
        last_ns = sec * 10**9 + nanosec
    print(json.dumps({"joints": names, "points": len(points), "duration_s": last_ns / 1e9, "first": points[0]["positions"],
                      "last": points[-1]["positions"]}))


if __name__ == "__main__":
    main()
