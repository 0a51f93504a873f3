"""openCARP simulations as maps: ``.pts`` and ``.elem``, with ``.dat`` and ``.igb`` at nodes."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from auricle.electroanatomy.formats.igb import read_igb
from auricle.electroanatomy.formats.omissions import Omissions
from auricle.electroanatomy.points import UNITS
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.errors import FormatError
from auricle.surface.reading import read_surface

SYSTEM = "openCARP"


def read_opencarp_map(
    path: Path, *, names: Mapping[str, str] | None = None
) -> ElectroanatomicStudy:
    """Read a surface with its fields; there are no mapping points.

    Parameters
    ----------
    path
        A ``.pts`` or ``.elem``; fields are the ``.dat`` that `read_surface` finds, and
        ``STEM_NAME.igb`` of a single moment.
    names
        OpenEP's name of fields by the name the files give them, as in
        ``{"lat": "local_activation_time"}``. openCARP's files state no units: a field named here
        is taken to be in that of `auricle.electroanatomy.points.UNITS`.

    Raises
    ------
    FormatError
        If the surface or a field cannot be read, or a field of `names` is not there.
    """
    soup = read_surface(path)
    fields = dict(soup.point_fields)
    omissions = Omissions()
    for file in sorted(path.parent.glob(f"{path.stem}_*.igb")):
        series = read_igb(file)
        if series.values.shape[1] != len(soup.vertices):
            raise FormatError(
                f"{file}: holds {series.values.shape[1]:,} values for {len(soup.vertices):,} "
                "vertices: give the surface it belongs to"
            )
        if len(series.values) == 1:
            fields[file.stem[len(path.stem) + 1 :]] = series.values[0]
        else:
            omissions.add("series of several moments left out")
    chosen = dict(names or {})
    absent = sorted(set(chosen) - set(fields))
    if absent:
        raise FormatError(f"{path}: has no field {absent[0]!r}: choose of {sorted(fields)}")
    named = {chosen.get(name, name): np.asarray(values) for name, values in fields.items()}
    units = {name: UNITS[name] for name in chosen.values() if name in UNITS}
    surface = replace(soup, point_fields=named, units={**soup.units, **units}, remarks=())
    found = ElectroanatomicMap("map 1", surface, remarks=soup.remarks + omissions.remarks)
    return ElectroanatomicStudy(SYSTEM, (found,))
