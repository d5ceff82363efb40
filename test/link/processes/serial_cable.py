"""A serial cable between the stand-in's pseudo-terminal and one that it makes for the bridge; a process of its own, so that
nothing else holds it up. usage: serial_cable.py STANDIN_END BRIDGE_END [keeps]. What waits in it is dropped when the bridge flushes its
output (TCOFLUSH), as a serial driver drops it; with "keeps" it never is, as in some adapters. Orders, one a line on standard input: block, half (pass a
part of the next frame, then block), catch (block before the next frame with thrust), free, noisy, clean, cut, plug. Each is answered, when it is done, with the time at which that began
and the number of frames with thrust that it kept and delivers now (free, with "keeps"; else 0)."""
import contextlib
import fcntl
import os
import pty
import random
import select
import struct
import sys
import termios
import time
import tty

from link_bench import be_firm, raw_rc

FLUSHED = 2    # TIOCPKT_FLUSHWRITE
SPOILT = 0.3  # share of packets with a flipped bit while noisy
THROTTLE = 2   # its place among the channels (A, E, T, R)


def thrust_frames(data):
    """@return number of whole frames in `data` that command thrust"""
    return sum(channels[THROTTLE] > 1050 for channels in raw_rc(data)[0])


class Cable:
    def __init__(self, standin_end, bridge_end, keeps):
        self.keeps = keeps
        self.far = os.open(standin_end, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        tty.setraw(self.far)
        self.path = bridge_end
        self.near = self.keep = None
        self.blocked = self.half = self.catch = self.noisy = False
        self.delivered = 0
        self.rest = b""
        self.rng = random.Random()
        self.plug()

    def plug(self):
        near, slave = pty.openpty()
        tty.setraw(slave)
        os.set_blocking(near, False)
        if not self.keeps:  # packet mode: each read begins with a byte that says whether the far side flushed
            fcntl.ioctl(near, termios.TIOCPKT, struct.pack("i", 1))
        os.symlink(os.ttyname(slave), self.path)
        self.keep, self.near = slave, near

    def cut(self):
        near, self.near = self.near, None
        os.unlink(self.path)
        os.close(near)
        os.close(self.keep)

    def obey(self, order):
        """@return whether it is done now; half and catch are done with the next frame"""
        self.delivered = self.deliver() if order == "free" and self.keeps else 0
        if order in ("block", "free"):
            self.blocked = order == "block"
        if order == "free" and self.rest and not self.keeps:
            os.write(self.far, self.rest)
            self.rest = b""
        if order in ("noisy", "clean"):
            self.noisy = order == "noisy"
        if order == "half":
            self.half = True
        if order == "catch":
            self.catch = True
        if order == "cut":
            self.cut()
        if order == "plug":
            self.plug()
        return order not in ("half", "catch")

    def deliver(self):
        """All that was kept goes on at once. @return number of frames with thrust in it"""
        kept, self.rest = self.rest, b""
        with contextlib.suppress(BlockingIOError):
            while True:
                kept += os.read(self.near, 4096)
        os.write(self.far, kept)
        return thrust_frames(kept)

    def move(self, source, target):
        with contextlib.suppress(BlockingIOError, OSError):
            begin = time.monotonic()
            data = self.read_near() if source == self.near else os.read(source, 4096)
            if self.noisy and self.rng.random() < SPOILT and data:
                spoilt = bytearray(data)
                spoilt[self.rng.randrange(len(spoilt))] ^= 1 << self.rng.randrange(8)
                data = bytes(spoilt)
            if self.catch and target == self.far and thrust_frames(data):
                self.rest, data = data, b""
                self.catch, self.blocked = False, True
                print(begin, 0)
            if self.half and target == self.far and len(data) > 1:
                part = self.rng.randrange(1, len(data))
                data, self.rest = data[:part], data[part:]
                self.half, self.blocked = False, True
                print(begin, 0)
            os.write(target, data)

    def read_near(self):
        data = os.read(self.near, 4096)
        if self.keeps:
            return data
        return data[1:] if data[:1] == b"\0" else b""

    def look_for_flush(self):
        """While blocked: what the bridge has thrown away, and the rest of a frame with it."""
        flushed = os.read(self.near, 4096)[0] & FLUSHED
        if flushed:
            self.rest = b""
            with contextlib.suppress(BlockingIOError):
                while os.read(self.near, 4096)[:1] == b"\0":
                    pass

    def run(self):
        while True:
            ends = [] if self.near is None or self.blocked else [self.near, self.far]
            flushes = [self.near] if self.blocked and self.near is not None and not self.keeps else []
            ready, _, flushed = select.select([*ends, 0], [], flushes)
            if flushed:
                with contextlib.suppress(OSError):
                    self.look_for_flush()
            if 0 in ready:
                order = sys.stdin.readline().strip()
                if not order:
                    return
                begin = time.monotonic()  # before: being held up then makes no time short
                if self.obey(order):
                    print(begin, self.delivered)
                continue
            if self.near in ready:
                self.move(self.near, self.far)
            if self.far in ready:
                self.move(self.far, self.near)


if __name__ == "__main__":
    be_firm(0, 65)
    Cable(sys.argv[1], sys.argv[2], "keeps" in sys.argv[3:]).run()
