"""Sees a clock jump: the rule of include/snapwing/common/time_watch.h, for programs in Python."""

MISSING, ON, BACK, AHEAD = "missing", "on", "back", "ahead"


class ClockWatch:
    """Told two clocks [s]: `now`, by which messages are stamped (0 = none yet), and `steady`, which only goes on."""

    def __init__(self, tolerance=0.5):
        self.tolerance = tolerance
        self.jumps = 0
        self.gone = 0.0  # s that the clock has jumped ahead in all; negative = back
        self._latest = None
        self._steady = 0.0

    def look(self, now, steady):
        if not now > 0:
            return MISSING
        waited = max(0.0, steady - self._steady)
        before, self._steady = self._latest, steady
        if before is None or before <= now <= before + waited + self.tolerance:
            self._latest = now
            return ON
        if before - self.tolerance <= now < before:
            return ON
        self._latest = now
        self.jumps += 1
        self.gone += now - before - waited
        return BACK if now < before else AHEAD
