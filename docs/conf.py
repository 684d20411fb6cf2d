"""Configuration of the documentation."""

import os
import re
import sys
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx

import fingerpad

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_extensions"))
import generated_reference  # noqa: E402
import layers_drawing  # noqa: E402
import pad_drawing  # noqa: E402

(HERE / "_static").mkdir(exist_ok=True)
generated_reference.write(HERE / "reference")
generated_reference.example_figure(HERE / "_static" / "example_area.svg")
layers_drawing.draw(HERE / "_static" / "layers.svg")
pad_drawing.draw(HERE / "_static" / "pad_to_contact.svg")
pad_drawing.draw_axes(HERE / "_static" / "axes.svg")
pad_drawing.draw_directions(HERE / "_static" / "contact_directions.svg")
# Real prints are not distributed; gallery scripts show them where they are.
os.environ.setdefault("FINGERPAD_PRINTS", str(HERE.parents[1] / "shared" / "data"))

project = "fingerpad"
author = "The fingerpad developers"
release = fingerpad.__version__
extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "sphinx-mathjax-offline",
]
myst_heading_anchors = 3
smartquotes_action = "qe"  # two hyphens begin a flag
myst_enable_extensions = ["colon_fence", "dollarmath"]
autosummary_generate = True
autodoc_typehints = "none"
numpydoc_show_class_members = False
sphinx_gallery_conf = {
    "examples_dirs": ["../examples/gallery", "../examples/notebook"],
    "gallery_dirs": ["gallery", "tutorial/notebook"],
    "capture_repr": (),
    "filename_pattern": "/",
    "image_scrapers": ("gallery_figures.save_drawings",),
    "reset_modules": ("gallery_figures.use_style",),
    "download_all_examples": False,
    "show_signature": False,
    "remove_config_comments": True,
    "write_computation_times": False,
    "subsection_order": [
        "../examples/gallery/dzidek2017",
        "../examples/gallery/model",
        "../examples/gallery/measurements",
        "../examples/gallery/uncertainty",
    ],
}
html_theme = "pydata_sphinx_theme"
html_title = "fingerpad"
html_theme_options = {"show_prev_next": False, "secondary_sidebar_items": ["page-toc"]}
html_sidebars = {"*": []}
exclude_patterns = [
    "_build",
    "**/_manifest_keys.md",
    "**/_summary_keys.md",
    "**/_command_line.md",
    "**/_flags.md",
]
html_static_path = ["_static", "_style"]
html_css_files = ["tables.css"]
templates_path = ["_templates"]


def keep_numbers_whole(_app: Sphinx, tree: nodes.document) -> None:
    """Let no line end between a number and its per cent."""
    for text in list(tree.findall(nodes.Text)):
        if not isinstance(text.parent, nodes.literal | nodes.literal_block | nodes.math):
            text.parent.replace(text, nodes.Text(re.sub(r"(?<=\d) %", "\N{NO-BREAK SPACE}%", text)))


def setup(app: Sphinx) -> None:
    """Connect what is changed in every page."""
    app.connect("doctree-read", keep_numbers_whole)
