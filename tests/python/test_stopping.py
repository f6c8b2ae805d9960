# SPDX-License-Identifier: GPL-3.0-or-later

"""Commands asked to stop end soon, say so, and leave no files behind."""

import os
import signal
import subprocess
import sys
import threading

import numpy as np
import prefilter
import pytest
from prefilter._border import stopping
from prefilter.commands.program import run_to_status
from prefilter.files import staging
from prefilter.workflows.files import png

STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143}

pytestmark = pytest.mark.skipif(os.name == "nt", reason="there are no such signals")


@pytest.fixture(params=STATUS, ids=lambda number: number.name)
def number(request):
    return request.param


@pytest.mark.parametrize("name", ["out.ktx2", "out.png"])
def test_a_command_that_works(tmp_path, number, name):
    """Stops the command as a user would who sees the first line of progress."""
    pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")
    values = np.random.default_rng(1).integers(0, 255, (512, 512, 3), np.uint8)
    (tmp_path / "paint.png").write_bytes(png.encoded(values))
    command = [sys.executable, "-m", "prefilter", "mipmaps", "paint.png", "-o", name]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(
        command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True
    ) as run:
        assert "%" in run.stderr.readline()
        run.send_signal(number)
        told = run.stderr.read()
    assert run.returncode == STATUS[number], told
    assert told.endswith("prefilter: canceled\n")
    assert [path.name for path in tmp_path.iterdir()] == ["paint.png"]


def test_elsewhere_it_is_interrupted(number, capsys, quick_path):
    def run():
        def write(file):
            file.write(b"new")
            os.kill(os.getpid(), number)

        staging.write_output(quick_path / "a.txt", write)

    assert run_to_status(run) == STATUS[number]
    assert capsys.readouterr().err == "prefilter: canceled\n"
    assert list(quick_path.iterdir()) == []


def test_what_fails_because_of_it_is_no_failure(number, capsys):
    def run():
        try:
            os.kill(os.getpid(), number)
        except KeyboardInterrupt as error:
            raise RuntimeError("an operator of Blender tells it in its way") from error

    assert run_to_status(run) == STATUS[number]
    assert capsys.readouterr().err == "prefilter: canceled\n"


def test_a_set_that_is_put_into_place_is_not_interrupted(number, quick_path, monkeypatch):
    replace = os.replace

    def stop_amid(*names):
        if not stopping.asked():
            os.kill(os.getpid(), number)
        replace(*names)

    files = [staging.stage_data(quick_path / f"{i}.txt", b"new") for i in range(3)]
    monkeypatch.setattr(os, "replace", stop_amid)
    assert run_to_status(lambda: staging.commit_all(files)) == STATUS[number]
    assert sorted(path.name for path in quick_path.iterdir()) == ["0.txt", "1.txt", "2.txt"]


def test_other_threads_do_not_hold_it(number):
    def run():
        with stopping.held():
            os.kill(os.getpid(), number)

    def elsewhere():
        thread = threading.Thread(target=run)
        thread.start()
        thread.join()

    assert run_to_status(elsewhere) == STATUS[number]


def test_handlers_are_put_back(number):
    before = signal.getsignal(number)
    assert run_to_status(lambda: None) == 0
    assert signal.getsignal(number) is before


def test_others_end_as_canceled():
    def run():
        raise prefilter.Cancelled

    assert run_to_status(run) == 130
