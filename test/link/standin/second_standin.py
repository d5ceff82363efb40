"""A second stand-in flight controller, written from the measured rules alone (docs/safety.md, "What the stand-in does") and not from
src/link/standin_*.cpp: bytes and times in, state and answers out. test_two_standins.py compares the two. Times in microseconds."""
import bisect
import struct

MS = 1000
FLIGHT = 4  # channels that a flight needs: A E T R
A, E, T, R, AUX1 = range(5)

RXLOSS, FAILSAFE, NOT_DISARMED, THROTTLE, BOOTGRACE, ARMSWITCH = 1 << 2, 1 << 1, 1 << 3, 1 << 7, 1 << 9, 1 << 25

# values that the rules leave open, as the first has them
BOXES = [0, 1, 2, 27, 13, 36]
CYCLE_TIME = 125
RATE = 96.037  # turns a second
LARGEST, LARGEST_V1 = 255, 254  # payloads that a port holds

# throttle [us] -> motor [us], as measured; straight lines between
MEASURED = [(1050, 1070), (1100, 1118), (1300, 1314), (1500, 1509), (1700, 1706), (2000, 1999)]


def motor_for(throttle):
    if throttle < MEASURED[0][0]:
        return MEASURED[0][1]
    if throttle >= MEASURED[-1][0]:
        return MEASURED[-1][1]
    k = bisect.bisect_right([x for x, _ in MEASURED], throttle) - 1
    (x0, y0), (x1, y1) = MEASURED[k:k + 2]
    return y0 + (y1 - y0) * (throttle - x0) / (x1 - x0)


class Channel:
    """Last good value and when it came."""

    def __init__(self, value):
        self.value, self.heard = value, None

    def take(self, value, now):
        if 885 <= value <= 2115:
            self.value, self.heard = value, now

    def lost(self, now):
        return self.heard is None or now - self.heard > 300 * MS


class Controller:
    """Receiver, arming, failsafe, motors."""

    def __init__(self):
        self.channels = [Channel(1500), Channel(1500), Channel(885), Channel(1500)] + [Channel(1000) for _ in range(12)]
        self.first_frame = self.last_frame = None
        self.stream_since = None     # signal good without a break since
        self.last_good = None        # last frame with all flight channels good or held
        self.blind_until = None      # thrust stays away a little after a gap
        self.armed = self.failsafe = False
        self.must_be_off_once = False
        self.refused = False         # switched on in vain
        self.switch_on_since = None  # when arming began

    # -- frames

    def frame(self, values, now):
        for channel, value in zip(self.channels, values):
            channel.take(value, now)
        if self.first_frame is None:
            self.first_frame = now
            self.must_be_off_once = self.switch()
        if self.last_frame is not None and now - self.last_frame > 280 * MS:
            self.blind_until = now + 20 * MS
        if self.last_frame is None:
            self.blind_until = now + 20 * MS
        self.last_frame = now
        if any(channel.lost(now) for channel in self.channels[:FLIGHT]):
            self.stream_since = None
            return
        if self.stream_since is None or now - self.last_good > 100 * MS:
            self.stream_since = now
        self.last_good = now

    # -- what the rules say at a moment

    def switch(self):
        return self.first_frame is not None and self.channels[AUX1].value >= 1700

    def silent_for(self, now):
        return float("inf") if self.last_good is None else now - self.last_good

    def rxloss(self, now):
        return self.stream_since is None or self.silent_for(now) > 100 * MS or now - self.stream_since < 500 * MS

    def throttle(self, now):
        """In force; 885 when lost."""
        gone = self.last_frame is None or now - self.last_frame > 280 * MS
        blind = self.blind_until is not None and now < self.blind_until
        return 885 if gone or blind or self.channels[T].lost(now) else self.channels[T].value

    def flags(self, now):
        found = 0
        found |= RXLOSS * self.rxloss(now)
        found |= FAILSAFE * self.failsafe
        found |= NOT_DISARMED * self.must_be_off_once
        found |= THROTTLE * (not self.armed and self.throttle(now) >= 1050)
        found |= BOOTGRACE * (now < 5000 * MS)
        found |= ARMSWITCH * self.refused
        return found

    def tick(self, now):
        if self.armed and self.silent_for(now) >= 1500 * MS:
            self.armed, self.failsafe, self.switch_on_since = False, True, None
        if self.failsafe and not self.switch() and self.silent_for(now) <= 100 * MS and \
                self.stream_since is not None and now - self.stream_since >= 1000 * MS:
            self.failsafe = False
        if not self.switch():
            self.armed = self.must_be_off_once = self.refused = False
            self.switch_on_since = None
        elif not self.armed and not self.failsafe:
            self.try_to_arm(now)

    def try_to_arm(self, now):
        if self.flags(now):
            self.refused, self.switch_on_since = True, None
        elif self.switch_on_since is None:
            self.switch_on_since = now
        elif now - self.switch_on_since >= 40 * MS:
            self.armed, self.switch_on_since = True, None

    def motor(self, now):
        return motor_for(self.throttle(now)) if self.armed else 1000

    def shown(self, now):
        """As MSP_RC: roll, pitch, yaw, throttle, AUX."""
        silent = self.last_good is None or now - self.last_good > 300 * MS
        value = [channel.value for channel in self.channels]
        for k in range(FLIGHT):
            frames_go_on = self.last_frame is not None and now - self.last_frame <= 300 * MS
            if self.channels[k].lost(now) and frames_go_on:
                value[k] = 885
            elif silent:
                value[k] = 885 if k == T else 1500
        return [value[A], value[E], value[R], value[T]] + value[AUX1:]


# -- wire


