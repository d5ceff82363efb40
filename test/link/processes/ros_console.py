"""The planner's place in the fault table: takes the same commands as link_console and prints the same status lines, but through
ROS and flight_link_node. rospy comes from the environment."""
import json
import sys
import threading
import time

import rospy
from snapwing.msg import LinkStatus, PulseCommand
from snapwing.srv import Arm, ArmRequest, ResetLink, ResetLinkRequest
from snapwing_tools import seal
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

STATES = {LinkStatus.BRIDGE_IDLE: "idle", LinkStatus.BRIDGE_ARMED: "armed", LinkStatus.BRIDGE_PULSE: "pulse",
          LinkStatus.BRIDGE_FAULT: "fault"}


HEARD = {}


def on_status(message):
    HEARD["status"] = message
    print(json.dumps({"t": time.monotonic(), "state": STATES.get(message.bridge_state, "unknown"), "fault": message.bridge_fault,
                      "pulse_id": message.pulse_id, "frames": message.frames_sent, "refused": message.commands_refused,
                      "refusal": message.last_refusal, "armed": int(message.controller_armed),
                      "flags": message.arming_disable_flags}), flush=True)


def sealed(message, key, content):
    seal.fill(message.seal, key, HEARD["status"], content)
    return message


def call(name, kind, *arguments):
    def run():
        try:
            rospy.ServiceProxy(name, kind)(*arguments)
        except (rospy.ServiceException, rospy.ROSException, OSError):
            pass
    threading.Thread(target=run, daemon=True).start()


class Deadman:
    """A joystick's button: while held, a message each 20 ms; let go, one that says so."""

    def __init__(self):
        self.publisher = rospy.Publisher("command/deadman", Bool, queue_size=1, tcp_nodelay=True)
        self.held = False
        self.lock = threading.Lock()  # none says "held" after one has said "let go"
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        while True:
            with self.lock:
                if self.held:
                    self.publisher.publish(True)
            time.sleep(0.02)

    def set(self, held):
        with self.lock:
            self.held = held
            if not held:
                tell_time("deadman")
                self.publisher.publish(False)


def tell_time(what):
    print(json.dumps({"said": what, "t": time.monotonic()}), flush=True)


def abort(service):
    def run():
        tell_time("abort")
        service()
    threading.Thread(target=run, daemon=True).start()


def main():
    rospy.init_node("planner", anonymous=True, disable_signals=True)
    pulses = rospy.Publisher("command/pulse", PulseCommand, queue_size=1, tcp_nodelay=True)
    rospy.Subscriber("link_status", LinkStatus, on_status, tcp_nodelay=True)
    abort_service, deadman = rospy.ServiceProxy("abort", Trigger, persistent=True), Deadman()
    key = seal.load_key(rospy.get_param("flight_link_node/key_file"))
    for line in sys.stdin:
        words = line.split()
        if words[0] == "arm":
            call("arm", Arm, sealed(ArmRequest(data=True), key, seal.arm_content(True)))
        elif words[0] == "disarm":
            call("arm", Arm, ArmRequest(data=False))
        elif words[0] == "reset":
            call("reset_link", ResetLink, sealed(ResetLinkRequest(), key, seal.reset_content()))
        elif words[0] == "abort":
            abort(abort_service)
        elif words[0] == "deadman":
            deadman.set(words[1] == "on")
        elif words[0] in ("pulse", "hold"):
            command = PulseCommand()
            command.header.stamp = rospy.Time.now()
            command.id = int(words[1])
            command.pulse.throttle, command.pulse.duration = float(words[2]), float(words[3])
            if words[0] == "hold":
                command.pulse.hold_throttle, command.pulse.hold_duration = float(words[4]), float(words[5])
            content = seal.pulse_content(command.id, command.pulse.throttle, command.pulse.duration,
                                         hold=(command.pulse.hold_throttle, command.pulse.hold_duration))
            pulses.publish(sealed(command, key, content))


if __name__ == "__main__":
    main()
