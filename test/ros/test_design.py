#!/usr/bin/python3
"""The action optimize_design: a design is computed once, found by the hash of its inputs, preempted, refused."""
import os
import shutil
import sys
import time
import unittest

import actionlib
import h5py
import rospy
import rostest
import yaml
from actionlib_msgs.msg import GoalStatus

from snapwing.msg import (ArmGeometry, ForceDisplacementCurve, OptimizeDesignAction, OptimizeDesignActionFeedback, OptimizeDesignFeedback,
                          OptimizeDesignGoal, OptimizeDesignResult, WingGeometry)


class Design(unittest.TestCase):
    def setUp(self):
        self.store = rospy.get_param("~store_folder")
        shutil.rmtree(self.store, ignore_errors=True)
        self.client = actionlib.SimpleActionClient("optimize_design", OptimizeDesignAction)
        self.assertTrue(self.client.wait_for_server(rospy.Duration(30)))
        self.feedback = []

    def ask(self, settings_file="arm_tiny.yaml", kind=OptimizeDesignGoal.ARM, after_feedback=None):
        def heard(message):
            self.feedback.append(message)
            if after_feedback:
                after_feedback(message)
        self.feedback.clear()
        self.client.send_goal(OptimizeDesignGoal(kind=kind, settings_file=settings_file), feedback_cb=heard)
        self.assertTrue(self.client.wait_for_result(rospy.Duration(60)))
        return self.client.get_result()

    def listen(self):
        """Feedback on its own topic: the client drops what comes behind the result, and a short run may have all of it there."""
        told = []
        topic = rospy.Subscriber("optimize_design/feedback", OptimizeDesignActionFeedback, told.append, queue_size=100)
        self.addCleanup(topic.unregister)
        self.wait_for(lambda: topic.get_num_connections() > 0)
        return told

    def wait_for(self, holds):
        end = time.monotonic() + 10
        while not holds():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)

    def test_computed_once_and_found_again(self):
        told = self.listen()
        first = self.ask()
        self.assertEqual(first.code, OptimizeDesignResult.SUCCEEDED, first.message)
        self.assertFalse(first.from_store)
        self.wait_for(lambda: any(message.feedback.stage == OptimizeDesignFeedback.CHECKING for message in told))
        iterations = [m.feedback.iteration for m in told if m.feedback.stage == OptimizeDesignFeedback.OPTIMIZING]
        self.assertEqual(iterations, list(range(8)))
        self.assertTrue(os.path.exists(os.path.join(first.folder, "report.json")))
        self.assertTrue(os.path.exists(os.path.join(first.folder, "parts", "arm.stl")))
        geometry = rospy.wait_for_message("designed/arm_geometry", ArmGeometry, timeout=10)
        self.assertEqual(geometry.density_file, os.path.join(first.folder, "body.csv"))
        curve = rospy.wait_for_message("designed/force_curve", ForceDisplacementCurve, timeout=10)
        with h5py.File(os.path.join(first.folder, "table.h5"), "r") as table:
            made_of = {key: value.decode() if isinstance(value, bytes) else str(value)
                       for key, value in table["provenance"].attrs.items()}
        self.assertEqual(curve.inputs_sha256, made_of["inputs_sha256"])  # of the arm alone
        self.assertEqual(made_of["design_sha256"], first.inputs_sha256)
        self.assertEqual(curve.bistable, first.verdict)
        again = self.ask()
        self.assertTrue(again.from_store)
        self.assertEqual(len(self.feedback), 0)
        self.assertEqual((again.folder, again.objective, again.verdict), (first.folder, first.objective, first.verdict))
        self.assertLess(again.seconds, first.seconds)

    def test_preempted_and_gone_on_with(self):
        halted = self.ask(after_feedback=lambda f: f.iteration == 2 and self.client.cancel_goal())
        self.assertEqual(self.client.get_state(), GoalStatus.PREEMPTED)
        self.assertEqual(halted.code, OptimizeDesignResult.PREEMPTED)
        told = self.listen()
        rest = self.ask()
        self.assertEqual(rest.code, OptimizeDesignResult.SUCCEEDED, rest.message)
        self.wait_for(lambda: told)
        self.assertGreaterEqual(told[0].feedback.iteration, 2)

    def test_wing_is_designed_once_and_published(self):
        own = rospy.wait_for_message("wing_geometry", WingGeometry, timeout=10)
        self.assertTrue(os.path.exists(own.table_file))
        told = self.listen()
        first = self.ask("wing_small.yaml", OptimizeDesignGoal.WING)
        self.assertEqual(first.code, OptimizeDesignResult.SUCCEEDED, first.message)
        self.assertTrue(first.verdict and first.targets_met)
        self.wait_for(lambda: len(told) > 1)
        wing = rospy.wait_for_message("designed/wing_geometry", WingGeometry, timeout=10)
        self.assertEqual(wing.table_file, os.path.join(first.folder, "wing_table.h5"))
        self.assertTrue(os.path.exists(wing.table_file))
        for reached, wanted in zip(wing.wing_rotation, (2.45, 2.46)):
            self.assertLess(abs(reached - wanted), 0.15)
        again = self.ask("wing_small.yaml", OptimizeDesignGoal.WING)
        self.assertTrue(again.from_store)
        self.assertEqual((again.folder, again.verdict), (first.folder, first.verdict))
        self.assertAlmostEqual(again.objective, first.objective, delta=1e-9)
        self.assertEqual(self.ask("wing_closed.yaml", OptimizeDesignGoal.WING).code, OptimizeDesignResult.INFEASIBLE)

    def small_wing_on(self, rung):
        """A file like wing_small.yaml with another rung and a single local run."""
        folder = rospy.get_param("design_node/designs_folder")
        with open(os.path.join(folder, "wing_small.yaml"), encoding="utf-8") as file:
            settings = yaml.safe_load(file)
        settings["vehicle"] = os.path.abspath(os.path.join(folder, settings["vehicle"]))
        settings["rung"] = rung
        settings["search"]["starts"] = 1
        os.makedirs(os.path.dirname(self.store), exist_ok=True)
        path = os.path.join(os.path.dirname(self.store), f"wing_{rung}.yaml")
        with open(path, "w", encoding="utf-8") as file:
            yaml.safe_dump(settings, file)
        return path

    def test_the_settings_choose_the_wings_rung(self):
        told = self.listen()
        folders = set()
        for rung in ("rigid", "elastic", "solid"):
            result = self.ask(self.small_wing_on(rung), OptimizeDesignGoal.WING)
            self.assertEqual(result.code, OptimizeDesignResult.SUCCEEDED, result.message)
            self.assertTrue(result.targets_met)
            wing = rospy.wait_for_message("designed/wing_geometry", WingGeometry, timeout=10)
            self.assertEqual(wing.rung, rung)
            folders.add(result.folder)
        self.assertEqual(len(folders), 3)
        self.wait_for(lambda: len({message.status.goal_id.id for message in told}) == 3)

    def test_a_wing_on_solids_is_preempted_within_its_run(self):
        # Its only feedback comes before its only run: the goal ends before the run does.
        halted = self.ask(self.small_wing_on("solid"), OptimizeDesignGoal.WING,
                          after_feedback=lambda f: self.client.cancel_goal())
        self.assertEqual(self.client.get_state(), GoalStatus.PREEMPTED)
        self.assertEqual(halted.code, OptimizeDesignResult.PREEMPTED, halted.message)
        self.assertIn("after 0 local runs", halted.message)

    def test_bad_input_is_named(self):
        missing = self.ask("no_such_file.yaml")
        self.assertEqual(missing.code, OptimizeDesignResult.BAD_INPUT)
        self.assertIn("no_such_file.yaml", missing.message)
        unknown = self.ask(kind=OptimizeDesignGoal.UNKNOWN)
        self.assertEqual(unknown.code, OptimizeDesignResult.BAD_INPUT)
        self.assertIn("kind", unknown.message)


if __name__ == "__main__":
    rospy.init_node("test_design")
    rostest.rosrun("snapwing", "design", Design, sys.argv)
