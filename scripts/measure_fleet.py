"""The table of what merging the states of many bags costs."""
import os
import pathlib
import subprocess
import tempfile
import time

from measure_program import table


def merging(places):
    rows = []
    for cameras in (10, 40):
        with tempfile.TemporaryDirectory() as folder:
            states = pathlib.Path(folder) / "states"
            subprocess.run([places.program("fleet_states"), "--folder", str(states), "--cameras", str(cameras)],
                           check=True, stdout=subprocess.DEVNULL)
            files = [file for file in states.rglob("*") if file.is_file()]
            size = sum(file.stat().st_size for file in files)
            begin = time.monotonic()
            merge = subprocess.Popen([places.program("merge_calibrations"), str(states), "--out", folder + "/merged",
                                      "--threads", "2"], stdout=subprocess.DEVNULL)
            _, status, usage = os.wait4(merge.pid, 0)
            took = time.monotonic() - begin
            merge.returncode = os.waitstatus_to_exitcode(status)
            if merge.returncode != 0:
                raise ValueError(f"merge_calibrations ended with {merge.returncode}")
            rows.append([f"{len(files)}", f"{cameras}", f"{size / 1e9:.2f} GB",
                         f"{usage.ru_utime + usage.ru_stime:.1f} s", f"{usage.ru_maxrss / 1024:.0f} MB", f"{took:.0f} s"])
    return table(["states", "cameras", "on disk", "CPU time", "memory", "wall time"], rows)
