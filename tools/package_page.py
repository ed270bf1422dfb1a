"""The page of the package on an index: README.md with links that work there.

The address of the repository stands once, in pyproject.toml under [tool.rubnoise]. With an address, relative links lead
to the files of this version. Without one, a link becomes its text, and a picture is left out.
"""

import re
import tomllib
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

CHECKOUT = "## Two commands"
"""The heading of README.md from which it is about a checkout; the index has package_page.md from there on."""
LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!https?://|#)([^)]+)\)")
BRANCHES = {
    "Source": "",
    "Documentation": "/tree/main/docs",
    "Changelog": "/blob/main/CHANGELOG.md",
    "Issues": "/issues",
}


class PackagePage(MetadataHookInterface):
    """Fills in the dynamic fields of the metadata."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set readme and urls; called by hatchling."""
        root = Path(self.root)
        address = repository(root)
        told = (root / "README.md").read_text(encoding="utf-8").partition(CHECKOUT)[0]
        told += (root / "tools" / "package_page.md").read_text(encoding="utf-8")
        page = with_links(told, address, f"v{metadata['version']}")
        metadata["readme"] = {"content-type": "text/markdown", "text": page}
        metadata["urls"] = {name: address + path for name, path in BRANCHES.items()} if address else {}


def repository(root: Path) -> str:
    """Return the address of the repository without a slash at its end, empty where none is set."""
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    return str(project["tool"]["rubnoise"]["repository"]).rstrip("/")


def with_links(page: str, address: str, version: str) -> str:
    """Return a page whose relative links are absolute, or plain text without an address."""

    def absolute(found: re.Match[str]) -> str:
        picture, text, target = found.groups()
        if not address:
            return "" if picture else text
        return f"{picture}[{text}]({address}/{'raw' if picture else 'blob'}/{version}/{target})"

    return LINK.sub(absolute, page)


def get_metadata_hook() -> type[MetadataHookInterface]:
    """Return the hook; called by hatchling."""
    return PackagePage
