"""Slips and reserves of samples from torques at a few slips: against closed forms, and what is done where they fail."""

import json

import numpy as np
import pytest
from scipy.stats import norm

import rollslip
from rollslip_campaigns.sweep.sampling import REPLICATES, probabilities
from rollslip_campaigns.uncertainty import UncertaintySettings, emulation
from rollslip_campaigns.uncertainty.emulator import balance, choose_basis, scales
from rollslip_campaigns.uncertainty.estimators import Estimate, quantile
from rollslip_campaigns.uncertainty.findings import RESERVE, STEADY
from rollslip_campaigns.uncertainty.run import run_uncertainty
from rollslip_studies.motion.loading_branch import branch_slips
from scattered import PLAIN

#: Cage slips of all branches.
SLIPS = branch_slips(0.95)
#: Samples of the synthetic bearings.
SAMPLES = 1024
#: Those of them that are computed as a whole.
WHOLE = 32


def synthetic(seed):
    """Torques T_0 + A S/(S + s) and constant drags of random bearings, (N, P), with their slips and reserves, (N,)."""
    z = norm.ppf(probabilities("replicated-sobol", SAMPLES, 6, seed))
    size = np.exp(0.5 * z[:, 0] + 0.2 * z[:, 1] + 0.1 * z[:, 0] * z[:, 1])
    bend = np.exp(-3.0 + 0.4 * z[:, 2] - 0.3 * z[:, 0] + 0.2 * z[:, 3])
    resistance = 0.02 * np.exp(0.3 * z[:, 4])
    drag = np.exp(-2.5 + 1.2 * z[:, 5])
    few = drag < np.quantile(drag, 0.01)
    drag[few] = -2.0 * resistance[few]  # their cages are driven
    torques = size[:, None] * SLIPS / (SLIPS + bend[:, None]) - resistance[:, None]
    fraction = (drag + resistance) / size
    with np.errstate(divide="ignore", invalid="ignore"):
        slips = np.where(fraction < 1.0, bend * fraction / (1.0 - fraction), np.inf)
        reserves = (size * 0.2 / (0.2 + bend) - resistance) / drag
    slips[slips > SLIPS[-1]] = np.inf
    reserves = np.where(slips <= 0.2, np.maximum(reserves, 1.0), np.minimum(reserves, 1.0))
    reserves[drag < 0.0] = np.inf
    return torques, np.repeat(drag[:, None], SLIPS.size, axis=1), (np.maximum(slips, 0.0), reserves)


def test_balance_has_slip_and_reserve_of_a_closed_form():
    torques, drags, exact = synthetic(0)
    found = balance(SLIPS, torques, drags)
    assert (exact[0] == 0.0).any()
    assert np.isinf(exact[0]).any()
    assert ((exact[0] > 0.2) & (exact[0] < 0.95)).any()
    for values, known, scale in zip(found, exact, scales(), strict=True):
        np.testing.assert_array_equal(np.isinf(values), np.isinf(known))
        np.testing.assert_allclose(scale.forward(values), scale.forward(known), atol=0.02)


def test_reserve_ends_where_a_jump_leads_beyond_the_slip_of_skidding():
    """A torque that rises to 2 at a slip of some 5 %, falls to 1 and regains 2 at 50 % skids from there on."""
    top = SLIPS[SLIPS < 0.05][-1]
    torques = np.interp(SLIPS, [0.0, top, 0.1, 0.5, 0.95], [0.0, 2.0, 1.0, 2.0, 3.0])[None]
    (slip,), (reserve,) = balance(SLIPS, torques, np.full_like(torques, 0.5))
    assert slip == pytest.approx(0.25 * top, rel=1e-2)
    assert reserve == pytest.approx(4.0, rel=0.03)
    (slip,), (reserve,) = balance(SLIPS, torques, np.full_like(torques, 2.5))
    assert slip == pytest.approx(0.725, rel=1e-2)
    assert reserve == pytest.approx(0.8, rel=0.03)
    # a jump to 12 % does not skid, so that the reserve is that at 20 %
    torques = np.interp(SLIPS, [0.0, top, 0.07, 0.12, 0.95], [0.0, 2.0, 1.0, 2.0, 3.0])[None]
    _, (reserve,) = balance(SLIPS, torques, np.full_like(torques, 0.5))
    assert reserve == pytest.approx(2.0 * np.interp(0.2, [0.12, 0.95], [2.0, 3.0]), rel=0.03)


