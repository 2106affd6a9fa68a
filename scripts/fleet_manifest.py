"""The manifest of a fleet: which bag shows which camera on which topic."""
import csv
import dataclasses
import hashlib
import pathlib
import re
import sys

COLUMNS = ("bag", "topic", "camera", "model")
MODELS = ("", "auto", "pinhole", "fov", "radtan", "plumb_bob", "equidistant")
IMAGE_TYPES = ("sensor_msgs/Image", "sensor_msgs/CompressedImage")


class Problem(Exception):
    """What is wrong and what to do, for people."""


@dataclasses.dataclass(frozen=True)
class Row:
    bag: str  # absolute path
    topic: str
    camera: str
    model: str = ""

    @property
    def id(self):
        """Names the files of the row; the same whatever else is in the manifest."""
        digest = hashlib.sha1("\0".join(dataclasses.astuple(self)).encode()).hexdigest()[:10]
        name = re.sub(r"[^A-Za-z0-9-]+", "_", f"{self.camera}-{pathlib.Path(self.bag).stem}")
        return f"{name[:80]}-{digest}"


def problems_of(line, row):
    if not row.bag or not row.camera:
        yield f"line {line}: a bag and a camera are needed"
    if row.model not in MODELS:
        yield f"line {line}: the model {row.model} is not one of {', '.join(MODELS[1:])}"


def read(path):
    """Rows of a CSV with a header; bags are relative to its folder. All problems at once."""
    folder = pathlib.Path(path).resolve().parent
    rows, problems = [], []
    try:
        with open(path, newline="") as file:
            reader = csv.DictReader(file)
            missing = [c for c in COLUMNS[:3] if c not in (reader.fieldnames or [])]
            if missing:
                raise Problem(f"{path} has no column {', '.join(missing)}; its first line must name "
                              f"{','.join(COLUMNS[:3])} and may name {COLUMNS[3]}")
            for entry in reader:
                values = [(entry.get(c) or "").strip() for c in COLUMNS]
                values[0] = values[0] and str(folder / values[0])
                rows.append(Row(*values))
                problems += problems_of(reader.line_num, rows[-1])
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise Problem(f"the manifest {path} cannot be read: {error}")
    if not rows:
        problems.append("it names no bag")
    if problems:
        raise Problem(f"the manifest {path} cannot be used:\n  - " + "\n  - ".join(problems))
    return list(dict.fromkeys(rows))


def camera_name(folder, bag, topic):
    """robot7/front for the topic /front/image_raw of a bag in the folder robot7."""
    words = [w for w in topic.split("/")
             if w and not re.fullmatch(r"image(_(raw|mono|color|rect|rect_color))?|compressed", w)]
    robot = bag.parent.relative_to(folder).as_posix()
    return ("" if robot == "." else robot + "/") + ("_".join(words) or "camera")


def image_topics(bag):
    """Those of a bag, and why there are none."""
    import rosbag
    try:
        with rosbag.Bag(str(bag)) as opened:
            topics = opened.get_type_and_topic_info().topics
    except Exception as error:  # rosbag raises what it likes on damaged bags
        return [], f"cannot be read ({error})"
    found = sorted(name for name, topic in topics.items() if topic.msg_type in IMAGE_TYPES)
    return found, "" if found else "has no images"


def scan(folder, out):
    """Writes a manifest of all bags in a folder. Those without images are named, and left in, so
    that the results tell of them."""
    root = pathlib.Path(folder).resolve()
    if not root.is_dir():
        raise Problem(f"{folder} is no folder")
    writer = csv.writer(out)
    writer.writerow(COLUMNS)
    for bag in sorted(root.rglob("*.bag")):
        topics, why = image_topics(bag) if bag.is_file() else ([], "is no file")
        if why:
            print(f"warning: {bag} {why}", file=sys.stderr)
        for topic in topics or [""]:
            writer.writerow([bag, topic, camera_name(root, bag, topic), "auto"])
    return 0
