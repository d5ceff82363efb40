"""Men in the middle for the fault table: one between the operator's and the bridge's LCM network, one on the serial line."""
import contextlib
import heapq
import os
import pty
import random
import select
import socket
import struct
import threading
import time
import tty

GROUP = "239.255.76.67"


def group_socket(port):
    """Hears one LCM network; datagrams that it sends itself come from another socket and are told apart by their port."""
    hears = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    hears.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    hears.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    hears.bind((GROUP, port))
    hears.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, struct.pack("4sL", socket.inet_aton(GROUP), socket.INADDR_ANY))
    return hears


class LcmRelay:
    """Carries datagrams between two networks; `treat(datagram)` gives the list of (delay, datagram) to hand to the bridge."""

    def __init__(self, operator_port, bridge_port):
        self.ports = (operator_port, bridge_port)
        self.hear = [group_socket(port) for port in self.ports]
        self.say = []
        for _ in self.ports:
            out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
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
    """Two pseudo-terminals with a cable between: the bridge's end and the stand-in's end. The cable can be blocked (nobody
    takes what is written), noisy, or cut (the bridge's device is gone)."""

    def __init__(self, standin_link, folder):
        self.far = os.open(standin_link, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        tty.setraw(self.far)
        self.path = os.path.join(folder, "cable")
        self.near = self.keep = None
        self.blocked = self.noisy = False
        self.rng = random.Random(7)
        self.plug()
        self.stop = False
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def plug(self):
        near, slave = pty.openpty()
        tty.setraw(slave)
        os.set_blocking(near, False)
        if os.path.islink(self.path):
            os.unlink(self.path)
        os.symlink(os.ttyname(slave), self.path)
        self.keep, self.near = slave, near

    def cut(self):
        near, self.near = self.near, None
        os.unlink(self.path)
        os.close(near)
        os.close(self.keep)

    def _move(self, source, target, noisy):
        try:
            data = os.read(source, 4096)
            if noisy and self.rng.random() < 0.3 and data:
                spoilt = bytearray(data)
                spoilt[self.rng.randrange(len(spoilt))] ^= 1 << self.rng.randrange(8)
                data = bytes(spoilt)
            os.write(target, data)
        except (BlockingIOError, OSError):
            pass

    def _run(self):
        with contextlib.suppress(PermissionError):  # a cable does not wait for a processor
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(65))
        while not self.stop:
            near = self.near
            if near is None or self.blocked:
                time.sleep(0.001)
                continue
            try:
                ready = select.select([near, self.far], [], [], 0.01)[0]
            except (OSError, ValueError):
                continue
            if near in ready:
                self._move(near, self.far, self.noisy)
            if self.far in ready:
                self._move(self.far, near, self.noisy)

    def close(self):
        self.stop = True
        self.thread.join(1)
