"""Measures how the texts of this project read: ``python tests/prose.py``.

Without an option it prints a row for each kind of text and each package. ``--check`` fails where a figure is
above the one in ``prose.json``, or a text is longer than its shape allows. ``--keep`` writes today's figures
there. ``--list PHRASE`` and ``--worst N`` find the places. The figures are a compass, not a grade: a text can
pass them all and still be hard to read.
"""

from __future__ import annotations

import argparse
import ast
import io
import json
import re
import sys
import tokenize
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parent.parent
KEPT: Final = Path(__file__).with_name("prose.json")
ONLY_FALL: Final = ("dialect", "long", "semicolons", "relative")
TOLERANCE: Final = 0.2  # percentage points: a share moves a little whenever a good text goes
LIMITS: Final = {
    "key label": 2,
    "key help": 10,
    "panel caption": 5,
    "panel help": 60,
    "toast": 12,
    "lesson page": 90,
    "lesson explanation": 60,
    "glossary term": 50,
}  # the most words of each shape

PHRASES: Final = {
    "in force": r"\bin force\b",
    "stands": r"\b(?:stands|stood|stand)\b(?! for\b| still\b| on a cart)",
    "told": r"\b(?:is|are|was|were|be|been|it) told\b|\btold (?:apart|from|that|the|by|in|once|when)\b",
    "tell from": r"\b(?:tells?|told) (?:\w+ ){0,3}from\b|\bcannot be told\b|\bcan tell\b",
    "says so": r"\btells? of\b|\bsays? (?:so|it|which)\b|\bis said\b",
    "comes to": r"\b(?:comes?|came|come) (?:to|of|upon|out as)\b",
    "best for this γ": r"\bbest for (?:this|the) γ|γ-best",
    "kept back": r"\b(?:kept|keeps?) back\b|\bgiven away\b",
    "nobody": r"\b(?:whoever|nobody|somebody|everybody|anybody|someone who)\b",
    "be it": r"\bbe (?:it|they)\b",
    "is no": r"(?<!there )\b(?:is|are|was|were) (?:no|none)\b(?! longer| more than| less than)",
    "is that of": r"\b(?:is|are) (?:that|those|such|one) (?:of (?:the|a|an|its|his)|in which|who|that has)\b",
    "goes by": r"\bgo(?:es)? by\b|\blaid to\b|\bh[eo]ld against\b",
    "of it is": r"\bof (?:it|them|which|whom|these) (?:is|are|has|have|only|one)\b",
    "of a": r"(?:^|[.;:(] ?)Of (?:a|an|the) [^.:,;]{1,30}[:,]",
    "by itself": r"\b(?:kept?|keeps?|found|ended|ends?|saves?|learned|goes|gone) (?:\w+ )?by (?:it|them)sel",
    "as it is": r"\bas (?:it|they) (?:is|are|was|were|stands?)\b",
    "so many": r"\bso (?:many|often|long|far|much|few) (?!that|as\b)",
    "alike": r"\b(?:alike|alone)\b",
    "be had": r"\bbe (?:had|mended|taken for|talked|met|seen|heard)\b|\bmend(?:s|ed)?\b",
    "beside": r"\bbesides\b|\b(?:stands?|put|have|runs?|one) beside\b|\b(?:thereby|therein)\b",
    "the one that": r"\b(?:the|that) one (?:that|which|who|of)\b|\bthat of (?:the|a|an)\b",
    "who": r"(?:^|[.;:,] )who (?!is responsible)\w+",
    "the house": r"\b(?:the house|rooms|storeys?|caretaker|which room)\b",
    "worth": r"\bwhat (?:it|they|\w+ (?:is|are)) worth\b|\bworth saying\b",
    "so that nobody": r"\bso that (?:nobody|no one|none|it is)\b",
    "where there is none": r"\bwhere (?:there is|it has|that has|one has) (?:room|none|no)\b",
}  # what a native writer would hardly write
DIALECT: Final = {name: re.compile(pattern, re.IGNORECASE) for name, pattern in PHRASES.items()}
RELATIVE: Final = re.compile(
    r"^(?:What|Who|Whoever|Whatever|Where|Whose|Whether|That which|Which|One that|Those that|How"
    r"|Of (?:a|an|the|two|three))\b(?!.*\?\s*$)",
    re.IGNORECASE,
)  # a sentence that begins with a clause in place of a noun, questions aside
REMEDY: Final = re.compile(
    r"; (?=(?:add|choose|close|compare|correct|create|declare|end|expected|fill|fix|free|give|install|keep"
    r"|leave (?:it )?out|list|make|name|open|raise|remove|rename|repeat|run|save|separate|set|simulate|start"
    r"|take|type|unset|update|use|vary|write)\b)"
)  # in an error, between what is wrong and how to fix it
WORD: Final = re.compile(r"[A-Za-zÀ-ÿα-ωΑ-Ω][A-Za-zÀ-ÿα-ωΑ-Ω'’-]*")
SENTENCE_END: Final = re.compile(
    r"(?<=[.!?])[\"')\]]*\s+(?=[A-Z\"'(`*◉◆▸≠~])|\n\s*\n|\n +(?=\w+: )|(?:Args|Returns|Raises|Yields):\n"
)  # the items of a docstring's lists are sentences too
NOT_PROSE: Final = re.compile(
    r"^\s*(?:SELECT|INSERT|CREATE|PRAGMA|BEGIN|UPDATE|DELETE)\b|^[#.&][\w-]+ ?\{|:\s*1fr;|\bon #|\bon color\("
    r"|^bold|^dim |width: |import \w+|<svg|</|px\b|^(?:bright_|black on|white on)|^move\('"
)
CODE_IN_DATA: Final = {"equation", "by", "measure", "id", "scenario", "setup", "name"}
IS_FOR_TOOLS: Final = re.compile(r"#\s*(?:noqa|type:|pragma|!|-\*-|mypy|fmt)")
BLOCK: Final = re.compile(r"\s*(?:[*-]|\d+\.|#+) ")  # begins a list item or a heading


