"""run.py HOURS SEED PROGRAMS: the soak run of scripts/soak, which sets up what this needs."""

import os
import random
import signal
import subprocess
import sys
import time

import rospy
from disturber import Disturber
from feed import HEIGHT, RATE_HZ, WIDTH, Feed
from subject import Subject
from witness import SILENCE_S, START_S, Witness, growth

SAMPLE_S = 10.0
GROWTH_MB = 10.0       # what allocators and the kernel may keep
SETTLED_SHARE = 1.05
FILLED_HOURS = 0.5     # all that has a bound has reached it by the second quarter of such a run
HANDLES = 3            # listeners and calls of the moment


def start_camera(programs, seed, hours):
    parameters = {"width": WIDTH, "height": HEIGHT, "rate": RATE_HZ, "duration": 3600.0 * hours + 600.0,
                  "speed": 0.6, "seed": seed}
    log = open(os.path.join(os.environ["ROS_HOME"], "camera.log"), "wb")
    return subprocess.Popen(
        [os.path.join(programs, "simulated_camera"), "__name:=camera_node",
         "image_raw:=/source/image_raw", "camera_info:=/source/camera_info"]
        + [f"truth/{topic}:=/source/truth/{topic}" for topic in
           ("camera_info", "calibration", "pose", "finished")]
        + [f"_{key}:={value}" for key, value in parameters.items()], stdout=log, stderr=log)


def start_nodes(programs, witness):
    program = os.path.join(programs, "self_calibration_node")
    home = os.environ["ROS_HOME"]

    def node(name, autosave_s, **more):
        parameters = {"model": "fov", "camera_name": name, "state_file": f"{home}/{name}.state",
                      "camera_info_url": f"file://{home}/{name}.yaml",
                      "report_file": f"{home}/{name}.report", "autosave_interval_s": autosave_s, **more}
        return Subject(name, program, parameters, witness.hear_event, witness.hear_calibration)

    return node("steady", 30.0), node("killed", 1.0)


class Patrol:
    """Whether the nodes live, answer, and know again what they had saved."""

    def __init__(self, feed, witness, subjects):
        self._feed, self._witness, self._subjects = feed, witness, subjects
        self._next_sample = time.monotonic() + SAMPLE_S
        self._restored_start = 0
        self.restored = 0

    def step(self):
        now = time.monotonic()
        for subject in self._subjects:
            if subject.exit_code() is not None:
                self._witness.problems.append(f"{subject.name} ended with code {subject.exit_code()}")
                subject.start()
            elif now - max(subject.last_status, self._feed.last_gap, subject.started) > SILENCE_S:
                self._witness.problems.append(f"{subject.name} fell silent")
                subject.last_status = now
        self._check_restored(self._subjects[1], now)
        if now < self._next_sample:
            return
        self._next_sample += SAMPLE_S
        for subject in self._subjects:
            subject.sample()

    def _check_restored(self, subject, now):
        """What had been saved is in use with the first images."""
        if subject.starts == self._restored_start or subject.starts == 1:
            return
        saved = subject.saved_calibration()
        if saved is None or saved[1] != self._feed.size:
            return
        if subject.camera_info is not None and subject.camera_info.K[0] > 0:
            self._restored_start = subject.starts
            self.restored += 1
        elif now - max(subject.started, self._feed.last_gap, self._feed.last_lens_change) > START_S:
            self._restored_start = subject.starts
            self._witness.problems.append(f"start {subject.starts} of {subject.name} does not know "
                                          "what had been saved")


def growths(steady, hours):
    if hours < FILLED_HOURS:
        print("Too short to judge growth: queue, places, path and allocators still fill up.")
        return []
    problems = []
    before, after = growth(steady.samples, "memory_mb")
    if after > SETTLED_SHARE * before + GROWTH_MB:
        problems.append(f"memory grew from {before:.0f} to {after:.0f} MB")
    for field in ("threads", "files"):
        before, after = growth(steady.samples, field)
        if after > before + HANDLES:
            problems.append(f"{field} grew from {before:.0f} to {after:.0f}")
    return problems


def judge(hours, witness, disturber, subjects):
    problems = witness.problems + disturber.problems
    for subject in subjects:
        left = [os.path.basename(path) for path in subject.files()]
        if [name for name in left if ".new." in name]:
            problems.append(f"files are left behind: {' '.join(left)}")
    problems += growths(subjects[0], hours)
    if "falsely CONVERGED" in witness.notes:
        problems.append("a calibration was falsely CONVERGED")
    if not witness.false_alarms_fit(hours):
        problems.append("more changes of the lens were reported without a cause than stated")
    return problems


def print_table(hours, feed, patrol, witness, disturber, subjects):
    rows = [("hours", f"{hours:.2f}"), ("images", feed.published)]
    rows += [(f"faults: {kind}", count) for kind, count in sorted(disturber.counts.items())]
    rows += [(f"events: {name} {kind}", count) for (name, kind), count in sorted(witness.events.items())]
    rows += [("starts that knew what had been saved", f"{patrol.restored} of {subjects[1].starts - 1}"),
             ("calibrations held against the truth", witness.judged),
             ("worst of them [sigma]", f"{witness.worst_sigmas:.1f}")]
    for field in ("memory_mb", "threads", "files"):
        before, after = growth(subjects[0].samples, field)
        rows.append((f"{field} of {subjects[0].name}, 2nd and last quarter", f"{before:.0f} {after:.0f}"))
    for name, value in rows:
        print(f"{name:58} {value}")
    for kind, texts in witness.notes.items():
        print(f"{kind}: {len(texts)}")
        for text in texts[:10]:
            print(f"  {text}")


def soak(hours, seed, programs):
    feed = Feed()
    witness = Witness(feed)
    camera = start_camera(programs, seed, hours)
    subjects = start_nodes(programs, witness)
    disturber = witness.disturber = Disturber(random.Random(seed), feed, *subjects)
    patrol = Patrol(feed, witness, subjects)
    begin = time.monotonic()
    try:
        while time.monotonic() - begin < 3600.0 * hours and camera.poll() is None:
            disturber.step()
            patrol.step()
            time.sleep(0.05)
    except KeyboardInterrupt:
        print("stopped before its time")
    if camera.poll() is not None:
        witness.problems.append(f"simulated_camera ended with code {camera.poll()}")
    for subject in subjects:
        if subject.end() != 0:
            witness.problems.append(f"{subject.name} did not end in order")
    camera.terminate()
    camera.wait()
    hours = (time.monotonic() - begin) / 3600.0
    print_table(hours, feed, patrol, witness, disturber, subjects)
    return judge(hours, witness, disturber, subjects)


def main():
    rospy.init_node("soak", disable_signals=True)
    for end in (signal.SIGINT, signal.SIGTERM):  # in the background, shells have SIGINT ignored
        signal.signal(end, signal.default_int_handler)
    problems = soak(float(sys.argv[1]), int(sys.argv[2]), sys.argv[3])
    for problem in problems:
        print(f"FAILED: {problem}")
    print("failed" if problems else "passed")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
