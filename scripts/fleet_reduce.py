"""From the states of all bags to one result, with what it cost."""
import csv
import json
import os
import subprocess
import sys

from fleet_task import write_atomically

# As merge_calibrations has it where no state can be used.
NOTHING = 3


def failures(fleet, outcomes):
    """A line for each bag that left no state."""
    for id, row in fleet.rows.items():
        outcome = outcomes.get(id)
        if outcome is None:
            yield f"{row.bag} ({row.camera}): not finished; run scripts/fleet again"
        elif outcome.kind != "state":
            yield f"{row.bag} ({row.camera}): {outcome.kind}: {outcome.reason}"


def hours_of_video(result):
    with open(result / "bags.csv", newline="") as file:
        return sum(float(row["end"]) - float(row["begin"]) for row in csv.DictReader(file)) / 3600


def cost(fleet, outcomes, result):
    """Figures to plan with, in words and in cost.json."""
    told = [(id, o) for id, o in outcomes.items() if o.kind == "state"]
    sizes = [fleet.path("states", id, "state").stat().st_size / 1e6 for id, _ in told]
    hours = hours_of_video(result)
    core_hours = sum(o.cpu_s for _, o in told) / 3600
    figures = {"bags_with_a_state": len(told), "hours_of_video": hours, "core_hours": core_hours,
               "core_hours_per_hour_of_video": core_hours / hours if hours else None,
               "state_mb_mean": sum(sizes) / len(sizes), "state_mb_max": max(sizes),
               "max_rss_mb": max(o.max_rss_mb for _, o in told)}
    write_atomically(fleet.folder / "cost.json", json.dumps(figures, indent=1) + "\n")
    return (f"{len(told)} bags with {hours:.2f} h of video took {core_hours:.2f} core-hours and up to "
            f"{figures['max_rss_mb']:.0f} MB; a state is {figures['state_mb_mean']:.2f} MB")


def reduce(fleet):
    """Exit code: that of merge_calibrations, or NOTHING."""
    outcomes = fleet.outcomes()
    lines = list(failures(fleet, outcomes))
    listed = fleet.folder / "failures.txt"
    write_atomically(listed, "".join(line + "\n" for line in lines))
    if lines:
        print(f"{len(lines)} of {len(fleet.rows)} bags left nothing ({listed}):")
        print("\n".join("  " + line for line in lines))
    sys.stdout.flush()
    states = [str(fleet.path("states", id, "state")) for id, o in outcomes.items()
              if o.kind == "state"]
    if not states:
        print("fleet: no bag has a result, so there is nothing to merge", file=sys.stderr)
        return NOTHING
    result = fleet.folder / "result"
    names = fleet.folder / "states.txt"
    write_atomically(names, "".join(name + "\n" for name in states))
    command = [os.path.join(fleet.settings["programs"], "merge_calibrations"), "--list", str(names),
               "--out", str(result), "--failures", str(listed),
               "--queue-segments", str(fleet.settings["queue_segments"])]
    code = subprocess.run(command).returncode
    if code == 0:
        print(cost(fleet, outcomes, result))
    return code
