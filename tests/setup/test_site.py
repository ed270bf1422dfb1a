"""The site: built without a warning in an environment of its own, where its packages can be installed."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PYTHON = ROOT / ".venv-docs" / "bin" / "python"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site") / "site"
    command = [sys.executable, str(ROOT / "tools" / "dev.py"), "docs", str(folder)]
    if PYTHON.exists():  # it is set up, and its tests need not wait for the network
        command = [str(PYTHON), str(ROOT / "tools" / "build_site.py"), str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if "installing failed" in done.stderr:
        pytest.skip("the packages for the site cannot be installed here")
    assert done.returncode == 0, done.stderr[-3000:]
    return folder


def test_every_link_of_the_site_leads_to_a_file_and_a_place(site: Path) -> None:
    pages = {path: path.read_text(encoding="utf-8") for path in site.rglob("*.html") if path.parent != site / "site"}
    assert len(pages) > 30
    broken = []
    for path, text in pages.items():
        for target in re.findall(r'(?:href|src)="(?!https?:|data:|mailto:)([^"]*)"', text):
            name, _, anchor = target.partition("#")
            found = (path.parent / name.partition("?")[0]).resolve() if name else path
            if not found.exists() or (anchor and found in pages and f'id="{anchor}"' not in pages[found]):
                broken.append(f"{path.relative_to(site)}: {target}")
    assert broken == []


def test_lesson_viewer_sound_and_outputs_live_in_it(site: Path) -> None:
    for name, page in (("lesson", "lesson"), ("view", "viewer")):
        text = (site / "site" / f"{name}.html").read_text(encoding="utf-8")
        assert "</html>" in text
        assert len(text) < 5_000_000
        assert f'src="site/{name}.html"' in (site / f"{page}.html").read_text(encoding="utf-8")
    assert (site / "site" / "fig5.wav").read_bytes().startswith(b"RIFF")
    shown = (site / "outputs.html").read_text(encoding="utf-8")
    assert all(f"rubnoise {name}" in shown for name in ("check", "run", "junction", "compare", "verify", "theory"))
    assert "landmarks" in (site / "searchindex.js").read_text(encoding="utf-8")


def test_the_gallery_is_in_it_with_its_pictures(site: Path) -> None:
    page = (site / "docs" / "gallery.html").read_text(encoding="utf-8")
    pictures = re.findall(r'<img[^>]* src="([^"]+\.png)"', page)
    assert len(pictures) > 30
    assert all((site / "docs" / name).resolve().is_file() for name in pictures)
    assert "rubnoise plot fig5.h5 lifelines" in page


def test_nothing_but_a_site_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine", encoding="utf-8")
    command = [sys.executable, str(ROOT / "tools" / "build_site.py"), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "is not a site" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