@pytest.mark.parametrize("seed", [1, 2])
def test_quantiles_of_emulated_samples_are_those_of_a_closed_form(seed):
    torques, drags, exact = synthetic(seed)
    whole = tuple(values[:WHOLE] for values in exact)
    basis = choose_basis(SLIPS, torques[:WHOLE], drags[:WHOLE], whole)
    found = balance(
        basis.slips,
        basis.branches(torques[:, np.searchsorted(SLIPS, basis.torque_slips)]),
        drags[:, np.searchsorted(SLIPS, basis.slips)],
    )
    for values, known, scale, error in zip(found, exact, scales(), basis.errors, strict=True):
        difference = (scale.forward(values) - scale.forward(known))[WHOLE:]
        assert np.sqrt(np.mean(difference**2)) < 2.0 * error
        for probability in (0.01, 0.05, 0.5, 0.95, 0.99):
            interval = quantile(known, probability, replicates=REPLICATES)
            scaled = scale.forward(
                np.array(
                    [
                        interval.low,
                        interval.high,
                        interval.value,
                        quantile(values, probability).value,
                    ]
                )
            )
            # at most half of the half width, the standard error of the samples
            assert abs(scaled[3] - scaled[2]) <= max(0.25 * (scaled[1] - scaled[0]), 0.01)


def test_branches_without_a_common_shape_are_refused():
    torques, drags, exact = synthetic(3)
    whole = tuple(values[:WHOLE] for values in exact)
    rough = torques[:WHOLE].copy()
    rough[:, 1:] = rough[:, :1] + (rough[:, 1:] - rough[:, :1]) * np.random.default_rng(
        0
    ).lognormal(sigma=0.5, size=(WHOLE, SLIPS.size - 1))
    assert choose_basis(SLIPS, rough, drags[:WHOLE], whole) is None
    rough = torques[:WHOLE].copy()
    rough[3, -1] = np.nan
    assert choose_basis(SLIPS, rough, drags[:WHOLE], whole) is None
    whole[0][5] = np.nan
    assert choose_basis(SLIPS, torques[:WHOLE], drags[:WHOLE], whole) is None


def test_an_interval_is_widened_by_twice_the_error():
    slip, reserve = scales()
    widened = reserve.widen(Estimate(2.0, 1.5, 2.5), 0.1)
    assert widened.low == pytest.approx(2.0 * np.exp(-np.hypot(np.log(2.0 / 1.5), 0.2)))
    assert widened.high == pytest.approx(2.0 * np.exp(np.hypot(np.log(2.5 / 2.0), 0.2)))
    open_ended = slip.widen(Estimate(0.1, -np.inf, np.inf), 0.1)
    assert (open_ended.low, open_ended.high) == (-np.inf, np.inf)


@pytest.fixture
def few_whole(monkeypatch):
    """Twelve samples are computed as a whole; so few leave a larger error."""
    monkeypatch.setattr(emulation, "WHOLE_SAMPLES", (12,))
    monkeypatch.setattr(emulation, "_MIN_RATIO", 2)


def values_of(found):
    return found["value"].sel(quantity=[RESERVE, STEADY]).to_numpy()


@pytest.mark.slow
def test_emulated_samples_are_those_computed_as_a_whole_whatever_the_engine(few_whole, tmp_path):
    found = rollslip.uncertainty(PLAIN, samples=24)
    assert found["computed"].sel(quantity=STEADY).item() == 12
    assert found["samples"].sel(quantity=STEADY).item() == 24
    assert found.attrs["stop"].startswith("12 of 24 samples computed as a whole")
    assert json.loads(found.attrs["points"]) == {"critical": {"ok": 12}, "torques": {"ok": 12}}

    threads = UncertaintySettings(PLAIN, samples=24, engine="threads").plan()
    run_uncertainty(threads, tmp_path)
    # the second time from the journals alone
    np.testing.assert_array_equal(values_of(run_uncertainty(threads, tmp_path)), values_of(found))

    plain = rollslip.uncertainty(PLAIN, samples=24, plain=True)
    assert "critical slip" in plain["quantity"]
    assert plain["computed"].sel(quantity=STEADY).item() == 24
    for one, other, scale in zip(values_of(found), values_of(plain), scales()[::-1], strict=True):
        np.testing.assert_array_equal(one[:12], other[:12])
        np.testing.assert_allclose(scale.forward(one), scale.forward(other), atol=0.15)


@pytest.mark.slow
def test_all_samples_are_computed_where_the_error_is_large(monkeypatch):
    monkeypatch.setattr(emulation, "WHOLE_SAMPLES", (4,))
    monkeypatch.setattr(emulation, "_MIN_RATIO", 2)
    monkeypatch.setattr(emulation, "basis_of", lambda points: None)
    found = rollslip.uncertainty(PLAIN, samples=8)
    assert found["computed"].sel(quantity=STEADY).item() == 8
    assert json.loads(found.attrs["points"]) == {"critical": {"ok": 8}}
