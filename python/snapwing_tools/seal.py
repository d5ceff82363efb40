"""Seal of commands to flight_link_node, as include/snapwing/link/command_seal.h defines it. Standard library only."""
import hashlib
import hmac
import os
import re
import secrets
import stat
import struct

from snapwing_tools.errors import InputError

LABEL = b"snapwing ROS command 2"


def load_key(path):
    """The link's key from its file: 64 hexadecimal digits, readable by the owner only."""
    try:
        mode = os.stat(path).st_mode
        with open(path, encoding="ascii") as stream:
            text = stream.read(66)
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot read the link's key: {error}") from error
    if mode & (stat.S_IRWXG | stat.S_IRWXO):
        raise InputError(f"{path}: key is open to group or others; allowed: permissions 0600")
    if not re.fullmatch("[0-9a-fA-F]{64}\n?", text):
        raise InputError(f"{path}: not a key: 64 hexadecimal digits expected")
    return bytes.fromhex(text.strip())


def arm_content(arm):
    return b"arm\0" + struct.pack("<B", bool(arm))


def reset_content():
    return b"reset\0"


def pulse_content(number, throttle, duration, mixed=False, pitch=0.0, hold=(0.0, 0.0)):
    """@param hold  throttle and duration [s] of the second level"""
    return b"pulse\0" + struct.pack("<IddddBd", number, throttle, duration, *hold, bool(mixed), pitch)


def code(key, vehicle_id, content, session, status_number, nonce):
    """HMAC-SHA-512-256: libsodium's crypto_auth, which is HMAC-SHA-512 cut to 32 bytes."""
    parts = (LABEL, vehicle_id.encode(), content, struct.pack("<qqq", session, status_number, nonce))
    text = b"".join(struct.pack("<Q", len(part)) + part for part in parts)
    return hmac.new(key, text, hashlib.sha512).digest()[:32]


def fill(seal, key, status, content):
    """Fills a snapwing/Seal for `content`, naming the LinkStatus `status`, the newest that was heard."""
    seal.session, seal.status_number = status.session, status.number
    seal.nonce = secrets.randbits(63)
    seal.code = code(key, status.vehicle_id, content, seal.session, seal.status_number, seal.nonce)
    return seal
