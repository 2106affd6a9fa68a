"""The camera of a soak run: the images of simulated_camera, with faults, and what is true of them."""

import threading
import time

import numpy
import rospy
from camera_self_calibration.msg import Calibration
from sensor_msgs.msg import Image

RATE_HZ = 12.0
WIDTH, HEIGHT = 320, 240


def seen_through(image, magnification, width, height):
    """What a lens of `magnification` times the focal length shows on `width` x `height` pixels, about
    the centre of the image."""
    rows, columns = image.shape
    y = (numpy.arange(height) - (height - 1) / 2) / magnification + (rows - 1) / 2
    x = (numpy.arange(width) - (width - 1) / 2) / magnification + (columns - 1) / 2
    y, x = numpy.clip(y, 0, rows - 1.001), numpy.clip(x, 0, columns - 1.001)
    y0, x0 = y.astype(int), x.astype(int)
    fy, fx = (y - y0)[:, None], x - x0
    source = image.astype(numpy.float32)
    above = source[y0][:, x0] * (1 - fx) + source[y0][:, x0 + 1] * fx
    below = source[y0 + 1][:, x0] * (1 - fx) + source[y0 + 1][:, x0 + 1] * fx
    return numpy.rint(above * (1 - fy) + below * fy).astype(numpy.uint8)


class Feed:
    """Republishes images with the faults that are set; knows when what happened [s, monotonic]."""

    def __init__(self):
        self._lock = threading.Lock()
        self._truth = None
        self._last_stamp = None
        self.magnification = 1.0
        self.size = (WIDTH, HEIGHT)
        self.covered = self.cut = False
        self.offset = rospy.Duration(0)
        self.published = 0
        self.last_gap = self.last_lens_change = time.monotonic()
        self._out = rospy.Publisher("camera/image_raw", Image, queue_size=5)
        rospy.Subscriber("source/truth/calibration", Calibration, self._keep_truth)
        rospy.Subscriber("source/image_raw", Image, self._pass, queue_size=5)

    def truth(self):
        """fx fy cx cy w of the present lens, or None before the first image."""
        with self._lock:
            if self._truth is None:
                return None
            fx, fy, cx, cy, w = self._truth
            m, (width, height) = self._lens()
            return [m * fx, m * fy, m * (cx - (WIDTH - 1) / 2) + (width - 1) / 2,
                    m * (cy - (HEIGHT - 1) / 2) + (height - 1) / 2, w]

    def zoom(self, magnification):
        with self._lock:
            self.magnification = magnification
            self.last_lens_change = time.monotonic()

    def resize(self, size):
        with self._lock:
            self.size = size
            self.last_lens_change = time.monotonic()

    def shift_clock(self, seconds):
        with self._lock:
            self.offset += rospy.Duration.from_sec(seconds)

    def send_broken(self, random):
        """An image whose head does not fit its pixels."""
        message = Image(encoding=random.choice(["mono8", "bgr8", "rgba16", "nonsense", ""]))
        message.header.stamp = rospy.Time.now()
        message.width, message.height = random.choice([(0, 0), (320, 240), (2 ** 31, 7), (40000, 2)])
        message.step = random.choice([0, 1, 320, 2 ** 32 - 1])
        message.data = bytes(random.randrange(1000))
        self._out.publish(message)

    def _lens(self):
        return self.magnification * self.size[0] / WIDTH, self.size

    def _keep_truth(self, message):
        with self._lock:
            self._truth = message.values

    def _pass(self, message):
        with self._lock:
            if self.cut:
                return
            magnification, (width, height) = self._lens()
            covered = self.covered
            stamp = message.header.stamp + self.offset
            if self._last_stamp is None or not 0 < (stamp - self._last_stamp).to_sec() < 2.5 / RATE_HZ:
                self.last_gap = time.monotonic()
            self._last_stamp = stamp
        image = numpy.frombuffer(message.data, numpy.uint8).reshape(message.height, message.width)
        if covered:
            image = numpy.full((height, width), 3, numpy.uint8)
        elif (magnification, width, height) != (1.0, WIDTH, HEIGHT):
            image = seen_through(image, magnification, width, height)
        out = Image(header=message.header, encoding="mono8", width=width, height=height, step=width,
                    data=image.tobytes())
        out.header.stamp = stamp
        self._out.publish(out)
        self.published += 1
