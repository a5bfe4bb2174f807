# SPDX-License-Identifier: MIT
"""A headless browser through its DevTools protocol, over pipes: no port, no network."""
import base64
import json
import os
import shutil
import subprocess
import tempfile
import time

WAIT_MS = 60000


def find():
    """The path of a browser; None where there is none."""
    return next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


class Browser:
    """One page. `problems` gathers what the console and uncaught exceptions say."""

    def __init__(self, path):
        self.folder = tempfile.mkdtemp(prefix="pursuit-browser-")
        self.problems, self.requests, self.serial, self.session, self.rest = [], [], 0, None, b""
        to_read, self.to = os.pipe()
        self.back, back_write = os.pipe()
        high = (to_read, back_write)
        self.process = subprocess.Popen(
            ["/bin/sh", "-c", f'exec "$0" "$@" 3<&{high[0]} 4>&{high[1]}', path, "--headless=new", "--no-sandbox",
             "--disable-gpu", "--disable-dev-shm-usage", "--disable-background-networking", "--no-first-run",
             "--force-color-profile=srgb", f"--user-data-dir={self.folder}", "--remote-debugging-pipe", "about:blank"],
            pass_fds=high, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            env={**os.environ, "HOME": self.folder})
        os.close(to_read)
        os.close(back_write)
        targets = []
        while not targets:  # it answers before it has a page
            targets = [one["targetId"] for one in self.call("Target.getTargets")["targetInfos"] if one["type"] == "page"]
        self.session = self.call("Target.attachToTarget", targetId=targets[0], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")

    def close(self):
        os.close(self.to)
        self.process.terminate()
        try:
            self.process.wait(WAIT_MS / 1000)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.back)
        shutil.rmtree(self.folder, ignore_errors=True)

    def receive(self):
        while b"\0" not in self.rest:
            more = os.read(self.back, 1 << 20)
            if not more:
                raise RuntimeError("the browser ended")
            self.rest += more
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def note(self, message):
        method, content = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.problems.append(content["exceptionDetails"])
        elif method == "Runtime.consoleAPICalled" and content["type"] in ("error", "warning"):
            self.problems.append(content["args"])
        elif method == "Log.entryAdded" and content["entry"]["level"] in ("error", "warning"):
            self.problems.append(content["entry"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(content["request"]["url"])

    def call(self, method, **parameters):
        self.serial += 1
        request = {"id": self.serial, "method": method, "params": parameters}
        if self.session:
            request["sessionId"] = self.session
        os.write(self.to, json.dumps(request).encode() + b"\0")
        while True:
            message = self.receive()
            if message.get("id") == self.serial:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.note(message)

    def evaluate(self, script):
        """The value of an expression; a promise is waited for."""
        result = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"])
        return result["result"].get("value")

    def wait_for(self, condition):
        """Until an expression is true; its value."""
        return self.evaluate(f"""new Promise((done, fail) => {{
            const end = performance.now() + {WAIT_MS};
            (function look() {{
                const value = ({condition});
                if (value) done(value);
                else if (performance.now() > end) fail('never true: ' + {json.dumps(condition)});
                else setTimeout(look, 20);
            }}());
        }})""")

    def open(self, path):
        """Until all of a page is there; the one before it, perhaps of the same name, still answers for a moment."""
        self.evaluate("window.isLeft = true")
        self.call("Page.navigate", url="file://" + path)
        end = time.monotonic() + WAIT_MS / 1000
        while True:
            try:
                self.wait_for(f"!window.isLeft && document.readyState === 'complete' && "
                              f"location.href === {json.dumps('file://' + path)}")
                return
            except RuntimeError:  # it went while it was asked
                if time.monotonic() > end:
                    raise

    def press(self, key, code=0, shift=False, text=""):
        """A key of the keyboard, by the name that pages know it by."""
        codes = {"Tab": 9, "Enter": 13, " ": 32, "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40,
                 "Home": 36, "End": 35}
        parameters = {"key": key, "code": {" ": "Space"}.get(key, key), "modifiers": 8 if shift else 0,
                      "windowsVirtualKeyCode": codes.get(key, code)}
        text = text or {"Enter": "\r", " ": " "}.get(key, key if len(key) == 1 else "")
        self.call("Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", text=text, **parameters)
        self.call("Input.dispatchKeyEvent", type="keyUp", **parameters)

    def window(self, width, height, dark=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.call("Emulation.setEmulatedMedia",
                  features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self.wait_for(f"innerWidth === {width} && innerHeight === {height}")

    def screenshot(self, path, whole=False):
        data = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))
