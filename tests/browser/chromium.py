"""A real headless Chromium, driven over the DevTools protocol."""

from __future__ import annotations

import asyncio
import base64
import itertools
import json
import os
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any, Final

import aiohttp
from emulator import Emulator

BINARY: Final = 2  # the kind of a WebSocket's frame
DEADLINE: Final = 120.0  # seconds until an event: only a broken program takes longer
_FLAGS: Final = (
    "--headless=new --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking"
    " --disable-component-update --disable-sync --disable-dev-shm-usage --hide-scrollbars"
    " --remote-debugging-port=0"
)


def chromium() -> str | None:
    return next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


class Chromium:
    """Starts the browser with a new profile in ``folder``. Use it as an async context."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        # The profile holds a socket. Its path has at most 107 bytes, and a folder for tests may be longer
        self._short = TemporaryDirectory(prefix="rl-tui-", dir="/tmp", ignore_cleanup_errors=True)
        self._errors = (folder.parent / "chromium.log").open("wb")
        program = chromium()
        assert program is not None
        self._process = subprocess.Popen(
            [program, *_FLAGS.split(), f"--user-data-dir={folder}", "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=self._errors,
            env=os.environ | {"TMPDIR": self._short.name},
            start_new_session=True,
        )
        self._numbers = itertools.count(1)
        self._answers: dict[int, asyncio.Future[dict[str, Any]]] = {}
        self._tabs: dict[str, Tab] = {}

    async def __aenter__(self) -> Chromium:
        place = self._folder / "DevToolsActivePort"
        self._http = aiohttp.ClientSession()
        try:
            await until(lambda: place.exists() and place.read_text().count("\n") == 1, "Chromium to start")
            port, path = place.read_text().split("\n")
            self._socket = await self._http.ws_connect(f"ws://127.0.0.1:{port}{path}", max_msg_size=0)
        except BaseException:
            await self._end()
            raise
        self._reading = asyncio.create_task(self._read())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            await self.send("Browser.close")
            await asyncio.to_thread(self._process.wait, DEADLINE)
        finally:
            self._reading.cancel()
            await self._end()

    async def _end(self) -> None:
        if self._process.poll() is None:
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)  # with all its child processes
        self._process.wait()
        self._errors.close()
        self._short.cleanup()
        await self._http.close()

    async def send(self, method: str, session: str | None = None, **parameters: Any) -> dict[str, Any]:
        number = next(self._numbers)
        answer = self._answers[number] = asyncio.get_running_loop().create_future()
        message = {"id": number, "method": method, "params": parameters}
        await self._socket.send_json(message if session is None else {**message, "sessionId": session})
        return await asyncio.wait_for(answer, DEADLINE)

    async def open(self, url: str, size: tuple[int, int]) -> Tab:
        target = (await self.send("Target.createTarget", url="about:blank", newWindow=True))["targetId"]
        attached = await self.send("Target.attachToTarget", targetId=target, flatten=True)
        tab = self._tabs[attached["sessionId"]] = Tab(self, target, attached["sessionId"])
        for domain in ("Page", "Network", "Runtime", "Log"):
            await tab.send(f"{domain}.enable")
        await tab.resize(size)
        await tab.send("Page.navigate", url=url)
        return tab

    async def _read(self) -> None:
        async for message in self._socket:
            content = json.loads(message.data)
            if "id" in content:
                answer = self._answers.pop(content["id"])
                if answer.done():  # nothing waits for it any more
                    continue
                if "error" in content:
                    answer.set_exception(RuntimeError(content["error"]["message"]))
                else:
                    answer.set_result(content["result"])
            elif content.get("sessionId") in self._tabs:
                self._tabs[content["sessionId"]].happened(content["method"], content["params"])


class Tab:
    def __init__(self, browser: Chromium, target: str, session: str) -> None:
        self._browser = browser
        self._target = target
        self._session = session
        self.emulator = Emulator(80, 24)
        self.asked_for: list[str] = []
        self.faults: list[str] = []

    def happened(self, method: str, parameters: dict[str, Any]) -> None:
        match method:
            case "Network.webSocketFrameReceived" if parameters["response"]["opcode"] == BINARY:
                self.emulator.feed(base64.b64decode(parameters["response"]["payloadData"]))
            case "Network.webSocketFrameSent":
                match json.loads(parameters["response"]["payloadData"]):
                    case ["resize", size]:
                        self.emulator.resize(size["height"], size["width"])
            case "Network.requestWillBeSent":
                self.asked_for.append(parameters["request"]["url"])
            case "Network.webSocketCreated":
                self.asked_for.append(parameters["url"])
                self.emulator = Emulator(80, 24)  # the page sends its size as soon as it is connected
            case "Runtime.exceptionThrown":
                self.faults.append(json.dumps(parameters["exceptionDetails"]))
            case "Log.entryAdded" if parameters["entry"]["level"] == "error":
                self.faults.append(parameters["entry"]["text"])

    async def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        return await self._browser.send(method, self._session, **parameters)

    async def resize(self, size: tuple[int, int]) -> None:
        await self.send(
            "Emulation.setDeviceMetricsOverride",
            width=size[0],
            height=size[1],
            deviceScaleFactor=1,
            mobile=False,
        )

    async def press(self, keys: str) -> None:
        for key in keys:
            for kind in ("keyDown", "keyUp"):
                text = {"text": key} if kind == "keyDown" else {}
                await self.send("Input.dispatchKeyEvent", type=kind, key=key, **text)

    async def click(self, x: float, y: float) -> None:
        for kind in ("mousePressed", "mouseReleased"):
            await self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    async def wait_for(self, pattern: str) -> None:
        def found() -> object:
            return self.emulator.is_whole and re.search(pattern, self.emulator.text)

        await until(found, repr(pattern), lambda: self.emulator.text)

    async def evaluate(self, expression: str) -> Any:
        answer = await self.send(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    async def shows(self, expression: str) -> None:
        deadline = time.perf_counter() + DEADLINE
        while not await self._is_true(expression):
            assert time.perf_counter() < deadline, f"never true: {expression}"
            await asyncio.sleep(0.02)

    async def _is_true(self, expression: str) -> bool:
        try:
            return bool(await self.evaluate(expression))
        except RuntimeError:  # another page is just being opened
            return False

    async def screenshot(self) -> bytes:
        return base64.b64decode((await self.send("Page.captureScreenshot", format="png"))["data"])

    async def cell(self) -> tuple[float, float]:
        box = "document.querySelector('.xterm-screen').getBoundingClientRect()"
        width, height = await self.evaluate(f"[{box}.width, {box}.height]")
        return width / self.emulator.columns, height / self.emulator.lines

    async def colours(self, png: bytes, points: list[tuple[float, float]]) -> list[str]:
        """Return the colours of ``png`` at ``points`` (pixels), six hexadecimal digits each."""
        expression = f"""(async () => {{
            const bytes = Uint8Array.from(atob("{base64.b64encode(png).decode()}"), (c) => c.charCodeAt(0));
            const image = await createImageBitmap(new Blob([bytes], {{type: "image/png"}}));
            const canvas = new OffscreenCanvas(image.width, image.height);
            const context = canvas.getContext("2d", {{willReadFrequently: true}});
            context.drawImage(image, 0, 0);
            return {json.dumps(points)}.map(([x, y]) =>
                [...context.getImageData(x, y, 1, 1).data.slice(0, 3)]
                    .map((part) => part.toString(16).padStart(2, "0")).join(""));
        }})()"""
        found: list[str] = await self.evaluate(expression)
        return found

    async def close(self) -> None:
        await self._browser.send("Target.closeTarget", targetId=self._target)


async def until(condition: Callable[[], object], what: str, seen: Callable[[], str] = str) -> None:
    deadline = time.perf_counter() + DEADLINE
    while not condition():
        assert time.perf_counter() < deadline, f"waited in vain for {what}; {seen()}"
        await asyncio.sleep(0.02)
