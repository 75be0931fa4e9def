"""Headless Chromium over its debugging pipe: opens a page, moves the mouse, presses keys, asks it in JavaScript, takes pictures.

With a page it takes pictures of it:  browser.py PAGE OUT [WIDTH...]  writes OUT-WIDTH.png (1400 and 390)."""
import base64
import json
import os
import pathlib
import select
import shutil
import subprocess
import sys
import tempfile
import time

FLAGS = ("--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking --disable-component-update --disable-sync "
         "--hide-scrollbars --remote-debugging-pipe").split()


def program():
    return shutil.which("chromium") or shutil.which("chromium-browser")


class Browser:
    """One page; `errors` are the messages of its scripts, `requests` the addresses that it asked for."""

    def __enter__(self):
        self.home = tempfile.mkdtemp()
        theirs, self.to = os.pipe()
        self.back, answers = os.pipe()

        def plumb():  # Chromium reads from descriptor 3 and writes to 4
            ends = os.dup(theirs), os.dup(answers)
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.process = subprocess.Popen([program(), *FLAGS, f"--user-data-dir={self.home}"], preexec_fn=plumb, close_fds=False,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(theirs)
        os.close(answers)
        self.number, self.rest, self.events, self.session = 0, b"", [], None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network"):
            self.call(f"{domain}.enable")
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(30)
        os.close(self.to)
        os.close(self.back)
        shutil.rmtree(self.home, ignore_errors=True)

    def message(self, seconds=60):
        while b"\0" not in self.rest:
            if not select.select([self.back], [], [], seconds)[0]:
                raise TimeoutError("Chromium does not answer")
            got = os.read(self.back, 1 << 20)
            if not got:
                raise EOFError("Chromium has ended")
            self.rest += got
        one, self.rest = self.rest.split(b"\0", 1)
        return json.loads(one)

    def call(self, method, **words):
        self.number += 1
        order = {"id": self.number, "method": method, "params": words} | ({"sessionId": self.session} if self.session else {})
        text = json.dumps(order).encode() + b"\0"
        while text:
            text = text[os.write(self.to, text):]
        while True:
            message = self.message()
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.events.append(message)

    def ask(self, script):
        """The value of an expression in the page."""
        found = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in found:
            raise RuntimeError(found["exceptionDetails"].get("exception", {}).get("description", str(found)))
        return found["result"].get("value")

    def until(self, script, seconds=20):
        """Waits for an expression to be true; returns its value."""
        end = time.monotonic() + seconds
        while not (value := self.ask(script)):
            if time.monotonic() > end:
                raise TimeoutError(f"never true: {script}")
            time.sleep(0.05)
        return value

    def open(self, file, width, height=900):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.events.clear()
        self.call("Page.navigate", url=pathlib.Path(file).resolve().as_uri())
        while not any(e.get("method") == "Page.loadEventFired" for e in self.events):
            self.events.append(self.message())

    def mouse(self, kind, x, y, buttons=0, count=0):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left" if kind != "mouseMoved" or buttons else "none", buttons=buttons, clickCount=count)

    def drag(self, start, end):
        self.mouse("mousePressed", *start, 1, 1)
        for part in (0.3, 0.6, 1):
            self.mouse("mouseMoved", *(a + part * (b - a) for a, b in zip(start, end)), 1)
        self.mouse("mouseReleased", *end, 0, 1)

    def key(self, name, text=""):
        self.call("Input.dispatchKeyEvent", type="keyDown", key=name, **({"text": text} if text else {}))
        self.call("Input.dispatchKeyEvent", type="keyUp", key=name)

    @property
    def errors(self):
        return [json.dumps(e["params"])[:600] for e in self.events if e.get("method") == "Runtime.exceptionThrown"
                or e.get("method") == "Runtime.consoleAPICalled" and e["params"]["type"] == "error"]

    @property
    def requests(self):
        return [e["params"]["request"]["url"][:100] for e in self.events if e.get("method") == "Network.requestWillBeSent"]

    def picture(self, file):
        """The whole page, as high as it is."""
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        clip = {"x": 0, "y": 0, "width": size["width"], "height": min(size["height"], 16000), "scale": 1}
        pathlib.Path(file).write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip=clip)["data"]))


def main(page, out, *widths):
    with Browser() as browser:
        for width in map(int, widths or (1400, 390)):
            browser.open(page, width)
            browser.call("Emulation.setDeviceMetricsOverride", width=width, height=browser.ask("document.documentElement.scrollHeight"), deviceScaleFactor=1, mobile=False)
            time.sleep(1)  # charts are made when they come into sight
            browser.picture(f"{out}-{width}.png")
            print(f"{out}-{width}.png", *browser.errors)


if __name__ == "__main__":
    main(*sys.argv[1:])
