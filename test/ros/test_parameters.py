#!/usr/bin/python3
"""Every node refuses a wrong parameter, names it and ends with a non-zero code."""
import os
import subprocess
import sys
import unittest

import roslib.packages
import rospkg
import rospy
import rostest
import yaml

ROOT = rospkg.RosPack().get_path("snapwing")
NODES = ("design_node", "reduced_model_node", "transition_planner_node", "wing_state_node", "simulated_vehicle_node",
         "flight_link_node", "pipeline_node")
GIVEN_BY_LAUNCH = {"flight_link_node": {"lcm_url": "udpm://239.255.76.67:7999?ttl=0", "key_file": "no_such_key"},
                   "pipeline_node": {}}
REQUIRED = {"flight_link_node": "lcm_url", "pipeline_node": "cell_size"}  # of the others: vehicle_file


def shipped(node):
    with open(os.path.join(ROOT, "config", "nodes", node + ".yaml"), encoding="utf-8") as stream:
        parameters = yaml.safe_load(stream)
    given = {"vehicle_file": os.path.join(ROOT, "config", "vehicles", "arris_x220.yaml")}
    parameters.update(GIVEN_BY_LAUNCH.get(node, given))
    return parameters


def wrong_value(value):
    """Right type, outside any sensible range; for text, a word that no node knows."""
    return -123456789.0 if isinstance(value, float) else -123456789 if isinstance(value, int) else "no_such_word"


class Parameters(unittest.TestCase):
    def refused(self, node, parameters, key):
        if rospy.has_param("/" + node):
            rospy.delete_param("/" + node)
        rospy.set_param("/" + node, parameters)
        program = roslib.packages.find_node("snapwing", node)[0]
        done = subprocess.run([program, "__name:=" + node], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=30, check=False)
        self.assertNotEqual(done.returncode, 0, node)
        self.assertIn(f"/{node}/{key}", done.stdout)

    def test_unknown_key(self):
        for node in NODES:
            self.refused(node, dict(shipped(node), no_such_key=1), "no_such_key")

    def test_missing_key(self):
        for node in NODES:
            parameters = shipped(node)
            key = REQUIRED.get(node, "vehicle_file")
            del parameters[key]
            self.refused(node, parameters, key)

    def test_wrong_type(self):
        for node in NODES:
            parameters = shipped(node)
            key = REQUIRED.get(node, "vehicle_file")
            self.refused(node, dict(parameters, **{key: 7}), key)

    def test_out_of_range(self):
        for node in NODES:
            numbers = [k for k, v in shipped(node).items() if isinstance(v, (int, float)) and not isinstance(v, bool)]
            if numbers:
                key = numbers[-1]
                self.refused(node, dict(shipped(node), **{key: wrong_value(shipped(node)[key])}), key)


if __name__ == "__main__":
    rospy.init_node("test_parameters")
    rostest.rosrun("snapwing", "parameters", Parameters, sys.argv)
