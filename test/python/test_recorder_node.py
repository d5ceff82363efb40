"""The recording node with a stand-in for rospy: strict parameters, and a file that is right however the node ends."""

import importlib
import io
import json
import os
import sys
import tempfile
import types
import unittest
from unittest import mock

import synthetic_run
from snapwing_tools import run_file, topics
from snapwing_tools.errors import InputError


ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


class FakeRospy(types.ModuleType):
    """Gives parameters, keeps the subscribers' callbacks, and shuts down after some polls."""

    def __init__(self, parameters):
        super().__init__("rospy")
        self.parameters, self.callbacks, self.polls, self.on_poll, self.fatal = parameters, {}, 0, {}, []

    def get_param(self, name, default):
        tree = {"run_id": "x", "record_run": self.parameters, "plant": {"seed": 3, "deep": {"a": 1}}}
        return {"~": self.parameters, "/": tree}.get(name, default)

    def get_time(self):
        return synthetic_run.ORIGIN

    def is_shutdown(self):
        self.polls += 1
        self.on_poll.get(self.polls, lambda: None)()
        return self.polls > 4

    def Subscriber(self, name, kind, callback, callback_args, **_):  # noqa: N802, the name is rospy's
        self.callbacks[name] = lambda message: callback(message, callback_args)
        return mock.Mock()

    def Service(self, name, kind, handler):  # noqa: N802
        self.service = (name, handler)
        return mock.Mock()

    def init_node(self, name):
        self.name = name

    def loginfo(self, *_):
        pass

    def logfatal(self, text, *values):
        self.fatal.append(text % values)


