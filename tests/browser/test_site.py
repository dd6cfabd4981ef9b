"""The server's answers and its access rules."""

from __future__ import annotations

import asyncio
import json
import re
import sys
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

pytest.importorskip("aiohttp", reason='needs aiohttp: pip install "rl-tui[serve]"')

from aiohttp import ClientWebSocketResponse, WSMsgType, WSServerHandshakeError, web
from aiohttp.test_utils import TestClient, TestServer
from served import DEADLINE, is_running

from rl_tui.commands.serving import app_process
from rl_tui.commands.serving.addresses import Doorkeeper, bind
from rl_tui.commands.serving.site import OF_A_MESSAGE, PAGE, Allowance, Site, serve
from rl_tui.common.limits import LARGEST_SCREEN

Client = TestClient[web.Request, web.Application]

# Sends its process id and size, then every packet it gets, as JSON. It exits at q, fails at x, writes much at
# f, and after h ignores requests to end
APP = """
import json, os, signal, sys
def write(kind, data):
    sys.stdout.buffer.write(kind + len(data).to_bytes(4, "big") + data)
    sys.stdout.buffer.flush()
print("a line before", flush=True)
print("__GANGLION__", flush=True)
keys = ("COLUMNS", "ROWS", "RL_TUI_KIOSK", "TERM", "NO_COLOR")
around = {key: os.environ.get(key) for key in keys}
write(b"D", json.dumps([os.getpid(), around | {"arguments": sys.argv[1:]}]).encode())
while head := sys.stdin.buffer.read(5):
    data = sys.stdin.buffer.read(int.from_bytes(head[1:], "big"))
    if data == b"q":
        write(b"M", b'{"type": "exit"}')
        break
    if data == b"x":
        sys.exit("it \\x1b[31mbroke")
    if data == b"h":
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
    if data == b"f":
        write(b"D", b"." * 1_000_000)
    write(b"D", json.dumps([head[:1].decode(), data.decode()]).encode())
"""


@asynccontextmanager
async def site(*, kiosk: bool = True, most: int = 2, url: str | None = None) -> AsyncIterator[Client]:
    command = [sys.executable, "-S", "-c", APP]
    made = Site(command, Doorkeeper("127.0.0.1", url), PAGE, kiosk=kiosk, most=most)
    async with TestClient(TestServer(made.application())) as client:
        yield client


@asynccontextmanager
async def tab(
    client: Client, query: str = "width=100&height=30", way: str = "/ws"
) -> AsyncIterator[ClientWebSocketResponse]:
    origin = str(client.make_url("/")).rstrip("/")
    async with client.ws_connect(f"{way}?{query}", headers={"Origin": origin}) as socket:
        yield socket


async def said(socket: ClientWebSocketResponse) -> list[object]:
    message = await socket.receive(DEADLINE)
    assert message.type is WSMsgType.BINARY, message
    found = json.loads(message.data)
    assert isinstance(found, list)
    return found


async def end_of(process: object) -> None:
    assert isinstance(process, int)
    async with asyncio.timeout(DEADLINE):
        while is_running(process):
            await asyncio.sleep(0.01)


async def test_the_app_gets_what_the_browser_sends(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    async with site() as client, tab(client) as socket:
        _, around = await said(socket)
        assert around == {
            "COLUMNS": "100",
            "ROWS": "30",
            "RL_TUI_KIOSK": "1",
            "TERM": "xterm-256color",
            "NO_COLOR": None,
            "arguments": [],
        }
        for sent, got in (
            (["stdin", "ä "], ["D", "ä "]),
            (["resize", {"width": 90, "height": 20}], ["M", {"type": "resize", "width": 90, "height": 20}]),
            (["focus"], ["M", {"type": "focus"}]),
        ):
            await socket.send_json(sent)
            kind, data = await said(socket)
            assert [kind, json.loads(str(data)) if kind == "M" else data] == got
        await socket.send_json(["ping", "123"])
        assert await socket.receive_json(timeout=DEADLINE) == ["pong", "123"]


async def test_a_browser_without_the_fonts_gets_ascii() -> None:
    async with site() as client, tab(client, way="/ws/ascii") as socket:
        _, around = await said(socket)
        assert isinstance(around, dict)
        assert around["arguments"] == ["--ascii"]


@pytest.mark.parametrize(
    ("query", "size"),
    [
        ("width=100000&height=99999", LARGEST_SCREEN),
        ("width=0&height=0", (1, 1)),
        ("width=x&height=-5", (80, 24)),
        ("", (80, 24)),
    ],
)
async def test_no_window_is_too_large(query: str, size: tuple[int, int]) -> None:
    async with site() as client, tab(client, query) as socket:
        _, around = await said(socket)
        assert isinstance(around, dict)
        assert (int(around["COLUMNS"]), int(around["ROWS"])) == size
        await socket.send_json(["resize", {"width": 10**12, "height": 10**12}])
        width, height = LARGEST_SCREEN
        _, message = await said(socket)
        assert json.loads(str(message)) == {"type": "resize", "width": width, "height": height}


@pytest.mark.parametrize(
    "message",
    [
        "no JSON",
        "[" * 10_000,
        '["stdin", 5]',
        '["resize", {"width": "5", "height": null}, 3]',
        '["quit"]',
        "{}",
        '["stdin", "' + "a" * 20_000 + '"]',
    ],
    ids=lambda message: message[:12],
)
async def test_what_our_page_never_sends_ends_it(message: str) -> None:
    async with site() as client, tab(client) as socket:
        process, _ = await said(socket)
        await socket.send_str(message)
        assert (await socket.receive(DEADLINE)).type in (WSMsgType.CLOSE, WSMsgType.CLOSED)
        await end_of(process)


async def test_the_page_is_told_why_it_ended() -> None:
    async with site(most=1) as client:
        for key, reason in (("q", "You left rl-tui."), ("x", "it [31mbroke")):
            async with tab(client) as socket:
                await said(socket)
                await socket.send_json(["stdin", key])
                message = await socket.receive(DEADLINE)
                assert (message.type, message.extra) == (WSMsgType.CLOSE, reason)


async def test_a_flood_of_keys_is_slowed_down() -> None:
    allowance = Allowance(per_second=1_000, at_once=500)
    started = time.perf_counter()
    for _ in range(10):
        await allowance.spend(50 - OF_A_MESSAGE)  # nothing waits
    for _ in range(10):
        await allowance.spend(10 - OF_A_MESSAGE)
    assert time.perf_counter() - started >= 0.09


async def test_an_app_that_floods_a_closed_tab_ends() -> None:
    async with site() as client:
        async with tab(client) as socket:
            process, _ = await said(socket)
            for _ in range(3):
                await socket.send_json(["stdin", "f"])
        await end_of(process)


async def test_an_app_that_does_not_listen_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app_process, "TO_END_WHEN_TOLD", 0.05)
    async with site() as client:
        async with tab(client) as socket:
            process, _ = await said(socket)
            await socket.send_json(["stdin", "h"])
            await said(socket)
        await end_of(process)


