"""One bag of a fleet, and what is known of all: the files in the folder of --out.

manifest.json          rows and options
states/ID.state        what was learnt from the bag
outcomes/ID.json       how it ended; no such file: not finished
logs/ID.log            what calibrate_bag said
"""
import dataclasses
import json
import os
import pathlib
import resource
import signal
import subprocess
import time

from fleet_manifest import Problem, Row

PROGRAMS = ("calibrate_bag", "merge_calibrations")
# Exit codes of calibrate_bag.
CONVERGED, NOT_CONVERGED, NO_IMAGES, STOPPED = 0, 2, 3, 4
# From outside: a machine that goes down, a queue's time limit, memory that others took.
FROM_OUTSIDE = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


def default_programs():
    root = pathlib.Path(__file__).resolve().parent.parent
    return str(root / "build/devel/lib/camera_self_calibration")


def check_programs(folder):
    missing = [p for p in PROGRAMS if not os.access(os.path.join(folder, p), os.X_OK)]
    if missing:
        raise Problem(f"{folder} has no {' and no '.join(missing)}: build the package, or name "
                      "another folder with --programs")


def write_atomically(path, text):
    beside = path.with_name(f"{path.name}.new.{os.getpid()}")
    with open(beside, "w") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    os.replace(beside, path)


@dataclasses.dataclass
class Outcome:
    """How a bag ended. kind: state (the file is there), nothing (it was not informative enough) or failed."""
    kind: str
    reason: str = ""
    wall_s: float = 0.0
    cpu_s: float = 0.0
    max_rss_mb: float = 0.0
    bag_mb: float = 0.0


class Interrupted(Exception):
    """The bag is not finished; it is for the next run."""


def interrupt(*_):
    raise Interrupted()


class Fleet:
    def __init__(self, folder, rows, settings):
        self.folder = pathlib.Path(folder).resolve()
        self.rows = {row.id: row for row in rows}
        self.settings = settings

    @classmethod
    def create(cls, options, rows):
        names = ("programs", "timeout", "queue_segments")
        settings = {name: getattr(options, name) for name in names}
        settings["programs"] = str(pathlib.Path(settings["programs"]).resolve())
        fleet = cls(options.out, rows, settings)
        for name in ("states", "outcomes", "logs"):
            (fleet.folder / name).mkdir(parents=True, exist_ok=True)
        text = {"settings": settings, "rows": [dataclasses.astuple(row) for row in rows]}
        write_atomically(fleet.folder / "manifest.json", json.dumps(text))
        if options.retry_failed:
            fleet.forget_failures()
        return fleet

    @classmethod
    def load(cls, folder):
        text = json.loads((pathlib.Path(folder) / "manifest.json").read_text())
        return cls(folder, [Row(*row) for row in text["rows"]], text["settings"])

    def path(self, kind, id, extension):
        return self.folder / kind / f"{id}.{extension}"

    def outcome(self, id):
        """None: not finished. A state that is gone has to be learnt again."""
        try:
            outcome = Outcome(**json.loads(self.path("outcomes", id, "json").read_text()))
        except (OSError, ValueError, TypeError):
            return None
        if outcome.kind == "state" and not self.path("states", id, "state").exists():
            return None
        return outcome

    def outcomes(self):
        found = {id: self.outcome(id) for id in self.rows}
        return {id: outcome for id, outcome in found.items() if outcome}

    def pending(self):
        return [id for id in self.rows if not self.outcome(id)]

    def forget_failures(self):
        for id, outcome in self.outcomes().items():
            if outcome.kind == "failed":
                self.path("outcomes", id, "json").unlink()

    def command(self, id):
        row = self.rows[id]
        command = [os.path.join(self.settings["programs"], "calibrate_bag"), row.bag,
                   "--camera", row.camera, "--state-out", str(self.path("states", id, "state"))]
        command += ["--topic", row.topic] if row.topic else []
        return command + (["--model", row.model] if row.model else [])

    def task(self, id, attempts=1):
        """Finishes a bag, unless it is. 0: finished; 1: it failed; 4: interrupted."""
        outcome = self.outcome(id)
        if not outcome:
            # A queue that ends the job by SIGTERM must not leave a program behind.
            signal.signal(signal.SIGTERM, interrupt)
            try:
                outcome = self.attempts(id, attempts)
            except Interrupted as reason:
                print(f"{id}: interrupted {reason}")
                return STOPPED
            text = json.dumps(dataclasses.asdict(outcome))
            write_atomically(self.path("outcomes", id, "json"), text)
        print(f"{id}: {outcome.kind} {outcome.reason}")
        return 1 if outcome.kind == "failed" else 0

    def attempts(self, id, count):
        # calibrate_bag does nothing where it finds a state, which may be older than what is asked for.
        self.path("states", id, "state").unlink(missing_ok=True)
        for _ in range(count):
            outcome = self.attempt(id)
            if outcome.kind != "failed":
                break
        return outcome

    def attempt(self, id):
        log = self.path("logs", id, "log")
        begin, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        with open(log, "wb") as out:
            code, late = run_limited(self.command(id), out, self.settings["timeout"])
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        outcome = self.judge(code, late, log.read_text(errors="replace"),
                             self.path("states", id, "state").exists())
        outcome.wall_s = round(time.monotonic() - begin, 3)
        outcome.cpu_s = round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 3)
        outcome.max_rss_mb = round(after.ru_maxrss / 1024, 1)
        outcome.bag_mb = bag_size_mb(self.rows[id].bag)
        return outcome

    def judge(self, code, late, log, has_state):
        last = (log.strip().splitlines() or [""])[-1]
        if late:
            return Outcome("failed", f"no end after {self.settings['timeout']:g} s")
        if -code in FROM_OUTSIDE or code == STOPPED:
            raise Interrupted(f"(signal {-code})" if code < 0 else "")
        if code < 0:
            return Outcome("failed", f"crashed: {signal.Signals(-code).name}")
        if code in (CONVERGED, NOT_CONVERGED):
            return Outcome("state") if has_state else Outcome("nothing", "it did not determine the lens")
        if code == NO_IMAGES:
            return Outcome("nothing", last)
        return Outcome("failed", last or f"exit code {code}")


def run_limited(command, out, timeout):
    """Exit code (negative: signal), and whether it was ended for being late."""
    child = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, start_new_session=True)
    try:
        return child.wait(timeout), False
    except subprocess.TimeoutExpired:
        return 0, True
    finally:
        if child.poll() is None:
            os.killpg(child.pid, signal.SIGKILL)
            child.wait()


def bag_size_mb(path):
    try:
        return round(os.path.getsize(path) / 1e6, 3)
    except OSError:
        return 0.0
