"""A second stand-in flight controller, written from the measured rules alone (docs/safety.md, "What the stand-in does") and not from
src/standin/standin_*.cpp: bytes and times in, state and answers out. test_two_standins.py compares the two. Times in microseconds."""
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
LOOK = 100 * MS  # without frames the receiver's task turns this often
RAMP = 21 * MS   # RC smoothing
GOLDEN = 2654435769  # 2**32 times the golden ratio's fraction
RING = 1400      # bytes that wait for the serial task
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
        self.replaced = False        # a flight channel was bad for too long: all four are put aside
        self.patience = 0            # how long this frame's throttle holds without another
        self.count = 0               # of frames
        self.next_look = LOOK
        self.armed = self.failsafe = False
        self.must_be_off_once = False
        self.refused = False         # switched on in vain
        self.switched = False        # as the task's last turn saw it
        self.turns_off = 0
        self.course = None           # of the motors: begin, from, to

    # -- frames

    def frame(self, values, now):
        for channel, value in zip(self.channels, values):
            channel.take(value, now)
        if self.first_frame is None:
            self.first_frame = now
            self.must_be_off_once = self.switch()
        self.last_frame = now
        self.draw_patience()
        self.replaced = any(channel.lost(now) for channel in self.channels[:FLIGHT])
        if self.replaced:
            self.stream_since = None
        else:
            if self.stream_since is None or now - self.last_good > 100 * MS:
                self.stream_since = now
            self.last_good = now
        self.turn(now, with_frame=True)
        self.next_look = now + LOOK

    def draw_patience(self):
        """The third look finds the throttle too old, up to 6 ms late; in a twentieth of cases only the fourth does."""
        self.count += 1
        share = self.count * GOLDEN % 2**32 / 2**32  # even over any number of frames
        if share < 0.05:
            self.patience = 400 * MS + 2 * MS * share / 0.05
        else:
            self.patience = 300 * MS + 6 * MS * (share - 0.05) / 0.95

    # -- what the rules say at a moment

    def switch(self):
        return self.first_frame is not None and self.channels[AUX1].value >= 1700

    def silent_for(self, now):
        return float("inf") if self.last_good is None else now - self.last_good

    def rxloss(self, now):
        return self.stream_since is None or self.silent_for(now) > 100 * MS or now - self.stream_since < 500 * MS

    def gone(self, now):
        return self.replaced or self.last_frame is None or now - self.last_frame > self.patience

    def throttle(self, now):
        """In force; 885 when lost."""
        return 885 if self.gone(now) else self.channels[T].value

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
            self.armed, self.failsafe = False, True
        if self.failsafe and self.silent_for(now) <= 100 * MS and self.stream_since is not None and \
                now - self.stream_since >= 1000 * MS:
            self.failsafe = False
        while self.next_look <= now:
            self.turn(self.next_look, with_frame=False)
            self.next_look += LOOK
        self.steer(now)

    def turn(self, now, with_frame):
        """The receiver's task: acts on the switch as the turn before saw it."""
        was, self.switched = self.switched, self.switch()
        if was:
            self.turns_off = 0
            if not self.armed:
                self.try_to_arm(now, with_frame)
        else:
            if not self.switched:
                self.must_be_off_once = self.refused = False
            if self.armed:
                self.turns_off += 1
                self.armed = self.turns_off < 4

    def try_to_arm(self, now, with_frame):
        if self.failsafe:
            if with_frame:
                self.refused = self.must_be_off_once = True
        elif self.flags(now):
            self.refused = True
        else:
            self.armed, self.turns_off = True, 0

    def steer(self, now):
        """The motors' course: an S from where they are to where the throttle wants them, 21 ms long."""
        if not self.armed:
            self.course = None
            return
        wanted = float(int(motor_for(self.throttle(now))))
        if self.course is None:
            self.course = (now - RAMP, wanted, wanted)
        elif wanted != self.course[2]:
            self.course = (now, self.motor(now), wanted)

    def motor(self, now):
        if self.course is None:
            return 1000
        begin, before, after = self.course
        part = min(1.0, (now - begin) / RAMP)
        return after if part == 1.0 else before + (after - before) * (3 * part**2 - 2 * part**3)

    def under_way(self, now):
        return self.course is not None and now - self.course[0] < RAMP

    def shown(self, now):
        """As MSP_RC: roll, pitch, yaw, throttle, AUX."""
        value = [channel.value for channel in self.channels]
        if self.gone(now):
            value[:FLIGHT] = [1500, 1500, 885, 1500]
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


