"""CVODE through scikit-sundae: the sentence without it, and with it the conformance kit and known solutions."""

import sys

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rollslip import get_model
from rollslip.errors import PluginError
from rollslip.testing import conformance, format_findings


def test_without_its_package_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "sksundae", None)
    monkeypatch.setitem(sys.modules, "sksundae.cvode", None)
    with pytest.raises(
        PluginError, match=r"needs scikit-sundae, .* pip install 'rollslip\[sundials\]', or take"
    ):
        get_model("integrator", "cvode").solver()


@pytest.fixture
def method():
    pytest.importorskip("sksundae")
    return get_model("integrator", "cvode").solver()


def test_it_passes_the_conformance_kit(method):
    findings = conformance(get_model("integrator", "cvode"))
    assert {finding.status for finding in findings} <= {"ok", "skipped"}, format_findings(findings)


def robertson(t, y):
    fast = 1e4 * y[1] * y[2]
    slow = 3e7 * y[1] ** 2
    return np.array([-0.04 * y[0] + fast, 0.04 * y[0] - fast - slow, slow])


def robertson_jacobian(t, y):
    return np.array(
        [
            [-0.04, 1e4 * y[2], 1e4 * y[1]],
            [0.04, -1e4 * y[2] - 6e7 * y[1], -1e4 * y[1]],
            [0.0, 6e7 * y[1], 0.0],
        ]
    )


@pytest.mark.parametrize("jac", [None, robertson_jacobian])
def test_robertsons_kinetics_come_out_as_of_radau(method, jac):
    """y(40) = 0.7158, 9.186e-6, 0.2842 to four digits, as the examples of LSODE and CVODE print it."""
    ours = solve_ivp(
        robertson,
        (0, 40),
        [1.0, 0, 0],
        method=method,
        rtol=1e-8,
        atol=[1e-10, 1e-14, 1e-10],
        jac=jac,
    )
    theirs = solve_ivp(robertson, (0, 40), [1.0, 0, 0], method="Radau", rtol=1e-10, atol=1e-14)
    np.testing.assert_allclose(ours.y[:, -1], theirs.y[:, -1], rtol=1e-6)
    np.testing.assert_allclose(ours.y[:, -1], [0.7158, 9.186e-6, 0.2842], rtol=2e-4)
    assert ours.njev > 0


def test_reading_between_the_steps_does_not_change_them(method):
    def run(dense):
        return solve_ivp(
            lambda t, y: [y[1], -y[0]],
            (0.0, 5.0),
            [0.0, 1.0],
            method=method,
            rtol=1e-9,
            atol=1e-9,
            dense_output=dense,
        )

    plain = run(False)
    read = run(True)
    assert np.array_equal(plain.t, read.t)
    assert np.array_equal(plain.y, read.y)
    times = np.linspace(0.0, 5.0, 301)
    assert np.max(np.abs(read.sol(times)[0] - np.sin(times))) < 1e-6
    np.testing.assert_allclose(read.sol(read.t), read.y, rtol=0, atol=1e-12)


def test_an_error_in_the_rates_comes_out_as_it_is(method):
    class OwnError(Exception):
        pass

    def rates(t, y):
        if t > 1.0:
            raise OwnError("no oil")
        return -y

    with pytest.raises(OwnError, match="no oil"):
        solve_ivp(rates, (0.0, 2.0), [1.0], method=method)
