"""The compiled dimensionless stress laws, elementwise over arrays with NumPy broadcasting.

- The laws are inline functions of rollslip_stress.pxd, so that traction kernels and this module run the same code.
- One loop over a function pointer serves all laws: the call costs a nanosecond or two beside logarithms.
"""
import numpy as np

from rollslip_stress cimport rs_eyring, rs_maxwell_eyring, rs_muraki

ctypedef double (*law_t)(double, double, double) noexcept nogil


cdef object _map(law_t law, object strain_rate, object deborah, object heating):
    arrays = np.broadcast_arrays(*[np.asarray(group, dtype=np.float64) for group in (strain_rate, deborah, heating)])
    result = np.empty(arrays[0].shape)
    cdef const double[::1] sigma, d, phi
    sigma, d, phi = [np.ascontiguousarray(array).reshape(-1) for array in arrays]
    cdef double[::1] out = result.reshape(-1)
    cdef Py_ssize_t i
    with nogil:
        for i in range(out.shape[0]):
            out[i] = law(sigma[i], d[i], phi[i])
    return result


def muraki(strain_rate, deborah, heating):
    """Muraki's closed form with asinh; the same law as rollslip_plugins.stress.muraki_stress."""
    return _map(rs_muraki, strain_rate, deborah, heating)


def maxwell_eyring(strain_rate, deborah, heating):
    """Exact Maxwell-Eyring mean stress; the same law as rollslip_plugins.stress.maxwell_eyring_stress."""
    return _map(rs_maxwell_eyring, strain_rate, deborah, heating)


def eyring(strain_rate, deborah, heating):
    """Heated Eyring stress without elasticity; the same law as rollslip_plugins.stress.eyring_stress."""
    return _map(rs_eyring, strain_rate, deborah, heating)
