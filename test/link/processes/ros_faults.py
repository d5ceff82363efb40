"""Faults of the ROS side: planner, flight_link_node, ROS master. They need a sourced workspace with snapwing in it."""
import contextlib
import pathlib
import signal
import socket
import time
import xmlrpc.client

import yaml
from link_bench import Bench, NotBegun, Process, free_port, wait_for_start
from link_faults import Fault, Killed, Lasting, Stopped

HERE = pathlib.Path(__file__).resolve().parent


class RosBench(Bench):
    """As Bench, with flight_link_node as the operator's end and a planner process in the console's place."""
    node_settings = {}
    namespace = ""
    ros_host = "localhost"

    def start_console(self, prefix=()):
        """The planner; the first time with all that it needs."""
        return self.start_planner() if hasattr(self, "node") else self.start_ros()

    def start_ros(self):
        port = free_port(socket.SOCK_STREAM)
        self.environment.update(ROS_MASTER_URI=f"http://{self.ros_host}:{port}", ROS_HOSTNAME=self.ros_host, ROS_LOG_DIR=self.home.name,
                                ROS_NAMESPACE=self.namespace)
        self.master = Process(["rosmaster", "--core", "-p", port], env=self.environment)
        self.processes.append(self.master)
        api = xmlrpc.client.ServerProxy(self.environment["ROS_MASTER_URI"])

        def answers():
            with contextlib.suppress(OSError):
                return api.getPid("/bench")[0] == 1
        wait_for_start(answers, "ROS master")
        settings = yaml.safe_load((HERE.parents[2] / "config/nodes/flight_link_node.yaml").read_text())
        settings.update(self.node_settings)
        for key, value in settings.items():
            api.setParam("/bench", self.namespace + "/flight_link_node/" + key, value)
        api.setParam("/bench", self.namespace + "/flight_link_node/key_file", self.key)
        self.node = self.start_node()
        return self.start_planner()

    def start_node(self):
        return self.start("flight_link_node", [f"_lcm_url:={self.url}", f"_key_file:={self.key}", f"_vehicle_id:={self.vehicle}"])

    def start_planner(self):
        planner = Process(["/usr/bin/python3", HERE / "ros_console.py"], self._status, env=self.environment)
        self.processes.append(planner)
        self.statuses.clear()
        wait_for_start(lambda: self.statuses, "planner hears the node")
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
    bench_kind = RosBench


class NodeKilled(OnRos, Killed):
    name = "flight_link_node: kill -9, then started again"
    promise = 0.25
    guard = "bridge: heartbeat timeout"
    victim = "node"


class NodeStopped(OnRos, Stopped):
    name = "flight_link_node: SIGSTOP, then SIGCONT"
    promise = 0.25
    guard = "bridge: heartbeat timeout, latched"
    victim = "node"


class PlannerKilled(OnRos, Lasting, Killed):
    name = "planner: kill -9 in the middle of its pulse, then started again"
    victim = "console"
    pauses = (0.0,)


class PlannerStopped(OnRos, Lasting, Stopped):
    name = "planner: SIGSTOP in the middle of its pulse, then SIGCONT"
    victim = "console"


class MasterKilled(OnRos, Lasting):
    name = "ROS master: kill -9 in the middle of a pulse"

    def harm(self):
        """Without a master nothing of ROS can start again: all of it is replaced, bridge and controller stay."""
        bench = self.bench
        bench.master.signal(signal.SIGKILL)

        def undo():
            time.sleep(0.3)
            for process in (bench.console, bench.node, bench.master):
                process.kill()
            bench.console = bench.start_ros()
        return None, undo


class MasterStopped(OnRos, Lasting, Stopped):
    name = "ROS master: SIGSTOP in the middle of a pulse, then SIGCONT"
    victim = "master"


ALL = [NodeKilled, NodeStopped, PlannerKilled, PlannerStopped, MasterKilled, MasterStopped]
