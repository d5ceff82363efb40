#!/usr/bin/python3
"""The action design_vehicle: preempted, killed and gone on with, to a vehicle file that names its results; refused."""
import os
import sys
import unittest

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from pipeline_bench import BODY, VEHICLE, Asked, new_folder, quick_settings  # noqa: E402

from snapwing.msg import (DesignPipelineAction, DesignPipelineFeedback, DesignPipelineGoal,  # noqa: E402
                          DesignPipelineResult)

STAGES = ["check and tables", "wing", "vehicle file", "plan F -> Q", "plan Q -> F", "validation"]


class Design(unittest.TestCase):
    def setUp(self):
        self.folder = new_folder("design")
        self.asked = Asked("design_vehicle", DesignPipelineAction)
        self.goal = DesignPipelineGoal(vehicle_file=str(VEHICLE), settings_file=str(quick_settings(self.folder)),
                                       density_file=str(BODY), into=str(self.folder / "made"))

    def begun_with(self):
        """What each stage begins with: KEPT, or why it is done."""
        return {f.name: f.what if f.what == DesignPipelineFeedback.KEPT else f.detail for f in reversed(self.asked.feedback)
                if f.what in (DesignPipelineFeedback.KEPT, DesignPipelineFeedback.BEGUN)}

    def test_preempted_killed_and_gone_on_with(self):
        kept = DesignPipelineFeedback.KEPT
        first = self.asked.ask(self.goal, lambda f: f.name == "vehicle file" and self.asked.client.cancel_goal())
        self.assertEqual(self.asked.client.get_state(), GoalStatus.PREEMPTED)
        self.assertEqual(first.code, DesignPipelineResult.PREEMPTED, first.message)
        self.assertIn("resumes", first.message)
        self.asked.kill_when(self.goal, lambda f: f.name == "validation" and f.seconds_left > 0)
        self.assertEqual([self.begun_with()[name] for name in STAGES[:3]], [kept] * 3)
        result = self.asked.ask(self.goal)
        self.assertIn(result.code, (DesignPipelineResult.PASSED, DesignPipelineResult.FAILED,
                                    DesignPipelineResult.UNDECIDED), result.message)
        self.assertEqual(result.stages, STAGES)
        self.assertEqual(list(result.kept), [True] * 5 + [False])
        self.assertEqual(self.begun_with()["validation"], "goes on")
        self.assertEqual([f.stage for f in self.asked.feedback][:5], [1, 2, 3, 4, 5])
        self.assertEqual({f.stages for f in self.asked.feedback}, {6})
        self.assertEqual(result.verdicts[:5], ["pass"] * 5, result.words)
        for path in (result.vehicle_file, result.report_file):
            self.assertTrue(os.path.isfile(path), path)
        again = self.asked.ask(self.goal)
        self.assertEqual((again.code, list(again.kept), again.verdicts), (result.code, [True] * 6, result.verdicts))
        self.assertLess(again.seconds, 5)

    def test_bad_input_is_named(self):
        self.goal.vehicle_file = "vehicle.yaml"
        result = self.asked.ask(self.goal)
        self.assertEqual(result.code, DesignPipelineResult.BAD_INPUT)
        self.assertIn("vehicle_file is 'vehicle.yaml'", result.message)
        self.goal.vehicle_file = str(VEHICLE)
        self.goal.settings_file = ""
        result = self.asked.ask(self.goal)
        self.assertEqual(result.code, DesignPipelineResult.BAD_INPUT)
        self.assertIn("arm_design.yaml", result.message)


if __name__ == "__main__":
    rospy.init_node("test_pipeline_design")
    rostest.rosrun("snapwing", "pipeline_design", Design, sys.argv)
