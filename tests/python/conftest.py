"""Makes the modules beside the tests importable, wherever pytest is started."""

import os
import sys
from pathlib import Path

# Set before numpy is there: threads that share small matrices wait for each other most of the time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parent))


def pytest_configure(config):
    config.addinivalue_line("markers", "heavy: long, and the same whichever Python runs it")
