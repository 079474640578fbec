"""What a fit has found: as a dataset, in words, and as an oil that a scene can use.

- There is no number without a meaning: what the data do not determine is NaN in the dataset and null in JSON, with a
  sentence beside it.
- The intervals are those of the profile likelihood; the covariance stands beside them.
- The oil is the ``[lubricant]`` table of the rig file with the fitted values in it, so that it is read as that one was.
"""

import datetime
import hashlib
import importlib.metadata
import json
import math
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.regimes import LONG_NAMES, NAMES, film_by_regime, groups
from rollslip.campaigns.fit.least_squares import LEVELS, PROFILE_POINTS
from rollslip.catalogue.registry import find
from rollslip.files import whole_file
from rollslip.models import SliceModel
from rollslip.references import KLEBANOV
from rollslip.results.dataset import about, references_of
from rollslip.scene.values import resolved
from rollslip.units import format_quantity
from rollslip_kernels.slices import Slices

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.campaigns.fit.fit import Bench, Fit, Parameter

__all__ = ["as_dict", "dataset_of", "headline", "notes", "parameter_rows", "write_oil"]

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

#: Points of a drawn curve.
CURVE_POINTS: Final = 201
#: Rows belong to one operating point if they differ from the next one by less: K, and shares of load and speed.
_SAME: Final = (1.0, 0.03, 0.03)
#: Probability below which chance is not believed.
_UNLIKELY: Final = 0.01


# Dataset ------------------------------------------------------------------------------------------------------------


def dataset_of(bench: "Bench", fitted: "Fit", wanted: "Sequence[Parameter]", wall_time: float) -> "xr.Dataset":
    """Return what was found about the parameters that were asked for, see `rollslip.campaigns.fit.fit.fit`."""
    import xarray as xr

    fitted_friction = fitted.friction(fitted.estimate.best.x)  # the tables of the bench now hold its film
    film = np.empty(len(bench.data))
    for _, rows, slices in bench.tables:
        film[rows] = slices.film_thickness
    sets = _operating_points(bench)
    c = bench.data.columns
    variables = {
        **_of_parameters(fitted, wanted),
        **_of_searches(fitted),
        "slide_roll_ratio": ("row", c["slide_roll_ratio"], about("1", "slide-roll ratio")),
        "rolling_speed": ("row", c["rolling_speed"], about("m/s", "rolling speed")),
        "load_per_length": ("row", bench.load, about("N/m", "normal force per length")),
        "temperature": ("row", c["temperature"], about("K", "temperature")),
        "film_thickness": ("row", film, about("m", "film thickness")),
        "friction": ("row", c["friction"], about("1", "friction coefficient")),
        "fitted_friction": ("row", fitted_friction, about("1", "fitted friction coefficient")),
        "residual": ("row", c["friction"] - fitted_friction, about("1", "measured less fitted friction")),
        "uncertainty": ("row", fitted.sigma, about("1", "standard deviation of the friction, given or estimated")),
        "operating_point": ("row", _numbered(sets), about("1", "operating point")),
        "line": ("row", np.array(bench.data.lines), about("1", "line of the data file")),
        **_curves(fitted, sets),
    }
    names, used = ([p.name for p in parameters] for parameters in (wanted, fitted.parameters))
    coordinates = {
        "parameter": ("parameter", _texts(names), about("1", "parameter")),
        "with_parameter": ("with_parameter", _texts(names), about("1", "parameter")),
        "fitted_parameter": ("fitted_parameter", _texts(used), about("1", "parameter that the data see")),
        "level": ("level", np.array(LEVELS), about("1", "level of confidence")),
        "side": ("side", _texts(["lower", "upper"]), about("1", "side of an interval")),
    }
    dataset = xr.Dataset(variables, coords=coordinates)
    known = "friction_uncertainty" in c
    dataset.attrs |= {
        "freedom": fitted.estimate.freedom,
        "scatter": float(np.sqrt(np.mean(dataset["residual"].to_numpy() ** 2))),
        "uncertainties": "given" if known else "estimated from the residuals",
        "warnings": json.dumps(_warnings(fitted, sets)),
        "wall_time": wall_time,
    }
    if known:  # otherwise it is a sum of squares without a scale
        dataset.attrs["chi2"] = fitted.estimate.best.chi2
    dataset.attrs |= _provenance(fitted, dataset)
    return dataset