def crc8(data):
    """DVB-S2, bit by bit."""
    crc = 0
    for byte in data:
        for bit in range(7, -1, -1):
            feedback = crc >> 7 ^ byte >> bit & 1
            crc = (crc << 1 & 0xFF) ^ (0xD5 if feedback else 0)
    return crc


def xor(data):
    total = 0
    for byte in data:
        total ^= byte
    return total


def unpack11(data):
    number = int.from_bytes(data, "little")
    return [number >> 11 * k & 0x7FF for k in range(16)]


def msp1(direction, code, payload):
    body = bytes([len(payload), code]) + payload
    return b"$M" + direction + body + bytes([xor(body)])


def msp2(direction, code, payload):
    body = struct.pack("<BHH", 0, code, len(payload)) + payload
    return b"$X" + direction + body + bytes([crc8(body)])


class MspPort:
    """One command served per turn of 1/96 s; others wait, and more than 106 are lost."""

    def __init__(self, controller):
        self.controller, self.waiting, self.bytes, self.turn = controller, [], bytearray(), 0

    def hear(self, data, _now):
        self.bytes += data
        while True:
            start = self.bytes.find(b"$")
            if start < 0:
                self.bytes.clear()
                return
            del self.bytes[:start]
            # A byte that does not fit ends the attempt and is gone; only a dollar sign right after another begins anew.
            kind, direction = self.bytes[1:2], self.bytes[2:3]
            if kind == b"$":
                del self.bytes[:1]
                continue
            if kind not in (b"", b"M", b"X"):
                del self.bytes[:2]
                continue
            if direction not in (b"", b"<", b">", b"!"):
                del self.bytes[:3]
                continue
            if not direction:
                return
            if not self.whole_packet(kind, direction):
                return

    def whole_packet(self, kind, direction):
        """@return False if bytes are missing yet"""
        head = 5 if kind == b"M" else 8
        if kind == b"M" and len(self.bytes) > 3 and self.bytes[3] > LARGEST_V1:
            del self.bytes[:4]
            return True
        if len(self.bytes) < head:
            return False
        size = self.bytes[3] if kind == b"M" else struct.unpack_from("<H", self.bytes, 6)[0]
        if size > LARGEST:
            del self.bytes[:head]
            return True
        if len(self.bytes) < head + size + 1:
            return False
        body, check = bytes(self.bytes[3:head + size]), self.bytes[head + size]
        payload = body[head - 3:]
        code = body[1] if kind == b"M" else struct.unpack_from("<H", body, 1)[0]
        good = check == (xor(body) if kind == b"M" else crc8(body))
        del self.bytes[:head + size + 1]
        if good and direction == b"<" and len(self.waiting) < 106:
            self.waiting.append((kind, code, payload))
        return True

    def tick(self, now):
        """@return answers"""
        out = b""
        while self.turn * 1e6 <= now * RATE:
            if self.waiting:
                kind, code, payload = self.waiting.pop(0)
                answer = self.serve(code, payload, self.turn * 1e6 / RATE)
                out += (msp1 if kind == b"M" else msp2)(b"!" if answer is None else b">", code, answer or b"")
            self.turn += 1
        return out

    def serve(self, code, payload, now):
        fc = self.controller
        if code == 200:
            if len(payload) > 36:
                return None
            fc.tick(now)
            fc.frame(struct.unpack(f"<{len(payload) // 2}H", payload[:len(payload) // 2 * 2]), now)
            fc.tick(now)
            return b""
        if code == 1:
            return bytes([0, 1, 46])
        if code == 2:
            return b"BTFL"
        if code == 75:
            return struct.pack("<BBHBHB", 15, 10, 1000, 0, 100, 1)
        if code == 101:
            modes = sum(1 << bit for bit, box in enumerate(BOXES) if box == 0 and fc.armed or box == 27 and fc.failsafe)
            return struct.pack("<HHHIBHHB4xBIBH", CYCLE_TIME, 0, 0, modes, 0, 0, 0, 4, 26, fc.flags(now), 0, 0)
        if code == 104:
            return struct.pack("<8H", *[int(fc.motor(now))] * 4, 0, 0, 0, 0)
        if code == 105:
            return struct.pack("<16H", *fc.shown(now))
        if code == 119:
            return bytes(BOXES)
        return None


class SbusPort:
    def __init__(self, controller):
        self.controller, self.frame, self.begin, self.last = controller, bytearray(), None, None

    def hear(self, data, now):
        """All bytes of a call come at one time."""
        if data and (self.begin is None or now - self.begin > 3500):
            self.frame, self.begin = bytearray(), now
        for byte in data:
            self.take(byte, now)

    def take(self, byte, now):
        if self.frame is None:  # the rest of a burst after its frame
            return
        if not self.frame and byte != 0x0F:
            return
        self.frame.append(byte)
        if len(self.frame) < 25:
            return
        frame, self.frame = self.frame, None
        if frame[24] == 0 and not frame[23] & 0x0C:
            self.controller.frame([int(tick * 5 / 8 + 880.5) for tick in unpack11(frame[1:23])], now)

    def tick(self, _now):
        return b""


class CrsfPort:
    def __init__(self, controller):
        self.controller, self.bytes = controller, bytearray()

    def hear(self, data, now):
        self.bytes += data
        while len(self.bytes) >= 26:
            if self.bytes[:3] == b"\xc8\x18\x16" and crc8(self.bytes[2:25]) == self.bytes[25]:
                self.controller.frame([int(0.62477 * tick + 881.5) for tick in unpack11(self.bytes[3:25])], now)
                del self.bytes[:26]
            else:
                del self.bytes[:1]

    def tick(self, _now):
        return b""


PORTS = {"msp": MspPort, "sbus": SbusPort, "crsf": CrsfPort}
