"""The tables of stored video whose cameras are known: what calibrate_bag says, and how true it is."""
import dataclasses
import json
import math
import pathlib
import subprocess
import tempfile

from measure_program import table


def calibrate(places, bag, options):
    """summary.json of calibrate_bag; of a rig, with those of its cameras as "cameras"."""
    with tempfile.TemporaryDirectory() as out:
        done = subprocess.run([places.program("calibrate_bag"), str(places.bag(bag)), "--out", out,
                               *options], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        # It ran to its end: converged or not, or GOOD, WRONG, CANNOT_TELL.
        if done.returncode not in (0, 2, 5, 6):
            raise ValueError(f"calibrate_bag on {bag}: {done.stderr.decode().strip()}")
        summary = json.loads((pathlib.Path(out) / "summary.json").read_text())
        summary["cameras"] = [json.loads(file.read_text())
                              for file in sorted(pathlib.Path(out).glob("cam*/summary.json"))]
        return summary


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


def stated(summary):
    px = summary["pixel_uncertainty"]["rms"]
    return "-" if px is None else two_digits(px)


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

    def scaled(self, focal, k=1.0):
        """The focal lengths by a factor, and all of K."""
        fx, fy, cx, cy, *rest = self.params
        return dataclasses.replace(self, params=(focal * k * fx, focal * k * fy, k * cx, k * cy, *rest))

    def taken_for(self, model):
        """Its numbers as if they were another model's."""
        return dataclasses.replace(self, model=model, params=self.params[:8])


ROOM = Lens("fov", 640, 480, (311.2, 309.8, 327.4, 233.1, 0.93))
BOARD = Lens("radtan", 752, 480, (421.52, 421.55, 353.95, 251.81, -0.33039, 0.16623, -0.00066,
                                  -0.00131, -0.05446), 250)
# Of AprilGrid images, not as the data set publishes them.
LEFT = Lens("equidistant", 752, 480, (461.083, 459.693, 365.850, 249.869, -0.006311, 0.039649,
                                      -0.064883, 0.039131), 330)
RIGHT = Lens("equidistant", 752, 480, (459.706, 458.352, 379.414, 255.639, 0.005407, -0.002780,
                                       0.001718, 0.001554), 330)
PUBLISHED_LEFT = Lens("radtan", 752, 480, (458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907,
                                           0.00019359, 1.76187114e-05))
PUBLISHED_RIGHT = Lens("radtan", 752, 480, (457.587, 456.134, 379.999, 255.238, -0.28368365, 0.07451284,
                                            -0.00010473, -3.55590700e-05))
CAR = Lens("pinhole", 1242, 375, (721.5377, 721.5377, 609.5593, 172.854))
OFFICE = Lens("pinhole", 640, 480, (615.0, 615.0, 320.0, 240.0))
KINECT = Lens("radtan", 640, 480, (517.306408, 516.469215, 318.643040, 255.313989, 0.262383, -0.953104,
                                   -0.005358, 0.002628, 1.163314), 300)
ENDOSCOPE = Lens("fov", 720, 576, (401.96, 401.96, 340, 277, 1.128), 300)


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


def error(places, truth, camera):
    """The distance, with where it holds."""
    px = two_digits(distance(places, truth, camera))
    return f"{px} within {truth.radius:.0f} px of the centre" if truth.radius < 1e9 else px


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
    rows = []
    for sequence, bag, options, truth in KNOWN:
        summary = calibrate(places, bag, options.split())
        rows.append([sequence, f"`{options.split()[-1]}`", truth, estimate(summary), summary["state"]])
    return table(["sequence", "model", "known", "estimate ± sigma", "state"], rows)


LEFT_TOPIC, RIGHT_TOPIC = ("/cam0/image_raw/compressed", "/cam1/image_raw/compressed")
# Sequence, bag, options, and the lens: exact, from a board, or as published.
CHOSEN = (
    ("a rendered room, lens of 125 degrees (`fov`)", "room_fov.bag", "", ROOM),
    ("a MAV camera over a desk", "mav_board.bag", "", BOARD),
    ("EuRoC MH_01, 16 s, left", "mh01_stereo.bag", f"--topic {LEFT_TOPIC}", LEFT),
    ("EuRoC MH_01, 16 s, right", "mh01_stereo.bag", f"--topic {RIGHT_TOPIC}", RIGHT),
    ("KITTI 03, forward driving, 25 s", "kitti03_begin.bag", "", CAR),
    ("New Tsukuba, 5 s (`pinhole`; the published focal length is in doubt)", "tsukuba.bag", "", OFFICE),
    ("a Kinect's colour camera, mostly rotation", "fr1_rpy_begin.bag", "", KINECT),
    ("an endoscope (known to about 6 px)", "endoscope_office.bag", "", ENDOSCOPE),
)


def chosen(places):
    rows = []
    for sequence, bag, options, truth in CHOSEN:
        summary = calibrate(places, bag, options.split())
        rows.append([sequence, f"`{summary['camera']['model']}`", summary["state"],
                     error(places, truth, summary["camera"]), stated(summary),
                     f"{summary['frames_per_second']:.0f}"])
    return table(["sequence", "chosen", "state", "error [px rms]", "stated [px rms]", "images/s"], rows)


def trajectory(places):
    """Of the rendered room, beside that of a run with the true calibration and the truth."""
    bag = str(places.bag("room_fov.bag"))
    of = calibrate(places, "room_fov.bag", ["--model", "fov", "--reference-calibration", bag + ".truth.yaml",
                                            "--ground-truth", bag + ".gt.tum"])["trajectory"]
    ate = "{:.1f} mm over {:.1f} m"
    rows = [[f"from the run with the true calibration, {when} hand-over",
             f"{100 * of[f'reference_{when}_handover']['share_of_way']:.3f} % of the distance travelled"]
            for when in ("until", "after")]
    for name, key in (("ATE after hand-over", "ground_truth_after_handover"),
                      ("the same with the true calibration", "ground_truth_with_reference_calibration")):
        rows.append([name, ate.format(1e3 * of[key]["ate_rms"], of[key]["travelled"])])
    return table(["distance of the trajectory, after similarity alignment", ""], rows)


# Sequence, bag, model, seconds left out at the beginning, and the lens.
NAMED = (
    ("a rendered room, lens of 125 degrees", "room_fov.bag", "radtan", 0, ROOM),
    ("", "room_fov.bag", "fov", 0, ROOM),
    ("rectified images of a car's camera, 1242x375", "kitti03_begin.bag", "pinhole", 0, CAR),
    ("", "kitti03_begin.bag", "pinhole", 1, CAR),
    ("", "kitti03_begin.bag", "pinhole", 2, CAR),
    ("", "kitti03_begin.bag", "radtan", 0, CAR),
    ("a MAV camera over a desk", "mav_board.bag", "radtan", 0, BOARD),
    ("", "mav_board.bag", "equidistant", 0, BOARD),
)


def named(places):
    rows = []
    for sequence, bag, model, start, truth in NAMED:
        summary = calibrate(places, bag, ["--model", model, "--start", str(start)])
        rows.append([sequence, f"`{model}`", str(start), error(places, truth, summary["camera"]),
                     stated(summary), summary["state"]])
    return table(["sequence", "model", "from [s]", "error [px rms]", "stated [px rms]", "state"], rows)


# Sequence, bag, topic, and the calibrations given with what they are called.
AUDITED = (
    ("EuRoC MH_01, cam0", "mh01_stereo.bag", LEFT_TOPIC, (
        ("published", PUBLISHED_LEFT),
        ("recalibrated from AprilGrid images", LEFT),
        ("published, f +1 %", PUBLISHED_LEFT.scaled(1.01)),
        ("published, as `equidistant`", PUBLISHED_LEFT.taken_for("equidistant")),
        ("recalibrated (`equidistant`), as `radtan`", LEFT.taken_for("radtan")),
        ("published, K halved", PUBLISHED_LEFT.scaled(1.0, 0.5)),
        ("published of cam1", PUBLISHED_RIGHT))),
    ("EuRoC MH_01, cam1", "mh01_stereo.bag", RIGHT_TOPIC, (
        ("published", PUBLISHED_RIGHT),
        ("recalibrated from AprilGrid images", RIGHT),
        ("published, f +1 %", PUBLISHED_RIGHT.scaled(1.01)),
        ("published of cam0", PUBLISHED_LEFT))),
    ("a MAV camera over a desk", "mav_board.bag", "", (
        ("from the board", BOARD), ("from the board, f +5 %", BOARD.scaled(1.05)))),
    ("a rendered room, 125 degrees", "room_fov.bag", "", (
        ("the true one", ROOM), ("f +0.1 %", ROOM.scaled(1.001)), ("f -1 %", ROOM.scaled(0.99)))),
    ("New Tsukuba, 5 s", "tsukuba.bag", "", (("published, f 615", OFFICE),)),
    ("KITTI 03, rectified", "kitti03_begin.bag", "", (("published", CAR),)),
    ("a phone moved sideways", "phone_sideways.bag", "", (("any", OFFICE),)),
    ("a MAV camera that stands still", "euroc_static.bag", "", (("any", LEFT),)),
)


def said(audit):
    """In the table's words."""
    text = audit["verdict"]
    if audit["distance_px"] is not None and audit["p_value"] is not None:
        text += f", {audit['distance_px']:.2f} ± {audit['sigma_px']:.2f} px"
        text += f", axis {audit['axis_deg']:.2f} ± {audit['axis_sigma_deg']:.2f} degrees"
    return text


def audited(places):
    rows = []
    for sequence, bag, topic, calibrations in AUDITED:
        for what, lens in calibrations:
            with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
                file.write(lens.text())
                file.flush()
                options = ["--audit", file.name, *(["--topic", topic] if topic else [])]
                audit = calibrate(places, bag, options)["audit"]
            cause = "" if audit["likely_cause"] == "none" else f"`{audit['likely_cause']}`"
            rows.append([sequence, what, said(audit), cause])
            sequence = ""
    return table(["sequence", "calibration given", "verdict", "likely cause"], rows)


# cam0_from_cam1, from AprilGrid images whose halves agree to 0.008 degrees and 0.2 mm.
ROTATION_XYZW = (0.0071661622, 0.00029152745, 0.0010676206, 0.9999737103)
POSITION_M = (0.10986137, -0.00020909, 0.00102029)


def angle_deg(a, b):
    """Between two vectors of any length."""
    cosine = sum(x * y for x, y in zip(a, b)) / math.hypot(*a) / math.hypot(*b)
    return math.degrees(math.acos(max(-1.0, min(1.0, cosine))))


def pair(places):
    """A stereo pair, together and each camera alone."""
    columns = []
    for model in ("auto", "radtan"):
        together = calibrate(places, "mh01_stereo.bag", ["--model", model, "--baseline", f"{math.hypot(*POSITION_M):.5f}",
                                                         "--topics", LEFT_TOPIC, RIGHT_TOPIC])
        alone = [calibrate(places, "mh01_stereo.bag", ["--model", model, "--topic", topic])
                 for topic in (LEFT_TOPIC, RIGHT_TOPIC)]
        camera = together["rig_from_camera"][1]
        turned = angle_deg(camera["rotation_xyzw"], ROTATION_XYZW)
        turned = 2 * min(turned, 180 - turned)  # q and -q are one rotation.
        columns.append([
            f"{turned:.3f} ({math.hypot(*camera['rotation_vector_sigma_deg']):.3f})",
            f"{angle_deg(camera['position'], POSITION_M):.2f} ({camera['direction_sigma_deg']:.2f})",
            *(", ".join(f"{distance(places, lens, one['camera']):.2f} ({stated(one)})"
                        for lens, one in zip((LEFT, RIGHT), summaries))
              for summaries in (together["cameras"], alone)),
            together["state"]])
    names = ["rotation between the cameras: error (sigma) [degrees]",
             "direction of the baseline: error (sigma) [degrees]",
             "cam0, cam1 within 330 px of the centre: error (stated) [px rms]",
             "the same, each camera alone", "state"]
    return table(["", "`--model auto`", "`--model radtan`"], [list(row) for row in zip(names, *columns)])


# Video, bag, options, the lens, and what COLMAP 3.8 made of the same video, in one run each.
COMPARED = (
    ("a rendered room, 640x480, 40 s", "room_fov.bag", "", ROOM,
     "0.015 to 0.061 px in 218 to 474 s, on rooms like it"),
    ("a MAV camera over a desk, 25 s", "mav_board.bag", "", BOARD, "6.4 px, on 148 of 736 images, in 385 s"),
    ("EuRoC MH_01, left camera, 16 s", "mh01_stereo.bag", f"--topic {LEFT_TOPIC}", LEFT,
     "0.50 px, on 106 of 330 images"),
    ("hand-held Kinect, rolling shutter, 12 s", "fr1_rpy_begin.bag", "", KINECT, "7.8 px, on every fourth image"),
    ("New Tsukuba, 5 s ([published f 615 in doubt](doc/experiments.md#new-tsukuba-615-or-622))", "tsukuba.bag", "",
     OFFICE, "f 622 to 626"),
)


def compared(places):
    rows = []
    for video, bag, options, truth, colmap in COMPARED:
        summary = calibrate(places, bag, options.split())
        rows.append([video, two_digits(distance(places, truth, summary["camera"])), stated(summary),
                     summary["state"], f"{summary['processing_seconds']:.0f}", colmap])
    headings = ["video", "this package: error [px]", "stated [px]", "state", "computed in [s]", "COLMAP 3.8"]
    return table(headings, rows)
