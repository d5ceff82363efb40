#!/usr/bin/python3
"""The nodes start with the shipped files, publish, and refuse what they cannot do."""
import sys
import unittest

import actionlib
import rospy
import rostest
import tf2_ros
from sensor_msgs.msg import Imu
from visualization_msgs.msg import MarkerArray

from snapwing.msg import (ArmGeometry, ForceDisplacementCurve, LinkStatus, ModeState, SwitchModeAction, SwitchModeGoal,
                          SwitchModeResult, ThrustPulse, VehicleTruth)
from snapwing.srv import PredictSnap


class Nodes(unittest.TestCase):
    def wait(self, topic, kind):
        return rospy.wait_for_message(topic, kind, timeout=30)

    def test_design_is_latched_and_bistable(self):
        curve = self.wait("force_curve", ForceDisplacementCurve)
        self.assertTrue(curve.bistable)
        self.assertEqual(len(curve.travel), len(curve.force))
        self.assertTrue(curve.peak_force > 0 > curve.valley_force)
        geometry = self.wait("arm_geometry", ArmGeometry)
        self.assertEqual(geometry.arm_count, 4)
        self.assertEqual(len(geometry.density_sha256), 64)
        self.assertGreater(len(geometry.outline), 0)

    def test_streams(self):
        for topic, kind, least, most in (("imu", Imu, 100, 220), ("truth", VehicleTruth, 50, 110),
                                         ("mode_state", ModeState, 20, 60), ("link_status", LinkStatus, 20, 60)):
            self.wait(topic, kind)
            stamps = []
            subscriber = rospy.Subscriber(topic, kind, lambda m, s=stamps: s.append(m.header.stamp.to_sec()),
                                          queue_size=500)
            rospy.sleep(2.5)
            subscriber.unregister()
            self.assertEqual(stamps, sorted(stamps), topic)
            rate = (len(stamps) - 1) / (stamps[-1] - stamps[0])
            self.assertTrue(least < rate < most, f"{topic}: {rate:.1f} Hz")

    def test_vehicle_rests_in_fixed_wing_mode(self):
        self.assertEqual(self.wait("truth", VehicleTruth).mode, VehicleTruth.FIXED_WING)
        state = self.wait("mode_state", ModeState)
        self.assertEqual(state.mode, ModeState.FIXED_WING)
        self.assertAlmostEqual(state.probability_fixed_wing + state.probability_quadrotor, 1.0, places=6)

    def test_picture(self):
        markers = self.wait("markers", MarkerArray).markers
        names = {m.ns for m in markers}
        ghosts = {name for name in names if name.startswith("ghost ")}  # beside it while the mode is not known
        self.assertEqual(names - ghosts, {"ring", "rotors", "thrust", "housing", "arms", "wings", "linkage", "label"})
        self.assertIn(ghosts, (set(), {"ghost housing", "ghost arms", "ghost wings", "ghost linkage"}))
        for space in ("wings", "linkage"):  # two markers of the left wing, two of the right one
            self.assertEqual([m.id for m in markers if m.ns == space], [0, 1, 2, 3])
        arms = [m for m in markers if m.ns == "arms"]
        self.assertEqual(len(arms), 4)
        for arm in arms:
            self.assertGreater(len(arm.points), 100)
            self.assertEqual(len(arm.points) % 3, 0)
            self.assertEqual(len(arm.points), len(arm.colors))
        buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(buffer)
        # The namespace is the frames' prefix: two vehicles on one master do not share them.
        buffer.lookup_transform("map", "snapwing/housing", rospy.Time(), rospy.Duration(10))
        self.assertTrue(all(m.header.frame_id.startswith("snapwing/") for m in markers))
        listener.unregister()

    def test_prediction(self):
        service = rospy.ServiceProxy("predict_snap", PredictSnap)
        service.wait_for_service(30)
        nothing = service(1, ThrustPulse(throttle=0.0, duration=0.1), 0.0)
        self.assertTrue(nothing.ok)
        self.assertFalse(nothing.prediction.snapped)
        for mode, throttle in ((0, 0.5), (9, 0.5), (1, 7.0), (1, float("nan"))):
            answer = service(mode, ThrustPulse(throttle=throttle, duration=0.1), 0.0)
            self.assertFalse(answer.ok)
            self.assertNotEqual(answer.message, "")

    def test_switch_is_refused_while_disarmed(self):
        client = actionlib.ActionClient("switch_mode", SwitchModeAction)
        self.assertTrue(client.wait_for_server(rospy.Duration(30)))
        for target in (0, 2):
            goal = client.send_goal(SwitchModeGoal(target_mode=target))
            deadline = rospy.get_time() + 60
            while goal.get_comm_state() != actionlib.CommState.DONE and rospy.get_time() < deadline:
                rospy.sleep(0.02)
            result = goal.get_result()
            self.assertEqual(result.code, SwitchModeResult.NOT_READY)
            self.assertNotEqual(result.message, "")
        self.assertEqual(self.wait("truth", VehicleTruth).thrust, 0.0)


if __name__ == "__main__":
    rospy.init_node("test_nodes")
    rostest.rosrun("snapwing", "nodes", Nodes, sys.argv)