async def test_every_place_can_be_taken_once() -> None:
    async with site(most=1) as client:
        async with tab(client) as socket:
            process, _ = await said(socket)
            page = await client.get("/")
            assert page.status == 503
            assert "Every place is taken: 1 at once" in await page.text()
            async with tab(client) as second:
                message = await second.receive(DEADLINE)
                assert message.type is WSMsgType.CLOSE
                assert str(message.extra).startswith("Every place is taken")
        await end_of(process)
        async with asyncio.timeout(DEADLINE):
            while (await client.get("/")).status != 200:
                await asyncio.sleep(0.01)


async def test_only_its_own_page_may_use_it() -> None:
    async with site(url="https://lab.example.org/rl/") as client:
        port = client.port
        for origin, host, lets_in in (
            (f"http://127.0.0.1:{port}", f"127.0.0.1:{port}", True),
            ("https://lab.example.org", f"127.0.0.1:{port}", True),
            ("https://lab.example.org", "lab.example.org", True),
            ("http://lab.example.org", f"127.0.0.1:{port}", False),
            (f"http://localhost:{port}", f"127.0.0.1:{port}", False),
            ("http://127.0.0.1:1", f"127.0.0.1:{port}", False),
            ("https://evil.example", f"127.0.0.1:{port}", False),
            (f"http://evil.example:{port}", f"evil.example:{port}", False),
            ("null", f"127.0.0.1:{port}", False),
            ("", f"127.0.0.1:{port}", False),
        ):
            headers = {"Host": host, **({"Origin": origin} if origin else {})}
            if lets_in:
                async with client.ws_connect("/ws", headers=headers) as socket:
                    await said(socket)
                    await socket.send_json(["stdin", "q"])
                    await socket.receive(DEADLINE)
            else:
                with pytest.raises(WSServerHandshakeError) as refused:
                    await client.ws_connect("/ws", headers=headers)
                assert refused.value.status == 403


@pytest.mark.parametrize(
    ("host", "url", "asked_for", "known"),
    [
        ("127.0.0.1", None, "localhost:9000", True),
        ("127.0.0.1", None, "[::1]:8000", True),
        ("127.0.0.1", None, "evil.example:8000", False),
        ("127.0.0.1", None, "", False),
        ("127.0.0.1", None, "[", False),
        ("127.0.0.1", "https://lab.example.org:8443", "lab.example.org", True),
        ("0.0.0.0", None, "192.168.1.5:8000", True),
        ("0.0.0.0", None, "evil.example:8000", False),
    ],
)
def test_it_answers_to_its_own_names(host: str, url: str | None, asked_for: str, known: bool) -> None:
    assert Doorkeeper(host, url).knows(asked_for) is known


async def test_the_page_needs_nobody_else() -> None:
    async with site() as client:
        page = await client.get("/")
        assert "default-src 'none'" in page.headers["Content-Security-Policy"]
        assert "frame-ancestors 'none'" in page.headers["Content-Security-Policy"]
        assert (await client.get("/", headers={"Host": "evil.example"})).status == 403
        assert (await client.get("/page/../site.py")).status == 404
        assert (await client.get("/page/")).status == 403
    for file in Path(PAGE).iterdir():
        assert not re.search(r"(https?:)?//(?!\s)[\w.]+\.\w+/", file.read_text(encoding="utf-8")), file


@pytest.mark.parametrize(
    "request_",
    [
        b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\nContent-Length: 5\r\n\r\n0\r\n\r\n",
        b"GET / HTTP/1.1\r\nContent-Length: -5\r\n\r\n",
        b"\x00\x01\r\n\r\n",
        b"GET / HTTP/1.1\r\nA" + b"x" * 20_000 + b": 1\r\n\r\n",
    ],
)
async def test_a_request_that_is_none_is_answered_without_a_word(
    request_: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    made = Site(["true"], Doorkeeper("127.0.0.1"), PAGE, kiosk=True, most=1)
    started = asyncio.Event()
    with bind("127.0.0.1", 0) as bound:
        serving = asyncio.create_task(serve(made, bound, started.set))
        await asyncio.wait_for(started.wait(), DEADLINE)
        reader, writer = await asyncio.open_connection(*bound.getsockname())
        writer.write(request_)
        answer = await asyncio.wait_for(reader.read(), DEADLINE)
        writer.close()
        serving.cancel()
        await asyncio.wait([serving])
    assert answer.split()[1] == b"400"
    assert caplog.records == []