def _texts(values: Any) -> NDArray[Any]:
    return np.array(values, dtype=str)


def _of_parameters(fitted: "Fit", wanted: "Sequence[Parameter]") -> dict[str, Any]:
    """Variables of all parameters; those that were kept have a value and a status only."""
    found, used = fitted.estimate, fitted.parameters
    place = [wanted.index(p) for p in used]
    unit, n, points = "see unit", len(wanted), 2 * PROFILE_POINTS + 1

    def whole(values: Any, *shape: int) -> Array:
        made = np.full((n, *shape), np.nan)
        made[place] = np.array(values, dtype=float).reshape(len(used), *shape)
        return made

    value = np.array([p.start for p in wanted])
    value[place] = fitted.values
    # covariances are of the logarithm, or of the value itself where the sign may change
    size = np.array([1.0 if p.logarithmic else p.size for p in used])
    covariance = np.full((n, n), np.nan)
    covariance[np.ix_(place, place)] = found.covariance * np.outer(size, size)
    error = np.sqrt(np.diag(covariance))
    limits = [p.value(profile.limits) for p, profile in zip(used, found.profiles, strict=True)]
    status = [fitted.kept.get(p.name, "") for p in wanted]
    limit_status = [["not determined"] * 2 for _ in wanted]
    for k, words in zip(place, _words(fitted), strict=True):
        status[k], limit_status[k] = words
    absolute = error * np.array([v if p.logarithmic else 1.0 for p, v in zip(wanted, value, strict=True)])
    determined = np.array([words == "determined" for words in status])
    held = [p.value(profile.x) for p, profile in zip(used, found.profiles, strict=True)]
    return {
        "unit": ("parameter", _texts([p.unit for p in wanted]), about("1", "unit of the parameter")),
        "meaning": ("parameter", _texts([p.doc for p in wanted]), about("1", "what the parameter is")),
        "start_value": ("parameter", [p.start for p in wanted], about(unit, "value before the fit")),
        "value": ("parameter", value, about(unit, "value")),
        "standard_error": (
            "parameter",
            np.where(determined, absolute, np.nan),
            about(unit, "standard error after the covariance"),
        ),
        "interval": (
            ("parameter", "level", "side"),
            whole(limits, len(LEVELS), 2),
            about(unit, "interval of confidence after the profile likelihood"),
        ),
        "status": ("parameter", _texts(status), about("1", "what the data tell")),
        "limit_status": (("parameter", "side"), _texts(limit_status), about("1", "whether the data give a limit")),
        "covariance": (
            ("parameter", "with_parameter"),
            covariance,
            about("1", "covariance of the logarithms, of the values where the sign may change"),
        ),
        "correlation": (
            ("parameter", "with_parameter"),
            covariance / np.outer(error, error),
            about("1", "correlation"),
        ),
        "profile_value": (("parameter", "profile_point"), whole(held, points), about(unit, "value held")),
        "profile_rise": (
            ("parameter", "profile_point"),
            whole([profile.rise for profile in found.profiles], points),
            about("1", "rise of chi2 over the variance"),
        ),
        "rise_limit": ("level", np.array(found.quantiles), about("1", "rise at which an interval ends")),
    }


def _of_searches(fitted: "Fit") -> dict[str, Any]:
    """Variables about where searches ended, and of the principal directions."""
    found = fitted.estimate
    ends = np.full((len(found.others), 2, len(fitted.parameters)), np.nan)
    chi2 = np.full(len(found.others), np.nan)
    for k, one in enumerate(found.others):
        if one is not None:
            ends[k], chi2[k] = [fitted.values_at(one.start), fitted.values_at(one.x)], one.chi2
    return {
        "search_start": (("search", "fitted_parameter"), ends[:, 0], about("see unit", "where a search started")),
        "search_end": (("search", "fitted_parameter"), ends[:, 1], about("see unit", "where it ended")),
        "search_chi2": ("search", chi2, about("1", "sum of squares where it ended")),
        "spread": ("direction", found.spread, about("1", "standard deviation along a principal direction")),
        "direction_part": (
            ("direction", "fitted_parameter"),
            found.directions,
            about("1", "part of a parameter's logarithm in a principal direction"),
        ),
    }


