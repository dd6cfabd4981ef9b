from __future__ import annotations

import os
import struct
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
import zlib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from drawn_samples import atlas, chart, curve, picture

from rl_tui.common.errors import UserError
from rl_tui.studies.pictures.files import SCALE, check_renderer, picture_file, png_of, svg_of
from rl_tui.studies.pictures.layout import laid_out
from rl_tui.studies.pictures.shapes import Text

SVG = "{http://www.w3.org/2000/svg}"
SAMPLE = picture(
    chart(curve("ε = 0.1", [1.0, 3.0, 2.0], low=(0.5, 2.0, 1.0), high=(1.5, 4.0, 3.0))),
    atlas([[1.0, 2.0]]),
    notes=("A note.",),
)


def test_an_svg_is_one_sound_document_with_its_words() -> None:
    root = ElementTree.fromstring(svg_of(SAMPLE))
    assert root.attrib["role"] == "img"
    labelled = root.attrib["aria-labelledby"].split()
    words = {each.attrib["id"]: each.text for each in root if "id" in each.attrib}
    assert [words[name] for name in labelled] == ["Of a test", "What is seen."]
    shown = [each.text for each in root.iter(f"{SVG}text")]
    assert {"Of a test", "ε = 0.1", "A note."} <= set(shown)


def test_an_svg_needs_nothing_else() -> None:
    text = svg_of(SAMPLE)
    assert "href" not in text
    assert "<script" not in text
    assert text.count("http") == 1  # the name of the format
    assert "monospace" not in text
    references = {name for name in ("plot-1",) if f'clip-path="url(#{name})"' in text}
    assert references == {each.attrib["id"] for each in ElementTree.fromstring(text).iter(f"{SVG}clipPath")}


@pytest.mark.process
def test_the_same_picture_has_the_same_bytes_in_every_process() -> None:
    code = (
        "import sys; sys.path[:0] = [sys.argv[1]]\n"
        "from drawn_samples import *\n"
        "from rl_tui.studies.pictures.files import svg_of\n"
        "sys.stdout.reconfigure(encoding='utf-8')\n"
        "print(svg_of(picture(chart(curve('a', [1.0, 2.5]), curve('b', [2.0, 0.1], 1)))), end='')"
    )
    command = [sys.executable, "-c", code, str(Path(__file__).parent)]
    made = {
        subprocess.run(
            command, capture_output=True, check=True, env=os.environ | {"PYTHONHASHSEED": seed}
        ).stdout
        for seed in ("1", "2")
    }
    here = svg_of(picture(chart(curve("a", [1.0, 2.5]), curve("b", [2.0, 0.1], 1))))
    assert made == {here.encode()}


@pytest.mark.parametrize("name", ["a < b & c > d", '"quoted"', "bell\x07 and null\x00"])
def test_any_text_can_stand_in_an_svg(name: str) -> None:
    root = ElementTree.fromstring(svg_of(picture(chart(curve(name, [1.0, 2.0])))))
    shown = [each.text or "" for each in root.iter(f"{SVG}text")]
    assert any(each.startswith(name[:4]) for each in shown)


@pytest.fixture
def _renderer() -> None:
    try:
        check_renderer()
    except UserError as error:
        pytest.skip(str(error))


def chunks_of(png: bytes) -> dict[bytes, bytes]:
    chunks: dict[bytes, bytes] = {}
    place = 8
    while place < len(png):
        size, kind = struct.unpack(">I4s", png[place : place + 8])
        chunks[kind] = chunks.get(kind, b"") + png[place + 8 : place + 8 + size]
        place += size + 12
    return chunks


def pixels_of(png: bytes) -> np.ndarray:
    """Return the pixels, [height, width, 4]."""
    chunks = chunks_of(png)
    width, height, depth, kind = struct.unpack(">IIBB", chunks[b"IHDR"][:10])
    assert (depth, kind) == (8, 6)
    data = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, 4 * width + 1)
    rows = data[:, 1:].reshape(height, width, 4).copy()
    above = np.zeros((width, 4), np.uint8)
    for method, row in zip(data[:, 0], rows, strict=True):
        if method == 1:
            row[:] = row.cumsum(axis=0, dtype=np.uint8)
        elif method == 2:
            row += above
        elif method:
            row[:] = unfiltered(int(method), row.ravel().tolist(), above.ravel().tolist())
        above = row
    return rows


def unfiltered(method: int, row: list[int], above: list[int]) -> np.ndarray:
    for place, up in enumerate(above):
        left, corner = (row[place - 4], above[place - 4]) if place >= 4 else (0, 0)
        guess = min((left, up, corner), key=lambda each: abs(left + up - corner - each))
        row[place] = (row[place] + ((left + up) // 2 if method == 3 else guess)) % 256
    return np.array(row, np.uint8).reshape(-1, 4)


@pytest.mark.usefixtures("_renderer")
def test_a_png_has_the_size_of_the_layout() -> None:
    png = png_of(SAMPLE)
    assert png.startswith(b"\x89PNG")
    page = laid_out(SAMPLE)
    width, height = struct.unpack(">II", png[16:24])
    assert width == round(page.width * SCALE)
    assert abs(height - page.height * SCALE) <= 1


@pytest.mark.exhaustive("decodes a picture in Python")
@pytest.mark.usefixtures("_renderer")
def test_a_png_has_the_colours_and_the_texts_of_the_svg() -> None:
    drawn = picture(atlas([[0.0, 10.0]]))
    rows = pixels_of(png_of(drawn))
    seen = set(map(tuple, np.unique(rows[:, :, :3].reshape(-1, 3), axis=0).tolist()))
    assert {(255, 255, 255), (0xFB, 0xF8, 0xD0), (0x1A, 0x34, 0x70)} <= seen
    (title,) = [shape for shape in laid_out(drawn).shapes if isinstance(shape, Text) and shape.y < 60]
    top, bottom = (SCALE * round(title.y - part) for part in (title.size, 0))
    assert (rows[top:bottom, :, :3].sum(axis=2) < 200).any()


@pytest.mark.usefixtures("_renderer")
def test_the_end_of_the_name_says_which_kind(tmp_path: Path) -> None:
    for name, start in (("a.svg", b"<svg"), ("a.PNG", b"\x89PNG")):
        with picture_file(tmp_path / name) as write:
            write(SAMPLE)
        assert (tmp_path / name).read_bytes().startswith(start)


@pytest.mark.parametrize(
    ("renderer", "message"),
    [
        (None, r"rl-tui\[plot\]"),
        (SimpleNamespace(__spec__=object(), svg_to_bytes=lambda **_: b"no text"), "needs a font"),
    ],
)
def test_without_resvg_or_a_font_there_is_no_png_but_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, renderer: object, message: str
) -> None:
    monkeypatch.setitem(sys.modules, "resvg_py", renderer)
    path = tmp_path / "a.png"
    with pytest.raises(UserError, match=message) as raised, picture_file(path):
        raise AssertionError("nothing is done for a picture that cannot be drawn")
    assert "\n" not in str(raised.value)
    assert not path.exists()
    with picture_file(tmp_path / "a.svg") as write:
        write(SAMPLE)


def test_a_folder_that_is_not_there_is_told_before_anything_is_done(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be written"), picture_file(tmp_path / "no" / "a.svg"):
        raise AssertionError
