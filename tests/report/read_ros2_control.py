#!/usr/bin/python3
"""Reads an export of parameters for ROS 2's controllers, strictly: whatever is no YAML of scalars, lists and maps, stands there
twice, is no parameter of its distribution, or breaks a rule of the parameter's definition ends it with a message.

    read_ros2_control.py FOLDER      FOLDER holds controllers-DISTRIBUTION.yaml

The definitions are those that the controllers were released with (ros2_parameters.json), so this reader is independent of what writes
the export. Kilted's file is also checked as one for Rolling. Needs Debian's python3-yaml. Prints what it has read as JSON:
{distribution: {"update_rate": ..., "interface": ..., "joints": [...], "gains": {joint: {parameter: value}}}}.
"""
import json
import math
import pathlib
import sys

import yaml

TRAJECTORY, PID, MANAGER = "joint_trajectory_controller", "pid_controller", "controller_manager"
TYPES = {TRAJECTORY: "joint_trajectory_controller/JointTrajectoryController", PID: "pid_controller/PidController"}
DEFINITIONS = json.loads(pathlib.Path(__file__).with_name("ros2_parameters.json").read_text(encoding="ascii"))["parameters"]
# The distributions that a file is for.
FILES = {"humble": ["humble"], "jazzy": ["jazzy"], "kilted": ["kilted", "rolling"]}
LISTS = {"string_array": str}
SCALARS = {"string": str, "double": float, "bool": bool, "int": int}


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


def take(mapping, where, required):
    require(isinstance(mapping, dict), f"{where} is no map")
    for key in required:
        require(key in mapping, f"{where} has no {key}")
    for key in mapping:
        require(key in required, f"{where} has an unknown {key!r}")
    return [mapping[key] for key in required]


def flatten(value, path=(), own=()):
    """Yields the path of every parameter, as written and as defined: a joint's name under gains is '*' in a definition."""
    if not isinstance(value, dict):
        yield path, ".".join(own), value
        return
    for key, part in value.items():
        require(isinstance(key, str), f"{key!r} is no word")
        yield from flatten(part, path + (key,), own + ("*" if own == ("gains",) else key,))


def check_rules(value, rules, where):
    for rule, limit in rules.items():
        holds = {"unique": lambda: len(set(value)) == len(value), "not_empty": lambda: len(value) > 0,
                 "size_gt": lambda: len(value) > limit, "size_lt": lambda: len(value) < limit,
                 "subset_of": lambda: set(value) <= set(limit), "one_of": lambda: value in limit,
                 "gt": lambda: value > limit, "gt_eq": lambda: value >= limit}[rule]
        require(holds(), f"{where} is {value!r}, against the rule {rule} {limit}")


def check_parameters(controller, parameters, distribution):
    defined = {name: (kind, rules[0] if rules else {})
               for name, kind, distributions, *rules in DEFINITIONS[controller] if distribution in distributions.split()}
    for path, name, value in flatten(parameters):
        where = f"{distribution}, {controller}: {'.'.join(path)}"
        require(name in defined, f"{where}: an unknown {path[-1]!r}")
        kind, rules = defined[name]
        if kind in LISTS:
            require(isinstance(value, list) and all(type(item) is LISTS[kind] for item in value), f"{where}: no {kind}")
        else:
            # An integer is refused for a double.
            require(type(value) is SCALARS[kind], f"{where} is {value!r}, which is no {SCALARS[kind].__name__}")
            require(kind != "double" or math.isfinite(value), f"{where} is not finite")
        check_rules(value, rules, where)


def check_gains(gains, joints, where):
    take(gains, where, joints)
    for joint in joints:
        for key in ("p", "i", "d"):
            require(key in gains[joint], f"{where} of {joint!r} has no {key}")
        # Pid::Gains::validate()
        for low, high in (("i_clamp_min", "i_clamp_max"), ("u_clamp_min", "u_clamp_max")):
            require(low not in gains[joint] or gains[joint][low] < gains[joint][high], f"{where}: {low} is not below {high}")


def read(file, name):
    with open(file, encoding="ascii") as stream:
        try:
            root = yaml.load(stream, StrictLoader)
        except yaml.YAMLError as error:
            require(False, f"{file}: {error}")
    require(isinstance(root, dict), f"{file} is no map")
    controllers = [TRAJECTORY, PID] if PID in root else [TRAJECTORY]
    parts = [take(part, key, ("ros__parameters",))[0] for key, part in zip([MANAGER] + controllers, take(root, file, [MANAGER] + controllers))]
    manager, parameters = parts[0], dict(zip(controllers, parts[1:]))
    for distribution in FILES[name]:
        check_parameters(MANAGER, {"update_rate": manager.get("update_rate")}, distribution)
    _, *kinds = take(manager, MANAGER, ["update_rate"] + controllers)
    for controller, kind in zip(controllers, kinds):
        require(take(kind, controller, ("type",)) == [TYPES[controller]], f"the type of {controller} is {kind!r}")
    joints = parameters[TRAJECTORY].get("joints")
    require(isinstance(joints, list), f"{TRAJECTORY} has no joints")
    for distribution in FILES[name]:
        for controller in controllers:
            check_parameters(controller, parameters[controller], distribution)
    commands, states = parameters[TRAJECTORY]["command_interfaces"], parameters[TRAJECTORY]["state_interfaces"]
    if PID in parameters:
        # The trajectory's positions go to the references of pid_controller, which adds them to the output of its PID.
        pid = parameters[PID]
        require(parameters[TRAJECTORY]["command_joints"] == [f"{PID}/{joint}" for joint in joints], "command_joints of no pid_controller")
        require(pid["dof_names"] == joints and commands == ["position"] == pid["reference_and_state_interfaces"], "interfaces that do not go together")
        require(pid["command_interface"] == "position" and "gains" not in parameters[TRAJECTORY], "two controllers with gains")
        require(name != "jazzy" or pid["enable_feedforward"], "the position is not added")
        require(all(gains["feedforward_gain"] == 1 for gains in pid["gains"].values()), "the position is not added")
    else:
        # Efforts and velocities want both: the PID's errors of position and velocity.
        require(commands in (["effort"], ["velocity"]) and {"position", "velocity"} <= set(states), "interfaces that do not go together")
    gains = parameters[controllers[-1]].get("gains")
    check_gains(gains, joints, f"{name}, gains")
    return {"update_rate": manager["update_rate"], "interface": commands[0], "joints": joints, "gains": gains}


def main():
    folder = pathlib.Path(sys.argv[1])
    found = [name for name in FILES if (folder / f"controllers-{name}.yaml").exists()]
    require({file.name for file in folder.iterdir()} == {f"controllers-{name}.yaml" for name in found}, "other files than expected")
    everything = {name: read(folder / f"controllers-{name}.yaml", name) for name in found}
    # Only Humble lacks a controller of positions.
    require(found == list(FILES) or found == ["jazzy", "kilted"] and everything["jazzy"]["interface"] == "position", f"files for {found} alone")
    print(json.dumps(everything))


if __name__ == "__main__":
    main()
