"""What valgrind runs to count instructions: every compiled stage once, on so many slices.

- ``counted.py FOLDER N``, FOLDER that of the package rollslip_kernels. It prints the names of the stages. The profile
  is dumped before each call of getppid: once for what came before, and then for a call of every stage, the first of
  them on no slices.
- The names of functions do not serve: a compiler may merge them.
- Under valgrind the interpreter is 50 times as slow, so nothing is imported but the kernels.
"""

import ctypes
import math
import os
import sys

sys.path.insert(0, sys.argv[1])

from rollslip_kernels import layout
from rollslip_kernels.stages import blend, contact, film, traction, viscosity

#: Inner contact of the bearing 1032930 at 50 degC.
CONDITIONS = {
    "length": 0.015,
    "radius": 0.006875,
    "modulus": 2.2857e11,
    "roughness": 2.358e-7,
    "effusivity": 12986.0,
    "temperature": 323.15,
    "viscosity": 8.58e-3,
    "pressure_viscosity": 1.074e-8,
    "thermoviscosity": 0.0284,
    "pressure_thermoviscosity": 9.3e-11,
    "conductivity": 0.1425,
    "eyring_stress": 4e6,
    "shear_modulus": 3e8,
}
MARTIN = (4.89497, 1.0, 0.0, -1.0)
BLOK = (1.6663, 2 / 3, 2 / 3, 0.0)
HERREBRUGH = (3.1, 0.6, 0.0, -0.2)
DOWSON = (2.65, 0.7, 0.54, -0.13)

kragelsky = traction.kragelsky(0.1, 22.28, 181.46)
muraki = traction.muraki(0.97)
#: In the order of a chain: each fills what the next ones read. The name is that of the C function.
STAGES = {
    "power_deflection": contact.power_deflection(5.2e10),
    "lundberg_deflection": contact.lundberg_deflection(),
    "hertz_line": contact.hertz_line(),
    "power_film": film.power(*DOWSON),
    "regime_film": film.regime(MARTIN, BLOK, HERREBRUGH, DOWSON),
    "moes_film": film.moes(),
    "roelands": viscosity.roelands(6.315e-5, 1.96e8),
    "barus": viscosity.barus(),
    "kragelsky": kragelsky,
    "eyring": traction.eyring(0.97),
    "maxwell_eyring": traction.maxwell_eyring(0.97),
    "muraki": muraki,
    "blend": blend.power(kragelsky, muraki, 0.01, 1.5, 6.0),
}


def main(n):
    """Call the stages."""
    fields = [("n", ctypes.c_size_t), *((name, ctypes.c_double) for name in layout.CONDITIONS)]
    fields += [(name, ctypes.POINTER(ctypes.c_double)) for name in layout.COLUMNS]
    slices = type("Slices", (ctypes.Structure,), {"_fields_": fields})(n=n, **CONDITIONS)
    column = ctypes.c_double * n
    for name in layout.COLUMNS:
        setattr(slices, name, column())
    for i in range(n):
        slices.approach[i] = 2e-6 * (1.1 + math.sin(0.15 * i))
        slices.rolling_speed[i] = 17.5 + 12.5 * math.sin(0.065 * i)
        slices.sliding_speed[i] = slices.rolling_speed[i] * 0.1 * math.sin(0.21 * i + 0.1)

    pointer = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(
        ("PyCapsule_GetPointer", ctypes.pythonapi)
    )
    evaluate = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
    given = ctypes.addressof(slices)
    calls = []
    for name, capsule in STAGES.items():
        at = pointer(capsule, b"rollslip.slice_model.v1")
        function, parameters = (
            ctypes.c_void_p.from_address(at + offset).value for offset in (8, 16)
        )
        calls.append((evaluate(function), parameters))
        if status := calls[-1][0](given, parameters):  # and so what is done once is done
            sys.exit(f"{name} returns status {status}")
    for k, (function, parameters) in enumerate((calls[0], *calls)):
        slices.n = n if k else 0
        os.getppid()
        function(given, parameters)
    os.getppid()
    print(*STAGES)


main(int(sys.argv[2]))
