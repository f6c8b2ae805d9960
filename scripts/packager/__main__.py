# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs the folder as a program: `python3 scripts/packager extension ...`."""

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[1])

from packager.command_line import main  # noqa: E402

sys.exit(main())
