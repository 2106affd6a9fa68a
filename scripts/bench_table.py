#!/usr/bin/env python3
"""Joins what the benchmark programs wrote into bench.json, and prints one table of ratios."""
import json
import statistics
import sys
from pathlib import Path


def medians(report):
    """Median time of each benchmark over its repetitions, in its own unit: that of the processor,
    which other load disturbs least, but of the clock where several threads work."""
    runs = {}
    for run in report["benchmarks"]:
        if run.get("run_type") == "iteration":
            runs.setdefault(run["run_name"], []).append(run)
    kind = {name: "real_time" if "real_time" in name else "cpu_time" for name in runs}
    return {name: statistics.median(r[kind[name]] for r in group) for name, group in runs.items()}


def row(name, value, target=""):
    print(f"{name:<52} {value:>14}   {target}")


def solver_rows(t):
    def ratio(name, suffix=""):
        return t[f"{name}/ceres{suffix}"] / t[f"{name}/ours{suffix}"]

    queue = "queue"
    one, two = "/1/real_time", "/2/real_time"
    row("against Ceres, one thread: sliding window", f"{ratio('slidingWindow'):.1f} x", "4 x")
    row("  candidate with marginal", f"{ratio('candidate'):.1f} x", "5 x")
    row("  marginal alone", f"{ratio('marginal'):.1f} x", "15 x")
    row("  queue of 10 x 10 keyframes", f"{ratio(queue, one):.1f} x", "4.5 x")
    row("queue on two threads against one",
        f"{t['queue/ours' + one] / t['queue/ours' + two]:.2f} x", "1.7 x")
    for name in ("slidingWindow/ours", "candidate/ours", "marginal/ours", "queue/ours" + one):
        row(f"  {name.split('/')[0]}", f"{t[name]:.2f} ms")
    for name, value in t.items():
        if name.startswith("batch/"):
            row(f"  batch with Ceres, {name.split('/')[2]} keyframes"
                + (", covariance" if "covariance" in name else ""), f"{value:.0f} ms")


def front_end_rows(t):
    for name, value in t.items():
        row(f"  {name}", f"{value:.1f} us", "8 us" if name == "registerPatch" else "")


def pipeline_rows(pipeline):
    targets = {"640x480 raw inline": "200 fps, p99 25 ms",
               "640x480 raw threaded": "350 fps, p99 8 ms",
               "1280x720 raw inline": "100 fps", "1280x720 raw threaded": "175 fps",
               "640x480 raw live 30 Hz": "15 % of a core"}
    for run in pipeline["runs"]:
        processed = run["frames"] - run["dropped"]
        row(run["name"], f"{run['fps']:.0f} fps", targets.get(run["name"], ""))
        row("  frame p50 p95 p99 max", " ".join(
            f"{run[key]:.1f}" for key in ("p50_ms", "p95_ms", "p99_ms", "max_ms")) + " ms")
        row("  frames per second of one core's time", f"{processed / run['cpu_seconds']:.0f}",
            f"{run['dropped']} images dropped" if run["dropped"] else "")
        share = 100 * run["cpu_seconds"] / run["wall_seconds"]
        row("  CPU, s per s of 30 Hz video; of a core, %",
            f"{30 * run['cpu_seconds'] / processed:.2f}; {share:.0f}")
    row("peak memory, videos included", f"{pipeline['peak_megabytes']:.0f} MB")


def real_video_rows(report):
    for video in report["videos"]:
        rate, inline, live = video["rate_hz"], video["inline"], video["live"]
        row(f"{inline['name']} inline, {inline['state']}", f"{inline['fps']:.0f} fps",
            f"{2 * rate:.0f} fps")
        row("  live: frame p50 p99 max", " ".join(
            f"{live[key]:.1f}" for key in ("p50_ms", "p99_ms", "max_ms")) + " ms",
            f"p99 {1e3 / rate:.0f} ms; {live['dropped']} images dropped")


def growth_rows(growth):
    base = growth[0]
    for stretch in growth:
        row(f"{stretch['keyframes']} keyframes: frame, keyframe",
            f"{stretch['frame_ms']:.2f} {stretch['keyframe_ms']:.2f} ms",
            f"{stretch['frame_ms'] / base['frame_ms']:.2f} "
            f"{stretch['keyframe_ms'] / base['keyframe_ms']:.2f} of the first; "
            f"{stretch['resident_megabytes']:.1f} MB")


def main():
    folder = Path(sys.argv[1])
    parts = {name: json.loads((folder / f"{name}.json").read_text())
             for name in ("solver", "front_end", "pipeline", "growth")}
    real_video = folder / "real_video.json"
    if real_video.exists():
        parts["real_video"] = json.loads(real_video.read_text())
    (folder / "bench.json").write_text(json.dumps(parts, indent=1))
    row("", "measured", "target")
    solver_rows(medians(parts["solver"]))
    front_end_rows(medians(parts["front_end"]))
    pipeline_rows(parts["pipeline"])
    growth_rows(parts["growth"]["growth"])
    if "real_video" in parts:
        real_video_rows(parts["real_video"])
    print(f"all figures: {folder / 'bench.json'}")


if __name__ == "__main__":
    main()
