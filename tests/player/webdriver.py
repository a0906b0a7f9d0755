"""A browser under remote control by the WebDriver protocol (https://www.w3.org/TR/webdriver2/), by the
standard library alone, and the pixels of its screenshots."""

import base64
import json
import shutil
import struct
import subprocess
import sys
import time
import urllib.error
import urllib.request
import zlib

SKIPPED = 77  # the exit code that the tests take for "skipped"


class Picture:
    """A PNG file of 8 bits per channel, without interlacing."""

    def __init__(self, png):
        at, packed = 8, b""
        while at < len(png):
            (size,), kind = struct.unpack(">I", png[at : at + 4]), png[at + 4 : at + 8]
            body = png[at + 8 : at + 8 + size]
            if kind == b"IHDR":
                self.width, self.height, depth, colour = struct.unpack(">IIBB", body[:10])
                assert depth == 8 and colour in (2, 6) and body[12] == 0
                self.channels = 3 if colour == 2 else 4
            elif kind == b"IDAT":
                packed += body
            at += size + 12
        self.rows = list(self._rows(zlib.decompress(packed)))

    def _rows(self, data):
        n, stride = self.channels, self.channels * self.width
        before = bytearray(stride)
        for y in range(self.height):
            kind, row = data[y * (stride + 1)], bytearray(data[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
            if kind == 2:  # as most rows of a quick picture are, and many of these are as the row before
                row = bytearray((a + b) & 255 for a, b in zip(row, before)) if any(row) else before
                kind = 0
            for i in range(stride if kind else 0):
                a, b, c = (row[i - n] if i >= n else 0), before[i], (before[i - n] if i >= n else 0)
                if kind == 4:
                    p = a + b - c
                    a, b, c = sorted(((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c)))[0][2], 0, 0
                row[i] = (row[i] + (0, a, b, (a + b) // 2, a)[kind]) & 255
            yield row
            before = row

    def at(self, x, y):
        i = self.channels * int(x)
        return tuple(self.rows[int(y)][i : i + 3])


class Browser:
    """Chromium without a window."""

    def __init__(self, width, height, phone=False):
        programs = [shutil.which(name) for name in ("chromedriver", "chromium")]
        if not all(programs):
            print("skipped: Chromium is not installed (Debian packages chromium and chromium-driver)")
            sys.exit(SKIPPED)
        self.driver = subprocess.Popen([programs[0], "--port=0"], stdout=subprocess.PIPE, text=True)
        port = None
        for line in self.driver.stdout:
            if "started successfully on port" in line:
                port = line.split("port")[-1].strip(" .\n")
                break
        self.base = f"http://127.0.0.1:{port}"
        arguments = ["--headless", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars",
                     "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        options = {"binary": programs[1], "args": arguments}
        if phone:
            options["mobileEmulation"] = {
                "deviceMetrics": {"width": width, "height": height, "pixelRatio": 2, "touch": True}}
        answer = self._call("POST", "/session", {"capabilities": {"alwaysMatch": {
            "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
        self.base += "/session/" + answer["sessionId"]
        if not phone:
            self.cdp("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self._call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()

    def _call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=300) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def cdp(self, command, **parameters):
        return self._call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def open(self, address):
        self._call("POST", "/url", {"url": "about:blank"})  # a new address of the same page would not load it
        self._call("POST", "/url", {"url": address})

    def evaluate(self, expression):
        return self._call("POST", "/execute/sync", {"script": f"return {expression}", "args": []})

    def wait(self, expression, seconds=120):
        """Until the expression is true."""
        end = time.monotonic() + seconds
        while not self.evaluate(expression):
            if time.monotonic() > end:
                raise TimeoutError(f"{expression} has not become true; the console says {self.console()}")
            time.sleep(0.05)

    def tap(self, x, y):
        self._call("POST", "/actions", {"actions": [{
            "type": "pointer", "id": "mouse", "actions": [
                {"type": "pointerMove", "x": round(x), "y": round(y), "duration": 0},
                {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}]}]})

    def keys(self, text):
        self._call("POST", "/actions", {"actions": [{"type": "key", "id": "keys", "actions": [
            {"type": kind, "value": key} for key in text for kind in ("keyDown", "keyUp")]}]})

    def fingers(self, *steps):
        """Fingers on the screen, where they are step by step: [[(x, y), ...], ...]."""
        for number, points in enumerate(steps):
            self.cdp("Input.dispatchTouchEvent", type="touchMove" if number else "touchStart",
                     touchPoints=[{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)])
        self.cdp("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def picture(self, file=None):
        # A picture that is quick to write is quick to read here, too.
        png = base64.b64decode(self.cdp("Page.captureScreenshot", format="png", optimizeForSpeed=True)["data"])
        if file:
            with open(file, "wb") as stream:
                stream.write(png)
        return Picture(png)

    def console(self):
        """Messages of errors and warnings since the last call."""
        entries = self._call("POST", "/se/log", {"type": "browser"})
        return [e["message"] for e in entries if e["level"] in ("SEVERE", "WARNING")]
