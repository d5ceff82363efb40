#!/usr/bin/python3
"""Killing radio_bridge in the middle of a pulse ends with the motors off and a scenario that says why it failed."""
import sys
import unittest

import rospy
import rostest

from snapwing.msg import SwitchModeResult
from snapwing_tools import scenario


class Failsafe(unittest.TestCase):
    def test_killed_bridge(self):
        folder = sys.argv[sys.argv.index("--output-dir") + 1]
        played = scenario.Scenario(scenario.parse_options(["--kill-bridge", "F", "--output-dir", folder]))
        outcome = played.run()
        self.assertEqual(outcome.switches[0].code, SwitchModeResult.LINK_LOST)
        self.assertIn("the motors are off", outcome.trouble())
        self.assertEqual(set(played.listener.latest("truth").motor_outputs), {0.0})
        # The pulse itself had begun: there was thrust to be turned off.
        self.assertGreater(max(sample.thrust for sample in played.listener.truth), 5.0)


if __name__ == "__main__":
    rospy.init_node("test_failsafe")
    rostest.rosrun("snapwing", "failsafe", Failsafe, sys.argv)
