"""How a table is measured that a program prints."""
import dataclasses
import os
import pathlib
import re
import subprocess
from typing import Callable, Optional


class NotMeasured(Exception):
    """What a table needs is not there."""


@dataclasses.dataclass
class Places:
    build: pathlib.Path
    videos: Optional[pathlib.Path]

    def folders(self):
        """Of the programs."""
        return self.build / "devel/lib/camera_self_calibration", self.build / "test"

    def program(self, name):
        tool, benchmark = (folder / name for folder in self.folders())
        return str(tool if tool.exists() else benchmark)

    def video_folder(self):
        if self.videos is None:
            raise NotMeasured("it needs video: give --videos FOLDER")
        return self.videos

    def bag(self, name):
        bag = self.video_folder() / name
        if not bag.exists():
            raise NotMeasured(f"it needs {bag}")
        return bag

    def shell(self, command, folder=None):
        """What a command prints that is typed in a folder, the programs on its path."""
        path = os.pathsep.join([*(str(f.resolve()) for f in self.folders()), os.environ["PATH"]])
        return subprocess.run(["bash", "-o", "pipefail", "-ec", command], check=True, text=True, cwd=folder,
                              stdout=subprocess.PIPE, env=dict(os.environ, PATH=path)).stdout


@dataclasses.dataclass
class Table:
    name: str
    page: str
    programs: tuple  # What it runs.
    command: str  # As it stands below the table, to be typed.
    measure: Callable[[Places], str]  # Gives the table in Markdown.


def table(header, rows):
    """In Markdown, of lists of cells."""
    lines = ["| " + " | ".join(cells) + " |" for cells in (header, *rows)]
    return "\n".join([lines[0], "|---" * len(header) + "|", *lines[1:]]) + "\n"


def last_table(text):
    """Header and rows of the last table in the output of a program, which may print others on the way."""
    lines = text.splitlines()
    rules = [i for i, line in enumerate(lines) if line.startswith("|---")]
    if not rules or rules[-1] == 0:
        raise ValueError("the program printed no table")
    last = lines[rules[-1] - 1:]
    end = next((i for i, line in enumerate(last) if not line.startswith("|")), len(last))
    return [re.sub(r"\bnan\b", "-", line) for line in last[:end]]


def shell_command(command, variants):
    """What one types to run it, for each variant if there are any."""
    if not variants:
        return command
    words = " ".join(f'"{v}"' if " " in str(v) else str(v) for v in variants)
    return f"for v in {words}; do {command.format('$v')}; done"


def printed(name, page, command, variants=(), label="", video=False):
    """A table that a benchmark prints. With variants it runs once for each, which takes the place of
    {} in the command and, with a `label`, stands in a first column of that name. Where it needs
    video, it runs in the folder of the bags."""
    def one(places, variant):
        folder = places.video_folder() if video else None
        return last_table(places.shell(command.format(variant), folder))

    def measure(places):
        lines = []
        for variant in variants or ("",):
            header, rule, *rows = one(places, variant)
            if label:
                header, rule, rows = f"| {label} {header}", f"|---{rule}", [f"| {variant} {row}" for row in rows]
            lines = (lines or [header, rule]) + rows
        return "\n".join(lines) + "\n"
    return Table(name, page, (command.split()[0],), shell_command(command, variants), measure)
