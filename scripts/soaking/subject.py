"""A node under test: its process, its files, and all that it says."""

import collections
import glob
import os
import signal
import subprocess
import time

import rospy
import yaml
from camera_self_calibration.msg import Calibration, CalibrationEvent, TrackingStatus
from sensor_msgs.msg import CameraInfo

Sample = collections.namedtuple("Sample", "time memory_mb threads files")


class Subject:
    def __init__(self, name, program, parameters, on_event, on_calibration):
        self.name = name
        self.home = os.environ["ROS_HOME"]
        self.samples = []
        self.kills = self.starts = 0
        self.calibration = self.camera_info = None
        self.last_status = self.started = time.monotonic()
        self._command = [program, "__name:=" + name, "image:=/camera/image_raw"] + [
            f"_{key}:={value}" for key, value in parameters.items()]
        self._log = open(os.path.join(self.home, name + ".log"), "ab")
        rospy.Subscriber(f"/{name}/event", CalibrationEvent, lambda m: on_event(self, m))
        rospy.Subscriber(f"/{name}/calibration", Calibration, lambda m: self._hear(m, on_calibration))
        rospy.Subscriber(f"/{name}/tracking_status", TrackingStatus, self._hear_status)
        rospy.Subscriber(f"/{name}/camera_info", CameraInfo, self._hear_info)
        self.start()

    def start(self):
        self.calibration = self.camera_info = None
        self.last_status = self.started = time.monotonic()
        self.starts += 1
        self._process = subprocess.Popen(self._command, stdout=self._log, stderr=self._log)

    def kill(self):
        self._process.send_signal(signal.SIGKILL)
        self._process.wait()
        self.kills += 1

    def end(self):
        """The exit code of an orderly end, or None if there was none within 20 s."""
        self._process.send_signal(signal.SIGINT)
        try:
            return self._process.wait(20)
        except subprocess.TimeoutExpired:
            self.kill()
            return None

    def exit_code(self):
        """None while it lives."""
        return self._process.poll()

    def sample(self):
        """What the process holds, as /proc has it."""
        folder = f"/proc/{self._process.pid}"
        with open(folder + "/status") as file:
            status = dict(line.split(":", 1) for line in file)
        self.samples.append(Sample(time.monotonic(), int(status["VmRSS"].split()[0]) / 1024,
                                   int(status["Threads"]), len(os.listdir(folder + "/fd"))))

    def converged(self):
        return self.calibration is not None and self.calibration.calibration_state == "CONVERGED"

    def files(self):
        return sorted(glob.glob(os.path.join(self.home, self.name + ".*")))

    def saved_calibration(self):
        """The calibration file's K and image size; None if there is none. Throws if it is damaged."""
        path = os.path.join(self.home, self.name + ".yaml")
        if not os.path.exists(path):
            return None
        with open(path) as file:
            content = yaml.safe_load(file)
        k = [float(value) for value in content["camera_matrix"]["data"]]
        if len(k) != 9 or not (k[0] > 0 and k[4] > 0 and k[8] == 1):
            raise ValueError(f"{path} holds no camera matrix: {k}")
        return k, (content["image_width"], content["image_height"])

    def _hear(self, message, on_calibration):
        self.calibration = message
        on_calibration(self, message)

    def _hear_status(self, message):
        self.last_status = time.monotonic()

    def _hear_info(self, message):
        self.camera_info = message
