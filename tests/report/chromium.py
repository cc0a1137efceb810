"""Headless Chromium, driven over its debugging pipe; run as a script it takes the picture of a page.

python tests/report/chromium.py results/report.html docs/images/report.png
"""

import argparse
import base64
import io
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

from PIL import Image

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--remote-debugging-pipe",
)
SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
WITHOUT_WEBGL = ("--disable-gpu", "--disable-3d-apis")
SECONDS = 60


def find_browser() -> str | None:
    """Chromium on the path, or the program that the variable CHROMIUM names."""
    found = [os.environ.get("CHROMIUM"), *map(shutil.which, NAMES)]
    return next((path for path in found if path), None)


class Browser:
    """One page in a browser of its own.

    Attributes:
        complaints: errors and warnings of the page's console, and exceptions.
        requests: addresses that the page asked for.
    """

    def __init__(self, program: str, flags: tuple[str, ...] = SOFTWARE, size: tuple[int, int] = (1280, 900)):
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self._last = 0
        self._unread = b""
        self._profile = tempfile.TemporaryDirectory(prefix="chromium-", ignore_cleanup_errors=True)
        reads, self._write = os.pipe()
        self._read, writes = os.pipe()
        # Chromium reads commands from descriptor 3 and writes answers to 4.
        profile = f"--user-data-dir={self._profile.name}"
        command = [program, *FLAGS, *flags, profile, "about:blank"]
        self._process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{reads} 4>&{writes}', "bash", *command],
            pass_fds=(reads, writes),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(reads)
        os.close(writes)
        self._session: str | None = None
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")
        self.resize(*size)

    def __enter__(self) -> "Browser":
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._write)  # Chromium ends when its pipe does
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._read)
        self._profile.cleanup()

    def send(self, method: str, **values: Any) -> dict[str, Any]:
        """Give a command and wait for its answer."""
        self._last += 1
        message = {"id": self._last, "method": method, "params": values}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._receive()
            if answer.get("id") == self._last:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self._note(answer)

    def _receive(self) -> dict[str, Any]:
        end = time.monotonic() + SECONDS
        while b"\0" not in self._unread:
            if not select.select([self._read], [], [], max(0, end - time.monotonic()))[0]:
                raise TimeoutError("the browser does not answer")
            more = os.read(self._read, 1 << 20)
            if not more:
                raise RuntimeError("the browser ended")
            self._unread += more
        message, _, self._unread = self._unread.partition(b"\0")
        return json.loads(message)

    def _note(self, event: dict[str, Any]) -> None:
        values = event.get("params", {})
        match event.get("method"):
            case "Runtime.consoleAPICalled" if values["type"] in ("error", "warning", "assert"):
                self.complaints.append(str([part.get("value") for part in values["args"]]))
            case "Runtime.exceptionThrown":
                self.complaints.append(str(values["exceptionDetails"]))
            case "Log.entryAdded" if values["entry"]["level"] in ("error", "warning"):
                self.complaints.append(values["entry"]["text"])
            case "Network.requestWillBeSent":
                self.requests.append(values["request"]["url"])

    def resize(self, width: int, height: int, dark: bool = False) -> None:
        self.send(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.send("Emulation.setEmulatedMedia", features=[scheme])

    def open(self, page: Path) -> None:
        self.send("Page.navigate", url="about:blank")
        self.wait("document.URL === 'about:blank'")
        self.send("Page.navigate", url=page.resolve().as_uri())
        self.wait("document.readyState === 'complete' && document.URL.startsWith('file:')")

    def evaluate(self, expression: str) -> Any:
        """Value of JavaScript in the page."""
        answer = self.send(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True, timeout=30_000
        )
        if "exceptionDetails" in answer:
            raise RuntimeError(str(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def wait(self, expression: str) -> None:
        """Until JavaScript is true."""
        end = time.monotonic() + SECONDS
        while not self.evaluate(expression):
            if time.monotonic() > end:
                raise TimeoutError(expression)
            time.sleep(0.05)

    def settle(self) -> None:
        """Until the page has drawn what it was asked to."""
        self.evaluate(
            "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))"
        )

    def _box(self, selector: str) -> dict[str, float]:
        self.evaluate(f"document.querySelector({selector!r}).scrollIntoView({{block: 'center'}})")
        return self.evaluate(
            f"(({{x, y, width, height}}) => ({{x, y, width, height}}))"
            f"(document.querySelector({selector!r}).getBoundingClientRect())"
        )

    def _mouse(self, kind: str, x: float, y: float, buttons: int = 0) -> None:
        self.send(
            "Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=buttons, clickCount=1
        )

    def click(self, selector: str) -> None:
        box = self._box(selector)
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self._mouse("mousePressed", x, y, 1)
        self._mouse("mouseReleased", x, y)
        self.settle()

    def drag(self, selector: str, right: float, down: float) -> None:
        box = self._box(selector)
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self._mouse("mouseMoved", x, y)
        self._mouse("mousePressed", x, y, 1)
        for part in (0.5, 1.0):
            self._mouse("mouseMoved", x + part * right, y + part * down, 1)
        self._mouse("mouseReleased", x + right, y + down)
        self.settle()

    def choose(self, selector: str, value: Any) -> None:
        """Set a control as a person would, events included."""
        self.evaluate(
            f"""(control => {{
                control.value = {json.dumps(str(value))};
                for (const kind of ["input", "change"]) control.dispatchEvent(new Event(kind));
            }})(document.querySelector({selector!r}))"""
        )
        self.settle()

    def picture(self, selector: str | None = None) -> Image.Image:
        """What the window shows, or one element of it."""
        box = self._box(selector) if selector else None
        self.settle()
        shown = self.send("Page.captureScreenshot", format="png")["data"]
        image = Image.open(io.BytesIO(base64.b64decode(shown))).convert("RGB")
        if box is None:
            return image
        edges = (box["x"], box["y"], box["x"] + box["width"], box["y"] + box["height"])
        return image.crop(tuple(round(edge) for edge in edges))


def main() -> None:
    """Write the picture of a page's top, in few colours."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--height", type=int, default=1250)
    parser.add_argument("--dark", action="store_true")
    arguments = parser.parse_args()
    program = find_browser()
    if program is None:
        raise SystemExit("error: no Chromium found; install it, or name it in the variable CHROMIUM")
    with Browser(program) as browser:
        browser.resize(1200, arguments.height, arguments.dark)
        browser.open(arguments.page)
        browser.settle()
        browser.picture().quantize(256, dither=Image.Dither.NONE).save(arguments.out, optimize=True)


if __name__ == "__main__":
    main()
