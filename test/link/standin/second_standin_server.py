"""The second stand-in flight controller in real time on a simulator's ports: MSP on TCP, motor outputs on UDP.
usage: second_standin_server.py TCP_PORT MOTOR_PORT   (TCP_PORT 0 = any, printed)"""
import contextlib
import os
import select
import socket
import struct
import sys
import time

import second_standin as second


class Line:
    """One caller at a time."""

    def __init__(self, port):
        self.server = socket.create_server(("127.0.0.1", port))
        self.server.setblocking(False)
        self.caller = None

    def accept(self):
        with contextlib.suppress(BlockingIOError):
            caller, _ = self.server.accept()
            if self.caller:
                caller.close()
            else:
                caller.setblocking(False)
                caller.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self.caller = caller

    def read(self):
        if not self.caller:
            return b""
        try:
            data = self.caller.recv(4096)
        except BlockingIOError:
            return b""
        except OSError:
            data = b""
        if not data:
            self.caller.close()
            self.caller = None
        return data

    def write(self, data):
        if self.caller and data:
            with contextlib.suppress(OSError):
                self.caller.sendall(data)

    def wait(self, seconds):
        select.select([self.server] + ([self.caller] if self.caller else []), [], [], seconds)


def main():
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(60))
    line = Line(int(sys.argv[1]))
    motors = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    print(f"listening on {line.server.getsockname()[1]}", flush=True)
    controller = second.Controller()
    port = second.PORTS["msp"](controller)
    begin = time.monotonic()
    due = 0.0
    while True:
        line.wait(0.001)
        data = line.read()
        line.accept()
        now = int(1e6 * (time.monotonic() - begin))
        port.hear(data, now)
        line.write(port.tick(now))
        controller.tick(now)
        if time.monotonic() >= due:
            due = time.monotonic() + 0.0005
            output = (int(controller.motor(now)) - 1000) / 1000
            with contextlib.suppress(OSError):
                motors.sendto(struct.pack("<4f", *[output] * 4), ("127.0.0.1", int(sys.argv[2])))


if __name__ == "__main__":
    main()