@dataclass(frozen=True)
class Text:
    path: Path
    line: int
    kind: str
    text: str

    @property
    def package(self) -> str:
        return "/".join(self.path.parts[:2] if self.path.parts[0] == "rl_tui" else self.path.parts[:1])

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.kind}: {' '.join(self.text.split())[:200]}"


def plain(text: str) -> str:
    """Return ``text`` without markup; each piece of code counts as one word."""
    text = re.sub(r"`+[^`]*`+", "it", text)
    return re.sub(r"[*_]{1,2}", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)).strip()


def is_prose(text: str) -> bool:
    if NOT_PROSE.search(text) or len(WORD.findall(text)) < 2:
        return False
    return sum(each.isalpha() or each.isspace() for each in text) > 0.6 * len(text)


def texts() -> Iterator[Text]:
    for path in (*ROOT.glob("*.md"), *sorted(ROOT.glob("docs/**/*.md"))):
        yield from markdown(path)
    for pattern in ("lessons/*.toml", "scenarios/*.toml", "rl_tui/**/*.toml"):
        for path in sorted(ROOT.glob(pattern)):
            yield from data(path)
    for path in sorted(ROOT.glob("rl_tui/**/*.py")):
        yield from python(path)
    for path in sorted(ROOT.glob("tests/**/*.py")):
        if "scripts" not in path.parts:  # written as other people write, some wrong on purpose
            yield from (each for each in python(path) if each.kind != "said")


def markdown(path: Path) -> Iterator[Text]:
    paragraph: list[str] = []
    start, in_code, name = 0, False, path.relative_to(ROOT)
    for number, line in enumerate([*path.read_text(encoding="utf-8").splitlines(), ""], 1):
        in_code ^= line.startswith("```")
        is_skipped = in_code or line.startswith(("    ", "```", "|", "<!--", "!["))
        if paragraph and (is_skipped or not line.strip() or BLOCK.match(line)):
            yield Text(name, start, "docs", " ".join(paragraph))
            paragraph = []
        if line.strip() and not is_skipped:
            start = start if paragraph else number
            paragraph.append(BLOCK.sub("", line, count=1).strip())
        elif line.startswith("|") and not in_code:
            for cell in line.strip("| ").split(" | "):
                if len(WORD.findall(cell)) > 5:
                    yield Text(name, number, "docs", cell)


