"""`fingerpad app`: printed address, local access only, and shutdown."""

import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import httpx
import pytest
from tests.waiting import wait_until

APP = [sys.executable, "-m", "fingerpad", "app", "--no-browser"]


def launched(*arguments, cwd):
    return subprocess.Popen(
        [*APP, *map(str, arguments)],
        cwd=cwd,
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


def test_the_address_is_printed_and_the_server_stops_cleanly(studies_folder):
    process = launched("demo", cwd=studies_folder)
    address = process.stdout.readline().split()[-1]
    try:
        assert address.startswith("http://127.0.0.1:")
        told = process.stdout.readline()
        assert "Ctrl-C" in told
        token_file = Path(told.split()[-1])
        assert token_file.stat().st_mode & 0o777 == 0o600
        assert token_file.parent.stat().st_mode & 0o777 == 0o700
        bearer = {"authorization": f"Bearer {token_file.read_text().strip()}"}
        with httpx.Client(base_url=address.partition("/start")[0], trust_env=False) as client:
            assert client.get("/").status_code == 403
            assert client.get("/api/session", headers=bearer).status_code == 200
            page = client.get(address, follow_redirects=True)
            assert page.status_code == 200
            assert "<html" in page.text
            assert client.get("/api/study").json()["name"] == "demo"
            with client.stream("GET", "/api/events") as events:  # a page that listens does not hold it up
                assert events.status_code == 200
                ended(process)
        assert not token_file.parent.exists()
    finally:
        process.kill()
        process.communicate()


def test_the_browser_is_started_with_a_code_of_its_own_and_never_the_token(studies_folder):
    browser = studies_folder / "browser"
    there = studies_folder / "argument"
    browser.write_text(f'#!/bin/sh\nprintf %s "$1" > {there}.new\nmv {there}.new {there}\n')
    browser.chmod(0o755)
    command = [part for part in APP if part != "--no-browser"]
    environment = os.environ | {"BROWSER": str(browser), "XDG_RUNTIME_DIR": str(studies_folder)}
    process = subprocess.Popen(
        [*command, "demo"], cwd=studies_folder, stdout=subprocess.PIPE, text=True, env=environment
    )
    try:
        printed = process.stdout.readline().split()[-1]
        token_file = Path(process.stdout.readline().split()[-1])
        assert token_file.is_relative_to(studies_folder)
        assert wait_until(there.exists)
        argument = there.read_text()
        assert token_file.read_text().strip() not in argument
        for address, again in ((argument, 403), (printed, 200)):
            for expected in (200, again):
                with httpx.Client(trust_env=False) as client:
                    assert client.get(address, follow_redirects=True).status_code == expected
    finally:
        process.kill()
        process.communicate()


def test_without_a_study_it_offers_those_of_the_folder_and_two_launches_stand_side_by_side(studies_folder):
    first, second = launched(cwd=studies_folder), launched(cwd=studies_folder)
    try:
        addresses = [process.stdout.readline().split()[-1] for process in (first, second)]
        assert addresses[0] != addresses[1]
        with httpx.Client(trust_env=False) as client:
            for address in addresses:
                client.get(address)
            for address in addresses:  # the second has not taken the first one's cookie
                session = client.get(f"{address.partition('/start')[0]}/api/session").json()
                assert session["study"] is None
                assert [study["name"] for study in session["studies"]] == ["demo"]
        ended(first)
        ended(second)
    finally:
        for process in (first, second):
            process.kill()
            process.communicate()


def test_it_listens_on_this_machine_only(studies_folder):
    process = launched("demo/study.toml", cwd=studies_folder)
    try:
        port = int(httpx.URL(process.stdout.readline().split()[-1]).port)
        others = {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)}
        for address in (*(one for one in others if not one.startswith("127.0.0.1")), "127.0.0.2"):
            with pytest.raises(OSError, match="refused|timed out|unreachable"):
                socket.create_connection((address, port), timeout=2)
        ended(process)
    finally:
        process.kill()
        process.communicate()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere/study.toml"], "no such file"),
        (["demo/observations.csv"], "named study.toml"),
        (["--out", "results"], "needs a study"),
        (["--port", "99999"], "port"),
    ],
)
def test_wrong_arguments_are_reported(studies_folder, arguments, words):
    process = launched(*arguments, cwd=studies_folder)
    out, errors = process.communicate(timeout=30)
    assert process.returncode == 2
    assert words in errors
    assert "Traceback" not in errors
    assert not out


def test_a_port_in_use_is_reported(studies_folder):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        process = launched("demo", "--port", taken.getsockname()[1], cwd=studies_folder)
        _, errors = process.communicate(timeout=30)
    assert process.returncode == 2
    assert "--port" in errors


@pytest.mark.parametrize("package", ["starlette", "uvicorn", "tomlkit"])
def test_a_package_that_is_not_installed_is_named_with_the_way_to_it(studies_folder, package):
    code = (
        "import sys\n"
        f"sys.modules[{package!r}] = None\n"
        "sys.argv = ['fingerpad', 'app', 'demo', '--no-browser']\n"
        "from fingerpad.__main__ import main\n"
        "main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=studies_folder, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 2
    assert f"needs the package {package}" in done.stderr
    assert "pip install 'fingerpad[app]'" in done.stderr
