"""Scenario for the demo: an operator and an experimenter, played through the same topics, services and action that a
person would use. Arms, switches F -> Q, lets the boom be stopped by hand, switches Q -> F, disarms, and tells what
happened. Exit code 0 only if both switches happened in truth and in the estimate."""

import argparse
import os
import signal
import sys
import threading
import time

import actionlib
import rospy
from std_srvs.srv import SetBool

from snapwing.msg import (ArmGeometry, ForceDisplacementCurve, LinkStatus, ModeState, PulseCommand, SwitchModeAction,
                          SwitchModeGoal, SwitchModeResult, VehicleTruth)
from snapwing.srv import Arm, ArmRequest, PredictSnap
from snapwing_tools import seal
from snapwing_tools.after_run import make_report
from snapwing_tools.errors import InputError, require_master
from snapwing_tools.output_file import OutputFiles, printing, require_folder, write_file
from snapwing_tools.scenario_summary import Outcome, Switch, TruthSample, happened, table, write_result

FIXED_WING, QUADROTOR = ModeState.FIXED_WING, ModeState.QUADROTOR
NAMES = {FIXED_WING: "F", QUADROTOR: "Q"}


class ScenarioFailure(Exception):
    """The scenario cannot go on; the text says why."""


class Listener:
    """Latest message of each topic, and the history of the truth."""

    TOPICS = {"arm_geometry": ArmGeometry, "force_curve": ForceDisplacementCurve, "link_status": LinkStatus,
              "mode_state": ModeState, "truth": VehicleTruth, "command/pulse": PulseCommand}

    def __init__(self):
        self._lock = threading.Lock()
        self._latest = {}
        self._arrival = {}
        self.truth = []
        self._subscribers = [rospy.Subscriber(name, kind, self._on_message, callback_args=name, queue_size=100)
                             for name, kind in self.TOPICS.items()]

    def _on_message(self, message, name):
        with self._lock:
            self._latest[name] = message
            self._arrival[name] = time.monotonic()
            if name == "truth":
                self.truth.append(TruthSample(message.header.stamp.to_sec(), message.mode, message.travel,
                                              message.speed, message.thrust))

    def latest(self, name):
        with self._lock:
            return self._latest.get(name)

    def age(self, name):
        """[s] since the last message; infinite if none came."""
        with self._lock:
            return time.monotonic() - self._arrival[name] if name in self._arrival else float("inf")

    def truth_since(self, time):
        with self._lock:
            return [sample for sample in self.truth if sample.time >= time]


