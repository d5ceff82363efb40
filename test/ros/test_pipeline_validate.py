#!/usr/bin/python3
"""The action validate_vehicle: preempted, killed and gone on with, and it says no by name."""
import os
import sys
import unittest

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from pipeline_bench import ROOT, VEHICLE, Asked, new_folder  # noqa: E402

from snapwing.msg import ValidateVehicleAction, ValidateVehicleGoal, ValidateVehicleResult  # noqa: E402


class Validate(unittest.TestCase):
    def setUp(self):
        self.folder = new_folder("validate")
        self.asked = Asked("validate_vehicle", ValidateVehicleAction)
        self.goal = ValidateVehicleGoal(vehicle_file=str(VEHICLE), folder=str(self.folder / "out"))

    def trials(self):
        return {path.name: path.stat().st_mtime_ns for path in self.folder.glob("out/trials/*.json")}

    def test_preempted_killed_and_gone_on_with(self):
        first = self.asked.ask(self.goal, lambda f: f.done == 1 and self.asked.client.cancel_goal())
        self.assertEqual(self.asked.client.get_state(), GoalStatus.PREEMPTED)
        self.assertEqual(first.code, ValidateVehicleResult.PREEMPTED, first.message)
        kept = self.trials()
        self.assertGreater(len(kept), 0)
        self.asked.kill_when(self.goal, lambda f: f.done > len(kept))
        killed = self.trials()
        self.assertFalse((self.folder / "out/validation.json").exists())
        result = self.asked.ask(self.goal)
        self.assertIn(result.code, (ValidateVehicleResult.PASSED, ValidateVehicleResult.FAILED,
                                    ValidateVehicleResult.UNDECIDED), result.message)
        self.assertEqual(bool(result.failed), result.code == ValidateVehicleResult.FAILED, result.failed)
        self.assertGreater(result.passed, 5)
        self.assertTrue(os.path.isfile(result.report_file))
        after = self.trials()
        for name, stamp in {**kept, **killed}.items():
            self.assertEqual(after[name], stamp, "not computed again")

    def test_a_table_of_another_arm_fails_by_name(self):
        text = VEHICLE.read_text(encoding="utf-8").replace("../../data", str(ROOT / "data"))
        self.assertIn("value: 5.5e+6", text)
        other = self.folder / "other.yaml"
        other.write_text(text.replace("value: 5.5e+6", "value: 5.0e+6"), encoding="utf-8")
        self.goal.vehicle_file = str(other)
        result = self.asked.ask(self.goal)
        self.assertEqual(result.code, ValidateVehicleResult.FAILED, result.message)
        self.assertEqual(len(result.failed), 1)
        self.assertIn("tables of this vehicle's arm", result.failed[0])
        self.assertIn("youngs_modulus", result.failed[0])

    def test_bad_input_is_named(self):
        self.goal.plan_files = [str(self.folder / "no_such_plan.json")]
        result = self.asked.ask(self.goal)
        self.assertEqual(result.code, ValidateVehicleResult.BAD_INPUT)
        self.assertIn("no_such_plan.json", result.message)


if __name__ == "__main__":
    rospy.init_node("test_pipeline_validate")
    rostest.rosrun("snapwing", "pipeline_validate", Validate, sys.argv)
