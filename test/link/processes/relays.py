"""Men in the middle for the fault table: one between the operator's and the bridge's LCM network, one on the serial line."""
import heapq
import os
import select
import socket
import struct
import threading
import time

from link_bench import Process, measure_firmly, wait_for

GROUP = "239.255.76.67"
LOOPBACK = "127.0.0.1"  # the link with ttl=0 uses no other interface


def group_socket(port):
    """Hears one LCM network; datagrams that it sends itself come from another socket and are told apart by their port."""
    hears = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    hears.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    hears.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    hears.bind((GROUP, port))
    hears.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + socket.inet_aton(LOOPBACK))
    return hears


class LcmRelay:
    """Carries datagrams between two networks; `treat(datagram)` gives the list of (delay, datagram) to hand to the bridge."""

    def __init__(self, operator_port, bridge_port):
        self.ports = (operator_port, bridge_port)
        self.hear = [group_socket(port) for port in self.ports]
        self.say = []
        for _ in self.ports:
            out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(LOOPBACK))
            out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
            out.bind(("", 0))
            self.say.append(out)
        self.own = [out.getsockname()[1] for out in self.say]
        self.treat = lambda datagram: [(0.0, datagram)]
        self.seen = []
        self.queue = []
        self.stop = False
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self):
        measure_firmly()  # it stands for a network, not for a busy machine
        count = 0
        while not self.stop:
            now = time.monotonic()
            while self.queue and self.queue[0][0] <= now:
                self.inject(heapq.heappop(self.queue)[2])
            wait = max(0.0, min(0.05, self.queue[0][0] - now)) if self.queue else 0.05
            for ready in select.select(self.hear, [], [], wait)[0]:
                datagram, sender = ready.recvfrom(65536)
                side = self.hear.index(ready)
                if sender[1] in self.own:
                    continue
                if side == 1:
                    self.say[0].sendto(datagram, (GROUP, self.ports[0]))
                    continue
                self.seen.append(datagram)
                for delay, changed in self.treat(datagram):
                    count += 1
                    heapq.heappush(self.queue, (time.monotonic() + delay, count, changed))

    def inject(self, datagram):
        self.say[1].sendto(datagram, (GROUP, self.ports[1]))

    def close(self):
        self.stop = True
        self.thread.join(1)
        for one in self.hear + self.say:
            one.close()


class SerialRelay:
    """Two pseudo-terminals with a cable between, a process of its own (serial_cable.py): the bridge's end and the stand-in's end.
    The cable can be blocked (nobody takes what is written), blocked in the middle of a frame, noisy, or cut (the bridge's
    device is gone)."""

    def __init__(self, standin_link, folder, keeps=False):
        self.path = os.path.join(folder, "cable")
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "serial_cable.py")
        self.process = Process(["/usr/bin/python3", "-u", script, standin_link, self.path, *(["keeps"] if keeps else [])])
        self.thrust_delivered = 0
        wait_for(lambda: os.path.exists(self.path), 60, "cable is there")

    def order(self, words):
        """@return the moment [s] at which it was done; what it delivered then is in thrust_delivered"""
        said = len(self.process.lines)
        self.process.send(words)
        wait_for(lambda: len(self.process.lines) > said, 5, "cable: " + words)
        moment, delivered = self.process.lines[-1].split()
        self.thrust_delivered = int(delivered)
        return float(moment)

    def close(self):
        self.process.kill()