class Scenario:
    """The steps, each a method; `outcome` grows as they run."""

    def __init__(self, options):
        self.options = options
        self.outcome = Outcome()
        self.listener = Listener()
        # Not the simple client: a quick answer can overtake its bookkeeping and is then lost.
        self.action = actionlib.ActionClient("switch_mode", SwitchModeAction)
        self.services = {name: rospy.ServiceProxy(name, kind) for name, kind in
                         (("arm", Arm), ("hold", SetBool), ("ring_held", SetBool), ("predict_snap", PredictSnap))}

    def run(self):
        try:
            self.wait_until_ready()
            self.call("hold", True)
            self.arm()
            self.stop_boom()
            self.switch(FIXED_WING, QUADROTOR)
            self.stop_boom()
            self.switch(QUADROTOR, FIXED_WING)
            self.stop_boom()
            self.disarm()
        except ScenarioFailure as failure:
            self.outcome.reason = str(failure)
        except InputError as failure:
            self.outcome.reason = str(failure)
        except rospy.ROSException as failure:
            self.outcome.reason = f"ROS: {failure}"
        return self.outcome

    # -- steps

    def wait_until_ready(self):
        say("waiting for the nodes")
        deadline = rospy.get_time() + self.options.ready_timeout
        for name in ("arm_geometry", "force_curve", "mode_state", "truth", "link_status"):
            self.wait(lambda name=name: self.listener.latest(name) is not None, deadline, f"nothing on topic {name}")
        for name, service in self.services.items():
            self.wait(lambda service=service: _is_there(service), deadline, f"no service {name}")
        self.wait(lambda: self.action.wait_for_server(rospy.Duration(0.1)), deadline, "no action server switch_mode")
        self.wait(lambda: self.listener.latest("link_status").controller_connected, deadline,
                  "the flight controller does not answer the radio bridge")
        self.outcome.vehicle = self.listener.latest("arm_geometry").vehicle
        curve = self.listener.latest("force_curve")
        self.outcome.curve_rung = curve.rung
        if not curve.bistable:
            raise ScenarioFailure("the arm's force curve is not bistable")

    def arm(self):
        """Asks until the controller is armed: right after power-up it refuses for some seconds (boot grace)."""
        say("arming")
        deadline = rospy.get_time() + self.options.arm_timeout
        answer = ""
        while not rospy.is_shutdown():
            reply = self.call("arm", self.arm_request())
            answer = "" if reply.success else reply.message
            until = min(deadline, rospy.get_time() + 1.5)
            while rospy.get_time() < until and not rospy.is_shutdown():
                status = self.listener.latest("link_status")
                if status.controller_armed and status.bridge_state == LinkStatus.BRIDGE_ARMED:
                    return
                rospy.sleep(0.02)
            if rospy.get_time() >= deadline:
                raise ScenarioFailure("arming failed: " + (answer or describe_link(self.listener.latest("link_status"))))
        raise ScenarioFailure("interrupted")

    def arm_request(self):
        """Sealed as an operator's; the nodes were told where the key lies."""
        request = ArmRequest(data=True)
        key = seal.load_key(rospy.get_param("flight_link_node/key_file"))
        seal.fill(request.seal, key, self.listener.latest("link_status"), seal.arm_content(True))
        return request

    def stop_boom(self):
        """The experimenter brakes the boom to rest and keeps it in the hand; the operator tells the estimator."""
        say("the hand stops the boom")
        self.call("hold", True)
        deadline = rospy.get_time() + self.options.stop_timeout
        self.wait(self.still, deadline, "the boom does not come to rest")
        self.call("ring_held", True)

    def still(self):
        recent = self.listener.truth_since(rospy.get_time() - 0.3)
        return len(recent) > 5 and self.listener.latest("truth").held and all(abs(s.speed) < 0.01 for s in recent)

    def switch(self, start, target):
        switch = Switch(start, target)
        self.outcome.switches.append(switch)
        say(f"planning {NAMES[start]} -> {NAMES[target]}")
        result = self.ask(target, plan_only=True, timeout=self.options.plan_timeout)
        self.note_plan(switch, result)
        if result.code != SwitchModeResult.SUCCEEDED:
            switch.code, switch.message = result.code, result.message
            raise ScenarioFailure(f"{NAMES[start]} -> {NAMES[target]}: {result.message}")
        self.note_prediction(switch)
        say(f"switching {NAMES[start]} -> {NAMES[target]}: throttle {100 * switch.throttle:.1f} % "
            f"for {switch.duration:.3f} s")
        self.call("ring_held", False)
        self.call("hold", False)
        if self.options.kill_bridge == NAMES[start]:
            threading.Thread(target=self.kill_bridge, args=(switch.duration,), daemon=True).start()
        if start == QUADROTOR:
            threading.Thread(target=self.mark_pulse, daemon=True).start()
        asked = rospy.get_time()
        result = self.ask(target, plan_only=False, timeout=self.options.switch_timeout)
        self.note_result(switch, result, asked)
        say(f"{NAMES[start]} -> {NAMES[target]}: {switch.trouble() or 'switched'}")
        if switch.trouble():
            self.call("hold", True)
            raise ScenarioFailure(f"{NAMES[start]} -> {NAMES[target]}: {self.explain(switch)}")

    def explain(self, switch):
        """Adds what the link says a moment later: a lost link shows as the flight controller's failsafe."""
        if switch.code != SwitchModeResult.LINK_LOST:
            return switch.trouble()
        return switch.trouble() + self.motors_afterwards()

    def motors_afterwards(self):
        """What the motors truly did once the link was gone: the flight controller's failsafe turns them off."""
        rospy.sleep(self.options.failsafe_wait)
        truth = self.listener.latest("truth")
        if truth is None or self.listener.age("truth") > 0.5:
            return ""
        off = max(truth.motor_outputs or [0.0]) == 0.0
        return "; the motors are off" if off else "; the motors are still turning"

    def kill_bridge(self, duration):
        """Ends the radio bridge without warning in the middle of the next pulse."""
        with open(os.path.join(self.options.output_dir, "radio_bridge.pid"), encoding="ascii") as stream:
            process = int(stream.read())
        while not rospy.is_shutdown():
            if self.listener.latest("link_status").bridge_state == LinkStatus.BRIDGE_PULSE:
                rospy.sleep(duration / 2)
                say("killing radio_bridge in the middle of the pulse")
                os.kill(process, signal.SIGKILL)
                return
            rospy.sleep(0.005)

    def mark_pulse(self):
        """The empty file picture_now tells others that the long pulse has begun: the moment worth a picture."""
        while self.options.output_dir and not rospy.is_shutdown():
            if self.listener.latest("link_status").bridge_state == LinkStatus.BRIDGE_PULSE:
                rospy.sleep(0.2)  # the thrust rises first
                with open(os.path.join(self.options.output_dir, "picture_now"), "w", encoding="ascii"):
                    return
            rospy.sleep(0.005)

    def disarm(self):
        say("disarming")
        self.call("arm", ArmRequest(data=False))
        deadline = rospy.get_time() + 3.0
        self.wait(lambda: not self.listener.latest("link_status").controller_armed, deadline, "disarming failed")

    # -- notes

    def note_plan(self, switch, result):
        plan = result.plan
        switch.throttle, switch.duration, switch.pulse = plan.pulse.throttle, plan.pulse.duration, plan.pulse
        switch.worst_margin, switch.share = plan.worst_margin, plan.share_switched
        switch.realisations, switch.plan_seconds = plan.realisations, plan.compute_seconds

    def note_prediction(self, switch):
        """Asks the reduced model itself, as anyone may."""
        reply = self.call("predict_snap", switch.start, switch.pulse, 0.0)
        if not reply.ok:
            raise ScenarioFailure(f"predict_snap: {reply.message}")
        prediction = reply.prediction
        switch.rung, switch.predicted_mode = prediction.rung, prediction.end_mode
        switch.predicted_snap_time, switch.predicted_margin = prediction.snap_time, prediction.energy_margin
        switch.predicted_peak, switch.predicted_least = prediction.peak_travel, prediction.least_travel

    def note_result(self, switch, result, asked):
        # What the vehicle does shows best a moment after the estimate has settled.
        rospy.sleep(self.options.watch_after)
        switch.code, switch.message = result.code, result.message
        command = self.listener.latest("command/pulse")
        commanded = command.header.stamp.to_sec() if command else asked
        barrier = self.listener.latest("force_curve").barrier_travel
        switch.happened = happened(self.listener.truth_since(asked), barrier, max(commanded, asked))
        # A busy machine may deliver late; an estimate that has stopped counts as unknown.
        deadline = rospy.get_time() + 3.0
        while self.listener.age("mode_state") > 0.2 and rospy.get_time() < deadline:
            rospy.sleep(0.02)
        state = self.listener.latest("mode_state")
        fresh = self.listener.age("mode_state") < 0.5
        switch.estimated_mode = state.mode if fresh else ModeState.UNKNOWN
        switch.estimated_probability = (state.probability_quadrotor if switch.target == QUADROTOR
                                        else state.probability_fixed_wing)
        switch.estimated_seconds = result.switch_seconds

    # -- helpers

    def ask(self, target, plan_only, timeout):
        """The planner reports several times a second while it works, however long that takes on a busy machine; only its
        silence for `timeout` is a failure."""
        heard = [time.monotonic()]

        def on_feedback(*_):
            heard[0] = time.monotonic()

        goal = self.action.send_goal(SwitchModeGoal(target_mode=target, plan_only=plan_only), feedback_cb=on_feedback)
        while goal.get_comm_state() != actionlib.CommState.DONE:
            if time.monotonic() > heard[0] + timeout or rospy.is_shutdown():
                goal.cancel()
                raise ScenarioFailure(f"switch_mode was silent for {timeout:g} s")
            time.sleep(0.02)
        result = goal.get_result()
        if result is None:
            raise ScenarioFailure("switch_mode is gone: the planner node ended")
        return result

    def call(self, name, *arguments):
        try:
            return self.services[name](*arguments)
        except rospy.ServiceException as failure:
            raise ScenarioFailure(f"service {name}: {failure}") from failure

    def wait(self, condition, deadline, complaint):
        while not rospy.is_shutdown():
            if condition():
                return
            if rospy.get_time() > deadline:
                raise ScenarioFailure(complaint)
            rospy.sleep(0.02)
        raise ScenarioFailure("interrupted")