def data(path: Path) -> Iterator[Text]:
    source = path.read_text(encoding="utf-8")

    def pieces(value: object, key: str) -> Iterator[Text]:
        if isinstance(value, dict):
            for inner, part in value.items():
                yield from pieces(part, inner)
        elif isinstance(value, list):
            for part in value:
                yield from pieces(part, key)
        elif isinstance(value, str) and key not in CODE_IN_DATA and is_prose(value):
            line = line_of(value.strip().splitlines()[0][:40], source)
            for piece in re.split(r"\n\s*\n", value):
                if is_prose(piece) and not piece.lstrip("\n").startswith("    "):
                    yield Text(path.relative_to(ROOT), line, "data", " ".join(piece.split()))

    yield from pieces(tomllib.loads(source), "")


def python(path: Path) -> Iterator[Text]:
    source, name = path.read_text(encoding="utf-8"), path.relative_to(ROOT)
    seen = set[ast.AST]()  # a parent comes before its parts
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Expr) and (text := written(node.value)) is not None:
            seen.update(ast.walk(node.value))
            yield Text(name, node.lineno, "docstring", text)
        elif node not in seen and (text := written(node)) is not None:
            seen.update(ast.walk(node))
            if is_prose(text):
                yield Text(name, getattr(node, "lineno", 0), "said", text)
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT and not IS_FOR_TOOLS.match(token.string):
            yield Text(name, token.start[0], "comment", token.string.lstrip("# "))


def written(node: ast.AST | None) -> str | None:
    """Return the string that ``node`` writes, with X for each value, or None."""
    if isinstance(node, ast.JoinedStr):
        return "".join(str(part.value) if isinstance(part, ast.Constant) else "X" for part in node.values)
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else None


def line_of(text: str, source: str) -> int:
    return source.count("\n", 0, max(source.find(text), 0)) + 1