def _words(fitted: "Fit") -> list[tuple[str, list[str]]]:
    """Say of each fitted parameter what the data tell, and of both its limits."""
    found, said = fitted.estimate, []
    for parameter, profile in zip(fitted.parameters, found.profiles, strict=True):
        given = np.isfinite(profile.limits[-1])
        sides = [
            "found" if limit else f"the data give no {side} limit, searched to {parameter.shown(parameter.value(end))}"
            for side, limit, end in zip(("lower", "upper"), given, profile.ends, strict=True)
        ]
        if given.all():
            status = "determined"
        elif given.any():
            status = sides[int(np.argmin(given))]
        else:
            weakest = np.abs(found.directions[int(np.argmax(found.spread))])
            partners = [p.name for p, part in zip(fitted.parameters, weakest, strict=True) if part > 0.1]
            together = f"only a combination of {' and '.join(partners)} is"
            status = f"not determined: {together if len(partners) > 1 else '; '.join(sides)}"
        said.append((status, sides))
    return said


def _operating_points(bench: "Bench") -> list[Indices]:
    """Rows that a rig held at one temperature, load and speed, each set in the order of slip."""
    c = bench.data.columns
    sets = [np.arange(len(bench.data))]
    for values, gap in zip((c["temperature"], np.log(bench.load), np.log(c["rolling_speed"])), _SAME, strict=True):
        parted = []
        for rows in sets:
            ordered = rows[np.argsort(values[rows], kind="stable")]
            parted += np.split(ordered, np.flatnonzero(np.diff(values[ordered]) > gap) + 1)
        sets = parted
    return [rows[np.argsort(c["slide_roll_ratio"][rows], kind="stable")] for rows in sets]


def _numbered(sets: Sequence[Indices]) -> Indices:
    numbers = np.empty(sum(rows.size for rows in sets), dtype=np.intp)
    for k, rows in enumerate(sets):
        numbers[rows] = k
    return numbers


def _curves(fitted: "Fit", sets: Sequence[Indices]) -> dict[str, Any]:
    """The fitted curve of each operating point, at its mean conditions, and these."""
    bench, (lubricant, traction) = fitted.bench, fitted.laws
    chain, c = bench.chain_of(traction), bench.data.columns
    slip, friction = np.empty((len(sets), CURVE_POINTS)), np.empty((len(sets), CURVE_POINTS))
    held = np.empty((3, len(sets)))
    for k, rows in enumerate(sets):
        measured = c["slide_roll_ratio"][rows]
        temperature, speed = float(c["temperature"][rows].mean()), float(c["rolling_speed"][rows].mean())
        slip[k] = np.linspace(min(measured.min(), 0.0), max(measured.max(), 0.0), CURVE_POINTS)
        film = {} if bench.film is not None else {"film_thickness": float(np.median(c["film_thickness"][rows]))}
        slices = Slices(
            CURVE_POINTS,
            bench.conditions(lubricant, temperature),
            load=float(bench.load[rows].mean()),
            rolling_speed=speed,
            sliding_speed=slip[k] * speed,
            **film,
        )
        chain(slices)
        friction[k], held[:, k] = slices.friction, (temperature, slices.pressure[0], speed)
    return {
        "curve_slip": (("point", "curve_point"), slip, about("1", "slide-roll ratio")),
        "curve_friction": (("point", "curve_point"), friction, about("1", "fitted friction coefficient")),
        "point_temperature": ("point", held[0], about("K", "temperature")),
        "point_pressure": ("point", held[1], about("Pa", "mean Hertz pressure")),
        "point_speed": ("point", held[2], about("m/s", "rolling speed")),
    }


# Warnings -----------------------------------------------------------------------------------------------------------


