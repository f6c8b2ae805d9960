# SPDX-License-Identifier: GPL-3.0-or-later

"""Pages of a viewer in headless Chromium, which get tasks from this program and return results."""

import http.server
import json
import shutil
import subprocess
import tempfile
import threading
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
_OPTIONS = (
    *("--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader"),
    *("--enable-unsafe-swiftshader", "--no-first-run", "--disable-background-networking"),
)
_TYPES = {".html": "text/html", ".js": "text/javascript", ".wasm": "application/wasm"}


def ask(page: str, request: Any, folders: dict[str, Path], timeout: float) -> Any:
    """Opens a page of this folder, and returns its answer.

    Args:
        page: Its file name.
        request: The value passed to the page.
        folders: The readable folders, by the first part of a URL.
        timeout: In seconds.

    Raises:
        RuntimeError: The page failed, or did not answer in time.
    """
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if program is None:
        raise RuntimeError("chromium is not installed")
    answers: list[Any] = []
    answered = threading.Event()

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            if self.path == "/request":
                self._send(json.dumps(request).encode(), "application/json")
                return
            first, _, rest = self.path.lstrip("/").partition("/")
            path = folders[first] / rest if first in folders else HERE / first
            if not path.is_file():
                self.send_error(404)
                return
            self._send(path.read_bytes(), _TYPES.get(path.suffix, "application/octet-stream"))

        def do_POST(self) -> None:
            data = self.rfile.read(int(self.headers["Content-Length"]))
            answers.append(json.loads(data))
            self._send(b"", "text/plain")
            answered.set()

        def _send(self, data: bytes, kind: str) -> None:
            self.send_response(200)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, *_: Any) -> None:
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with tempfile.TemporaryDirectory() as profile:
        url = f"http://127.0.0.1:{server.server_port}/{page}"
        command = (program, *_OPTIONS, f"--user-data-dir={profile}", "--remote-debugging-port=0")
        browser = subprocess.Popen(
            (*command, url), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        try:
            if not answered.wait(timeout):
                raise RuntimeError(f"{page} did not answer within {timeout:.0f} s")
        finally:
            browser.terminate()
            browser.wait()
            server.shutdown()
    if "error" in answers[0]:
        raise RuntimeError(f"{page}: {answers[0]['error']}")
    return answers[0]
