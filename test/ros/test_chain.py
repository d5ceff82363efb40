#!/usr/bin/python3
"""Both switches through the whole chain, as the demo runs them."""
import sys
import unittest

import rospy
import rostest

from snapwing_tools import scenario


class Chain(unittest.TestCase):
    def test_both_switches_truly_happen(self):
        outcome = scenario.Scenario(scenario.parse_options([])).run()
        self.assertEqual(outcome.trouble(), "")
        self.assertEqual([(s.start, s.target) for s in outcome.switches], [(1, 2), (2, 1)])
        for switch in outcome.switches:
            self.assertEqual(switch.code, 0)
            self.assertEqual(switch.happened.end_mode, switch.target)
            self.assertEqual(switch.predicted_mode, switch.target)
            self.assertGreater(switch.happened.snap_time, 0.0)
            # The plan was checked over the uncertainty that the simulated vehicle is drawn from.
            self.assertEqual(switch.share, 1.0)
            self.assertLess(abs(switch.happened.peak_travel - switch.predicted_peak), 0.010)


if __name__ == "__main__":
    rospy.init_node("test_chain")
    rostest.rosrun("snapwing", "chain", Chain, sys.argv)
