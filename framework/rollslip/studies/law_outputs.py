"""Quantities that laws compute beside their columns (`SliceModel.outputs`), as variables of any study's result.

They are means weighted by contact force: for each point of the curves of a study, or for each ring at the state where
the validity of its laws is checked.
"""

from collections.abc import Sequence

import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.raceway import RINGS, Array
from rollslip.fields import submodels
from rollslip.models import SliceModel
from rollslip.results.dataset import about, xr
from rollslip.results.text import LAW
from rollslip.studies.answers import LoadedSlices, Variables
from rollslip.studies.study import Study
from rollslip.studies.validity import evaluate_rings, quantity


def law_outputs(study: Study, assembly: Assembly, dataset: "xr.Dataset") -> Variables:
    """Return the quantities that the laws of a bearing compute beside their columns, as means by contact force.

    A quantity whose name the result has already is named with its law before it.

    Parameters
    ----------
    study : Study
        The study that was run.
    assembly : Assembly
        The bearing with which the result was computed.
    dataset : xarray.Dataset
        The result.
    """
    if not (laws := _laws_with_outputs(assembly)):
        return {}
    groups, dims = _contacts_by_group(study, assembly, dataset)
    variables = dict[str, tuple[tuple[str, ...], Array, dict[str, str]]]()
    for law in laws:
        for name, (unit, meaning) in law.outputs.items():
            values = np.array([_force_means(law, name, group, assembly) for group in groups])
            variable = f"{law.name.replace('-', '_')}_{name}" if name in dataset.variables else name
            if len(dims) == 1:
                values = values.mean(axis=1) if values.size else np.full(len(groups), np.nan)
            variables[variable] = dims, values, about(unit, meaning) | {LAW: law.name}
    return variables


def _laws_with_outputs(assembly: Assembly) -> list[SliceModel]:
    """Return the laws of a bearing, submodels included, that have outputs of their own."""
    return [
        law
        for model in assembly.inner.chain.models
        for law in (model, *(child for _, child in submodels(model)))
        if getattr(law, "outputs", None)
    ]


def _contacts_by_group(
    study: Study, assembly: Assembly, dataset: "xr.Dataset"
) -> tuple[list[list[LoadedSlices]], tuple[str, ...]]:
    """Return the loaded slices of each curve, or of each ring, and the dimensions of their means."""
    curves = None if type(study).loaded_slices is Study.loaded_slices else study.curves_of
    if curves is not None:
        contacts = [*study.loaded_slices(assembly, dataset)]
        groups = [
            [item for item in contacts if item.curve == k]
            for k in range(dataset.sizes[curves.over])
        ]
        return groups, (curves.over, curves.slip)
    contacts = study.validity_slices(assembly, dataset)
    groups = [[item for item in contacts if item.ring == ring] for ring in RINGS]
    if len(groups[0]) == dataset.sizes.get("steady"):
        return groups, ("ring", "steady")
    return groups, ("ring",)


def _force_means(
    law: SliceModel, name: str, contacts: Sequence[LoadedSlices], assembly: Assembly
) -> Array:
    """Return means of a quantity by force, one for each of the contacts of a ring, (n,); NaN where none is loaded."""
    sums = np.zeros((2, len(contacts)))
    loaded = [k for k, item in enumerate(contacts) if len(item.load)]
    for table in evaluate_rings(contacts, assembly):
        sums[:, loaded] = (
            np.add.reduceat(table.force * quantity(law, name, table.slices), table.starts),
            np.add.reduceat(table.force, table.starts),
        )
    with np.errstate(invalid="ignore"):
        means: Array = sums[0] / sums[1]
    return means