def _warnings(fitted: "Fit", sets: Sequence[Indices]) -> list[str]:
    """Say what a reader of the result has to know."""
    from scipy.special import chdtrc

    bench, found, said = fitted.bench, fitted.estimate, []
    if "friction_uncertainty" in bench.data.columns and chdtrc(found.freedom, found.best.chi2) < _UNLIKELY:
        said.append(
            f"the model does not fit the data within their uncertainties (chi2 {found.best.chi2:.4g} at "
            f"{found.freedom} degrees of freedom): values and intervals hold only as far as it does"
        )
    chance = _chance_of_order(found.best.residuals, sets)
    if chance < _UNLIKELY:
        said.append(
            f"the residuals are not random along the curves (probability {chance:.1g}): the model misses something "
            "that the data show, and the intervals, which take the errors for independent, are too narrow"
        )
    said += _other_minima(fitted)
    error = np.sqrt(np.diag(found.covariance))
    bent = [
        p.name
        for p, x, profile, width in zip(fitted.parameters, found.best.x, found.profiles, error, strict=True)
        if np.isfinite(profile.limits[-1]).all() and not np.all(_same_size(profile.limits[0] - x, width))
    ]
    if bent:
        said.append(
            f"the law is far from linear within the intervals of {', '.join(bent)}: what follows from the covariance, "
            "standard error and correlation, does not hold; the intervals do"
        )
    if bench.film is not None and bench.film.regime != "all":
        codes = np.concatenate([film_by_regime(*groups(slices))[1] for _, _, slices in bench.tables])
        outside = float(np.mean(codes != NAMES.index(bench.film.regime)))
        if outside > 0.0:
            said.append(
                f"film model {bench.film.name!r} holds in the {LONG_NAMES[bench.film.regime]} regime, in which "
                f"{outside:.0%} of the rows are not; film 'moes' covers all regimes"
            )
    return said


def _same_size(distances: Array, width: float) -> NDArray[np.bool_]:
    """Whether distances are within a factor of two of the width expected."""
    share = np.abs(distances) / width
    return np.asarray((share > 0.5) & (share < 2.0))


def _other_minima(fitted: "Fit") -> list[str]:
    found = fitted.estimate
    ends = [(one, (one.chi2 - found.best.chi2) / found.scale**2) for one in found.others if one is not None]
    elsewhere = [(one, rise) for one, rise in ends if one.converged and rise > 0.01]
    if not elsewhere:
        return []
    second, rise = min(elsewhere, key=lambda pair: pair[1])
    values = zip(fitted.parameters, fitted.values_at(second.x), strict=True)
    at = ", ".join(f"{p.name} {p.shown(value)}" for p, value in values)
    judged = "which the data do not exclude" if rise < found.quantiles[-1] else "which fits worse"
    return [
        f"{len(elsewhere)} of {len(found.others)} searches ended in another minimum, {judged} (chi2 higher by "
        f"{rise:.3g} variances): {at}"
    ]


def _chance_of_order(residuals: Array, sets: Sequence[Indices]) -> float:
    """Probability that random residuals change their sign along the curves as seldom as these do."""
    from scipy.special import bdtr

    changes = sum(int(np.count_nonzero(np.diff(residuals[rows] > 0.0))) for rows in sets)
    return float(bdtr(changes, sum(rows.size - 1 for rows in sets), 0.5))


# Origin -------------------------------------------------------------------------------------------------------------


def _provenance(fitted: "Fit", dataset: "xr.Dataset") -> dict[str, Any]:
    bench = fitted.bench
    models, oil, rig = bench.models, bench.lubricant, bench.rig
    offers = {kind: find(kind, model.name) for kind, model in models.items()}
    used = list(offers.values()) + ([] if rig.lubricant.name is None else [find("lubricant", rig.lubricant.name)])
    packages = {offer.package: offer.version for offer in used}
    packages |= {name: importlib.metadata.version(name) for name in ("rollslip", "numpy", "scipy", "xarray")}
    described = [
        {
            "kind": kind,
            "name": model.name,
            "package": offers[kind].package,
            "version": offers[kind].version,
            "equation": model.equation,
            "references": references_of(model),
            "parameters": repr(model),
        }
        for kind, model in models.items()
    ]
    law = oil.pressure_viscosity_law
    cited = [text for model in (*models.values(), law) for text in references_of(model)]
    asked = json.dumps([resolved(rig), described, bench.data.sha256, list(dataset["parameter"].values)], sort_keys=True)
    return {
        "study": "fit",
        "title": rig.title,
        "source": bench.data.source,
        "data": bench.data.text,
        "data_sha256": bench.data.sha256,
        "rig": rig.text,
        "rig_resolved": json.dumps(resolved(rig)),
        "scene_hash": hashlib.sha256(asked.encode()).hexdigest(),
        "packages": json.dumps(dict(sorted(packages.items())) | {"python": sys.version.split()[0]}),
        "models": json.dumps(described),
        "lubricant": json.dumps({"name": oil.name, "source": oil.source, "pressure_viscosity_law": repr(law)}),
        "citations": json.dumps(list(dict.fromkeys([KLEBANOV, *cited, *oil.references]))),
        "evaluations": bench.evaluated,
        "created": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        **_tables(fitted, dataset),
    }


