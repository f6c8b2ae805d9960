"""What the sessions share that run in a Blender with a window."""

import os
import traceback
from collections.abc import Callable, Iterator

import bpy

SECONDS_PER_STEP = 0.3
MAX_WAITS = 200


def until(condition: Callable[[], bool]) -> Iterator[None]:
    """Yields until a condition holds."""
    for _ in range(MAX_WAITS):
        yield
        if condition():
            return
    raise TimeoutError(f"waited {MAX_WAITS} times for {condition}")


def play(session: Iterator[None]) -> None:
    """Runs a session, which yields whenever Blender should draw and handle events, then ends."""

    def step() -> float:
        try:
            next(session)
        except StopIteration:
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        return SECONDS_PER_STEP

    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(step, first_interval=1.0, persistent=True)
