"""A foreign host beside the vehicle's computer, each a network namespace, with a cable between them. What the host can reach of ROS,
it uses: no thrust. Also a recorded stream of pulses, one's own pulses under simulated time, and a clock set back.
usage: test_foreign_host.py PROGRAMS SOURCE [unittest options]; needs root and a sourced workspace; else it says so and skips."""
import contextlib
import json
import os
import pathlib
import subprocess
import sys
import time
import unittest

PROGRAMS, SOURCE = (pathlib.Path(part) for part in sys.argv[1:3]) if len(sys.argv) > 2 else (None, None)
VEHICLE, HOST = f"snapv{os.getpid() % 10000}", f"snaph{os.getpid() % 10000}"
INSIDE = pathlib.Path(__file__).resolve()


def ip(*words, **options):
    return subprocess.run(["ip", *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options)


def namespaces_allowed():
    """Why not; empty if they are."""
    for name in (VEHICLE, HOST):
        made = ip("netns", "add", name)
        if made.returncode != 0:
            return made.stdout.strip() or "ip netns add failed"
    return ""


class ForeignHost(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        trouble = namespaces_allowed()
        if trouble:
            raise unittest.SkipTest(f"network namespaces are not allowed here: {trouble}")
        ip("link", "add", "snapv", "netns", VEHICLE, "type", "veth", "peer", "name", "snaph", "netns", HOST)
        for name, device, address in ((VEHICLE, "snapv", "10.77.0.1/24"), (HOST, "snaph", "10.77.0.2/24")):
            ip("-n", name, "addr", "add", address, "dev", device)
            for link in ("lo", device):
                ip("-n", name, "link", "set", link, "up")
            ip("-n", name, "route", "add", "default", "dev", device)
        cls.processes = []

    @classmethod
    def tearDownClass(cls):
        for name in (VEHICLE, HOST):
            ip("netns", "del", name)

    def run_inside(self, name, role, *arguments):
        return subprocess.Popen(["ip", "netns", "exec", name, "/usr/bin/python3", str(INSIDE), "--role", role, str(PROGRAMS), str(SOURCE),
                                 *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)

    def attacked(self, name):
        """@param name  that ROS's nodes on the vehicle go by. @return what the host found, what the vehicle saw"""
        vehicle = self.run_inside(VEHICLE, "vehicle", name)
        try:
            ready = json.loads(vehicle.stdout.readline())
            self.assertIn("node_uri", ready, ready)
            host = self.run_inside(HOST, "host", json.dumps(ready))
            attack = json.loads(host.communicate(timeout=120)[0].splitlines()[-1])
            vehicle.stdin.write("report\n")
            vehicle.stdin.flush()
            report = json.loads(vehicle.stdout.readline())
        finally:
            with contextlib.suppress(OSError):
                vehicle.stdin.close()
            vehicle.wait(30)
        print(json.dumps({"attack": attack, "report": report}, indent=1))
        self.assertTrue(attack["xmlrpc"], "roscpp's port is open to everybody: the test would show nothing otherwise")
        self.assertTrue(report["own_pulse"], "the operator's own pulse goes out, under simulated time too")
        self.assertFalse(report["foreign_thrust"])
        self.assertEqual(report["recorded"], 0, "a recorded stream of sealed pulses is refused")
        self.assertFalse(report["unsealed_arm"])
        return attack, report

    def test_loopback_as_shipped(self):
        attack, _ = self.attacked("localhost")
        self.assertFalse(attack["master"], "the ROS master hears the loopback only")
        self.assertFalse(attack["services"], "so do the services")

    def test_opened_by_a_careless_operator(self):
        attack, report = self.attacked("10.77.0.1")
        self.assertTrue(attack["master"] and attack["services"])
        self.assertGreater(attack["pulses"], 50, "the node has asked the foreign publisher for its pulses")
        self.assertGreater(report["unsealed_reached"], 50, "the node has seen them, and refused them")


# -- inside the namespaces


def vehicle_side(name):
    """Master, node, bridge and controller as bringup runs them: loopback names. Simulated time that stands still in 2020."""
    sys.path.insert(0, str(SOURCE / "test/link/processes"))
    import rospy
    from link_bench import IDLE, wait_for
    from ros_faults import RosBench
    from snapwing.msg import LinkStatus, PulseCommand
    from snapwing.srv import Arm, ArmRequest
    from snapwing_tools import seal

    RosBench.ros_host = name
    with RosBench(PROGRAMS) as bench:
        os.environ.update(bench.environment)
        bench.arm(timeout=30)
        rospy.init_node("watcher", disable_signals=True)
        rospy.set_param("/use_sim_time", True)  # for nodes that start now; flight_link_node is started anew
        bench.node.kill()
        bench.node = bench.start_node()
        time.sleep(1.5)
        bench.arm(timeout=30)
        heard, recorded = {}, []
        rospy.Subscriber("link_status", LinkStatus, lambda message: heard.update(status=message))
        publisher = rospy.Publisher("command/pulse", PulseCommand, queue_size=10)
        key = seal.load_key(bench.key)
        wait_for(lambda: "status" in heard and publisher.get_num_connections() > 0, 20, "the node's topics")

        def send(number, throttle=1.0):
            command = PulseCommand(id=number)
            command.header.stamp = rospy.Time(1577836800)  # 2020
            command.pulse.throttle, command.pulse.duration = throttle, 0.2
            seal.fill(command.seal, key, heard["status"], seal.pulse_content(number, throttle, 0.2))
            publisher.publish(command)
            recorded.append(command)

        def thrust(since):
            return bench.motors.highest(since) > IDLE
        begin = time.monotonic()
        for number in range(2000000000, 2000000005):
            if not thrust(begin):
                send(number)
                time.sleep(0.4)
        own = thrust(begin)
        node_uri = rospy.get_master().lookupNode("/flight_link_node")[2]
        since = time.monotonic()
        print(json.dumps({"node_uri": node_uri, "master_port": int(os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1]),
                          "service_port": int(rospy.get_master().lookupService("/arm")[2].rsplit(":", 1)[1])}), flush=True)
        sys.stdin.readline()
        foreign = thrust(since)
        refused = sum("no seal" in line for line in bench.node.lines)
        # A recorded stream, played into another session of the bridge, where its ids are newer than the last one.
        bench.bridge.kill()
        bench.bridge = bench.start_bridge()
        time.sleep(1.0)
        bench.arm(timeout=30)
        since = time.monotonic()
        for command in recorded * 20:
            publisher.publish(command)
            time.sleep(0.02)
        time.sleep(0.3)
        recorded_thrust = int(thrust(since))
        rospy.ServiceProxy("arm", Arm)(ArmRequest(data=False))
        time.sleep(0.3)
        unsealed = rospy.ServiceProxy("arm", Arm)(ArmRequest(data=True))
        print(json.dumps({"own_pulse": own, "foreign_thrust": foreign, "unsealed_reached": refused, "recorded": recorded_thrust,
                          "unsealed_arm": bool(unsealed.success), "why": unsealed.message}), flush=True)
        sys.stdin.readline()


def reachable(port):
    import socket
    try:
        socket.create_connection(("10.77.0.1", port), timeout=2).close()
        return True
    except OSError:
        return False


def host_side(ready):
    """An own ROS with a publisher of pulses; flight_link_node is told of it by a call that any host can make."""
    import xmlrpc.client
    os.environ.update(ROS_MASTER_URI="http://10.77.0.2:11311", ROS_IP="10.77.0.2", ROS_LOG_DIR=os.environ.get("TMPDIR", "/tmp"))
    os.environ.pop("ROS_HOSTNAME", None)
    found = {"master": reachable(ready["master_port"]), "services": reachable(ready["service_port"]), "xmlrpc": False, "pulses": 0}
    master = subprocess.Popen(["rosmaster", "--core", "-p", "11311"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        import rospy
        from snapwing.msg import PulseCommand
        for _ in range(100):
            with contextlib.suppress(OSError):
                xmlrpc.client.ServerProxy("http://10.77.0.2:11311").getPid("/host")
                break
            time.sleep(0.2)
        rospy.init_node("attacker", disable_signals=True)
        publisher = rospy.Publisher("command/pulse", PulseCommand, queue_size=10)
        port = ready["node_uri"].rstrip("/").rsplit(":", 1)[1]
        node = xmlrpc.client.ServerProxy(f"http://10.77.0.1:{port}/")
        with contextlib.suppress(OSError, xmlrpc.client.Error):
            found["xmlrpc"] = node.publisherUpdate("/master", "/command/pulse", [rospy.get_node_uri()])[0] == 1
        for number in range(200):
            if publisher.get_num_connections() == 0:
                time.sleep(0.05)
                continue
            command = PulseCommand(id=3000000000 + number)
            command.header.stamp = rospy.Time.now()
            command.pulse.throttle, command.pulse.duration = 1.0, 1.0
            publisher.publish(command)
            found["pulses"] += 1
            time.sleep(0.01)
    finally:
        master.terminate()
        master.wait(10)
    print(json.dumps(found), flush=True)


if __name__ == "__main__":
    if "--role" in sys.argv:
        role = sys.argv[2]
        PROGRAMS, SOURCE = pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[4])
        if role == "vehicle":
            vehicle_side(sys.argv[5])
        else:
            host_side(json.loads(sys.argv[5]))
    else:
        unittest.main(argv=sys.argv[:1] + sys.argv[3:])
