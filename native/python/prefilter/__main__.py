# SPDX-License-Identifier: GPL-3.0-or-later

"""`python -m prefilter`: the command."""

import sys

from .commands.program import main

sys.exit(main())
