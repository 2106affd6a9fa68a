"""The tables that scripts/measure writes: which program prints each, and what becomes of its output."""
import dataclasses
import json
import pathlib
import subprocess
import tempfile
from typing import Callable, Optional


class NotMeasured(Exception):
    """What a table needs is not there."""


@dataclasses.dataclass
class Places:
    build: pathlib.Path
    videos: Optional[pathlib.Path]

    def program(self, name):
        tool = self.build / "devel/lib/camera_self_calibration" / name
        return str(tool if tool.exists() else self.build / "test" / name)

    def bag(self, name):
        if self.videos is None:
            raise NotMeasured("it needs video: give --videos FOLDER")
        bag = self.videos / name
        if not bag.exists():
            raise NotMeasured(f"it needs {bag}")
        return bag


@dataclasses.dataclass
class Table:
    name: str
    page: str
    programs: tuple  # What it runs.
    command: str  # As it stands below the table, to be typed.
    measure: Callable[[Places], str]  # Gives the table in Markdown.


def last_table(text):
    """Header and rows of the last table in the output of a program, which may print others on the way."""
    lines = text.splitlines()
    rules = [i for i, line in enumerate(lines) if line.startswith("|---")]
    if not rules or rules[-1] == 0:
        raise ValueError("the program printed no table")
    table = lines[rules[-1] - 1:]
    end = next((i for i, line in enumerate(table) if not line.startswith("|")), len(table))
    return table[:end]


def shell_command(command, variants):
    """What one types to run it, for each variant if there are any."""
    if not variants:
        return command
    return f"for v in {' '.join(map(str, variants))}; do {command.format('$v')}; done"


def printed(name, page, command, variants=(), label=""):
    """A table that a benchmark prints. With variants it runs once for each, which takes the place of
    {} in the command and stands in a first column named `label`."""
    def one(places, variant):
        program, *arguments = command.format(variant).split()
        output = subprocess.run([places.program(program), *arguments], check=True, text=True,
                                stdout=subprocess.PIPE).stdout
        return last_table(output)

    def measure(places):
        if not variants:
            return "\n".join(one(places, "")) + "\n"
        lines = []
        for variant in variants:
            header, rule, *rows = one(places, variant)
            lines = lines or [f"| {label} " + header, "|---" + rule]
            lines += [f"| {variant} " + row for row in rows]
        return "\n".join(lines) + "\n"
    return Table(name, page, (command.split()[0],), shell_command(command, variants), measure)