# Oil ----------------------------------------------------------------------------------------------------------------


def write_oil(dataset: "xr.Dataset", path: str | os.PathLike[str]) -> None:
    """Write the fitted oil as a TOML file with a table ``[lubricant]``, ready for a scene.

    If parameters of the traction model were fitted, the file has a table ``[models.traction]`` too.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result of `rollslip.fit`.
    path : str or path
        The file; it appears whole or not at all.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    lines = [f"# Fitted to {dataset.attrs['source']}; copy into a scene."]
    lines += [
        f"# {name}: {value}, 95 %: {limits}; {status}" for name, value, _, _, limits, status in parameter_rows(dataset)
    ]
    for key, attribute in (("lubricant", "lubricant_table"), ("models.traction", "traction_table")):
        if attribute in dataset.attrs:
            lines += ["", f"[{key}]"]
            lines += [f"{name} = {_toml(value)}" for name, value in json.loads(dataset.attrs[attribute]).items()]
    with whole_file(Path(path)) as partial:
        partial.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _toml(value: Any) -> str:
    """A value as TOML; numbers with all their digits."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_toml(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False)  # its texts and numbers are TOML's too


def _tables(fitted: "Fit", dataset: "xr.Dataset") -> dict[str, str]:
    """Tables of a scene with what was fitted, as JSON."""
    bench, values = fitted.bench, fitted.values
    oil = {p.key[0]: value / p.unit_value for p, value in zip(fitted.parameters, values, strict=True) if p.of_oil}
    written = resolved(bench.rig.lubricant)
    at = " to ".join(dict.fromkeys(format_quantity(T, "K", 4) for T, *_ in (bench.tables[0], bench.tables[-1])))
    film = "measured film" if bench.film is None else f"film {bench.film.name}"
    found = ", ".join(
        f"{name} {value} (95 %: {limits}; {status})" for name, value, _, _, limits, status in parameter_rows(dataset)
    )
    source = (
        f"Fitted by rollslip {importlib.metadata.version('rollslip')} to {Path(bench.data.source).name} (sha256 "
        f"{bench.data.sha256}) with traction {bench.traction.name} and {film} at {at}: {found}."
    )
    source = " ".join(filter(None, (str(written.get("source", "")), source)))
    tables = {"lubricant_table": json.dumps({**written, **oil, "source": source})}
    if not all(p.of_oil for p in fitted.parameters):
        tables["traction_table"] = json.dumps(_model_table(fitted.laws[1]))
    return tables


def _model_table(model: SliceModel) -> dict[str, object]:
    """A model as a scene writes it."""
    made: dict[str, object] = {"model": model.name}
    for attribute in getattr(model, "__attrs_attrs__", ()):
        value = getattr(model, attribute.name)
        if attribute.metadata.get("key", attribute.name) is not None:  # what the oil puts in is no key
            made[attribute.name] = _model_table(value) if isinstance(value, SliceModel) else value
    return made


# Words --------------------------------------------------------------------------------------------------------------


def headline(dataset: "xr.Dataset") -> str:
    """Return the first line about a fit: version, data and hash, models with their packages."""
    a = dataset.attrs
    models = ", ".join(
        f"{model['kind']} {model['name']} ({model['package']} {model['version']})" for model in json.loads(a["models"])
    )
    return f"rollslip {json.loads(a['packages'])['rollslip']} | {a['source']} {a['data_sha256'][:12]} | {models}"


