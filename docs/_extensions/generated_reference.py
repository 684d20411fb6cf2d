"""Parts that the program itself makes: keys of files, the command line, a figure of the tutorial."""

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from fingerpad.flags import FLAGS, Flagged
from fingerpad.study.editing.template import manifest_schema
from fingerpad.study.results.summary_file import SummaryFile

_TABLES = {
    "Study": "Top of the file",
    "Uncertainty": "`[uncertainty]`",
    "Apparatus": "`[apparatus]`",
    "ResolutionScale": "`[scales.NAME]`: pixels per inch",
    "PitchScale": "`[scales.NAME]`: millimetres per pixel",
    "LineScale": "`[scales.NAME]`: a line of known length",
    "CoinScale": "`[scales.NAME]`: a coin",
    "CircleScale": "`[scales.NAME]`: a circle by three points",
    "GridScale": "`[scales.NAME]`: a checkerboard or a grid of dots",
    "Finger": "`[[fingers]]`",
    "SemiAxes": "`semi_axes_mm` of a finger",
    "SemiAxesStd": "`semi_axes_mm_std` of a finger",
    "Photograph": "`photographs` of a finger",
    "Observation": "`[[observations]]`",
    "ContactEllipse": "`ellipse_mm` of an observation",
    "ContactSequence": "`[[sequences]]`",
    "Curve": "`[[curves]]`",
}


def manifest_keys() -> str:
    """Return tables of the manifest's keys, in Markdown."""
    study = json.loads(manifest_schema())
    tables = {"Study": study, **study["$defs"]}
    titles = {**{name: f"`{name}`" for name in tables}, **_TABLES}
    ordered = [*_TABLES, *(name for name in tables if name not in _TABLES)]
    return "\n".join(_table(titles[name], tables[name]) for name in ordered)


def summary_keys() -> str:
    """Return tables of the keys of summary.json, in Markdown, each below the one that holds it."""
    top = SummaryFile.model_json_schema(mode="serialization")
    tables, titles = {"SummaryFile": top, **top["$defs"]}, {"SummaryFile": _TABLES["Study"]}
    for table in list(tables.values()):
        for key, value in table["properties"].items():
            for name in re.findall(r"#/\$defs/(\w+)", json.dumps(value)):
                titles.setdefault(name, f"`{key}`: {tables[name]['description'].partition('.')[0]}")
    ordered = ["SummaryFile"]
    for name in ordered:
        held = re.findall(r"#/\$defs/(\w+)", json.dumps(tables[name]["properties"]))
        ordered += dict.fromkeys(one for one in held if one not in ordered)
    plain = {"required": [], "description": ""}
    return "\n".join(_table(titles[name], tables[name] | plain) for name in ordered)


def _table(title: str, table: dict) -> str:
    required = table.get("required", [])
    rows = ""
    for key, value in table["properties"].items():
        name = f"`{key}` (required)" if key in required else f"`{key}`"
        rows += f"| {name} | {_values(value)} | {value.get('description', '')} |\n"
    about = "" if title == _TABLES["Study"] else f"{table['description']}\n\n"
    head = f"## {title}\n\n{about}:::{{container}} keys\n\n| key | value | meaning |\n|---|---|---|\n"
    return f"{head}{rows}\n:::\n"


def _values(value: dict) -> str:
    """Return what a key takes, and its default, in a few words."""
    choices = [one for one in value.get("anyOf", [value]) if one.get("type") != "null"]
    kinds = dict.fromkeys(_kind(one) for one in choices)
    default = value.get("default")
    stated = default not in (None, "", [], {}) and not isinstance(default, dict)
    shown = str(default).lower() if isinstance(default, bool) else default
    return " or ".join(kinds) + (f", default {shown}" if stated else "")


def _kind(value: dict) -> str:
    if "enum" in value:
        return ", ".join(f"`{one}`" for one in value["enum"])
    if "$ref" in value or "oneOf" in value:
        return "table" if "oneOf" not in value else "name or table"
    names = {
        "string": "text",
        "boolean": "true or false",
        "object": "table",
        "array": "list",
        "integer": "number",
    }
    kind = names.get(value.get("type", ""), value.get("type", ""))
    low = value.get("minimum", value.get("exclusiveMinimum"))
    high = value.get("maximum", value.get("exclusiveMaximum"))
    if kind == "number" and low is not None and high is not None:
        return f"number, {low:g} to {high:g}"
    return kind


def command_line() -> str:
    """Return the commands and their flags, in Markdown, as Typer writes them."""
    command = [sys.executable, "-m", "typer", "fingerpad.cli", "utils", "docs", "--name", "fingerpad"]
    found = subprocess.run(command, capture_output=True, text=True, check=True)
    _title, _, body = found.stdout.partition("\n")
    return _whole_summaries(body)


def _whole_summaries(body: str) -> str:
    """Return the commands with whole summaries in their lists, where Typer cuts them."""
    summaries = dict(re.findall(r"^#+ `fingerpad (.+)`\n\n(.+)$", body, re.MULTILINE))
    by_end = {command.split()[-1]: text for command, text in summaries.items()}
    command = re.compile(r"^\* `(\w+)`: .*$", re.MULTILINE)
    return command.sub(lambda found: f"* `{found[1]}`: {by_end.get(found[1], found[0])}", body)


def flag_tables() -> str:
    """Return a table of the flags of each kind of measurement, in Markdown."""
    titles: dict[Flagged, str] = {
        "contact": "Flags of a contact image",
        "scale": "Flags of a scale",
        "frame": "Flags of a frame of a sequence",
        "photograph": "Flags of a photograph",
        "curve": "Flags of a loading curve",
        "layer": "`layer_flag`: no result on the layer",
        "row": "Range notes of a row",
    }
    kept_out = {
        "": "",
        "pooling": "not pooled",
        "pooling unless reviewed": "not pooled until accepted or corrected",
        "pooled ridge area": "its ridge area is not pooled",
    }
    text = ""
    for kind, title in titles.items():
        flags = FLAGS[kind].values()
        of_contacts = any(flag.excludes for flag in flags)
        head = ("flag", "meaning", *(("pooling",) if of_contacts else ()), "what to do")
        rows = [
            (f"`{flag.code}`", flag.words, *((kept_out[flag.excludes],) if of_contacts else ()), flag.to_do)
            for flag in flags
        ]
        lines = [head, ("---",) * len(head), *rows]
        text += f"## {title}\n\n" + "".join(f"| {' | '.join(line)} |\n" for line in lines) + "\n"
    return text


def example_figure(path: Path) -> None:
    """Run the example study as the tutorial does, and draw its figure of area against load."""
    area = "example/results/figures/synthetic_pad_30deg_synthetic_area.json"
    commands = (
        ["init", "--example", "example"],
        ["run", "example/study.toml"],
        ["figure", area, "--width-mm", "89", "--out", str(path.resolve())],
    )
    with tempfile.TemporaryDirectory() as folder:
        for command in commands:
            run = [sys.executable, "-m", "fingerpad", *command]
            subprocess.run(run, cwd=folder, capture_output=True, check=True)


def write(folder: Path) -> None:
    """Write the keys, the command line and the flags into a folder, for pages to include."""
    (folder / "_manifest_keys.md").write_text(manifest_keys(), encoding="utf-8")
    (folder / "_summary_keys.md").write_text(summary_keys(), encoding="utf-8")
    (folder / "_command_line.md").write_text(command_line(), encoding="utf-8")
    (folder / "_flags.md").write_text(flag_tables(), encoding="utf-8")
