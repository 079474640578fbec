"""Quantities that laws give beside their columns (`SliceModel.outputs`), as variables of any study's result.

Means by contact force: on each point of the curves of a study, or of each ring where its laws are judged.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array
from rollslip.fields import submodels
from rollslip.models import SliceModel
from rollslip.results.dataset import about
from rollslip.results.words import LAW
from rollslip.studies.answers import LoadedSlices, Variables
from rollslip.studies.study import Study
from rollslip.studies.validity import filled, quantity

if TYPE_CHECKING:
    import xarray as xr


def law_outputs(study: Study, assembly: Assembly, dataset: "xr.Dataset") -> Variables:
    """Return what the laws of a bearing give beside their columns, where a study's result was computed with them.

    A name that the result has already stands with that of its law before it.
    """
    chain = assembly.inner.chain.models
    laws = [law for model in chain for law in (model, *(child for _, child in submodels(model)))]
    laws = [law for law in laws if getattr(law, "outputs", None)]
    if not laws:
        return {}
    curves = None if type(study).loaded_slices is Study.loaded_slices else study.curves_of
    if curves is not None:
        contacts = [*study.loaded_slices(assembly, dataset)]
        groups = [
            [one for one in contacts if one.curve == k] for k in range(dataset.sizes[curves.over])
        ]
        dims: tuple[str, ...] = (curves.over, curves.slip)
    else:
        contacts = study.validity_slices(assembly, dataset)
        groups = [[one for one in contacts if one.ring == ring] for ring in RINGS]
        dims = ("ring", "steady")
        if len(groups[0]) != dataset.sizes.get("steady"):
            dims = ("ring",)
    found = dict[str, tuple[tuple[str, ...], Array, dict[str, str]]]()
    for law in laws:
        for name, (unit, meaning) in law.outputs.items():
            values = np.array([_means(law, name, group, assembly) for group in groups])
            called = f"{law.name.replace('-', '_')}_{name}" if name in dataset.variables else name
            if len(dims) == 1:
                values = values.mean(axis=1) if values.size else np.full(len(groups), np.nan)
            found[called] = dims, values, about(unit, meaning) | {LAW: law.name}
    return found


def _means(
    law: SliceModel, name: str, contacts: Sequence[LoadedSlices], assembly: Assembly
) -> Array:
    """Means of a quantity by force, one for each of the contacts of a ring, (n,); NaN where none is loaded."""
    sums = np.zeros((2, len(contacts)))
    loaded = [k for k, one in enumerate(contacts) if len(one.load)]
    for table in filled(contacts, assembly):
        weighted = table.force * quantity(law, name, table.slices)
        sums[:, loaded] = (
            np.add.reduceat(weighted, table.starts),
            np.add.reduceat(table.force, table.starts),
        )
    with np.errstate(invalid="ignore"):
        means: Array = sums[0] / sums[1]
    return means
