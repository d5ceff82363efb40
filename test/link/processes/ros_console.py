"""The planner's place in the fault table: takes the same commands as link_console and prints the same status lines, but through
ROS and flight_link_node. rospy comes from the environment."""
import json
import sys
import threading
import time

import rospy
from snapwing.msg import LinkStatus, PulseCommand
from std_srvs.srv import SetBool, Trigger

STATES = {LinkStatus.BRIDGE_IDLE: "idle", LinkStatus.BRIDGE_ARMED: "armed", LinkStatus.BRIDGE_PULSE: "pulse",
          LinkStatus.BRIDGE_FAULT: "fault"}


def on_status(message):
    print(json.dumps({"t": time.monotonic(), "state": STATES.get(message.bridge_state, "unknown"), "fault": message.bridge_fault,
                      "pulse_id": message.pulse_id, "frames": message.frames_sent, "refused": message.commands_refused,
                      "refusal": message.last_refusal, "armed": int(message.controller_armed),
                      "flags": message.arming_disable_flags}), flush=True)


def call(name, kind, *arguments):
    def run():
        try:
            rospy.ServiceProxy(name, kind)(*arguments)
        except (rospy.ServiceException, rospy.ROSException, OSError):
            pass
    threading.Thread(target=run, daemon=True).start()


def main():
    rospy.init_node("planner", anonymous=True, disable_signals=True)
    pulses = rospy.Publisher("command/pulse", PulseCommand, queue_size=1, tcp_nodelay=True)
    rospy.Subscriber("link_status", LinkStatus, on_status, tcp_nodelay=True)
    for line in sys.stdin:
        words = line.split()
        if words[0] == "arm":
            call("arm", SetBool, True)
        elif words[0] == "disarm":
            call("arm", SetBool, False)
        elif words[0] == "reset":
            call("reset_link", Trigger)
        elif words[0] == "abort":
            call("abort", Trigger)
        elif words[0] == "pulse":
            command = PulseCommand()
            command.header.stamp = rospy.Time.now()
            command.id = int(words[1])
            command.pulse.throttle, command.pulse.duration = float(words[2]), float(words[3])
            pulses.publish(command)


if __name__ == "__main__":
    main()
