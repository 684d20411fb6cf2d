"""Access control, and files that no request may reach."""

import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import version

import httpx
import pytest
from tests.web.conftest import refused, serving

from fingerpad.web import app
from fingerpad.web.security import Access
from fingerpad.web.workspace import Workspace


def bare(client, **headers):
    return httpx.Client(base_url=client.base_url, headers=headers, trust_env=False, verify=False)


@pytest.mark.parametrize(
    "host",
    ["evil.example", "127.0.0.1.evil.example", "evil.example:80", "192.168.0.7", "", "[::", "a@127.0.0.1"],
)
def test_a_foreign_host_is_refused(standing, host):
    answer = standing.get("/api/session", headers={"host": host})
    assert answer.status_code in {421, 400}  # an empty Host never reaches the application
    assert "study" not in answer.text


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "LOCALHOST", "[::1]"])
def test_the_loopback_answers_by_each_of_its_names(standing, name):
    host = f"{name}:{standing.base_url.port}"
    assert standing.get("/api/session", headers={"host": host}).status_code == 200


PATHS = ["/", "/api/session", "/static/index.html", "/nowhere"]


@pytest.mark.parametrize("path", [*PATHS, "/api/studies/demo/state", "/api/openapi.json"])
@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"authorization": "Bearer no"},
        {"authorization": "Bearer é".encode("latin-1")},
        {"authorization": "Basic eDp5"},
        {"cookie": "x=y"},
    ],
)
def test_without_the_token_requests_are_refused(standing, path, headers):
    with bare(standing, **headers) as stranger:
        answer = stranger.get(path)
    assert answer.status_code == 403
    assert "token" in answer.text
    assert "demo" not in answer.text


@pytest.fixture
def clock():
    return [1000.0]


@pytest.fixture
def opened(studies_folder, clock):
    """Return what opens a launch, and a client of it that knows nothing."""
    access = Access("a-token", clock=lambda: clock[0])
    with serving(Workspace(studies_folder), access) as client, bare(client) as page:
        yield access, page


@pytest.mark.parametrize("way", ["token", "code"])
def test_the_start_address_gives_a_cookie_that_scripts_and_other_sites_cannot_use(opened, way):
    access, page = opened
    for wrong in ({way: "guess"}, {way: "é☃"}, {"code": access.token}, {}):
        assert page.get("/start", params=wrong).status_code == 403
    answer = page.get("/start", params={way: access.token if way == "token" else access.new_code(60)})
    assert (answer.status_code, answer.headers["location"]) == (303, "/")
    cookie = answer.headers["set-cookie"].lower()
    assert "httponly" in cookie
    assert "samesite=strict" in cookie
    assert "domain" not in cookie
    assert page.get("/api/session").status_code == 200


def test_a_code_is_valid_once_and_reuse_is_explained(opened):
    access, page = opened
    code = {"code": access.new_code(60)}
    assert page.head("/start", params=code).status_code == 403  # a look at it is no use of it
    assert page.get("/start", params=code).status_code == 303
    assert page.get("/start", params=code).headers["location"] == "/"  # in the same browser it goes on
    with bare(page) as other:
        answer = other.get("/start", params=code)
        assert answer.status_code == 403
        assert answer.headers["content-type"].startswith("text/html")
        assert "printed in the terminal" in answer.text
        assert "default-src 'none'" in answer.headers["content-security-policy"]
        assert other.get("/api/session").status_code == 403
        assert other.get("/start", params={"token": access.token}).status_code == 303


def test_an_expired_code_is_refused(opened, clock):
    access, page = opened
    in_time, late = access.new_code(120), access.new_code(120)
    clock[0] += 119
    assert page.get("/start", params={"code": in_time}).status_code == 303
    clock[0] += 2
    with bare(page) as other:
        assert other.get("/start", params={"code": late}).status_code == 403


def test_two_at_once_cannot_use_one_code():
    access = Access()
    code = access.new_code(60)
    with ThreadPoolExecutor(8) as pool:
        assert sum(pool.map(lambda _: access.accepts(token="", code=code), range(64))) == 1


@pytest.mark.parametrize(
    "headers",
    [
        *({"origin": origin} for origin in ("https://evil.example", "null", "http://127.0.0.1:1")),
        *({"sec-fetch-site": site} for site in ("cross-site", "same-site")),
    ],
)
@pytest.mark.parametrize(
    ("path", "body"), [("studies/demo/state", None), ("studies/demo/run", {}), ("session/example", {})]
)
def test_other_pages_are_refused_even_with_the_token(standing, path, body, headers):
    method = "GET" if body is None else "POST"
    assert standing.request(method, f"/api/{path}", headers=headers, json=body).status_code == 403
    assert standing.get("/api/session").json()["study"]["name"] == "demo"


@pytest.mark.parametrize("path", PATHS)
def test_every_response_has_the_security_headers(standing, path):
    headers = standing.get(path).headers
    policy = headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "script-src 'self';" in policy  # and nothing inline
    assert "frame-ancestors 'none'" in policy
    assert "unsafe-eval" not in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert "access-control-allow-origin" not in headers


