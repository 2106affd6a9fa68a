"""Where the bags of a fleet are worked off: here, by GNU parallel, by Slurm."""
import concurrent.futures
import math
import os
import pathlib
import shlex
import shutil
import subprocess
import sys

import fleet_reduce
from fleet_manifest import Problem
from fleet_task import STOPPED, bag_size_mb, write_atomically

FLEET = str(pathlib.Path(__file__).resolve().parent / "fleet")
# Slurm's default MaxArraySize is 1001.
MOST_ARRAY_TASKS = 1000
LEAST_MEMORY_MB, LEAST_MINUTES = 256, 2
# What is asked for, over what was measured.
MEMORY_MARGIN, TIME_MARGIN = 1.5, 3.0


def need(program, package):
    if not shutil.which(program):
        raise Problem(f"{program} is not installed: apt install {package}")


def task(fleet, id, attempts):
    return [sys.executable, FLEET, "task", str(fleet.folder), id, str(attempts)]


def local(fleet, options):
    """As many bags at a time as --jobs, on this machine."""
    pending = fleet.pending()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runs = [pool.submit(subprocess.run, task(fleet, id, options.retries),
                            stdout=subprocess.PIPE, text=True) for id in pending]
        try:
            for number, run in enumerate(concurrent.futures.as_completed(runs), 1):
                print(f"[{number}/{len(pending)}] {run.result().stdout.strip()}", flush=True)
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)
            raise
    return fleet_reduce.reduce(fleet)


def parallel(fleet, options):
    """GNU parallel, here or on the machines of --sshloginfile, which see the same folders."""
    need("parallel", "parallel")
    bags = fleet.folder / "parallel.txt"
    # What is finished the outcomes tell; the log is for people.
    write_atomically(bags, "".join(id + "\n" for id in fleet.pending()))
    command = ["parallel", "--will-cite", "--joblog", str(fleet.folder / "parallel.joblog"),
               "--retries", str(options.retries), "--jobs", str(options.jobs),
               "--bar" if sys.stderr.isatty() else "--line-buffer"]
    if options.sshloginfile:
        command += ["--sshloginfile", options.sshloginfile]
    words = " ".join(shlex.quote(word) for word in task(fleet, "{}", options.retries)).replace("'{}'", "{}")
    code = subprocess.run(command + [words, "::::", str(bags)]).returncode
    # Bags that failed count to 101; the last code is its own trouble, as an option that it lacks.
    if code == 255:
        raise Problem("parallel could not work off the bags; see above")
    if code < 0 or code > 128:
        return STOPPED
    return fleet_reduce.reduce(fleet)


def measured(fleet):
    """MB of memory, and seconds per MB of bag, that bags took at most; None: nothing is known."""
    done = [o for o in fleet.outcomes().values() if o.kind != "failed"]
    if not done:
        return None
    return max(o.max_rss_mb for o in done), max(o.wall_s / max(1.0, o.bag_mb) for o in done)


def measure(fleet, pending):
    """Tries bags here, from the middle of the sizes on, until one has told what a bag takes."""
    by_size = sorted(pending, key=lambda id: bag_size_mb(fleet.rows[id].bag))
    for id in by_size[len(by_size) // 2:]:
        print(f"Nothing is known of what a bag takes: trying {fleet.rows[id].bag} here", flush=True)
        fleet.task(id)
        if measured(fleet):
            break
    return measured(fleet) or (LEAST_MEMORY_MB, 1.0)


def chunks(fleet, pending):
    """Lists of bags, one for each task of the array, about equally long."""
    count = min(MOST_ARRAY_TASKS, len(pending))
    lists = [[] for _ in range(count)]
    for number, id in enumerate(sorted(pending, key=lambda i: -bag_size_mb(fleet.rows[i].bag))):
        lists[number % count].append(id)
    return lists


def submit(script, fleet, options, arguments):
    """The job, and its exit code: with --wait, that of what it ran if that was 0 or NOTHING."""
    command = ["sbatch", "--parsable", f"--chdir={fleet.folder}"]
    command += [f"--partition={options.partition}"] if options.partition else []
    done = subprocess.run(command + arguments, input=script, text=True, stdout=subprocess.PIPE)
    job = done.stdout.strip().split(";")[0]
    if not job:
        raise Problem("sbatch refused the job; see above")
    if done.returncode not in (0, fleet_reduce.NOTHING):
        raise Problem(f"the job {job} ended with the code {done.returncode}; run this again to go on")
    return job, done.returncode


def submit_array(fleet, options, pending):
    memory, seconds_per_mb = measured(fleet) or measure(fleet, pending)
    pending = fleet.pending()
    if not pending:
        return None
    lists = chunks(fleet, pending)
    write_atomically(fleet.folder / "slurm.txt", "".join(" ".join(ids) + "\n" for ids in lists))
    longest = max(sum(bag_size_mb(fleet.rows[id].bag) for id in ids) for ids in lists)
    # One bag of a task may hang for as long as it is let.
    seconds = TIME_MARGIN * seconds_per_mb * longest + options.retries * options.timeout
    minutes = max(LEAST_MINUTES, math.ceil(seconds / 60))
    megabytes = max(LEAST_MEMORY_MB, math.ceil(MEMORY_MARGIN * memory))
    one = " ".join(shlex.quote(w) for w in task(fleet, "ID", options.retries)).replace(" ID ", ' "$id" ')
    script = (f"#!/bin/bash\nids=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" slurm.txt)\n"
              f"for id in $ids; do {one}; done\nexit 0\n")
    print(f"{len(lists)} tasks of {minutes} min and {megabytes} MB", flush=True)
    job, _ = submit(script, fleet, options,
                    ["--job-name=fleet", f"--array=0-{len(lists) - 1}%{options.jobs}",
                     "--cpus-per-task=1", f"--mem={megabytes}M", f"--time={minutes}", "--requeue",
                     "--output=logs/slurm-%A_%a.log"])
    return job


def slurm(fleet, options):
    """An array job over the bags, then the merge, whatever became of them."""
    need("sbatch", "slurm-client")
    pending = fleet.pending()
    array = submit_array(fleet, options, pending) if pending else None
    script = f"#!/bin/bash\nexec {shlex.join([sys.executable, FLEET, 'reduce', str(fleet.folder)])}\n"
    arguments = ["--job-name=fleet-merge", "--output=logs/reduce.log", "--cpus-per-task=1"]
    arguments += [f"--dependency=afterany:{array}"] if array else []
    arguments += ["--wait"] if options.wait else []
    job, code = submit(script, fleet, options, arguments)
    log = fleet.folder / "logs/reduce.log"
    if options.wait:
        print(log.read_text(), end="")
        return code
    print(f"Submitted: the bags as job {array or '-'}, the merge as job {job}. What it says will be "
          f"in {log}; run the same command again if jobs were lost")
    return 0


ENGINES = {"local": local, "parallel": parallel, "slurm": slurm}
