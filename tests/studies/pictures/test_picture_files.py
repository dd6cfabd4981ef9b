from __future__ import annotations

import os
import struct
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from drawn_samples import atlas, chart, curve, picture

from rl_tui.common.errors import UserError
from rl_tui.studies.pictures.files import SCALE, picture_file, png_of, svg_of
from rl_tui.studies.pictures.layout import laid_out

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


@pytest.mark.process  # Matplotlib starts another process for the fonts, the first time
def test_a_png_has_the_size_of_the_layout() -> None:
    png = png_of(SAMPLE)
    assert png.startswith(b"\x89PNG")
    page = laid_out(SAMPLE)
    width, height = struct.unpack(">II", png[16:24])
    assert width == round(page.width * SCALE)
    assert abs(height - page.height * SCALE) <= 1
    assert b"Of a test" in png


@pytest.mark.process  # Matplotlib starts another process for the fonts, the first time
def test_a_png_has_the_colours_of_the_shapes(tmp_path: Path) -> None:
    from matplotlib.image import imread

    path = tmp_path / "x.png"
    path.write_bytes(png_of(picture(atlas([[0.0, 10.0]]))))
    pixels = imread(path)
    seen = {tuple(round(float(part) * 255) for part in pixel[:3]) for pixel in pixels.reshape(-1, 4)[::7]}
    assert {(255, 255, 255), (0xFB, 0xF8, 0xD0), (0x1A, 0x34, 0x70)} <= seen


@pytest.mark.process  # Matplotlib starts another process for the fonts, the first time
def test_dollars_are_no_mathematics() -> None:
    assert png_of(picture(chart(curve("$x_", [1.0, 2.0])))).startswith(b"\x89PNG")


@pytest.mark.process  # Matplotlib starts another process for the fonts, the first time
def test_the_end_of_the_name_says_which_kind(tmp_path: Path) -> None:
    for name, start in (("a.svg", b"<svg"), ("a.PNG", b"\x89PNG")):
        with picture_file(tmp_path / name) as write:
            write(SAMPLE)
        assert (tmp_path / name).read_bytes().startswith(start)


def test_without_matplotlib_there_is_no_png_but_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    path = tmp_path / "a.png"
    with pytest.raises(UserError, match=r"rl-tui\[plot\]"), picture_file(path):
        raise AssertionError("nothing is done for a picture that cannot be drawn")
    assert not path.exists()
    with picture_file(tmp_path / "a.svg") as write:
        write(SAMPLE)


def test_a_folder_that_is_not_there_is_told_before_anything_is_done(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be written"), picture_file(tmp_path / "no" / "a.svg"):
        raise AssertionError
