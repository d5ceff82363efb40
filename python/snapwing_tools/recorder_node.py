"""Node that records a run: subscribes to everything in topics.py and keeps one HDF5 file up to date. The service ~save
(std_srvs/Trigger) writes it at once, for those who want to read it while the nodes still run.

Parameters: ~output (path of the file, required), ~autosave_period [s] (> 0; what a killed recorder loses at most),
~vehicle_file (optional; its path and hash go into the provenance).
"""

import json
import os
import sys
import time

import rospy
from snapwing import msg as snapwing_msgs
from sensor_msgs.msg import Imu
from std_srvs.srv import Trigger, TriggerResponse

from snapwing_tools import provenance, topics
from snapwing_tools.errors import InputError, require_master
from snapwing_tools.recorder import RunBuffer, machine_provenance


def message_class(topic):
    package, name = topic.message.split("/")
    return Imu if package == "sensor_msgs" else getattr(snapwing_msgs, name)


def read_parameters():
    """Strict: a missing, mistyped or unknown parameter is an error."""
    given = rospy.get_param("~", {})
    unknown = set(given) - {"output", "autosave_period", "vehicle_file"}
    if unknown:
        raise InputError("parameter ~{}: unknown; known are output, autosave_period, vehicle_file".format(
            sorted(unknown)[0]))
    output = given.get("output")
    if not isinstance(output, str) or not output:
        raise InputError("parameter ~output = {!r}: expected the path of the file to write".format(output))
    period = given.get("autosave_period", 5.0)
    if isinstance(period, bool) or not isinstance(period, (int, float)) or not 0.5 <= period <= 3600:
        raise InputError("parameter ~autosave_period = {!r}: expected a number of seconds within 0.5 .. 3600".format(
            period))
    return os.path.abspath(os.path.expanduser(output)), float(period), given.get("vehicle_file", "")


def flat_parameters(tree, prefix=""):
    """Parameter tree -> {full name: value}, without what roslaunch itself leaves there."""
    found = {}
    for key, value in tree.items():
        name = prefix + "/" + key
        if isinstance(value, dict):
            found.update(flat_parameters(value, name))
        elif name.split("/")[1] not in ("roslaunch", "run_id", "rosversion", "rosdistro"):
            found[name] = value
    return found


def subscribe(buffer):
    """One subscriber per recorded topic; queues hold some seconds of the fastest one."""
    def callback(message, topic):
        buffer.add(topic, message, rospy.get_time())
    return [rospy.Subscriber(topic.name, message_class(topic), callback, callback_args=topic, queue_size=2000,
                             tcp_nodelay=True) for topic in topics.SERIES + topics.LATCHED]


class Recording:
    """A buffer and its file. The file's `ended` stays "saved on request" once somebody asked for it."""

    def __init__(self, buffer, output):
        self.buffer, self.output, self.ended = buffer, output, "recording"

    def save(self, ended=None):
        self.buffer.save(self.output, ended or self.ended)

    def autosave(self):
        """A full disk now is no reason to lose what comes: the next save holds everything."""
        try:
            self.save()
        except InputError as error:
            rospy.logwarn("not saved now: %s", error)

    def answer(self, _):
        """Service ~save."""
        self.ended = "saved on request"
        try:
            self.save()
        except InputError as error:
            return TriggerResponse(success=False, message=str(error))
        return TriggerResponse(success=True, message=self.output)


def provenance_texts(vehicle_file):
    texts = machine_provenance(" ".join(sys.argv))
    if vehicle_file:
        texts["vehicle_file"] = vehicle_file
        texts["vehicle_sha256"] = provenance.sha256_of_file(vehicle_file) or ""
    parameters = json.dumps(flat_parameters(rospy.get_param("/", {})))
    texts["parameters"] = parameters if len(parameters) < 60000 else "{}"  # an HDF5 attribute holds 64 kB
    return texts


def record(output, period, vehicle_file):
    recording = Recording(RunBuffer(rospy.get_time(), provenance_texts(vehicle_file)), output)
    recording.save()  # a place that cannot be written shows now, not at the end
    if not rospy.get_time() > 0:
        rospy.loginfo("waiting for a clock: use_sim_time is set and nobody publishes /clock")
        while not rospy.get_time() > 0 and not rospy.is_shutdown():
            time.sleep(0.02)
        recording.buffer = RunBuffer(rospy.get_time(), provenance_texts(vehicle_file))
    subscribers = subscribe(recording.buffer)
    service = rospy.Service("~save", Trigger, recording.answer)
    rospy.loginfo("recording to %s", output)
    saved = time.monotonic()
    # Plain sleep: it ends with the node, whatever becomes of the ROS clock.
    while not rospy.is_shutdown():
        time.sleep(0.1)
        if time.monotonic() - saved >= period:
            recording.autosave()
            saved = time.monotonic()
    service.shutdown()
    for subscriber in subscribers:
        subscriber.unregister()
    recording.save("closed")
    counts = ", ".join("{} {}".format(name, count) for name, count in recording.buffer.counts().items())
    print("recorded to {}: {}".format(output, counts), flush=True)


def main():
    try:
        require_master()
    except InputError as error:
        print("record_run: {}".format(error), file=sys.stderr)
        return 2
    rospy.init_node("record_run")
    try:
        record(*read_parameters())
    except InputError as error:
        rospy.logfatal("record_run: %s", error)
        return 2
    return 0
