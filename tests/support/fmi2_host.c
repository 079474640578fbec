/* A host by the types of the standard's headers: host GUID LOAD moves the unit for 50 ms and tells its cage speed. */
#include <stdio.h>
#include <stdlib.h>
#include <stdarg.h>
#include "fmi2Functions.h"
static void logger(fmi2ComponentEnvironment e, fmi2String who, fmi2Status s, fmi2String about, fmi2String text, ...) {
    va_list more;
    (void)e, va_start(more, text), printf("%s %d %s ", who, (int)s, about), vprintf(text, more), va_end(more), puts("");
}
int main(int n, char **given) {
    fmi2CallbackFunctions call = {logger, calloc, free, NULL, NULL};
    fmi2ValueReference beyond = RADIAL_LOAD, asked = CAGE_SPEED;
    fmi2Real load = atof(given[2]), speed, time = 0.0;
    fmi2Component unit = fmi2Instantiate("host", fmi2CoSimulation, given[1], "", &call, fmi2False, fmi2False);
    if (n < 3 || !unit || fmi2SetupExperiment(unit, fmi2False, 0.0, 0.0, fmi2False, 0.0) != fmi2OK) return 1;
    if (fmi2EnterInitializationMode(unit) != fmi2OK || fmi2SetReal(unit, &beyond, 1, &load) != fmi2OK) return 2;
    if (fmi2ExitInitializationMode(unit) != fmi2OK) return 3;
    for (int k = 0; k < 50; k++, time += 1e-3)
        if (fmi2DoStep(unit, time, 1e-3, fmi2True) != fmi2OK) return 4;
    if (fmi2GetReal(unit, &asked, 1, &speed) != fmi2OK) return 5;
    if (fmi2GetReal(unit, &(fmi2ValueReference){99}, 1, &time) != fmi2Error) return 6;
    fmi2Terminate(unit), fmi2FreeInstance(unit);
    printf("%.17g", speed);
    return 0;
}