def test_the_report_may_stand_in_the_page_and_runs_no_script(done):
    policy = done.get("/api/studies/demo/download/report.html").headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "script-src" not in policy
    assert "frame-ancestors 'self'" in policy


OUTSIDE = [
    "../study.toml", "..%2f..%2fetc%2fpasswd", "/etc/passwd", "//etc/passwd",
    "figures/../../study.toml", "figures/..%2f..%2fstudy.toml", "overlays/sequences/../../store.sqlite",
    "store.sqlite", "report/../../study.toml", "report/..%2f..%2fstudy.html", "report/pages.txt",
    "report/", "figures/", "figures/.svg/../x.svg", "figures\\..\\..\\x.svg", "%00", "figures/%00.svg",
]  # fmt: skip


@pytest.mark.parametrize("path", OUTSIDE)
def test_downloads_reach_only_what_the_run_wrote(done, path):
    answer = done.get(httpx.URL(f"{done.base_url}/api/studies/demo/download/{path}"))
    assert answer.status_code in {403, 404}, answer.text


FILES = [
    "../study.toml", "/etc/passwd", "uploads/../study.toml", "synthetic/../study.toml", "./study.toml",
    "study.toml", "results/store.sqlite", "\0",
]  # fmt: skip
ITEMS = [
    "synthetic_pad/../../etc/passwd", "unknown/x.png", "nothing", "synthetic_press_30deg#x",
    "synthetic_press_30deg#-1", "synthetic_press_30deg#99999999999", "coin:camera", "coin:nothing", "#", "/",
    "x" * 900,
]  # fmt: skip


@pytest.mark.parametrize("item", [*(f"file:{name}" for name in FILES), *ITEMS])
@pytest.mark.parametrize("kind", ["info", "preview", "thumbnail", "overlay"])
def test_items_are_names_and_never_paths(done, item, kind):
    answer = done.study_get(f"picture/{kind}", item=item)
    assert answer.status_code == 404, answer.text


def test_a_frame_that_is_a_link_out_of_the_study_is_not_shown(client, studies_folder):
    frames = studies_folder / "demo" / "frames"
    frames.mkdir()
    shutil.copy(studies_folder / "demo/synthetic/synthetic_30deg_1N.png", studies_folder / "outside.png")
    (frames / "f1.png").symlink_to(studies_folder / "outside.png")
    client.edit({"kind": "sequence", "key": "draft", "set": {"file": "frames"}})
    for kind in ("info", "preview", "thumbnail"):
        said = refused(client.study_get(f"picture/{kind}", item="draft#0"))
        assert "'frames/f1.png' is a link that leaves the study folder" in said


@pytest.mark.parametrize("coin", ["../../etc/passwd", "/etc/passwd", "study.toml", "nothing.png"])
@pytest.mark.parametrize("path", ["scale", "length", "contact"])
def test_a_coin_is_a_picture_of_the_study(done, coin, path):
    scale = {"coin": coin, "diameter_mm": 23.25}
    params = {
        "scale": {"table": scale},
        "length": {"scale": scale, "line_px": [[0, 0], [0, 10]]},
        "contact": {"item": "synthetic_30deg_2N", "scale": scale},
    }[path]
    answer = done.study_post(f"measure/{path}", **params)
    assert answer.status_code == 404, answer.text
    assert "root:" not in answer.text


@pytest.mark.parametrize("name", ["..", "../x", "a/b", "", ".hidden", "x" * 61, "a\0b", "con:"])
@pytest.mark.parametrize("path", ["new", "open"])
def test_studies_are_named_within_the_workspace(standing, name, path):
    before = standing.get("/api/session").json()
    answer = standing.post(f"/api/session/{path}", json={"name": name})
    assert answer.status_code in {400, 404, 409}, answer.text
    assert standing.get("/api/session").json() == before


@pytest.mark.parametrize("path", ["../app.py", "..%2fapp.py", "%2e%2e/app.py", "vendor/../../app.py"])
def test_static_files_stay_in_their_folder(standing, path):
    address = httpx.URL(f"{standing.base_url}/static/{path}")
    assert standing.get(address).status_code in {404, 405}


def test_a_body_that_is_too_large_is_refused(standing):
    answer = standing.post("/api/studies/demo/corrections", content=b" " * 9_000_000)
    assert answer.status_code == 413


def test_plotly_is_served_locally_and_cached(standing):
    address = standing.get("/api/session").json()["plotly"]
    assert version("plotly") in address
    answer = standing.get(address).raise_for_status()
    assert len(answer.content) > 1_000_000
    assert "max-age" in answer.headers["cache-control"]


def test_files_of_the_page_are_cached_until_one_changes(standing, tmp_path, monkeypatch):
    def script():
        page = standing.get("/")
        assert page.headers["cache-control"] == "no-cache"
        return re.search(r'src="(/static/[^"]+/app\.js)"', page.text)[1]

    before = script()
    assert "immutable" in standing.get(before).raise_for_status().headers["cache-control"]
    assert script() == before
    changed = shutil.copytree(app.STATIC, tmp_path / "static")
    (changed / "core" / "dom.js").write_text("// another version", encoding="utf-8")
    monkeypatch.setattr(app, "STATIC", changed)
    assert script() != before