def _is_there(service):
    try:
        service.wait_for_service(0.05)
        return True
    except rospy.ROSException:
        return False


def describe_link(status):
    """One line about the link, for a failure's reason."""
    if status.bridge_fault:
        return f"bridge fault: {status.bridge_fault}"
    if not status.controller_connected:
        return "the flight controller is not connected"
    return f"arming-disable flags 0x{status.arming_disable_flags:x}, last refusal '{status.last_refusal}'"


def say(text):
    print(f"[scenario] {text}", flush=True)


def parse_options(arguments):
    parser = argparse.ArgumentParser(prog="run_scenario", description=__doc__)
    parser.add_argument("--output-dir", default="", metavar="FOLDER",
                        help="write run_summary.json and summary.txt there")
    parser.add_argument("--report", default="", metavar="VEHICLE.yaml",
                        help="at the end have the recorder save FOLDER/run.h5 and make FOLDER/report.html of it; - = the "
                             "vehicle that the parameter vehicle_file of the namespace names")
    parser.add_argument("--end-roslaunch", action="store_true", help="after both switches, end the roslaunch that "
                        "started this")
    parser.add_argument("--mount", default="auto", choices=("auto", "free", "boom", "held"),
                        help="what the vehicle hangs on, for the report's predictions (%(default)s)")
    parser.add_argument("--kill-bridge", default="none", choices=("none", "F", "Q"),
                        help="kill radio_bridge in the middle of the pulse that starts in this mode (a test of the "
                             "failsafe; needs its process id in FOLDER/radio_bridge.pid)")
    for name, default, text in (("ready-timeout", 120.0, "all nodes must be there by then"),
                                ("arm-timeout", 20.0, "for arming, boot grace included"),
                                ("plan-timeout", 60.0, "silence of the planner while it plans"),
                                ("switch-timeout", 20.0, "silence of the planner while it switches"),
                                ("stop-timeout", 15.0, "for the hand to stop the boom"),
                                ("watch-after", 0.5, "watched after each switch"),
                                ("failsafe-wait", 2.0, "after a lost link, before the motors are looked at")):
        parser.add_argument(f"--{name}", type=float, default=default, metavar="S", help=f"[s] {text} (%(default)s)")
    options = parser.parse_args(arguments)
    if (options.kill_bridge != "none" or options.report) and not options.output_dir:
        parser.error("--kill-bridge and --report need --output-dir")
    return options


