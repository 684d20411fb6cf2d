"""`fingerpad app`: printed address, local access only, and shutdown."""

import os
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import httpx
import pytest
from tests.command import refusal, run
from tests.waiting import wait_until

from fingerpad.web.workspace import title_of

APP = [sys.executable, "-m", "fingerpad", "app", "--no-browser"]


def launched(*arguments, cwd, command=APP, env=None):
    return subprocess.Popen(
        [*command, *arguments],
        cwd=cwd,
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        bufsize=1,
    )


def ended(process):
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert "Traceback" not in errors, errors
    assert process.returncode == 0


def other_addresses():
    """Return addresses of this machine at which the page must not be reached."""
    own = set()
    with suppress(socket.gaierror):  # a minimal machine does not know its own name
        own = {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)}
    return [*(one for one in own if not one.startswith("127.0.0.1")), "127.0.0.2"]


def require_reached_from_here_alone(address, token_file):
    assert address.startswith("http://127.0.0.1:")
    assert token_file.stat().st_mode & 0o777 == 0o600
    assert token_file.parent.stat().st_mode & 0o777 == 0o700
    bearer = {"authorization": f"Bearer {token_file.read_text().strip()}"}
    with httpx.Client(base_url=address.partition("/start")[0], trust_env=False, verify=False) as client:
        for other in other_addresses():
            with pytest.raises(OSError, match="refused|timed out|unreachable"):
                socket.create_connection((other, client.base_url.port), timeout=2)
        assert client.get("/").status_code == 403
        assert client.get("/api/session", headers=bearer).status_code == 200


def require_codes(printed, argument, token_file):
    """Open the browser's address, which holds once and is not the token, and the printed one."""
    assert token_file.read_text().strip() not in argument
    for address, again in ((argument, 403), (printed, 200)):
        for expected in (200, again):
            with httpx.Client(trust_env=False, verify=False) as client:
                assert client.get(address, follow_redirects=True).status_code == expected


def test_two_launches_stand_side_by_side_until_each_is_stopped(studies_folder):
    """One opens a study and the browser; the other, without a study, offers those of the folder."""
    browser = studies_folder / "browser"
    there = studies_folder / "argument"
    browser.write_text(f'#!/bin/sh\nprintf %s "$1" > {there}.new\nmv {there}.new {there}\n')
    browser.chmod(0o755)
    environment = os.environ | {"BROWSER": str(browser), "XDG_RUNTIME_DIR": str(studies_folder)}
    command = [part for part in APP if part != "--no-browser"]
    first = launched("demo", cwd=studies_folder, command=command, env=environment)
    second = launched(cwd=studies_folder)
    try:
        addresses, token_files = [], []
        for process in (first, second):
            addresses.append(process.stdout.readline().split()[-1])
            reported = process.stdout.readline()
            assert "Ctrl-C" in reported
            token_files.append(Path(reported.split()[-1]))
        assert addresses[0] != addresses[1]
        assert token_files[0].is_relative_to(studies_folder)
        for address, token_file in zip(addresses, token_files, strict=True):
            require_reached_from_here_alone(address, token_file)
        assert wait_until(there.exists)
        require_codes(addresses[0], there.read_text(), token_files[0])
        with httpx.Client(trust_env=False, verify=False) as client:
            for address in addresses:
                page = client.get(address, follow_redirects=True)
                assert page.status_code == 200
                assert "<html" in page.text
            # The second has not taken the first one's cookie.
            first_at, second_at = (address.partition("/start")[0] for address in addresses)
            assert client.get(f"{first_at}/api/studies/demo/state").json()["name"] == "demo"
            session = client.get(f"{second_at}/api/session").json()
            assert session["study"] is None
            assert [study["name"] for study in session["studies"]] == ["demo"]
            with client.stream("GET", f"{first_at}/api/studies/demo/events") as events:
                assert events.status_code == 200
                ended(first)  # a page that listens does not hold it up
            ended(second)
        assert not any(token_file.parent.exists() for token_file in token_files)
    finally:
        for process in (first, second):
            process.kill()
            process.communicate()


@pytest.mark.nightly
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_the_token_is_removed_on_signals_that_end_the_program(studies_folder, number):
    before = signal.signal(number, signal.SIG_DFL)  # under nohup the program would ignore it, as it should
    process = launched("demo", cwd=studies_folder)
    signal.signal(number, before)
    try:
        process.stdout.readline()
        token_file = Path(process.stdout.readline().split()[-1])
        assert token_file.exists()
        process.send_signal(number)
        _, errors = process.communicate(timeout=30)
    finally:
        process.kill()
        process.communicate()
    assert (process.returncode, errors) == (128 + signal.SIGTERM, "")
    assert not token_file.parent.exists()


@pytest.mark.parametrize(
    ("at", "arguments", "opened"),
    [(".", [], None), (".", ["empty"], None), (".", ["demo"], "demo"), ("demo", [], "demo")],
)
def test_a_folder_without_a_manifest_is_one_to_begin_a_study_in(
    studies_folder, monkeypatch, at, arguments, opened
):
    (studies_folder / "empty").mkdir()
    monkeypatch.chdir(studies_folder / at)
    served = []
    monkeypatch.setattr("fingerpad.web.app.serve", lambda workspace, **_: served.append(workspace))
    assert run("app", *arguments)[0] == 0
    (workspace,) = served
    assert (workspace.last and workspace.last.name) == opened
    assert workspace.workspace == studies_folder / ("empty" if arguments == ["empty"] else ".")


def test_a_title_is_read_at_a_glance_or_left_alone(tmp_path):
    titles = {
        'title = "Left index"\n[[fingers]]\nname = "f"': "Left index",
        '# a comment\ntitle = "[1] of two"\n': "[1] of two",
        'description = """\n[note] of old\n"""\ntitle = "Hidden"': None,
        **dict.fromkeys(("title = 3", "[scales]", "title = "), None),
    }
    for text, title in titles.items():
        (tmp_path / "study.toml").write_text(text)
        assert title_of(tmp_path) == title, text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere/study.toml"], "no such file"),
        (["demo/observations.csv"], "named study.toml"),
        (["--out", "results"], "needs a study"),
        (["--port", "99999"], "port"),
    ],
)
def test_wrong_arguments_are_reported(studies_folder, monkeypatch, arguments, words):
    monkeypatch.chdir(studies_folder)
    assert words in refusal("app", "--no-browser", *arguments)


def test_a_port_in_use_is_reported(studies_folder):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = ("--port", taken.getsockname()[1])
        assert "--port" in refusal("app", "--no-browser", studies_folder / "demo", *port)
