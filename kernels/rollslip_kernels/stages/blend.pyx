"""Blend of two traction models by the share of the load that asperities carry; the formulas are in stages/blend.h."""

import sys

from cpython.pycapsule cimport PyCapsule_GetPointer

from rollslip_abi cimport ROLLSLIP_MODEL, rs_evaluate, rs_model
from rollslip_blocks cimport TERMS, blend_params, rs_active_blocks
from rollslip_stage cimport rs_new_model


cdef bint _raises(capsule) except -1:
    """Whether a stage runs Python, which may raise on a slice that it was not needed for."""
    cdef const rs_model *model = <const rs_model *>PyCapsule_GetPointer(capsule, ROLLSLIP_MODEL)
    if model.evaluate != rs_active_blocks().blend:
        chain = sys.modules.get("rollslip_kernels.chain")  # who makes such stages
        return chain is not None and chain.runs_python(capsule)
    cdef const blend_params *q = <const blend_params *>model.params
    return q.boundary_raises or q.hydrodynamic_raises


cdef object _new(boundary, hydrodynamic, rs_evaluate fraction, tuple law):
    """Stage that blends two capsules by a share law; they live as long as it does."""
    cdef blend_params q
    cdef int k
    q.boundary = (<rs_model *>PyCapsule_GetPointer(boundary, ROLLSLIP_MODEL))[0]
    q.hydrodynamic = (<rs_model *>PyCapsule_GetPointer(hydrodynamic, ROLLSLIP_MODEL))[0]
    q.boundary_raises, q.hydrodynamic_raises = _raises(boundary), _raises(hydrodynamic)
    q.fraction = fraction
    for k in range(<int>len(law)):
        q.law[k] = law[k]
    return rs_new_model(rs_active_blocks().blend, &q, sizeof(q), (boundary, hydrodynamic))


def power(boundary, hydrodynamic, double boundary_limit, double hydrodynamic_limit, double exponent):
    """Return the stage that blends two capsules by a power of the film parameter between two limits."""
    law = boundary_limit, hydrodynamic_limit, exponent
    return _new(boundary, hydrodynamic, rs_active_blocks().power_fraction, law)


def exponential(boundary, hydrodynamic, double reach, double factor, double exponent):
    """Return the stage that blends two capsules by exp(-factor Lambda^exponent), 0 from ``reach`` on."""
    return _new(boundary, hydrodynamic, rs_active_blocks().exponential_fraction, (reach, factor, exponent))


def greenwood_tripp(boundary, hydrodynamic, double reach, double coefficient, series: Sequence[float]):
    """Return the stage that blends two capsules by the pressure on asperities, 0 from ``reach`` on."""
    if len(series) != TERMS:
        raise ValueError(f"the series of the integral has {TERMS} terms, not {len(series)}")
    return _new(boundary, hydrodynamic, rs_active_blocks().greenwood_tripp_fraction, (reach, coefficient, *series))
