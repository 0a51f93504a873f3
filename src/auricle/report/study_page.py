"""The page of a vendor's study, its maps side by side, and the folder it comes in."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from auricle.atomic import write_bytes, write_text
from auricle.progress import Progress, silent
from auricle.report.gallery import drawn_files
from auricle.report.html import Caption, CaptionedFigure, captioned, rendered
from auricle.report.study_answer import field_answer, map_answers
from auricle.report.study_figures import field_picture, redundancy_figure, support_picture
from auricle.report.study_tables import (
    extent_table,
    fill_table,
    parameters_table,
    points_table,
    quantity_tables,
)
from auricle.report.tables import Table
from auricle.report.wording import counted, field_words, printable
from auricle.study.map_study import FieldAnalysis, MapAnalysis, MapStudy
from auricle.study.map_study_store import map_fields, map_study_document, points_csv
from auricle.study.store import json_text
from auricle.surface.writing import write_surface


@dataclass(frozen=True)
class QuantitySection:
    """One quantity of a map on the page."""

    title: str
    answer: str
    reasons: tuple[str, ...]
    notes: tuple[str, ...]
    figures: tuple[CaptionedFigure, ...]
    tables: tuple[Table, ...]


@dataclass(frozen=True)
class MapSection:
    """One map on the page."""

    title: str
    notes: tuple[str, ...]
    tables: tuple[Table, ...]
    quantities: tuple[QuantitySection, ...]


def study_answers(study: MapStudy) -> tuple[str, ...]:
    """The answer for each map and quantity, a sentence or two each."""
    return tuple(answer for one in study.maps for answer in map_answers(one))


def write_map_study(study: MapStudy, folder: Path, *, progress: Progress = silent) -> Path:
    """Write a study's report, maps, tables of points and, last, result.json; returns the report.

    Raises
    ------
    OutputError
        If the folder cannot be written.
    """
    figures = drawn_files(dict(_figures(study)), progress)
    page = study_page(study, figures)
    document = json_text(map_study_document(study))
    for name, content in figures.items():
        write_bytes(folder / "figures" / name, content)
    for one in study.maps:
        if one.prepared is not None and one.fields:
            place = folder / f"map_{one.number}.vtp"
            write_surface(place, one.prepared.surface, map_fields(one), space=one.prepared.space)
        for field in one.fields:
            write_text(folder / f"{_stem(one, field)}_points.csv", points_csv(field))
    write_text(folder / "report.html", page)
    write_text(folder / "timings.json", json_text({"wall_s": dict(study.seconds)}))
    write_text(folder / "result.json", document)
    return folder / "report.html"


def study_page(study: MapStudy, figures: Mapping[str, bytes]) -> str:
    """The report as one HTML page, complete in itself."""
    context = {
        "system": printable(study.system),
        "source": study.source,
        "n_maps": len(study.maps),
        "answers": study_answers(study),
        "overview": [table for table in (points_table(study), fill_table(study)) if table.rows],
        "notes": [printable(remark) for remark in study.remarks],
        "maps": [_section(one, figures) for one in study.maps],
        "config": study.config,
        "parameters": parameters_table(study),
        "versions": [f"{name} {version}" for name, version in study.versions.items()],
    }
    return rendered("study.html.j2", context)


def _stem(one: MapAnalysis, field: FieldAnalysis) -> str:
    return f"map_{one.number}_{field.name}"


def _figures(study: MapStudy) -> Iterator[tuple[str, Callable[[], Figure]]]:
    for one in study.maps:
        for field in one.fields:
            yield f"{_stem(one, field)}.png", partial(field_picture, field)
            if not field.knows_nothing:
                yield f"{_stem(one, field)}_support.png", partial(support_picture, field)
                yield f"{_stem(one, field)}_points.svg", partial(redundancy_figure, field)


def _section(one: MapAnalysis, figures: Mapping[str, bytes]) -> MapSection:
    prepared = one.prepared
    notes = [] if prepared is None else [*map(str, prepared.repairs), *prepared.remarks]
    return MapSection(
        title=f"{one.number}. {printable(one.name)}: {counted(one.n_points, 'point')}",
        notes=tuple(printable(note) for note in (*notes, *one.remarks)),
        tables=() if one.extent is None else (extent_table(one.extent),),
        quantities=tuple(_quantity(one, field, figures) for field in one.fields),
    )


def _quantity(
    one: MapAnalysis, field: FieldAnalysis, figures: Mapping[str, bytes]
) -> QuantitySection:
    captions = _captions(_stem(one, field), field)
    drawn = {name: content for name, content in figures.items() if name in captions}
    words = field_words(field.name)
    reasons = () if field.knows_nothing else field.rebuilt.verdict.reasons
    return QuantitySection(
        title=words[:1].upper() + words[1:],
        answer=field_answer(field),
        reasons=tuple(printable(reason) for reason in reasons),
        notes=tuple(printable(note) for note in field.rebuilt.placed.remarks),
        figures=captioned(drawn, captions),
        tables=quantity_tables(field),
    )


def _captions(stem: str, field: FieldAnalysis) -> dict[str, Caption]:
    words = field_words(field.name)
    text = (
        "The points as they count; of the map nothing can be said."
        if field.knows_nothing
        else "Rows: the map rebuilt from the points, the mapping system's own (if exported), the "
        "uncertainty, the velocity of activation."
    )
    return {
        f"{stem}.png": Caption(
            f"{words[:1].upper()}{words[1:]} on the surface", text, "The surface from four sides."
        ),
        f"{stem}_support.png": Caption(
            "What the points support",
            "The finest wavelength that the points support at each place. Black: points; grey: "
            "those that could have been left out.",
            "The surface from four sides with the points.",
        ),
        f"{stem}_points.svg": Caption(
            "How many points would have done",
            "Expected error of the mapped part as the points missed least are left out one after "
            "another.",
            "A curve of the expected error, rising as points are left out.",
        ),
    }
