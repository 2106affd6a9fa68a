"""What happens to camera and nodes in a soak run, at random moments."""

import math
import threading
import time

import rospy
from camera_self_calibration.srv import SetScale, SetScaleRequest
from feed import HEIGHT, WIDTH
from sensor_msgs.msg import CameraInfo
from sensor_msgs.srv import SetCameraInfo
from std_srvs.srv import SetBool, Trigger

TOPICS = ["track_image", "convergence", "markers", "landmarks", "path", "pose", "odometry", "queue",
          "image_raw", "camera_info"]
ANSWER_LIMIT_S = 30.0  # a driver that is silent is waited for 5 s


class Disturber:
    """Every fault has a name under which it is counted, and a moment that explains what follows."""

    def __init__(self, random, feed, steady, killed):
        self.counts = {}
        self.problems = []
        self.last_cover = self.last_broken = -math.inf
        self.last_request = {steady.name: -math.inf, killed.name: -math.inf}       # of any kind
        self.last_lens_request = {steady.name: -math.inf, killed.name: -math.inf}  # what unlearns
        self._random, self._feed, self._killed = random, feed, killed
        self._subjects = [steady, killed]
        self._due = []
        self._waiting = {}
        self._calls = 0
        self._listeners = []
        now = time.monotonic()
        for action, mean_s in [(self._fault, 30.0), (self._service, 12.0), (self._listen, 9.0),
                               (self._kill, 150.0)]:
            self._plan(now + random.uniform(0.5, 1.5) * mean_s, action, mean_s)

    def step(self):
        """Does what is due."""
        now = time.monotonic()
        for entry in sorted((e for e in self._due if e[0] <= now), key=lambda e: e[0]):
            self._due.remove(entry)
            entry[1]()
            if entry[2]:
                self._plan(time.monotonic() + self._random.uniform(0.5, 1.5) * entry[2], *entry[1:])
        for call, since in list(self._waiting.items()):
            if now - since > ANSWER_LIMIT_S:
                self.problems.append(f"{call} gave no answer in {ANSWER_LIMIT_S:.0f} s")
                self._waiting.pop(call, None)

    def _plan(self, when, action, repeat_s=None):
        self._due.append((when, action, repeat_s))

    def _count(self, what):
        self.counts[what] = self.counts.get(what, 0) + 1

    def _fault(self):
        now, pick = time.monotonic(), self._random.uniform
        kind = self._random.choice(["loss", "zoom", "gap", "clock back", "clock ahead", "size", "broken"])
        if kind == "size" and (self._feed.size != (WIDTH, HEIGHT) or self._random.random() < 0.6):
            return  # learning anew takes a while, which is not to be all of the run
        if kind == "loss":
            self._feed.covered, self.last_cover = True, now
            self._plan(now + pick(0.3, 6.0), self._uncover)
        elif kind == "zoom":
            self._feed.zoom(self._random.choice([1.0, 1.06, 1.12, 1.25]))
        elif kind == "gap":
            self._feed.cut = True
            self._plan(now + pick(0.3, 8.0), lambda: setattr(self._feed, "cut", False))
        elif kind == "clock back":
            self._feed.shift_clock(-pick(1.0, 100.0))
        elif kind == "clock ahead":
            self._feed.shift_clock(pick(1.0, 100.0))
        elif kind == "size":
            self._feed.resize((240, 180))
            self._plan(now + pick(20.0, 60.0), lambda: self._feed.resize((WIDTH, HEIGHT)))
        elif kind == "broken":
            self.last_broken = now
            for _ in range(self._random.randrange(1, 20)):
                self._feed.send_broken(self._random)
        self._count(kind)

    def _uncover(self):
        self._feed.covered, self.last_cover = False, time.monotonic()

    def _listen(self):
        if self._listeners and self._random.random() < 0.5:
            self._listeners.pop(self._random.randrange(len(self._listeners))).unregister()
        else:
            topic = f"/{self._random.choice(self._subjects).name}/{self._random.choice(TOPICS)}"
            self._listeners.append(rospy.Subscriber(topic, rospy.AnyMsg, lambda m: None))
        self._count("listener")

    def _service(self):
        node = self._random.choice(self._subjects).name
        name, kind, request, sensible = self._request()
        self.last_request[node] = time.monotonic()
        if name in ("reset", "set_camera_info", "freeze") and sensible:
            self.last_lens_request[node] = time.monotonic()
        self._count("~" + name)
        self._call(f"/{node}/{name}", kind, request, sensible)
        if name == "freeze":
            self._plan(time.monotonic() + self._random.uniform(1.0, 10.0), lambda: self._thaw(node))

    def _thaw(self, node):
        self.last_lens_request[node] = time.monotonic()
        self._call(f"/{node}/freeze", SetBool, [False])

    def _request(self):
        """A service, its type, its arguments, and whether they make sense."""
        name = self._random.choice(4 * ["save", "commit", "dump_report", "set_scale"] + [
            "freeze", "reset_tracking", "set_camera_info", "set_camera_info", "reset"])
        if name == "freeze":
            return name, SetBool, [True], True
        if name == "set_scale":
            factor = self._random.choice([0.5, 2.0, math.nan, math.inf, 0.0, -1.0, 1e300, 1e-320])
            return name, SetScale, [SetScaleRequest(factor=factor)], 0.1 < factor < 10.0
        if name == "set_camera_info":
            info, sensible = self._camera_info()
            return name, SetCameraInfo, [info], sensible
        return name, Trigger, [], True

    def _camera_info(self):
        info = CameraInfo(width=self._feed.size[0], height=self._feed.size[1],
                          distortion_model="equidistant", D=[0.0, 0.0, 0.0, 0.0])
        sensible = self._random.random() < 0.4
        f = 0.45 * info.width if sensible else self._random.choice([math.nan, -100.0, 0.0, 1e-30])
        info.K = [f, 0, (info.width - 1) / 2, 0, f, (info.height - 1) / 2, 0, 0, 1]
        info.R = [1, 0, 0, 0, 1, 0, 0, 0, 1]
        info.P = [f, 0, info.K[2], 0, 0, f, info.K[5], 0, 0, 0, 1, 0]
        return info, sensible

    def _call(self, service, kind, arguments, sensible=True):
        self._calls += 1
        call = f"{service} #{self._calls}"
        self._waiting[call] = time.monotonic()

        def answer():
            try:
                response = rospy.ServiceProxy(service, kind)(*arguments)
                if response.success and not sensible:
                    self.problems.append(f"{service} took {arguments}")
            except (rospy.ServiceException, rospy.ROSException):
                self._count("service away")  # killed meanwhile, or not there yet
            self._waiting.pop(call, None)

        threading.Thread(target=answer, daemon=True).start()

    def _kill(self):
        """In the midst of saving, and at once started again."""
        for _ in range(3):
            self._call(f"/{self._killed.name}/save", Trigger, [])
        time.sleep(self._random.uniform(0.0, 0.05))
        self._killed.kill()
        self._count("kill")
        try:
            self._killed.saved_calibration()
        except (ValueError, KeyError, TypeError, OSError) as error:
            self.problems.append(f"after kill {self._killed.kills}: {error}")
        self._killed.start()
