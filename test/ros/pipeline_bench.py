"""What the tests of pipeline_node share: small inputs, goals with their feedback, and a node that is killed."""
import os
import pathlib
import shutil
import signal
import time
import xmlrpc.client

import actionlib
import rosgraph
import rospy

ROOT = pathlib.Path(__file__).resolve().parents[2]
VEHICLE = ROOT / "config/vehicles/arris_x220.yaml"
BODY = ROOT / "data/arms/arris_x220_body.csv"
NODE = "/pipeline_node"


def new_folder(name):
    folder = pathlib.Path(rospy.get_param("~folder")) / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def quick_settings(folder):
    """arm_tiny, checked on cells that the shipped arm keeps its curve on."""
    text = (ROOT / "test/data/designs/arm_tiny.yaml").read_text(encoding="utf-8")
    for old, new in (("../../../config", str(ROOT / "config")), ("cell_sizes: [0.004]", "cell_sizes: [0.0025, 0.00125]")):
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "arm.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def process_of_node():
    return xmlrpc.client.ServerProxy(rosgraph.Master("/test").lookupNode(NODE)).getPid("/test")[2]


class Asked:
    """A client that hears all feedback of its goals."""

    def __init__(self, name, action):
        self.name, self.action, self.feedback = name, action, []
        self.client = self.connected()

    def connected(self):
        client = actionlib.SimpleActionClient(self.name, self.action)
        assert client.wait_for_server(rospy.Duration(30)), self.name
        return client

    def send(self, goal, heard=None):
        def take(message):
            self.feedback.append(message)
            if heard:
                heard(message)
        self.feedback = []
        self.client.send_goal(goal, feedback_cb=take)

    def ask(self, goal, heard=None, patience=100):
        self.send(goal, heard)
        assert self.client.wait_for_result(rospy.Duration(patience)), "no result"
        return self.client.get_result()

    def kill_when(self, goal, there, patience=100):
        """kill -9 of the node once there(feedback) of one of the goal's; the next one is waited for."""
        self.send(goal)
        end = time.monotonic() + patience
        while not any(there(f) for f in list(self.feedback)):
            assert time.monotonic() < end, "nothing to be killed at"
            time.sleep(0.01)
        old = process_of_node()
        os.kill(old, signal.SIGKILL)
        while True:
            assert time.monotonic() < end, "the node does not come back"
            try:
                if process_of_node() != old:
                    break
            except Exception:  # pylint: disable=broad-except
                pass  # it is not there yet
            time.sleep(0.2)
        self.client = self.connected()
        # The client may take the dead node's connections for the new one's, which has the same name, and miss what comes first.
        while not self.hears_all():
            assert time.monotonic() < end, "the node that came back is not heard"
            time.sleep(0.05)

    def hears_all(self):
        """The node, asked, knows this process as a subscriber of all that it tells."""
        connections = xmlrpc.client.ServerProxy(rosgraph.Master("/test").lookupNode(NODE)).getBusInfo("/test")[2]
        heard = {c[4] for c in connections if c[1] == rospy.get_name() and c[2] == "o"}
        return {rospy.resolve_name(f"{self.name}/{topic}") for topic in ("feedback", "result", "status")} <= heard
