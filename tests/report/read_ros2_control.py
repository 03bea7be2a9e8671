#!/usr/bin/python3
"""Reads an export of parameters for ROS 2's controllers, strictly: whatever is no YAML of scalars, lists and maps, stands there
twice, or is no parameter of its distribution with a value of its type ends it with a message.

    read_ros2_control.py FOLDER      FOLDER holds controllers-DISTRIBUTION.yaml

Written from joint_trajectory_controller_parameters.yaml of ros2_controllers (Humble 2.x, Jazzy from 4.27.0, Kilted from 5.7.0), and
independent of what writes the export. Needs Debian's python3-yaml. Prints what it has read as JSON:
{distribution: {"update_rate": ..., "joints": [...], "gains": {joint: {parameter: value}}}}.
"""
import json
import math
import pathlib
import sys

import yaml

STRATEGIES = ("none", "back_calculation", "conditional_integration")
# Of a joint: the parameter's type, or the values that a string may have.
COMMON_GAINS = {"p": float, "i": float, "d": float, "ff_velocity_scale": float}
NEW_GAINS = {"u_clamp_max": float, "u_clamp_min": float, "tracking_time_constant": float, "error_deadband": float}
GAINS = {
    "humble": COMMON_GAINS | {"i_clamp": float, "normalize_error": bool, "angle_wraparound": bool},
    "jazzy": COMMON_GAINS | NEW_GAINS | {"i_clamp": float, "antiwindup_strategy": STRATEGIES + ("legacy",)},
    "kilted": COMMON_GAINS | NEW_GAINS | {"i_clamp_max": float, "i_clamp_min": float, "antiwindup_strategy": STRATEGIES},
}
INTERFACES = ("position", "velocity", "acceleration", "effort")


def require(condition, message):
    if not condition:
        sys.exit(f"read_ros2_control.py: {message}")


class StrictLoader(yaml.SafeLoader):
    """No key twice, no aliases, no tags."""

    def compose_node(self, parent, index):
        require(not self.check_event(yaml.events.AliasEvent), "an alias")
        event = self.peek_event()
        require(event.anchor is None and event.tag is None, f"{event.start_mark}: an anchor or a tag")
        return super().compose_node(parent, index)

    def construct_mapping(self, node, deep=False):
        keys = [self.construct_object(key, deep=True) for key, _ in node.value]
        require(len(keys) == len(set(keys)), f"{node.start_mark}: a key stands there twice")
        return super().construct_mapping(node, deep)


def take(mapping, where, required, optional=()):
    require(isinstance(mapping, dict), f"{where} is no map")
    for key in required:
        require(key in mapping, f"{where} has no {key}")
    for key in mapping:
        require(key in required or key in optional, f"{where} has an unknown {key!r}")
    return [mapping[key] for key in required]


def check_strings(value, where, allowed=None):
    require(isinstance(value, list) and value and all(isinstance(text, str) for text in value), f"{where}: no list of strings")
    require(len(set(value)) == len(value), f"{where}: a value stands there twice")
    require(allowed is None or set(value) <= set(allowed), f"{where}: an unknown value")


def check_gains(gains, where, distribution):
    known = GAINS[distribution]
    take(gains, where, ("p", "i", "d"), known)
    for key, value in gains.items():
        if isinstance(known[key], tuple):
            require(value in known[key], f"{where}: {key} is {value!r}")
        else:
            # An integer is refused for a double.
            require(type(value) is known[key], f"{where}: {key} is {value!r}, which is no {known[key].__name__}")
            require(known[key] is bool or math.isfinite(value), f"{where}: {key} is not finite")
    # Pid::Gains::validate()
    for low, high in (("i_clamp_min", "i_clamp_max"), ("u_clamp_min", "u_clamp_max")):
        require(low not in gains or gains[low] < gains[high], f"{where}: {low} is not below {high}")


def read(file, distribution):
    with open(file, encoding="ascii") as stream:
        try:
            root = yaml.load(stream, StrictLoader)
        except yaml.YAMLError as error:
            require(False, f"{file}: {error}")
    name = "joint_trajectory_controller"
    manager, controller = take(root, file, ("controller_manager", name))
    (manager,) = take(manager, "controller_manager", ("ros__parameters",))
    rate, kind = take(manager, "controller_manager", ("update_rate", name))
    require(type(rate) is int and rate > 0, f"update_rate is {rate!r}")
    (kind,) = take(kind, name, ("type",))
    require(kind == "joint_trajectory_controller/JointTrajectoryController", f"the type is {kind!r}")
    (parameters,) = take(controller, name, ("ros__parameters",))
    joints, commands, states, gains = take(parameters, name, ("joints", "command_interfaces", "state_interfaces", "gains"))
    check_strings(joints, "joints")
    check_strings(commands, "command_interfaces", INTERFACES)
    check_strings(states, "state_interfaces", INTERFACES[:3])
    # An effort command wants both: the PID's errors of position and velocity.
    require(commands == ["effort"] and {"position", "velocity"} <= set(states), "interfaces that do not go together")
    take(gains, "gains", joints)
    for joint in joints:
        check_gains(gains[joint], f"{distribution}, gains of {joint!r}", distribution)
    return {"update_rate": rate, "joints": joints, "gains": gains}


folder = pathlib.Path(sys.argv[1])
require({file.name for file in folder.iterdir()} == {f"controllers-{name}.yaml" for name in GAINS}, "other files than expected")
print(json.dumps({name: read(folder / f"controllers-{name}.yaml", name) for name in GAINS}))
