/* The door to Python: a module that hands out the law in the capsule that rollslip.h describes. */
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "law.h"

/* One table for all: the law has no parameters, and a static table lives as long as any capsule. */
static const rs_model MODEL = {ROLLSLIP_ABI, sizeof(rs_slices), ertel_grubin, NULL};

static PyObject *capsule(PyObject *module, PyObject *none)
{
    (void)module, (void)none;
    return PyCapsule_New((void *)&MODEL, ROLLSLIP_MODEL, NULL);
}

static PyMethodDef METHODS[] = {
    {"capsule", capsule, METH_NOARGS, "Return the stage."},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef MODULE = {
    PyModuleDef_HEAD_INIT,
    .m_name = "_kernel",
    .m_doc = "The law of rollslip_plain_c_film.film in C.",
    .m_methods = METHODS,
};

PyMODINIT_FUNC PyInit__kernel(void)
{
    return PyModuleDef_Init(&MODULE);
}