class Node(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.output = os.path.join(self.folder.name, "run.h5")
        self.rospy = FakeRospy({"output": self.output})
        messages, imu = types.ModuleType("snapwing"), types.ModuleType("sensor_msgs.msg")
        messages.msg, imu.Imu = mock.Mock(), mock.Mock()
        triggers = types.ModuleType("std_srvs.srv")
        triggers.Trigger, triggers.TriggerResponse = mock.Mock(), types.SimpleNamespace
        self.rosgraph = types.ModuleType("rosgraph")
        self.rosgraph.is_master_online, self.rosgraph.get_master_uri = lambda: True, lambda: "http://here:11311"
        modules = {"rosgraph": self.rosgraph, "std_srvs": types.ModuleType("std_srvs"), "std_srvs.srv": triggers, "rospy": self.rospy,
                   "snapwing": messages, "sensor_msgs": types.ModuleType("sensor_msgs"), "sensor_msgs.msg": imu}
        self.patch = mock.patch.dict(sys.modules, modules)
        self.patch.start()
        sys.modules.pop("snapwing_tools.recorder_node", None)
        self.node = importlib.import_module("snapwing_tools.recorder_node")

    def tearDown(self):
        self.patch.stop()
        sys.modules.pop("snapwing_tools.recorder_node", None)
        self.folder.cleanup()

    def refused(self, pattern, **parameters):
        self.rospy.parameters = parameters
        with self.assertRaisesRegex(InputError, pattern):
            self.node.read_parameters()

    def test_wrong_parameters_are_named(self):
        self.refused("~output = None", autosave_period=1.0)
        self.refused("~output = 3", output=3)
        self.refused("~outptu: unknown", output="run.h5", outptu="x")
        self.refused("~autosave_period = 0.1: .* 0.5 .. 3600", output="run.h5", autosave_period=0.1)
        self.refused("~autosave_period = 'often'", output="run.h5", autosave_period="often")
        self.refused("~autosave_period = True", output="run.h5", autosave_period=True)

    def test_wrong_parameter_ends_the_node_with_2(self):
        self.rospy.parameters = {"output": os.path.join(self.folder.name, "absent", "run.h5")}
        self.assertEqual(self.node.main(), 2)
        self.assertIn("cannot write", self.rospy.fatal[0])

    def test_without_a_master_it_says_so_and_ends_with_2(self):
        self.rosgraph.is_master_online = lambda: False
        with mock.patch("sys.stderr", new_callable=io.StringIO) as text:
            self.assertEqual(self.node.main(), 2)
        self.assertEqual(text.getvalue(), "record_run: no ROS master answers at http://here:11311; "
                                          "start roscore or a launch file, or set ROS_MASTER_URI\n")

    def test_subscribes_to_every_topic_and_closes_the_file(self):
        def send():
            self.rospy.callbacks["link_status"](synthetic_run.link_message(0.1, 1, 0, 0.0, False))
        self.rospy.on_poll[2] = send
        with mock.patch("builtins.print"):
            self.assertEqual(self.node.main(), 0)
        self.assertEqual(set(self.rospy.callbacks), {topic.name for topic in topics.SERIES + topics.LATCHED})
        run = run_file.read_run(self.output)
        self.assertEqual(run.attributes["ended"], "closed")
        self.assertEqual(len(run.series["link_status"]["time"]), 1)

    def test_killed_recorder_leaves_its_last_save(self):
        seen = []

        def send():
            self.rospy.callbacks["link_status"](synthetic_run.link_message(0.1, 1, 0, 0.0, False))

        def look():
            run = run_file.read_run(self.output)
            seen.append((run.attributes["ended"], len(run.series["link_status"]["time"])))
        self.rospy.on_poll.update({1: look, 2: send, 4: look})
        with mock.patch("builtins.print"):
            self.node.record(self.output, 0.05, "")
        self.assertEqual(seen, [("recording", 0), ("recording", 1)])

    def test_service_saves_at_once_and_later_saves_keep_its_mark(self):
        answers = []

        def ask():
            name, handler = self.rospy.service
            answers.append((name, handler(None), run_file.read_run(self.output).attributes["ended"]))
            self.node.Recording.save(self.recording)
            answers.append(run_file.read_run(self.output).attributes["ended"])
        make = self.node.Recording

        def keep(*arguments):
            self.recording = make(*arguments)
            return self.recording
        self.rospy.on_poll[3] = ask
        with mock.patch("builtins.print"), mock.patch.object(self.node, "Recording", side_effect=keep) as patched:
            patched.save = make.save
            self.node.record(self.output, 100.0, "")
        name, answer, ended = answers[0]
        self.assertEqual((name, answer.success, answer.message), ("~save", True, self.output))
        self.assertEqual([ended, answers[1]], ["saved on request", "saved on request"])
        self.assertEqual(run_file.read_run(self.output).attributes["ended"], "closed")

    def test_after_a_run_the_recorder_saves_and_the_report_is_made(self):
        synthetic_run.make_buffer().save(self.output, "saved on request")
        vehicle = os.path.join(ROOT, "config", "vehicles", "arris_x220.yaml")
        self.rospy.ROSException, self.rospy.ServiceException = OSError, ValueError
        self.rospy.wait_for_service = mock.Mock()
        answer = types.SimpleNamespace(success=True, message="")
        self.rospy.ServiceProxy = mock.Mock(return_value=lambda: answer)
        sys.modules.pop("snapwing_tools.after_run", None)
        after_run = importlib.import_module("snapwing_tools.after_run")
        with mock.patch("builtins.print"), mock.patch.dict(os.environ, {"CMAKE_PREFIX_PATH": ""}):
            self.assertEqual(after_run.make_report(self.folder.name, vehicle), "")
        self.assertEqual(self.rospy.ServiceProxy.call_args[0][0], "record_run/save")
        self.assertTrue(os.path.isfile(os.path.join(self.folder.name, "report.html")))
        with mock.patch.object(after_run.report_command, "main", side_effect=ZeroDivisionError("defect")):
            self.assertIn("defect", after_run.make_report(self.folder.name, vehicle))
        answer.success, answer.message = False, "disk full"
        self.assertEqual(after_run.make_report(self.folder.name, vehicle), "disk full")
        self.rospy.wait_for_service.side_effect = OSError("timeout")
        self.assertIn("does not answer: timeout", after_run.make_report(self.folder.name, vehicle))
        sys.modules.pop("snapwing_tools.after_run", None)

    def test_parameters_of_all_nodes_are_kept(self):
        with mock.patch("builtins.print"):
            self.node.main()
        kept = json.loads(run_file.read_run(self.output).attributes["parameters"])
        self.assertEqual(kept, {"/record_run/output": self.output, "/plant/seed": 3, "/plant/deep/a": 1})

    def test_vehicle_file_is_hashed(self):
        vehicle = os.path.join(self.folder.name, "vehicle.yaml")
        with open(vehicle, "w") as file:
            file.write("name: x\n")
        self.rospy.parameters = {"output": self.output, "vehicle_file": vehicle}
        with mock.patch("builtins.print"):
            self.node.main()
        self.assertRegex(run_file.read_run(self.output).attributes["vehicle_sha256"], "^[0-9a-f]{64}$")


if __name__ == "__main__":
    unittest.main()
