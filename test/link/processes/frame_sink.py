"""Takes the CRSF frames of a bridge and prints when each arrived [s] and its throttle [ticks]. A process of its own with one thread and a
priority above the bridge's, so that neither a busy machine nor Python's lock makes a frame look late. First line: its TCP port."""
import socket
import time

from link_bench import be_firm

SIZE = 26  # bytes

if __name__ == "__main__":
    be_firm(0, 70)
    server = socket.create_server(("127.0.0.1", 0))
    print(server.getsockname()[1], flush=True)
    caller, _ = server.accept()
    rest = b""
    while data := caller.recv(4096):
        now = time.monotonic()
        rest += data
        while len(rest) >= SIZE:
            print(f"{now:.6f} {int.from_bytes(rest[3:25], 'little') >> 22 & 0x7FF}", flush=True)
            rest = rest[SIZE:]
