"""The compiled dimensionless stress laws, elementwise over arrays with NumPy broadcasting.

The laws are the functions of stages/stress.h, so that traction kernels and this module run the same code.
"""
import numpy as np

from rollslip_blocks cimport rs_active_blocks, rs_stress_law


cdef object _map(rs_stress_law law, object strain_rate, object deborah, object heating):
    arrays = np.broadcast_arrays(*[np.asarray(group, dtype=np.float64) for group in (strain_rate, deborah, heating)])
    result = np.empty(arrays[0].shape)
    cdef const double[::1] sigma, d, phi
    sigma, d, phi = [np.ascontiguousarray(array).reshape(-1) for array in arrays]
    cdef double[::1] out = result.reshape(-1)
    if out.shape[0]:
        with nogil:
            law(out.shape[0], &sigma[0], &d[0], &phi[0], &out[0])
    return result


def muraki(strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike) -> Array:
    """Muraki's closed form with asinh."""
    return _map(rs_active_blocks().muraki_stress, strain_rate, deborah, heating)


def maxwell_eyring(strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike) -> Array:
    """Exact Maxwell-Eyring mean stress."""
    return _map(rs_active_blocks().maxwell_stress, strain_rate, deborah, heating)


def eyring(strain_rate: ArrayLike, deborah: ArrayLike, heating: ArrayLike) -> Array:
    """Heated Eyring stress without elasticity."""
    return _map(rs_active_blocks().eyring_stress, strain_rate, deborah, heating)
