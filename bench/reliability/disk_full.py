# SPDX-License-Identifier: GPL-3.0-or-later

"""Whether anything is lost where files cannot be written: on full disks of 30 sizes, in a folder
that is read-only, and in one that is gone before the file is there.

Disks are file systems in memory, which root can mount; else no file may grow beyond a size. After
each run there must be the earlier files, and an exit status that is not 0; or the new files as
they are elsewhere, and 0. Nothing else may be left.

With --quota they are folders with a limit each on a large disk, whose file system (Btrfs) reports a
full disk as late as it can. That needs root, and Btrfs's programs.

usage: disk_full.py [PATTERN] [--sizes N] [--quota] [--json FILE]
  scripts/run python3 bench/reliability/disk_full.py            writers of the package, the command
  scripts/run blender --background --python-exit-code 1 --python bench/reliability/disk_full.py
"""

import argparse
import contextlib
import io
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from bench import report  # noqa: E402
from bench.reliability import writers  # noqa: E402
from bench.reliability.writers import Writer  # noqa: E402

EARLIER = b"earlier"
# Makes a disk with room for the given number of bytes; None if it cannot.
Disk = Callable[[int], AbstractContextManager[Path | None]]
_PAGE = 4096
# Sizes of a disk with quotas, and of its metadata nodes, in bytes.
_LARGE, _NODE = 1 << 27, 1 << 12
# Magic numbers of Zstandard, and of the seek table at the end of its seekable format.
_ZSTANDARD, _SEEK_TABLE = b"\x28\xb5\x2f\xfd", b"\xb1\xea\x92\x8f"
_END_OF_FBX = bytes.fromhex("f85a8c6adef5d97eece90ce3758f290b")


class Trial:
    """A writer, its sources, and its output when there is room."""

    def __init__(self, writer: Writer, sources: Path, place: Path) -> None:
        """Runs it once."""
        self.writer, self.sources = writer, sources
        with tempfile.TemporaryDirectory(dir=place) as name:
            out = Path(name)
            self.prepare(out)
            status = self.first_status(out)
            self.new = contents(out)
        if status or any(self.new.get(name) in (None, EARLIER) for name in writer.targets):
            raise ValueError(f"{writer.kind} {writer.name}: {status}, {sorted(self.new)}")
        if self.new == self.earlier():
            raise ValueError(f"{writer.kind} {writer.name}: has written nothing")

    def first_status(self, out: Path) -> int:
        """Runs it once."""
        return quietly(self.writer, self.sources, out)[0]

    def is_whole(self, name: str, data: bytes) -> bool:
        """Tells whether a file with varying contents is whole."""
        return is_whole(name, data)

    def is_named(self, text: str, out: Path) -> bool:
        """Tells whether an error's message names a file that was to be written, or its folder."""
        _, _, message = text.rpartition("error: ")
        earlier = self.earlier()
        names = {Path(name).name for name, data in self.new.items() if data != earlier.get(name)}
        names.add(f"'{out}'")
        return any(name in message for name in names) and ".prefilter-" not in message

    def prepare(self, out: Path) -> None:
        """Puts earlier files into a folder."""
        for name in self.writer.targets:
            (out / name).write_bytes(EARLIER)
        source = self.sources / self.writer.in_place
        if self.writer.in_place and source.is_dir():
            shutil.copytree(source, out, dirs_exist_ok=True)
        elif self.writer.in_place:
            shutil.copy(source, out)

    def earlier(self) -> dict[str, bytes]:
        """Returns the files that `prepare` writes."""
        found = dict.fromkeys(self.writer.targets, EARLIER)
        source = self.sources / self.writer.in_place
        if self.writer.in_place and source.is_dir():
            found |= contents(source)
        elif self.writer.in_place:
            found[self.writer.in_place] = source.read_bytes()
        return found

    def state(self, found: dict[str, bytes]) -> str:
        """Returns "old" or "new" if the files are exactly these, else a description of them."""
        if found == self.earlier():
            return "old"
        if found.keys() == self.new.keys() and all(
            data == self.new[name] or self.is_whole(name, data) for name, data in found.items()
        ):
            return "new"
        return f"neither: { ({name: len(data) for name, data in found.items()}) }"


