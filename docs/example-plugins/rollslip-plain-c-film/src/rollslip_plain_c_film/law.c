/* The law alone: rollslip.h is all it knows of rollslip, and it knows nothing of Python. */
#include "law.h"

#include <math.h>

/* h/R = 1.95 (G U)^(8/11) W^(-1/11), U = eta0 u/(E' R), G = alpha E', W = w/(E' R) */
int ertel_grubin(const rs_slices *slices, const void *params)
{
    const double ER = slices->modulus * slices->radius;
    const double GU_of_speed = slices->pressure_viscosity * slices->viscosity / slices->radius;
    (void)params;
    for (size_t i = 0; i < slices->n; i++) {
        const double GU = GU_of_speed * slices->rolling_speed[i];
        slices->film_thickness[i] = slices->radius * 1.95 * pow(GU, 8.0 / 11.0) * pow(slices->load[i] / ER, -1.0 / 11.0);
    }
    return 0;
}
