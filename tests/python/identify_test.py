"""identify(): the program's plant bit for bit, what it found as a dict, and the program's messages for bad logs."""
import pathlib
import unittest

from support import FolderTest, ROOT, read_bytes

import armwright

LOGS = ROOT / "configs/logs/kr300"


class IdentifyTest(FolderTest):
    def test_same_bytes_as_the_program(self):
        mine = armwright.identify(LOGS / "trajectory-A.csv", "kr300", validate=[LOGS / "trajectory-B.csv"], fit=["friction", "armature", "payload"],
                                  payload_kg=200, payload_com_m=[0, 0, -0.05], cutoff_hz=8, out="mine")
        self.run_program("identify", LOGS / "trajectory-A.csv", "--robot", "kr300", "--validate", LOGS / "trajectory-B.csv", "--fit",
                         "friction,armature,payload", "--payload", 200, "--payload-com", "0,0,-0.05", "--out", "its", "--quiet")
        for file in ("plant.toml", "identification.json", "result.json"):
            self.assertEqual(read_bytes("mine", file), read_bytes("its", file), file)
        self.run_program(*mine.manifest["command_line"][1:], "--quiet")
        found = mine.identification
        self.assertEqual(found, armwright.load_run("its").identification)
        self.assertEqual(found["doubts"], [])
        mass = next(one for one in found["parameters"] if one["name"] == "payload.mass")
        self.assertLess(mass["lower"], 200)
        self.assertGreater(mass["upper"], 200)
        self.assertLess(found["held_back"]["error_after"], 0.6 * found["held_back"]["error_before"])
        self.assertEqual([joint["joint"] for joint in found["fitted"]["joints"]], [f"joint_{number}" for number in range(1, 7)])
        # The plant that was found is one for other problems.
        problem = armwright.load_problem(robot="kr300", plant=mine.folder / "plant.toml")
        self.assertEqual(problem.configuration["robot"]["plant"], str((self.folder / "mine/plant.toml").resolve()))

    def test_default_groups_and_folder(self):
        run = armwright.identify(str(LOGS / "trajectory-A.csv"), "kr300", budget=3)
        self.assertRegex(str(run.folder), "^results/kr300-plant-ceres-lm-seed1-[0-9a-f]{8}$")
        kinds = {one["name"].split(".")[1] for one in run.identification["parameters"]}
        self.assertEqual(kinds, {"viscous", "coulomb", "offset", "armature"})
        self.assertNotIn("held_back", run.identification)
        self.assertIsNone(armwright.optimize("sphere", "random", budget=5).identification)

    def test_columns_units_and_signs_are_those_of_the_log(self):
        lines = (LOGS / "trajectory-A.csv").read_text().splitlines()
        names = lines[0].split(",")
        names[0], torque = "stamp", names.index("motor_torque_2_n_m")
        rows = [line.split(",") for line in lines[1:]]
        for row in rows:
            row[0] = f"{1000 * float(row[0]):.0f}"
            row[torque] = str(-float(row[torque]))
        pathlib.Path("mine.csv").write_text("\n".join(",".join(row) for row in [names, *rows]) + "\n")
        run = armwright.identify("mine.csv", "kr300", columns={"time": "stamp"}, units={"time": "ms"}, signs={"joint_2": -1}, budget=3)
        plain = armwright.identify(LOGS / "trajectory-A.csv", "kr300", budget=3, out="plain")
        for mine, its in zip(run.identification["parameters"], plain.identification["parameters"]):
            self.assertAlmostEqual(mine["value"], its["value"], delta=1e-9 * max(1, abs(its["value"])))
        with self.expect_error(armwright.BadDataError, "mine.csv: the efforts of joint 'joint_2' have the opposite sign", "give --sign joint_2=-1"):
            armwright.identify("mine.csv", "kr300", columns={"time": "stamp"}, units={"time": "ms"})

    def test_bad_logs_are_refused_as_by_the_program(self):
        lines = (LOGS / "trajectory-A.csv").read_text().splitlines(keepends=True)
        pathlib.Path("gap.csv").write_text("".join(lines[:100] + lines[130:]))
        with self.expect_error(armwright.BadDataError, "gap.csv:101: column 'time_s' jumps from 0.392 s to 0.516 s", "split the log there"):
            armwright.identify("gap.csv", "kr300")
        with self.expect_error(armwright.UsageError, "'frictions' cannot be fitted", "friction, stribeck"):
            armwright.identify("gap.csv", "kr300", fit=["frictions"])


if __name__ == "__main__":
    unittest.main()
