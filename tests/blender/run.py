# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs pytest inside Blender.

blender --background --factory-startup --python-exit-code 1 --python tests/blender/run.py -- ARGS
"""

import os
import sys

import pytest

arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
status = int(pytest.main(arguments or [os.path.dirname(__file__)]))
sys.stdout.flush()
sys.stderr.flush()
# Blender would end with its own status.
os._exit(status)
