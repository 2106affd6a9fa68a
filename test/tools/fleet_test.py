"""scripts/fleet with programs that do as their bags are named: what is skipped, tried again, listed."""
import json
import os
import pathlib
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(sys.argv.pop(1))
sys.path.insert(0, str(SCRIPTS))
sys.dont_write_bytecode = True

import fleet_manifest
import fleet_task

# Stands in for calibrate_bag, which leaves a state that it finds as it is; notes each calibration.
CALIBRATE = """#!/bin/bash
bag=$1; while [[ $# -gt 0 ]]; do [[ $1 == --state-out ]] && state=$2; shift; done
[[ -e "$state" ]] && { echo "$state already holds the result of this bag"; exit 0; }
echo "$bag" >> "$CALLS"
case "$bag" in
  *crash*) kill -SEGV $$ ;;
  *killed*) [[ -e "$bag.up" ]] || kill -KILL $$ ;;
  *empty*) echo "no images in $bag" >&2; exit 3 ;;
  *vague*) exit 2 ;;
  *damaged*) echo "calibrate_bag: $bag is damaged" >&2; exit 1 ;;
esac
echo state > "$state"
"""
MERGE = """#!/bin/bash
while [[ $# -gt 0 ]]; do
  [[ $1 == --list ]] && list=$2; [[ $1 == --out ]] && out=$2; shift
done
mkdir -p "$out"; sort "$list" > "$out/merged.txt"
printf 'camera,bag,begin,end\\nc,b,0,3600\\n' > "$out/bags.csv"
"""
# Stands in for sbatch --wait.
SBATCH = """#!/bin/bash
for word; do [[ $word == --chdir=* ]] && cd "${word#*=}"; done
echo 7
bash > logs/reduce.log 2>&1
"""


