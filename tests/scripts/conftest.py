# SPDX-License-Identifier: GPL-3.0-or-later

"""The programs in scripts/ are imported by the tests."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).resolve().parents[2] / "scripts")]
