# SPDX-License-Identifier: GPL-3.0-or-later

"""OpenImageIO's maketx: a picture file to a mip-mapped file, all of it timed."""

from pathlib import Path

from . import Measurement, run


class Maketx:
    """The program as a user runs it, with its defaults except the filter and the threads."""

    def __init__(
        self, picture: Path, folder: Path, *, filter: str, threads: int, sharpen: float = 0.0
    ) -> None:
        """Reads `picture` and writes into `folder`, anew each time."""
        options = ["--filter", filter, *(["--sharpen", str(sharpen)] if sharpen else [])]
        self.name = " ".join(["maketx", *options])
        self._target = folder / f"{filter}.{sharpen}.tx"
        self._command = ["maketx", "--threads", str(threads), *options]
        self._command += ["-o", str(self._target), str(picture)]

    def measure(self) -> Measurement:
        """See `Peer`."""
        self._target.unlink(missing_ok=True)
        seconds, peak, _ = run(self._command)
        if not self._target.exists():
            raise OSError(f"maketx wrote no '{self._target}'")
        return Measurement(seconds, peak)