def is_whole(name: str, data: bytes) -> bool:
    """Tells whether a file with a time stamp inside is whole."""
    if data == EARLIER:
        return False
    if name.endswith((".exr", ".tif", ".tx")):
        from prefilter.workflows import openimageio

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / Path(name).name
            path.write_bytes(data)
            try:
                openimageio.check_whole(path)
            except OSError:
                return False
        return not name.endswith(".tx") or b"oiio:SHA-1" not in data  # Which Blender's have.
    if name.endswith(".fbx"):
        return data.startswith(b"Kaydara FBX Binary") and data.endswith(_END_OF_FBX)
    if name.endswith((".blend", ".blend1")):
        if data.startswith(_ZSTANDARD):  # Blender 5 compresses its files.
            return data.endswith(_SEEK_TABLE)
        return data.startswith(b"BLENDER") and b"ENDB" in data[-64:]
    return False


def contents(folder: Path) -> dict[str, bytes]:
    """Returns the contents of a folder and its subfolders."""
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else b""
        for path in folder.rglob("*")
    }


def is_left(name: str) -> bool:
    """Tells whether a name is one of ours for files that are not finished."""
    return any(part.startswith(".prefilter-") for part in Path(name).parts)


def quietly(writer: Writer, sources: Path, out: Path) -> tuple[int, str]:
    """Runs a writer without showing its output.

    Returns:
        The exit status, and the output of Python.
    """
    with open(os.devnull, "w") as nowhere:
        kept = [os.dup(stream) for stream in (1, 2)]
        sys.stdout.flush()
        for stream in (1, 2):
            os.dup2(nowhere.fileno(), stream)
        try:
            text = io.StringIO()
            with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
                status = writer.run(sources, out)
            return status, text.getvalue()
        finally:
            for stream, old in enumerate(kept, start=1):
                os.dup2(old, stream)
                os.close(old)


@contextlib.contextmanager
def disk(place: Path, size: int) -> Iterator[Path | None]:
    """Mounts a file system of a size; None where that cannot be done."""
    folder = place / "disk"
    folder.mkdir(exist_ok=True)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)]
    can = sys.platform == "linux" and shutil.which("mount") is not None
    if not can or subprocess.run(mount, capture_output=True, check=False).returncode:
        yield None
        return
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


@contextlib.contextmanager
def large_disk(place: Path) -> Iterator[Path]:
    """Mounts a file system whose folders may have limits.

    Raises:
        OSError: It cannot be had here.
    """
    image, folder = place / "disk.btrfs", place / "disk"
    folder.mkdir(exist_ok=True)
    with image.open("wb") as file:
        file.truncate(_LARGE)
    try:
        for words in (
            ["mkfs.btrfs", "--quiet", "--nodesize", str(_NODE), str(image)],
            ["mount", "-o", "loop", str(image), str(folder)],
        ):
            subprocess.run(words, capture_output=True, check=True)
    except subprocess.CalledProcessError as error:
        raise OSError(f"cannot make a disk with quotas: {error.stderr.decode()}") from error
    try:
        _btrfs("quota", "enable", folder)
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


@contextlib.contextmanager
def limited(disk: Path, size: int) -> Iterator[Path]:
    """Makes a folder of a large disk that may have a size."""
    folder = disk / "limited"
    _btrfs("subvolume", "create", folder)
    try:
        # An empty folder takes some space, and Btrfs reserves some while it makes a file.
        _btrfs("qgroup", "limit", size + 10 * _NODE, folder)
        yield folder
    finally:
        _btrfs("subvolume", "delete", "--commit-after", folder)


def _btrfs(*words: object) -> None:
    subprocess.run(["btrfs", *map(str, words)], stdout=subprocess.DEVNULL, check=True)


