# SPDX-License-Identifier: BSD-3-Clause
"""Headless Chromium for the tests of pages: Debian's chromium, without a package of Python."""
import base64
import json
import os
import shutil
import subprocess
import sys


class Browser:
    """Chromium with a pipe of the DevTools protocol: messages of JSON that end with a zero byte."""

    def __init__(self, profile):
        to_browser, self.output = os.pipe()
        self.input, from_browser = os.pipe()

        def place_pipes():
            # The numbers that --remote-debugging-pipe asks for; copies first, so that neither overwrites the other.
            reading, writing = os.dup(to_browser), os.dup(from_browser)
            os.dup2(reading, 3)
            os.dup2(writing, 4)

        self.process = subprocess.Popen(
            ["chromium", "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
             "--disable-extensions", "--disable-background-networking", f"--user-data-dir={profile}",
             "--remote-debugging-pipe", "about:blank"],
            preexec_fn=place_pipes, close_fds=False, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer = b""
        self.count = 0
        self.requests, self.errors = [], []
        self.session = None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(domain + ".enable")

    def receive(self):
        while b"\0" not in self.buffer:
            read = os.read(self.input, 1 << 16)
            if not read:
                raise RuntimeError("chromium ended")
            self.buffer += read
        message, self.buffer = self.buffer.split(b"\0", 1)
        message = json.loads(message)
        method = message.get("method")
        if method == "Network.requestWillBeSent":
            self.requests.append(message["params"]["request"]["url"])
        elif method == "Runtime.exceptionThrown":
            exception = message["params"]["exceptionDetails"].get("exception", {})
            self.errors.append(exception.get("description", "exception"))
        elif method == "Log.entryAdded" and message["params"]["entry"]["level"] == "error":
            self.errors.append(message["params"]["entry"]["text"])
        return message

    def call(self, method, **parameters):
        self.count += 1
        message = {"id": self.count, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.output, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.count:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def open(self, page, script=True, scheme="light", width=1200):
        self.call("Emulation.setScriptExecutionDisabled", value=not script)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        self.call("Page.navigate", url=page.as_uri())
        while self.receive().get("method") != "Page.loadEventFired":
            pass

    def value(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"]["exception"]["description"])
        return result["result"].get("value")

    def mouse(self, kind, place, clicks=1, pressed=False):
        button = {"mouseMoved": "left" if pressed else "none"}.get(kind, "left")
        self.call("Input.dispatchMouseEvent", type=kind, x=place[0], y=place[1], button=button,
                  buttons=1 if pressed or kind == "mousePressed" else 0, clickCount=clicks)

    def picture(self, path, selector="body"):
        clip = self.value(f"""(() => {{
          const box = document.querySelector({json.dumps(selector)}).getBoundingClientRect();
          const height = Math.min(box.height, 4000);
          return {{x: box.x + scrollX, y: box.y + scrollY, width: box.width, height, scale: 1}};
        }})()""")
        data = self.call("Page.captureScreenshot", clip=clip, captureBeyondViewport=True)["data"]
        path.write_bytes(base64.b64decode(data))

    def close(self):
        self.process.terminate()
        self.process.wait()


def check(condition, words):
    if not condition:
        sys.exit("failed: " + words)
    print("passed: " + words)


def need_chromium():
    """Installs it as root where it is missing."""
    if shutil.which("chromium") is None:
        install = ["apt-get", "install", "-y", "--no-install-recommends", "chromium"]
        print("installs: " + " ".join(install), file=sys.stderr)
        if os.geteuid() != 0 or subprocess.run(install, stdout=subprocess.DEVNULL).returncode != 0:
            sys.exit("chromium is needed: apt-get install chromium")
