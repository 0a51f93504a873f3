"""HTML: pages that are complete in themselves, names escaped, pictures inside."""

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from auricle.report.tables import LEAST, PLANNED, UNPLANNED
from auricle.report.wording import counted, number, percent

_MEDIA_TYPES = {"svg": "image/svg+xml", "png": "image/png"}


@dataclass(frozen=True)
class Caption:
    """What is written with a figure: above it, below it, and for those who cannot see it."""

    title: str
    text: str
    alternative: str


@dataclass(frozen=True)
class CaptionedFigure:
    """A figure with its caption, its content as a data URI."""

    caption: Caption
    uri: str


def rendered(template: str, context: Mapping[str, Any]) -> str:
    """A page from its template: styles inside, no script, no network; texts are escaped."""
    return _environment().get_template(template).render(context)


def captioned(
    files: Mapping[str, bytes], captions: Mapping[str, Caption]
) -> tuple[CaptionedFigure, ...]:
    """Figures in the order of their captions; those without one come last, by name."""
    known = [name for name in captions if name in files]
    others = sorted(name for name in files if name not in captions)
    return tuple(
        CaptionedFigure(captions.get(name) or Caption(name, "", name), _data_uri(name, files[name]))
        for name in (*known, *others)
    )


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("auricle.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(percent=percent, counted=counted)
    environment.globals.update(number=number, PLANNED=PLANNED, UNPLANNED=UNPLANNED, LEAST=LEAST)
    return environment


def _data_uri(name: str, content: bytes) -> str:
    media_type = _MEDIA_TYPES[name.rpartition(".")[2]]
    return f"data:{media_type};base64,{base64.b64encode(content).decode('ascii')}"