class FleetTest(unittest.TestCase):
    def setUp(self):
        self.keeper = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.keeper.name)
        (self.folder / "programs").mkdir()
        self.program("calibrate_bag", CALIBRATE)
        self.program("merge_calibrations", MERGE)

    def tearDown(self):
        self.keeper.cleanup()

    def program(self, name, text):
        program = self.folder / "programs" / name
        program.write_text(text)
        program.chmod(program.stat().st_mode | stat.S_IXUSR)

    def fleet(self, names, *options):
        rows = "".join(f"{name}.bag,/image,front\n" for name in names)
        (self.folder / "manifest.csv").write_text("bag,topic,camera\n" + rows)
        command = [sys.executable, SCRIPTS / "fleet", self.folder / "manifest.csv", "--out",
                   self.folder / "out", "--programs", self.folder / "programs", "--jobs", "2",
                   "--timeout", "600", *options]
        environment = dict(os.environ, CALLS=str(self.folder / "calls"),
                           PATH=f"{self.folder / 'programs'}:{os.environ['PATH']}")
        return subprocess.run(command, env=environment, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT)

    def calls(self):
        path = self.folder / "calls"
        return [pathlib.Path(c).stem for c in path.read_text().split()] if path.exists() else []

    def merged(self):
        return len((self.folder / "out/result/merged.txt").read_text().split())

    def test_bags_that_fail_are_listed_and_stop_nothing(self):
        run = self.fleet(["a", "crash", "b", "empty", "vague", "damaged", "c"])
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertEqual(self.merged(), 3)
        failures = (self.folder / "out/failures.txt").read_text()
        for words in ("failed: crashed: SIGSEGV", "nothing: no images",
                      "it did not determine the lens", "damaged.bag is damaged"):
            self.assertIn(words, failures)
        self.assertEqual(self.calls().count("crash"), 2, "tried twice")
        self.assertEqual(self.calls().count("empty"), 1)

    def test_a_program_that_hangs_is_ended_and_its_bag_failed(self):
        with open(self.folder / "log", "wb") as log:
            self.assertEqual(fleet_task.run_limited(["sleep", "1000"], log, 0.1), (0, True))
            self.assertEqual(fleet_task.run_limited(["true"], log, 600), (0, False))
        fleet = fleet_task.Fleet(self.folder, [], {"timeout": 60.0})
        outcome = fleet.judge(0, True, "", has_state=False)
        self.assertEqual((outcome.kind, outcome.reason), ("failed", "no end after 60 s"))

    def test_no_state_at_all_is_told_by_the_exit_code(self):
        run = self.fleet(["empty", "vague"])
        self.assertEqual(run.returncode, 3, run.stdout)
        self.assertIn("no bag has a result", run.stdout)
        self.assertIn("2 of 2 bags left nothing", run.stdout)

    def test_slurm_tells_by_the_exit_code_that_there_is_no_state(self):
        self.program("sbatch", SBATCH)
        run = self.fleet(["empty"], "--engine", "slurm", "--wait")
        self.assertEqual(run.returncode, 3, run.stdout)
        self.assertIn("no bag has a result", run.stdout)

    def test_trouble_of_parallel_is_no_interruption(self):
        self.program("parallel", "#!/bin/bash\nexit 255\n")
        run = self.fleet(["a"], "--engine", "parallel")
        self.assertEqual(run.returncode, 1, run.stdout)
        self.assertIn("fleet: parallel could not work off the bags", run.stdout)

    @unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed")
    def test_parallel_goes_by_outcomes(self):
        self.fleet(["a", "b"], "--engine", "parallel")
        next((self.folder / "out/outcomes").glob("*-a-*")).unlink()
        before = self.calls()
        run = self.fleet(["a", "b"], "--engine", "parallel")
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertEqual(self.calls()[len(before):], ["a"])
        self.assertTrue((self.folder / "out/parallel.joblog").exists())
        run = self.fleet(["a", "b"], "--engine", "parallel")
        self.assertEqual(run.returncode, 0, "nothing is left to do")

    def test_what_is_finished_is_skipped(self):
        self.fleet(["a", "b", "crash"])
        before = self.calls()
        self.fleet(["a", "b", "crash", "new"])
        self.assertEqual(self.calls()[len(before):], ["new"])
        self.fleet(["a", "b", "crash", "new"], "--retry-failed")
        self.assertEqual(self.calls()[len(before) + 1:], ["crash", "crash"])
        next((self.folder / "out/states").glob("*-a-*")).unlink()
        before = self.calls()
        self.fleet(["a", "b", "crash", "new"])
        self.assertEqual(self.calls()[len(before):], ["a"], "its state was gone")

    def test_what_has_no_outcome_is_done_again(self):
        self.fleet(["a", "b"])
        next((self.folder / "out/outcomes").glob("*-a-*")).unlink()
        before = self.calls()
        self.fleet(["a", "b"])
        self.assertEqual(self.calls()[len(before):], ["a"])

    def test_what_was_killed_from_outside_is_for_the_next_run(self):
        first = self.fleet(["a", "killed"])
        self.assertIn("not finished", first.stdout)
        self.assertEqual(self.merged(), 1)
        (self.folder / "killed.bag.up").touch()
        self.fleet(["a", "killed"])
        self.assertEqual(self.merged(), 2)
        self.assertEqual((self.folder / "out/failures.txt").read_text(), "")

    def test_costs_are_kept_to_plan_with(self):
        self.fleet(["a", "b"])
        cost = json.loads((self.folder / "out/cost.json").read_text())
        self.assertEqual(cost["bags_with_a_state"], 2)
        self.assertEqual(cost["hours_of_video"], 1.0)

    def test_a_bad_manifest_is_refused_with_all_its_problems(self):
        path = self.folder / "m.csv"
        path.write_text("bag,topic,camera,model\n,/t,front,\na.bag,/t,front,fisheye\n")
        with self.assertRaises(fleet_manifest.Problem) as refused:
            fleet_manifest.read(path)
        self.assertIn("line 2", str(refused.exception))
        self.assertIn("fisheye", str(refused.exception))
        path.write_text("file\nx\n")
        with self.assertRaisesRegex(fleet_manifest.Problem, "no column bag, topic, camera"):
            fleet_manifest.read(path)

    def test_cameras_are_named_after_robot_and_topic(self):
        root = pathlib.Path("/bags")
        name = fleet_manifest.camera_name
        self.assertEqual(name(root, root / "robot7/a.bag", "/front/image_raw/compressed"),
                         "robot7/front")
        self.assertEqual(name(root, root / "a.bag", "/stereo/left/image_rect"), "stereo_left")
        self.assertEqual(name(root, root / "a.bag", "/image_raw"), "camera")
        self.assertEqual(name(root, root / "a.bag", "/camera/image_left/compressed"),
                         "camera_image_left")
        self.assertEqual(name(root, root / "a.bag", "/camera/image_rect_color"), "camera")


if __name__ == "__main__":
    unittest.main()