@contextlib.contextmanager
def small_files(place: Path, size: int) -> Iterator[Path]:
    """Lets no file grow beyond a size."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        with tempfile.TemporaryDirectory(dir=place) as name:
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
            try:
                yield Path(name)
            finally:
                resource.setrlimit(resource.RLIMIT_FSIZE, before)
    finally:
        signal.signal(signal.SIGXFSZ, handler)


def on_full_disks(
    trial: Trial, place: Path, count: int, disk_of: Disk | None = None
) -> tuple[list[str], bool]:
    """Tries disks from one with room for the earlier files up to one with room for everything.

    Args:
        trial: The writer.
        place: The folder for the disks.
        count: The number of disks.
        disk_of: Makes the disks; None for file systems in memory.

            Returns:
        The state after each, and whether they were disks rather than file size limits.
    """
    old = sum(-(-len(data) // _PAGE) for data in trial.earlier().values())
    most = old + 3 * sum(-(-len(data) // _PAGE) for data in trial.new.values()) + 4
    found, are_disks = [], True
    disk_of = disk_of or partial(disk, place)
    for i in range(count):
        pages = old + (most - old) * i // max(1, count - 1)
        with disk_of(pages * _PAGE) as mounted:
            if mounted is not None:
                found.append(_tried(trial, mounted))
                continue
        are_disks = False
        largest = max(map(len, trial.new.values()))
        with small_files(place, max(len(EARLIER), largest * i // max(1, count - 1))) as folder:
            found.append(_tried(trial, folder))
    return found, are_disks


def _tried(trial: Trial, out: Path) -> str:
    trial.prepare(out)
    status, text = quietly(trial.writer, trial.sources, out)
    if status and not trial.is_named(text, out):
        return f"a message that names no file: {text}"
    return outcome(trial.state(contents(out)), status)


def outcome(state: str, status: int) -> str:
    """Returns a state that fits an exit status, else both."""
    fits = (state == "new") == (status == 0) and state in ("old", "new")
    return state if fits else f"{state}, status {status}"


def read_only(trial: Trial, place: Path) -> str:
    """Tries a folder that nobody may write to."""
    with tempfile.TemporaryDirectory(dir=place) as name:
        out = Path(name)
        trial.prepare(out)
        folders = [out, *(path for path in out.iterdir() if path.is_dir())]
        for folder in folders:
            folder.chmod(0o555)
        status, _ = quietly(trial.writer, trial.sources, out)
        for folder in folders:
            folder.chmod(0o755)
        return outcome(trial.state(contents(out)), status)


def vanishing(trial: Trial, place: Path) -> str:
    """Tries a folder that is moved away as soon as something is written into it."""
    with tempfile.TemporaryDirectory(dir=place) as name:
        out, elsewhere = Path(name) / "out", Path(name) / "elsewhere"
        out.mkdir()
        trial.prepare(out)
        moved = []

        def watch(event: str, arguments: tuple[object, ...]) -> None:
            if event == "os.rename" and not moved and out.exists():
                moved.append(True)
                out.rename(elsewhere)

        sys.addaudithook(watch)
        status, _ = quietly(trial.writer, trial.sources, out)
        moved.append(True)
        if not elsewhere.exists():
            return outcome(trial.state(contents(out)), status)
        left = trial.state(
            {name: data for name, data in contents(elsewhere).items() if not is_left(name)}
        )
        if out.exists() and contents(out):
            return f"neither: {sorted(contents(out))}, status {status}"
        return outcome(left, status)


def summary(found: list[str]) -> str:
    """Returns the count of each state."""
    others = sorted({one for one in found if one not in ("old", "new")})
    text = f"{found.count('old')} old, {found.count('new')} new"
    return (
        f"{text}, {len(found) - found.count('old') - found.count('new')} {others}"
        if others
        else text
    )


def main() -> None:
    """Tries every writer of this program."""
    parser = argparse.ArgumentParser()
    parser.add_argument("pattern", nargs="?", default="")
    parser.add_argument("--sizes", type=int, default=30)
    parser.add_argument("--quota", action="store_true")
    report.add_json_option(parser)
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    in_blender = "bpy" in sys.modules
    options = parser.parse_args(arguments if in_blender else None)
    kinds = ("blender",) if in_blender else ("package", "command")
    told = report.Report()
    rows, bad, tried = [], 0, 0
    with tempfile.TemporaryDirectory() as name, contextlib.ExitStack() as held:
        sources, place = Path(name) / "sources", Path(name)
        sources.mkdir()
        writers.make_sources(sources)
        if in_blender:
            writers.make_scene(sources)
        disk_of = None
        if options.quota:
            disk_of = partial(limited, held.enter_context(large_disk(place)))
        for writer in writers.chosen(options.pattern, kinds, sources, told):
            trial = Trial(writer, sources, place)
            full, are_disks = on_full_disks(trial, place, options.sizes, disk_of)
            others = [] if options.quota else [read_only(trial, place), vanishing(trial, place)]
            rows.append([f"{writer.kind}: {writer.name}", summary(full), *others])
            print("  ".join(rows[-1]), flush=True)
            tried += len(full) + len(others)
            bad += sum(one not in ("old", "new") for one in (*full, *others))
    told.table(
        "Files that cannot be written",
        ["Writer", "Over quota"] if options.quota else ["Writer", "Full disk", "Read-only", "Gone"],
        rows,
        "writers",
    )
    kind = "disks" if are_disks else "limits of the size of files"
    kind = "quotas" if options.quota else kind
    told.verdict(not bad, f"{tried} runs, on {kind}: old files and a failure, or new ones and none")
    told.finish(options.json)


if __name__ == "__main__":
    main()
