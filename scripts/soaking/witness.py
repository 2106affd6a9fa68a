"""What is wrong with what the nodes of a soak run say, keep and hold."""

import math
import statistics
import time

LENS_MEMORY_S = 60.0   # a change of the lens is noticed, and learnt anew, within this
EVENT_MEMORY_S = 20.0  # all else shows within this
SILENCE_S = 30.0       # images come, no status does
START_S = 60.0         # a start from a state file is CONVERGED within this
SIGMAS = 6.0           # a CONVERGED value further from the truth is false: noise takes ages for that
FALSE_ALARMS_PER_HOUR = 0.1


class Witness:
    def __init__(self, feed):
        self.feed = feed
        self.disturber = None
        self.events = {}
        self.problems = []
        self.notes = {}
        self.worst_sigmas = 0.0
        self.judged = 0

    def hear_event(self, subject, message):
        key = (subject.name, message.type)
        self.events[key] = self.events.get(key, 0) + 1
        if self.disturber is not None and not self._explained(subject, message):
            self._note(f"{message.type} without a cause", f"{subject.name}: {message.sentence}")

    def hear_calibration(self, subject, message):
        truth = self.feed.truth()
        if not self._comparable(subject, message, truth):
            return
        self.judged += 1
        sigmas = max(abs(v - t) / s for v, t, s in zip(message.values, truth, message.sigma) if s > 0)
        self.worst_sigmas = max(self.worst_sigmas, sigmas)
        if sigmas > SIGMAS:
            self._note("falsely CONVERGED", f"{subject.name}: {sigmas:.1f} sigma, "
                       f"{list(message.values)} where {truth} is true")

    def false_alarms_fit(self, hours):
        """Whether as many changes without a cause have at least 1 % probability at the stated rate."""
        count = len(self.notes.get("CALIBRATION_CHANGE without a cause", []))
        mean = FALSE_ALARMS_PER_HOUR * hours
        below = sum(mean ** k * math.exp(-mean) / math.factorial(k) for k in range(count))
        return 1.0 - below >= 0.01

    def _note(self, kind, text):
        self.notes.setdefault(kind, []).append(time.strftime("%H:%M:%S ") + text)

    def _explained(self, subject, message):
        now, feed, disturber = time.monotonic(), self.feed, self.disturber
        lens = self._lens_known_since(subject)
        view = max(lens, disturber.last_cover, feed.last_gap, disturber.last_request[subject.name])
        if message.type == "CALIBRATION_CHANGE":
            return now - lens < LENS_MEMORY_S
        if message.type == "LOST":
            return feed.covered or now - view < EVENT_MEMORY_S
        if message.type == "INPUT":
            return now - max(view, disturber.last_broken) < EVENT_MEMORY_S
        return True

    def _comparable(self, subject, message, truth):
        if self.disturber is None or truth is None or message.model != "fov":
            return False
        if message.calibration_state != "CONVERGED" or message.frozen:
            return False
        if (message.width, message.height) != self.feed.size:
            return False
        return time.monotonic() - self._lens_known_since(subject) > LENS_MEMORY_S

    def _lens_known_since(self, subject):
        return max(self.feed.last_lens_change, subject.started,
                   self.disturber.last_lens_request[subject.name])


def growth(samples, field):
    """Of the second quarter's median to the last quarter's."""
    values = [getattr(sample, field) for sample in samples]
    quarter = len(values) // 4
    if quarter == 0:
        return 0.0, 0.0
    return (statistics.median(values[quarter:2 * quarter]), statistics.median(values[-quarter:]))
