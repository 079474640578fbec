/* Traction coefficient of a slice: hydrodynamic laws and boundary laws.
 *
 * tau0 and Gamma are those at the mean pressure of the slice: value at ambient pressure plus slope times p.
 * sigma = eta V/(tau0 h), D = eta u/(Gamma b), w = Phi sigma = beta zeta tau0 V, mu = tau0 S/p, and the temperature per
 * heat flux of surfaces and film zeta = flash sqrt(b/u)/(e sqrt(pi)) + h/(12 K_f) */
#ifndef HYDRODYNAMIC
#define HYDRODYNAMIC \
    (COL_rolling_speed | COL_sliding_speed | COL_half_width | COL_pressure | COL_film_thickness | COL_film_viscosity \
     | COL_film_thermoviscosity)
#endif

/* The groups sigma, w, D = eta u/(Gamma b) and sigma/D = V Gamma b/(u tau0 h) for |V| and positive speeds */
static void PATH(groups)(
    const rs_slices *s, double factor, rise_params rise, filled sigma, filled w, filled deborah, filled ramp
) {
    const double *u = s->rolling_speed, *sliding = s->sliding_speed, *half_width = s->half_width;
    const double *film = s->film_thickness, *viscosity = s->film_viscosity, *fall = s->film_thermoviscosity;
    double flash = factor / (s->effusivity * sqrt(RS_PI)), across = 1.0 / (12.0 * s->conductivity);
    double tau0 = s->eyring_stress, elastic = s->shear_modulus / tau0, fluid = 1.0 / tau0, soft = 1.0 / s->shear_modulus;
    size_t n = WHOLE(s->n);
    EACH(i, n) {
        double h = film[i], b = half_width[i], V = fabs(sliding[i]), flow = u[i] * h;
        double inverse = 1.0 / (flow * b), per = b * inverse;   /* one division for b/u, V/h and u/b */
        sigma[i] = fluid * viscosity[i] * (V * (u[i] * per));
        w[i] = fall[i] * RS_FMA(flash, sqrt(b * (h * per)), across * h) * (tau0 * V);
        deborah[i] = soft * viscosity[i] * (u[i] * (flow * inverse));
        ramp[i] = elastic * (b * V) * per;
    }
    if (rise.stress == 0.0 && rise.modulus == 0.0) return;
    const double *pressure = s->pressure;
    EACH(i, n) {   /* from the values at ambient pressure to those of the slice */
        double stress = (tau0 + rise.stress * pressure[i]) / tau0;
        double stiff = (s->shear_modulus + rise.modulus * pressure[i]) / s->shear_modulus;
        sigma[i] /= stress;
        w[i] *= stress;
        deborah[i] /= stiff;
        ramp[i] *= stiff / stress;
    }
}

STAGE(muraki, HYDRODYNAMIC, COL_friction) {
    const double *sliding = s->sliding_speed, *pressure = s->pressure;
    const eyring_params *q = (const eyring_params *)params;
    double *friction = s->friction, tau0 = s->eyring_stress, sigma[BLOCK], w[BLOCK], deborah[BLOCK], ramp[BLOCK];
    double over[BLOCK], under[BLOCK], slope = q->rise.stress;
    size_t n = WHOLE(s->n);
    PATH(groups)(s, q->flash, q->rise, sigma, w, deborah, ramp);
    PATH(muraki_parts)(n, sigma, deborah, w, ramp, over, under);
    EACH(i, n) {
        double factor = pressure[i] > 1e-290 ? tau0 + slope * pressure[i] : RS_INF;   /* refused as not finite: lost digits would show */
        friction[i] = copysign(factor * over[i] / (under[i] * pressure[i]), sliding[i]);
    }
    return 0;
}

STAGE(maxwell_eyring, HYDRODYNAMIC, COL_friction) {
    const eyring_params *q = (const eyring_params *)params;
    const double *sliding = s->sliding_speed, *pressure = s->pressure;
    double *friction = s->friction, tau0 = s->eyring_stress, slope = q->rise.stress;
    double sigma[BLOCK], w[BLOCK], deborah[BLOCK], stress[BLOCK];
    size_t n = WHOLE(s->n);
    PATH(groups)(s, q->flash, q->rise, sigma, w, deborah, stress);
    PATH(maxwell_stress)(n, sigma, deborah, w, stress);
    EACH(i, n) friction[i] = copysign((tau0 + slope * pressure[i]) / pressure[i] * stress[i], sliding[i]);
    return 0;
}

STAGE(eyring, HYDRODYNAMIC, COL_friction) {
    const eyring_params *q = (const eyring_params *)params;
    const double *sliding = s->sliding_speed, *pressure = s->pressure;
    double *friction = s->friction, tau0 = s->eyring_stress, sigma[BLOCK], w[BLOCK], stress[BLOCK], none[BLOCK];
    double slope = q->rise.stress;
    size_t n = WHOLE(s->n);
    PATH(groups)(s, q->flash, q->rise, sigma, w, none, stress);
    PATH(eyring_stress)(n, sigma, w, stress);
    EACH(i, n) friction[i] = copysign((tau0 + slope * pressure[i]) / pressure[i] * stress[i], sliding[i]);
    return 0;
}

/* mu = (-A + B s) exp(-C s) + A, written with expm1 so that small s loses no digits */
STAGE(kragelsky, COL_rolling_speed | COL_sliding_speed, COL_friction) {
    const kragelsky_params *q = (const kragelsky_params *)params;
    const double *u = s->rolling_speed, *sliding = s->sliding_speed;
    double *friction = s->friction, limit = q->limit, rise = q->rise, decay = q->decay;
    double far = 693.0 / decay;   /* beyond it the fast exponential falls no more, and x must not grow */
    size_t n = WHOLE(s->n);
    EACH(i, n) {
        double ratio = fabs(sliding[i]) / u[i], x = ratio > far ? far : ratio;
        double left, gone = rs_expm1_exp_falling(-decay * x, &left);
        friction[i] = copysign(RS_FMA(rise * x, left, -limit * gone), sliding[i]);
    }
    return 0;
}

/* mu = (A + B s) exp(-C s) + D - (A + D) max(0, 1 - s/s0), with expm1 so that small s loses no digits */
STAGE(gupta, COL_rolling_speed | COL_sliding_speed, COL_friction) {
    const gupta_params *q = (const gupta_params *)params;
    const double *u = s->rolling_speed, *sliding = s->sliding_speed;
    double *friction = s->friction, a = q->a, b = q->b, c = q->c, ramp = q->a + q->d, transition = q->transition;
    size_t n = WHOLE(s->n);
    EACH(i, n) {
        double x = fabs(sliding[i]) / u[i], left, gone = rs_expm1_exp(-c * x, &left);
        double reached = x < transition ? x / transition : 1.0, mu = b * x * left + a * gone + ramp * reached;
        friction[i] = sliding[i] > 0.0 ? mu : -mu;
    }
    return 0;
}

STAGE(constant, COL_rolling_speed | COL_sliding_speed, COL_friction) {
    const constant_params *q = (const constant_params *)params;
    const double *u = s->rolling_speed, *sliding = s->sliding_speed;
    double *friction = s->friction, coefficient = q->coefficient, transition = q->transition;
    size_t n = WHOLE(s->n);
    EACH(i, n) friction[i] = coefficient * rs_clamped(sliding[i] / (transition * u[i]), -1.0, 1.0);
    return 0;
}