def calibrate(places, bag, options):
    """summary.json of calibrate_bag."""
    with tempfile.TemporaryDirectory() as out:
        done = subprocess.run([places.program("calibrate_bag"), str(places.bag(bag)), "--out", out,
                               *options], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        # 0 and 2: it ran to its end.
        if done.returncode not in (0, 2):
            raise ValueError(f"calibrate_bag on {bag}: {done.stderr.decode().strip()}")
        return json.loads((pathlib.Path(out) / "summary.json").read_text())


def decimals(sigma):
    """So that two digits of a sigma are seen."""
    return max(0, 1 - int(f"{sigma:e}".split("e")[1]))


def two_digits(value):
    """At least two digits of it, never in powers of ten."""
    return f"{value:.{decimals(value)}f}"


def estimate(summary):
    """"fx 311.202 ± 0.017, ..."; of a lens that is not known, "none"."""
    values, sigmas = summary["camera"]["params"], summary["camera"]["sigma"]
    if any(sigma is None for sigma in sigmas.values()):
        return "none"
    return ", ".join(f"{name} {values[name]:.{decimals(sigma)}f} ± {two_digits(sigma)}"
                     for name, sigma in sigmas.items() if sigma > 0)


# Sequence, bag, options, and what is known of the lens.
KNOWN = (
    ("a rendered room, 640x480, 40 s", "room_fov.bag", "--model fov",
     "fx 311.2, fy 309.8, cx 327.4, cy 233.1, w 0.93 (exact)"),
    ("a MAV camera over a desk, 752x480, 25 s", "mav_board.bag", "--model radtan",
     "fx 421.52, fy 421.55, cx 353.95, cy 251.81 (checkerboard)"),
    ("New Tsukuba, 640x480, 5 s", "tsukuba.bag", "--model pinhole",
     "fx = fy = 615, c = (320, 240) (published)"),
    ("a MAV camera that stands still, 5 s", "euroc_static.bag", "--model fov", ""),
    ("a phone moved sideways, 7 s", "phone_sideways.bag", "--model pinhole", "fx 525, fy 524"),
)


def known(places):
    rows = ["| sequence | model | known | estimate ± sigma | state |", "|---|---|---|---|---|"]
    for sequence, bag, options, truth in KNOWN:
        summary = calibrate(places, bag, options.split())
        rows.append(f"| {sequence} | `{options.split()[-1]}` | {truth} | {estimate(summary)} | "
                    f"{summary['state']} |")
    return "\n".join(rows) + "\n"


@dataclasses.dataclass
class Lens:
    """A calibration by others, as far from the centre as their board came [px]."""
    model: str
    width: int
    height: int
    params: tuple
    radius: float = 1e9

    def text(self):
        return (f"model: {self.model}\nwidth: {self.width}\nheight: {self.height}\n"
                f"params: {list(self.params)}\n")


def distance(places, truth, camera):
    """px rms between the truth and a camera of summary.json, a rotation removed."""
    found = Lens(camera["model"], camera["width"], camera["height"], tuple(camera["params"].values()))
    with tempfile.TemporaryDirectory() as folder:
        files = [pathlib.Path(folder) / name for name in ("truth.yaml", "found.yaml")]
        for file, lens in zip(files, (truth, found)):
            file.write_text(lens.text())
        output = subprocess.run([places.program("compare_calibration"), *map(str, files), "--radius",
                                 str(truth.radius)], check=True, text=True, capture_output=True).stdout
    # "distance 0.123 px rms, ..."
    return float(output[output.index("\ndistance "):].split()[1])


# Sequence, bag, options, and the lens: exact, from a board, or as published.
CHOSEN = (
    ("a rendered room, lens of 125 degrees (`fov`)", "room_fov.bag", "",
     Lens("fov", 640, 480, (311.2, 309.8, 327.4, 233.1, 0.93))),
    ("a MAV camera over a desk", "mav_board.bag", "",
     Lens("radtan", 752, 480, (421.52, 421.55, 353.95, 251.81, -0.33039, 0.16623, -0.00066,
                               -0.00131, -0.05446), 250)),
    ("EuRoC MH_01, 16 s, left", "mh01_stereo.bag", "--topic /cam0/image_raw/compressed",
     Lens("equidistant", 752, 480, (461.083, 459.693, 365.850, 249.869, -0.006311, 0.039649,
                                    -0.064883, 0.039131), 330)),
    ("EuRoC MH_01, 16 s, right", "mh01_stereo.bag", "--topic /cam1/image_raw/compressed",
     Lens("equidistant", 752, 480, (459.706, 458.352, 379.414, 255.639, 0.005407, -0.002780,
                                    0.001718, 0.001554), 330)),
    ("KITTI 03, forward driving, 25 s", "kitti03_begin.bag", "",
     Lens("pinhole", 1242, 375, (721.5377, 721.5377, 609.5593, 172.854))),
    ("New Tsukuba, 5 s (`pinhole`; the published focal length is in doubt)", "tsukuba.bag", "",
     Lens("pinhole", 640, 480, (615.0, 615.0, 320.0, 240.0))),
    ("a Kinect's colour camera, mostly rotation", "fr1_rpy_begin.bag", "",
     Lens("radtan", 640, 480, (517.306408, 516.469215, 318.643040, 255.313989, 0.262383, -0.953104,
                               -0.005358, 0.002628, 1.163314), 300)),
    ("an endoscope (known to about 6 px)", "endoscope_office.bag", "",
     Lens("fov", 720, 576, (401.96, 401.96, 340, 277, 1.128), 300)),
)


def chosen(places):
    rows = ["| sequence | chosen | state | error [px rms] | stated [px rms] | images/s |",
            "|---|---|---|---|---|---|"]
    for sequence, bag, options, truth in CHOSEN:
        summary = calibrate(places, bag, options.split())
        stated = summary["pixel_uncertainty"]["rms"]
        error = two_digits(distance(places, truth, summary["camera"]))
        if truth.radius < 1e9:
            error += f" within {truth.radius:.0f} px of the centre"
        rows.append(f"| {sequence} | `{summary['camera']['model']}` | {summary['state']} | {error} | "
                    f"{'-' if stated is None else two_digits(stated)} | "
                    f"{summary['frames_per_second']:.0f} |")
    return "\n".join(rows) + "\n"


TABLES = (
    Table("known", "doc/accuracy.md", ("calibrate_bag",), "calibrate_bag BAG --model MODEL --out DIR", known),
    Table("auto", "doc/lens_models.md", ("calibrate_bag", "compare_calibration"),
          "calibrate_bag BAG --out DIR", chosen),
    printed("audit", "doc/audit.md", "audit_benchmark"),
    printed("misfit", "doc/quality.md", "misfit_benchmark --sequences 32 --first-seed 9001"),
    printed("rough_images", "doc/rough_images.md",
            "rough_images_benchmark --kinds none,rolling,exposure,blur,noise,vignetting,JPEG,25,fast,all "
            "--seconds 15 --scale 0.5 --sequences 4 --first-seed 2"),
    printed("rough_scenes", "doc/rough_images.md",
            "rough_images_benchmark --kinds moving,carried,text,automatic "
            "--seconds 15 --scale 0.5 --sequences 8 --first-seed 501"),
    printed("blur", "doc/rough_images.md", "track_error_benchmark 2 4 {} 2", (0, 0.02),
            "exposure [s]"),
    printed("rolling_shutter", "doc/rough_images.md",
            "rolling_shutter_benchmark --trials 30 --noise {}", (0.1, 0.2, 0.5), "noise [px]"),
    printed("rendered", "doc/accuracy.md", "consistency_benchmark 24 30"),
)
