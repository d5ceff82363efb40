"""flight_link_node, whose threads all have a real-time priority, ends when it is told to, on a single core too, where a thread that turns
without a pause would keep the others from ever ending it. usage: test_shutdown.py PROGRAMS SOURCE"""
import os
import pathlib
import signal
import sys
import time
import unittest

PROGRAMS, SOURCE = (pathlib.Path(part) for part in sys.argv[1:3])
sys.path.insert(0, str(SOURCE / "test/link/processes"))
from ros_faults import RosBench  # noqa: E402

TRIALS = 5
LIMIT = 20.0  # s, on a busy machine
WORK = 1.0    # s of processor time, from the request to the end


class OneCore(RosBench):
    def start(self, program, arguments, on_line=None, prefix=(), **options):
        core = str(min(os.sched_getaffinity(0)))
        return super().start(program, arguments, on_line, ("taskset", "-c", core) if program == "flight_link_node" else prefix, **options)


def processor_time(process):
    """[s]; 0 if it has ended."""
    try:
        fields = pathlib.Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except OSError:
        return 0.0


class Shutdown(unittest.TestCase):
    def setUp(self):
        self.bench = OneCore(PROGRAMS)
        self.addCleanup(self.bench.__exit__)

    def ends(self, node, request):
        before = used = processor_time(node.child.pid)
        request()
        deadline = time.monotonic() + LIMIT
        while node.child.poll() is None and time.monotonic() < deadline and used - before < 2 * WORK:
            used = max(used, processor_time(node.child.pid))
            time.sleep(0.02)
        ended = node.child.poll()
        node.kill()
        self.assertEqual(ended, 0, f"{used - before:.2f} s of processor time since the request")
        self.assertLess(used - before, WORK)

    def test_on_sigint(self):
        for _ in range(TRIALS):
            node = self.bench.node
            self.ends(node, lambda node=node: node.signal(signal.SIGINT))
            self.bench.node = self.bench.start_node()
            time.sleep(1.0)

    def test_when_another_one_takes_its_name(self):
        for _ in range(TRIALS):
            node = self.bench.node

            def replace():
                self.bench.node = self.bench.start_node()
            self.ends(node, replace)
            time.sleep(1.0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
