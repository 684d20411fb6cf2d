"""The page on which a study is measured, corrected and read."""

import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fingerpad.exceptions import FingerpadError, ManifestError

if TYPE_CHECKING:
    from fingerpad.web.app import Launch

_NEEDED = {"fastapi", "plotly", "tomlkit", "uvicorn"}


def app(
    study: Annotated[
        Path | None, typer.Argument(help="The study's manifest, or its folder.", show_default=False)
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder of its results.", show_default="results beside the manifest")
    ] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port; 0 takes one that is free.")] = 0,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
) -> None:
    """Open a page in the browser to measure, correct and read a study.

    It can be reached from this machine only, through the address that is printed. Without a study the page
    offers those in the current folder. Ctrl-C ends it.
    """
    try:
        from fingerpad.web.app import serve
        from fingerpad.web.workspace import Workspace
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in _NEEDED:
            raise
        raise FingerpadError(
            f"the page needs the package {error.name}: pip install 'fingerpad[app]'"
        ) from None
    workspace = Workspace(Path.cwd() if study is None else _folder_of(study).parent)
    if study is not None:
        workspace.open_folder(_folder_of(study), out)
    elif out is not None:
        raise FingerpadError("--out needs a study: name its manifest")
    serve(workspace, port=port, on_ready=lambda launch: _tell(launch, browser=browser))


def _folder_of(study: Path) -> Path:
    from fingerpad.study.manifest.load import STUDY_NAME

    if study.is_dir():
        return study.absolute()
    if not study.is_file():
        raise ManifestError(f"{study}: no such file; `fingerpad app` without a name starts a new study")
    if study.name != STUDY_NAME:
        raise ManifestError(f"{study}: the page changes manifests named {STUDY_NAME} only; rename it")
    return study.absolute().parent


def _tell(launch: "Launch", *, browser: bool) -> None:
    typer.echo(
        f"The page is at {launch.address}\nCtrl-C ends it. Scripts read the token from {launch.token_file}"
    )
    if browser:
        webbrowser.open(launch.browser_address)