def shapes() -> Iterator[Text]:
    from rl_tui.screen.keys.registry import ACTIONS
    from rl_tui.screen.panels.catalogue import PANELS

    keys, panels = Path("rl_tui/screen/keys"), Path("rl_tui/screen/panels/catalogue.py")
    for action in ACTIONS:
        yield Text(keys, 0, "key label", action.label)
        yield Text(keys, 0, "key help", action.help)
    for panel in PANELS:
        yield Text(panels, 0, "panel caption", panel.caption)
        yield Text(panels, 0, "panel help", panel.help)
    for path in sorted(ROOT.glob("rl_tui/screen/**/*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and re.search(r"\b(?:tell|notify|say)$", ast.unparse(node.func)):
                text = written(node.args[0] if node.args else None) or ""
                yield Text(path.relative_to(ROOT), node.lineno, "toast", text)
    for path in sorted(ROOT.glob("lessons/*.toml")):
        source, name = path.read_text(encoding="utf-8"), path.relative_to(ROOT)
        for page in tomllib.loads(source)["pages"]:
            line = line_of(f'id = "{page["id"]}"', source)
            yield Text(name, line, "lesson page", plain(page.get("text", "")))
            yield Text(name, line, "lesson explanation", plain(page.get("explanation", "")))
    path = ROOT / "rl_tui/screen/glossary/glossary.toml"
    source = path.read_text(encoding="utf-8")
    for term in tomllib.loads(source)["term"]:
        line = line_of(f'id = "{term["id"]}"', source)
        yield Text(path.relative_to(ROOT), line, "glossary term", plain(term["text"]))


def too_long() -> list[Text]:
    return [each for each in shapes() if len(WORD.findall(each.text)) > LIMITS[each.kind]]


def hits(text: str) -> Counter[str]:
    words = plain(text)
    found = {name: len(pattern.findall(words)) for name, pattern in DIALECT.items()}
    return Counter({name: count for name, count in found.items() if count})


def semicolons(text: Text) -> int:
    words = plain(text.text)
    return (REMEDY.sub(" ", words, count=1) if text.kind == "said" else words).count(";")


def measure(found: Sequence[Text]) -> dict[str, float]:
    sentences = [each for text in found for each in SENTENCE_END.split(plain(text.text)) if WORD.search(each)]
    lengths = [len(WORD.findall(each)) for each in sentences]
    share = 100 / max(len(sentences), 1)
    return {
        "texts": len(found),
        "words": sum(lengths),
        "dialect": sum(sum(hits(text.text).values()) for text in found),
        "long": round(share * sum(length > 25 for length in lengths), 1),
        "semicolons": round(share * sum(map(semicolons, found)), 1),
        "relative": round(share * sum(bool(RELATIVE.match(each)) for each in sentences), 1),
    }


def table(found: Sequence[Text]) -> dict[str, dict[str, float]]:
    rows = defaultdict[str, list[Text]](list)
    for each in found:
        rows[f"{each.kind} all"].append(each)
        rows[f"{each.kind} {each.package}"].append(each)
    return {name: measure(rows[name]) for name in sorted(rows)}


def worse(
    rows: dict[str, dict[str, float]], long_texts: Sequence[Text], kept: dict[str, dict[str, float]]
) -> list[str]:
    lines = []
    for name, limits in kept.items():
        for figure, limit in limits.items():
            slack = 0 if figure == "dialect" else TOLERANCE
            if (now := rows.get(name, {}).get(figure, 0)) > limit + slack:
                lines.append(
                    f"{name}: {figure} is {now}, at most {limit}; see --worst 20 --only {name.split()[0]}"
                )
    lines += [f"{name}: no figures are kept; run tests/prose.py --keep" for name in rows if name not in kept]
    return lines + [f"more than {LIMITS[each.kind]} words: {each}" for each in long_texts]


def weight(text: Text) -> float:
    return (sum(hits(text.text).values()) + semicolons(text)) / max(len(WORD.findall(text.text)), 12) ** 0.5


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--check", action="store_true", help="fail where a figure rose or a text is too long")
    parser.add_argument("--keep", action="store_true", help="keep today's figures as the limit")
    parser.add_argument(
        "--list", metavar="PHRASE", help="print every place of a phrase, or of a regular expression"
    )
    parser.add_argument("--worst", metavar="N", type=int, help="print the texts that most need rewriting")
    parser.add_argument(
        "--only", metavar="WORD", default="", help="only texts of this kind or below this path"
    )
    arguments = parser.parse_args()
    found = [
        each for each in texts() if each.kind == arguments.only or str(each.path).startswith(arguments.only)
    ]
    if arguments.list:
        pattern = DIALECT.get(arguments.list) or re.compile(arguments.list, re.IGNORECASE)
        print(*(each for each in found if pattern.search(plain(each.text))), sep="\n")
    elif arguments.worst:
        for each in sorted(found, key=weight, reverse=True)[: arguments.worst]:
            print(each, *hits(each.text), sep="\n    ")
    elif arguments.keep:
        kept = {name: {figure: row[figure] for figure in ONLY_FALL} for name, row in table(found).items()}
        KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    elif arguments.check:
        lines = worse(table(found), too_long(), json.loads(KEPT.read_text(encoding="utf-8")))
        print(*lines or ["no figure rose"], sep="\n")
        return bool(lines)
    else:
        rows = table(found)
        print(f"{'':32}" + "".join(f"{figure:>12}" for figure in next(iter(rows.values()))))
        for name, row in rows.items():
            print(f"{name:32}" + "".join(f"{value:>12}" for value in row.values()))
        lengths = Counter(each.kind for each in too_long())
        print("Too long:", ", ".join(f"{count} × {kind}" for kind, count in lengths.items()) or "none")
    return 0


if __name__ == "__main__":
    sys.exit(main())