def placed(size, *parts):
    """@return a payload of zeros with (place, bytes) put in"""
    payload = bytearray(size)
    for place, part in parts:
        payload[place:place + len(part)] = part
    return bytes(payload)


# How the firmware is set, where it matters here: what lost channels become, ranges of modes (ARM on AUX1 from 1700 to 2100 us, in
# steps of 25 from 900), features (MSP receiver, airmode), valid and low throttle, limits of throttle (off, 100 %) and of motors (100 %).
SETTINGS = {
    77: b"".join(struct.pack("<BH", mode, value) for mode, value in [(0, 1500)] * 3 + [(0, 885)] + [(1, 1500)] * 14),
    34: placed(80, (0, bytes([0, 0, 32, 48]))),
    36: struct.pack("<I", 1 << 14 | 1 << 22),
    44: placed(24, (1, struct.pack("<H", 1900)), (5, struct.pack("<H", 1050)), (8, struct.pack("<HH", 885, 2115))),
    111: placed(23, (15, bytes([100]))),
    94: placed(61, (47, bytes([100])))}


class MspPort:
    """One command served per turn of 1/96 s; bytes wait in a ring of 1400, and one too many loses all."""

    def __init__(self, controller):
        self.controller, self.ring, self.turn = controller, bytearray(), 0
        self.begun = bytearray()  # of a frame

    def hear(self, data, _now):
        room = RING - len(self.ring)
        if len(data) >= room:
            self.ring.clear()
            data = data[room:]
            data = data[len(data) // RING * RING:]
        self.ring += data

    def next_command(self):
        """Takes bytes from the ring until a command is whole. @return (kind, code, payload), or None if the ring is empty first"""
        while self.ring:
            self.begun.append(self.ring.pop(0))
            while self.begun:
                state = self.look_at()
                if isinstance(state, tuple):
                    return state
                if state == "wait":
                    break
        return None

    def look_at(self):
        """One step through the bytes of a begun frame. @return a command, or "wait" for more bytes, or "again" to look anew"""
        begun = self.begun
        # A byte that does not fit ends the attempt and is gone; only a dollar sign right after another begins anew.
        if begun[:1] != b"$":
            del begun[:1]
            return "again"
        kind, direction = begun[1:2], begun[2:3]
        if kind == b"$":
            del begun[:1]
            return "again"
        if kind not in (b"", b"M", b"X"):
            del begun[:2]
            return "again"
        if direction not in (b"", b"<", b">", b"!"):
            del begun[:3]
            return "again"
        return self.whole_packet(kind, direction) if direction else "wait"

    def whole_packet(self, kind, direction):
        head = 5 if kind == b"M" else 8
        begun = self.begun
        if kind == b"M" and len(begun) > 3 and begun[3] > LARGEST_V1:
            del begun[:4]
            return "again"
        if len(begun) < head:
            return "wait"
        size = begun[3] if kind == b"M" else struct.unpack_from("<H", begun, 6)[0]
        if size > LARGEST:
            del begun[:head]
            return "again"
        if len(begun) < head + size + 1:
            return "wait"
        body, check = bytes(begun[3:head + size]), begun[head + size]
        payload = body[head - 3:]
        code = body[1] if kind == b"M" else struct.unpack_from("<H", body, 1)[0]
        good = check == (xor(body) if kind == b"M" else crc8(body))
        del begun[:head + size + 1]
        return (kind, code, payload) if good and direction == b"<" else "again"

    def tick(self, now):
        """@return answers"""
        out = b""
        while self.turn * 1e6 <= now * RATE:
            command = self.next_command()
            if command:
                kind, code, payload = command
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
        if code == 64:
            return bytes([0, 1, 3, 2, 4, 5, 6, 7])
        if code in SETTINGS:
            return SETTINGS[code]
        if code == 75:
            return struct.pack("<BBHBHB", 15, 10, 1000, 0, 100, 1)
        if code == 101:
            modes = sum(1 << bit for bit, box in enumerate(BOXES) if box == 0 and fc.armed or box == 27 and fc.failsafe)
            return struct.pack("<HHHIBHHB4xBIBH", CYCLE_TIME, 0, 0, modes, 0, 0, 0, 4, 26, fc.flags(now), 0, 0)
        if code == 102:  # accelerometer, 512 per g: rests upright
            return struct.pack("<9h", 0, 0, 512, 0, 0, 0, 0, 0, 0)
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