def write_outcome(outcome, folder):
    os.makedirs(folder, exist_ok=True)
    write_file(os.path.join(folder, "summary.txt"), table(outcome) + "\n")
    write_result(outcome, os.path.join(folder, "run_summary.json"))


def check_outputs(options):
    if options.output_dir:
        require_folder(options.output_dir)
        for name in ("summary.txt", "run_summary.json"):
            if os.path.isdir(options.output_dir):
                OutputFiles().writes(os.path.join(options.output_dir, name), "--output-dir")


def main():
    options = parse_options(rospy.myargv(argv=sys.argv)[1:])
    try:
        check_outputs(options)
        require_master()
        return printing(lambda: play(options), "run_scenario")
    except InputError as error:
        print("run_scenario: {}".format(error), file=sys.stderr)
        return 2


def play(options):
    rospy.init_node("scenario", anonymous=False)
    outcome = Scenario(options).run()
    if options.output_dir:
        write_outcome(outcome, options.output_dir)
    print("\n" + table(outcome) + "\n")
    if options.report:
        say("making the report")
        vehicle_file = rospy.get_param("vehicle_file") if options.report == "-" else options.report
        problem = make_report(options.output_dir, vehicle_file, options.mount)
        if problem:
            say(f"no report: {problem}")
    if outcome.trouble():
        return 1
    if options.end_roslaunch:
        end_roslaunch()
    return 0


def end_roslaunch(patience=60.0):
    """A good end: asks the roslaunch that started this node to end everything, as Ctrl-C would, and waits for it. Ending
    as a required node would do the same, but with an error in red. Without roslaunch: nothing."""
    parent = os.getppid()
    with open(f"/proc/{parent}/cmdline", "rb") as stream:
        started_by_roslaunch = b"roslaunch" in stream.read()
    if not started_by_roslaunch:
        return
    say("done: both switches happened")
    os.kill(parent, signal.SIGINT)
    deadline = time.monotonic() + patience
    while not rospy.is_shutdown() and time.monotonic() < deadline:
        time.sleep(0.05)
