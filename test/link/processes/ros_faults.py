"""Faults of the ROS side: planner, flight_link_node, ROS master. They need a sourced workspace with snapwing in it."""
import pathlib
import random
import signal
import socket
import subprocess
import time

from link_bench import Bench, NotBegun, Process, free_port
from link_faults import Fault, Undisturbed

HERE = pathlib.Path(__file__).resolve().parent


class RosBench(Bench):
    """As Bench, with flight_link_node as the operator's end and a planner process in the console's place."""

    def start_console(self, prefix=()):
        self.ros_port = free_port(socket.SOCK_STREAM)
        self.environment.update(ROS_MASTER_URI=f"http://localhost:{self.ros_port}", ROS_HOSTNAME="localhost",
                                ROS_LOG_DIR=self.home.name)
        self.start_master()
        self.start_node()
        return self.start_planner()

    def start_master(self):
        self.master = Process(["rosmaster", "--core", "-p", self.ros_port], env=self.environment)
        self.processes.append(self.master)
        for _ in range(100):
            if subprocess.run(["rosparam", "list"], env=self.environment, capture_output=True).returncode == 0:
                break
            time.sleep(0.1)
        subprocess.run(["rosparam", "load", str(HERE.parents[2] / "config/nodes/flight_link_node.yaml"), "/flight_link_node"],
                       env=self.environment, check=True, capture_output=True)

    def start_node(self):
        self.node = self.start("flight_link_node", [f"_lcm_url:={self.url}", f"_key_file:={self.key}"])

    def start_planner(self):
        planner = Process(["/usr/bin/python3", HERE / "ros_console.py"], self._status, env=self.environment)
        self.processes.append(planner)
        self.statuses.clear()
        deadline = time.monotonic() + 15
        while not self.statuses and time.monotonic() < deadline:
            time.sleep(0.05)
        time.sleep(0.3)  # the node's subscription to the new publisher
        return planner

    def arm(self, timeout=10):
        """The services do the cycling of the switch and the waiting themselves."""
        deadline = time.monotonic() + timeout
        while time.monotonic() < deadline:
            if self.fresh().get("state") == "fault":
                self.console.send("reset")
                time.sleep(0.4)
            self.console.send("arm")
            until = time.monotonic() + 1.0
            while time.monotonic() < until:
                if self.fresh().get("state") == "armed" and self.fresh().get("armed") and self.motors.last()["armed"]:
                    return
                time.sleep(0.005)
        raise NotBegun(f"not armed: {self.status()} {self.node.lines[-3:]}")


class OnRos(Fault):
    def __init__(self, programs, seed):
        self.rng = random.Random(seed)
        self.bench = RosBench(programs)
        self.programs = programs


class NodeKilled(OnRos):
    name = "flight_link_node: kill -9, then started again"
    promise = 0.25
    guard = "bridge: heartbeat timeout"

    def harm(self):
        self.bench.node.signal(signal.SIGKILL)
        since = time.monotonic()

        def undo():
            self.bench.node.kill()
            self.bench.start_node()
            time.sleep(1.0)
        return since, undo


class NodeStopped(OnRos):
    name = "flight_link_node: SIGSTOP, then SIGCONT"
    promise = 0.25
    guard = "bridge: heartbeat timeout, latched"

    def harm(self):
        self.bench.node.signal(signal.SIGSTOP)
        since = time.monotonic()
        pause = self.rng.uniform(0.3, 1.0)

        def undo():
            time.sleep(max(0.0, since + pause - time.monotonic()))
            self.bench.node.signal(signal.SIGCONT)
        return since, undo


class DuringPulse(OnRos, Undisturbed):
    """Harm in the middle of a pulse that need not break it off."""
    trial = Undisturbed.trial
    guard = "bridge: own deadline"
    pulse = 0.5
    rises = False

    def begin(self):
        bench, rng = self.bench, self.rng
        send = bench.console.send

        def pulse_then_harm(line):
            send(line)
            time.sleep(rng.uniform(0.03, 0.45))
            self.hurt()
        bench.console.send = pulse_then_harm
        return self.heal


class PlannerKilled(DuringPulse):
    name = "planner: kill -9 in the middle of its pulse"

    def hurt(self):
        self.bench.console.signal(signal.SIGKILL)

    def heal(self):
        self.bench.console.kill()
        self.bench.console = self.bench.start_planner()


class PlannerStopped(DuringPulse):
    name = "planner: SIGSTOP in the middle of its pulse, then SIGCONT"

    def hurt(self):
        self.bench.console.signal(signal.SIGSTOP)

    def heal(self):
        self.bench.console.signal(signal.SIGCONT)
        del self.bench.console.send


class MasterKilled(DuringPulse):
    name = "ROS master: kill -9 in the middle of a pulse"

    def hurt(self):
        self.bench.master.signal(signal.SIGKILL)

    def heal(self):
        """Without a master nothing of ROS can start again: all of it is replaced, bridge and controller stay."""
        bench = self.bench
        for process in (bench.console, bench.node, bench.master):
            process.kill()
        bench.start_master()
        bench.start_node()
        bench.console = bench.start_planner()


class MasterStopped(DuringPulse):
    name = "ROS master: SIGSTOP in the middle of a pulse, then SIGCONT"

    def hurt(self):
        self.bench.master.signal(signal.SIGSTOP)

    def heal(self):
        self.bench.master.signal(signal.SIGCONT)
        del self.bench.console.send


ALL = [NodeKilled, NodeStopped, PlannerKilled, PlannerStopped, MasterKilled, MasterStopped]
