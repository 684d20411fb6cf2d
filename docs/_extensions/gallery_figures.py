"""Pictures of gallery scripts: figures and drawings that a script leaves in its variables."""

from pathlib import Path

import matplotlib as mpl
import plotly.graph_objects as go
from matplotlib.figure import Figure as Drawn
from plotly.offline import get_plotlyjs
from sphinx_gallery.scrapers import figure_rst

from fingerpad.figures import save_figure, style
from fingerpad.figures.marks import Figure
from fingerpad.figures.publish import FigureSettings
from fingerpad.figures.show import Drawing

_DPI = 200
_PLOTLY = "plotly.min.js"


def use_style(_gallery_conf, _script):
    """Let a script draw in the style of fingerpad's figures."""
    mpl.rcParams.update(style._STYLE)


def save_drawings(_block, block_vars, gallery_conf):
    """Save what a block has drawn and no block before it, and return the text that shows it."""
    variables = block_vars["example_globals"]
    shown = variables.setdefault("_shown", [])
    paths, texts = [], []
    for value in list(variables.values()):
        if any(value is one for one in shown):
            continue
        if isinstance(value, Drawn | Figure | Drawing):
            path = next(block_vars["image_path_iterator"])
            if isinstance(value, Drawn):
                value.savefig(path, dpi=_DPI)
            elif isinstance(value, Figure):
                save_figure(value, path, settings=FigureSettings(dpi=_DPI))
            else:
                value.save(path)
            paths.append(path)
            shown.append(value)
        elif isinstance(value, go.Figure):
            texts.append(_interactive(value, gallery_conf))
            shown.append(value)
    return figure_rst(paths, gallery_conf["src_dir"]) + "".join(texts)


def _interactive(figure, gallery_conf):
    """Return an interactive figure as HTML, with Plotly's script among the static files."""
    script = Path(gallery_conf["src_dir"]) / "_static" / _PLOTLY
    script.write_text(get_plotlyjs(), encoding="utf-8")
    page = figure.to_html(
        full_html=False, include_plotlyjs=f"../../_static/{_PLOTLY}", default_height="480px"
    )
    return "\n.. raw:: html\n\n" + "".join(f"    {line}\n" for line in page.splitlines())
