"""Drawing of the layers of the code, from the contracts that `make check` enforces."""

import importlib
import re
import tomllib
from pathlib import Path
from xml.sax.saxutils import escape

ROOT = Path(__file__).parents[2]
WIDTH, HEIGHT, GAP, MARGIN = 640, 34, 6, 8


def layers(name: str) -> list[list[str]]:
    """Return the layers of a contract, the highest first, each the modules that stand side by side."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    (found,) = (each["layers"] for each in contracts if each["name"] == name)
    return [[module.strip() for module in layer.split("|")] for layer in found]


def _says(module: str) -> str:
    """Return the first sentence of a module's docstring."""
    lines = (importlib.import_module(module).__doc__ or "").split("\n\n")[0]
    return re.split(r"(?<!al)\. ", " ".join(lines.split()))[0].rstrip(".")


def draw(path: Path) -> None:
    """Write the drawing as SVG: packages from top to bottom, those of a study beside it."""
    parts, y = [], MARGIN
    for layer in layers("Data flows one way"):
        packages = [module for module in layer if not module.split(".")[1].startswith("_")]
        if packages in ([], ["fingerpad.exceptions"]):
            continue
        if "fingerpad.estimate" in packages or "fingerpad.flags" in packages:
            continue
        y = _row(parts, packages, y, "#dbe7f3", detail=True)
        if packages == ["fingerpad.study"]:
            for inner in layers("A study goes from its manifest to its results"):
                y = _row(parts, inner, y, "#f2ead8", inset=60)
    helpers = "flags, estimates, units, files and arrays, which all may import; exceptions below them"
    parts.append(_text(WIDTH / 2, y + 14, helpers, size=11))
    y += 24
    size = f'viewBox="0 0 {WIDTH} {y}" width="{WIDTH}" height="{y}"'
    font = 'font-family="sans-serif" text-anchor="middle"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} {font}>'
    path.write_text("\n".join([head, '<rect width="100%" height="100%" fill="white"/>', *parts, "</svg>"]))


def _row(
    parts: list[str], modules: list[str], y: float, colour: str, *, inset: float = 0, detail: bool = False
) -> float:
    left, height = MARGIN + inset, HEIGHT if detail else HEIGHT - 12
    width = (WIDTH - 2 * left - GAP * (len(modules) - 1)) / len(modules)
    for number, module in enumerate(modules):
        x = left + number * (width + GAP)
        box = f'x="{x:.1f}" y="{y}" width="{width:.1f}" height="{height}" rx="4"'
        parts.append(f'<rect {box} fill="{colour}" stroke="#667788"/>')
        name, middle = module.removeprefix("fingerpad.").removeprefix("study."), x + width / 2
        parts.append(_text(middle, y + 14 if detail else y + 15, name, size=12, weight="bold"))
        says = _says(module)
        if detail and len(says) * 5.0 < width:
            parts.append(_text(middle, y + 28, says, size=10))
    return y + height + GAP


def _text(x: float, y: float, words: str, *, size: int, weight: str = "normal") -> str:
    place = f'x="{x:.1f}" y="{y:.1f}" font-size="{size}" font-weight="{weight}"'
    return f'<text {place} fill="#222222">{escape(words)}</text>'
