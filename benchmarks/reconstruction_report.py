"""The sections of docs/reconstruction.md: each program writes its own and leaves the others."""

import re
from pathlib import Path

from auricle.atomic import write_text

FOLDER = Path(__file__).resolve().parents[1] / "docs"
REPORT = FOLDER / "reconstruction.md"
SECTIONS = ("live_session", "reconstruction_real", "qulati_peer")
"""Programs, in the order of their sections."""

_HEAD = """# Reconstruction, measured

Each section is written by the program of `benchmarks/` that it names; run that again rather than
edit it. Maps rebuilt from simulated truths are in `calibration.md`.
"""


def write_section(name: str, text: str) -> None:
    """Put the section of one program in its place in the report."""
    before = REPORT.read_text(encoding="utf-8") if REPORT.exists() else ""
    found = dict(re.findall(r"<!-- (\w+) -->\n(.*?)\n<!-- end -->", before, flags=re.DOTALL))
    found[name] = text.strip()
    parts = [f"<!-- {each} -->\n{found[each]}\n<!-- end -->" for each in SECTIONS if each in found]
    write_text(REPORT, "\n\n".join([_HEAD.strip(), *parts]) + "\n")