def parameter_rows(dataset: "xr.Dataset") -> list[tuple[str, ...]]:
    """Return rows of parameter, value, standard error, 68 % and 95 % interval and status."""
    rows = []
    for name in dataset["parameter"].values:
        one = dataset.sel(parameter=name)
        unit, value, error = one["unit"].item(), float(one["value"]), float(one["standard_error"])
        share = f"{100 * error / abs(value):.2g} %" if value else format_quantity(error, unit, 2)
        intervals = (_interval(limits, unit) for limits in one["interval"].values)
        rows.append(
            (
                str(name),
                format_quantity(value, unit, 4),
                "-" if math.isnan(error) else share,
                *intervals,
                one["status"].item(),
            )
        )
    return rows


def _interval(limits: Array, unit: str) -> str:
    low, high = ("" if math.isnan(limit) else format_quantity(float(limit), unit, 4) for limit in limits)
    if low and high:
        number, _, same = low.partition(" ")
        return f"{number if high.endswith(f' {same}') else low} to {high}"
    return f"above {low}" if low else f"below {high}" if high else "none"


def notes(dataset: "xr.Dataset") -> list[str]:
    """Return what the table does not say: the scatter and the strongest correlations."""
    a = dataset.attrs
    largest = float(np.abs(dataset["friction"]).max())
    chi2 = f", chi2 {a['chi2']:.4g}" if "chi2" in a else ""
    points = f"{dataset.sizes['point']} operating point{'s' * (dataset.sizes['point'] > 1)}"
    said = [
        f"{dataset.sizes['row']} rows at {points}, {a['freedom']} degrees of freedom"
        f"{chi2}; residuals of {a['scatter']:.3g}, {a['scatter'] / largest:.2%} of the largest friction; uncertainties "
        f"{a['uncertainties']}"
    ]
    names, correlation = dataset["parameter"].values, dataset["correlation"].to_numpy()
    pairs = [(i, j) for i in range(names.size) for j in range(i) if math.isfinite(correlation[i, j])]
    if pairs:
        strongest = sorted(pairs, key=lambda pair: -abs(correlation[pair]))[:3]
        said.append(
            "correlation: " + ", ".join(f"{names[j]} with {names[i]} {correlation[i, j]:.3f}" for i, j in strongest)
        )
    return said


def as_dict(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return a fit as plain values; a value without meaning is null, with its status beside it."""
    a = dataset.attrs
    parameters = {}
    for name in dataset["parameter"].values:
        one = dataset.sel(parameter=name)
        levels = dict(zip(("68 %", "95 %"), one["interval"].values, strict=True))
        parameters[str(name)] = {
            "unit": one["unit"].item(),
            "meaning": one["meaning"].item(),
            "value": float(one["value"]),
            "start_value": float(one["start_value"]),
            "standard_error": _or_none(one["standard_error"]),
            "status": one["status"].item(),
            **{f"interval {level}": [_or_none(limit) for limit in limits] for level, limits in levels.items()},
            "limit_status": dict(zip(("lower", "upper"), map(str, one["limit_status"].values), strict=True)),
            "correlation": {
                str(other): _or_none(value)
                for other, value in zip(dataset["with_parameter"].values, one["correlation"], strict=True)
            },
        }
    return {
        "rollslip": json.loads(a["packages"])["rollslip"],
        "data": a["source"],
        "data_sha256": a["data_sha256"],
        "models": {model["kind"]: model["name"] for model in json.loads(a["models"])},
        "rows": dataset.sizes["row"],
        "operating_points": dataset.sizes["point"],
        "freedom": int(a["freedom"]),
        "chi2": float(a["chi2"]) if "chi2" in a else None,
        "scatter": float(a["scatter"]),
        "uncertainties": a["uncertainties"],
        "parameters": parameters,
        "spread": [_or_none(value) for value in dataset["spread"]],
        "warnings": json.loads(a["warnings"]),
        "evaluations": int(a["evaluations"]),
        "wall_time": float(a["wall_time"]),
    }


def _or_none(value: Any) -> float | None:
    number = float(value)
    return number if math.isfinite(number) else None
