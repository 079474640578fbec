/* A cylindrical roller bearing by its tables: cage and one mean roller in time, without rollslip.  SI units. */
#ifndef BEARING_H
#define BEARING_H
enum {
    B_TIME, B_RADIAL_LOAD, B_INNER_SPEED, B_OUTER_SPEED, B_TEMPERATURE, B_CAGE_SPEED, B_ROLLER_SPEED, B_CAGE_SLIP,
    B_TORQUE, B_OUTER_TORQUE, B_POWER_LOSS, B_DRAG_RESERVE, B_FIRST_CAGE_SLIP, B_INSIDE, B_VALUES
};
/* Inputs and outputs, unknowns, and the tables under one load at one temperature: numbers alone, so that a copy of them
 * is a state that can be restored. */
typedef struct bearing bearing;
unsigned long bearing_size(void);
double *bearing_values(bearing *b);            /* B_VALUES numbers; inputs are set here */
void bearing_init(bearing *b);                 /* inputs of the scene */
void bearing_start(bearing *b);                /* cage at first_cage_slip, rollers between the rings; outputs there */
int bearing_step(bearing *b, double span);     /* 0 if no step of time is short enough; inputs are constant */
void bearing_output(bearing *b);               /* compute the outputs at the inputs that are set */
int bearing_outside(const bearing *b);         /* bits of inputs beyond the tables: 1 load, 2 temperature, 4 speed */
const char *bearing_message(int outside);      /* sentence on these bits */
const char *bearing_guid(void);
#endif
