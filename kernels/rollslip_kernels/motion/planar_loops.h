/* The loops over rollers of planar_columns.h, which includes them once for each instruction set: RS_SET(name) is the name in
 * the set that is being compiled. */
/* Columns of the rollers, and their angles. */
static void RS_SET(rs_plane_angles)(rs_bearing *p, const double *head, const double *rollers) {
    const size_t n = p->rollers;
    const double per_orbit = 1.0 / p->orbit_radius;
    rs_gather(p, rollers);
    rs_given at = p->unknown[POSITION];
    rs_column small = p->small;
    RS_EACH(j, n) small[j] = at[j] * per_orbit;
    p->cage_cos = cos(head[CAGE_ANGLE]);
    p->cage_sin = sin(head[CAGE_ANGLE]);
    rs_angles(n, p->cage_cos, p->cage_sin, p->pitch_cos, p->pitch_sin, small, p->cosine, p->sine);
}

/* The same, and gaps and speeds at the raceways. */
static void RS_SET(rs_plane_places)(rs_bearing *p, const double *head, const double *rollers) {
    const size_t n = p->rollers;
    const double r = p->roller_radius, Ri = p->inner_radius, Ro = p->outer_radius;
    const double x = head[RING_X], y = head[RING_Y], vx = head[RING_VX], vy = head[RING_VY];
    const double wi = p->inner_speed, wo = p->outer_speed, half = p->half_clearance;
    rs_given w = p->unknown[ORBIT], spin = p->unknown[SPIN], rho = p->unknown[RADIAL], v = p->unknown[RISE];
    rs_given c = p->cosine, s = p->sine;
    rs_column di = p->gap[0], dn = p->gap[1], ri = p->rate[0], ro = p->rate[1];
    rs_column Vi = p->sliding[0], Vo = p->sliding[1], ui = p->rolling[0], uo = p->rolling[1];
    RS_SET(rs_plane_angles)(p, head, rollers);
    RS_EACH(j, n) {
        double along = x * c[j] + y * s[j], across = y * c[j] - x * s[j];
        double drive = vy * c[j] - vx * s[j] - along * w[j];
        double a1 = Ri * (wi - w[j]) + drive, a2 = r * (spin[j] + w[j]), a3 = Ro * (w[j] - wo);
        di[j] = along - half - rho[j];
        dn[j] = rho[j];
        ri[j] = vx * c[j] + vy * s[j] + across * w[j] - v[j];
        ro[j] = v[j];
        Vi[j] = a1 - a2;
        ui[j] = 0.5 * (a1 + a2);
        Vo[j] = a2 - a3;
        uo[j] = 0.5 * (a3 + a2);
    }
}

/* What shapes and forms of the rings make of the gaps, their rates and their slopes. */
static void RS_SET(rs_plane_bent)(rs_bearing *p, const double *head) {
    const size_t Z = p->rollers;
    rs_given c = p->cosine, s = p->sine, w = p->unknown[ORBIT];
    for (size_t n = 1; n <= p->max_order; n++) {
        rs_column cn = p->wave_cos + (n - 1) * Z, sn = p->wave_sin + (n - 1) * Z;
        if (n == 1) {
            RS_EACH(j, Z) { cn[j] = c[j]; sn[j] = s[j]; }
            continue;
        }
        rs_given ca = cn - Z, sa = sn - Z;
        RS_EACH(j, Z) {
            cn[j] = ca[j] * c[j] - sa[j] * s[j];
            sn[j] = sa[j] * c[j] + ca[j] * s[j];
        }
    }
    for (int i = 0; i < 2; i++) {
        const rs_bent_ring *ring = &p->ring[i];
        const size_t m = ring->max_order + 1;
        rs_column gap = p->gap[i], rate = p->rate[i], slope = p->slope[i];
        RS_EACH(j, Z) slope[j] = 0.0;
        if (ring->shapes) {
            const double *q = ring->place, *v = ring->rate;
            rs_ring_waves(ring, head + ring->at, ring->place);
            rs_ring_waves(ring, head + ring->speeds, ring->rate);
            RS_EACH(j, Z) { gap[j] -= q[0]; rate[j] -= v[0]; }
            for (size_t n = 1; n < m; n++) {
                const double a = q[n], b = q[m + n], va = v[n], vb = v[m + n], times = (double)n;
                rs_given cn = p->wave_cos + (n - 1) * Z, sn = p->wave_sin + (n - 1) * Z;
                if (a == 0.0 && b == 0.0 && va == 0.0 && vb == 0.0) continue;
                RS_EACH(j, Z) {
                    gap[j] -= a * cn[j] - b * sn[j];
                    slope[j] += times * (a * sn[j] + b * cn[j]);
                    rate[j] -= va * cn[j] - vb * sn[j];
                }
            }
        }
        if (ring->cells) {
            const double turned = ring->angle ? head[ring->angle] : 0.0;
            const double speed = !ring->angle ? 0.0 : i ? p->outer_speed : p->inner_speed;
            for (size_t j = 0; j < Z; j++) {
                double z, psi = head[CAGE_ANGLE] + p->pitch * (double)j + p->small[j] - turned;
                const double *f = rs_form_cell(ring, psi, &z);
                double own = (f[1] + z * (2.0 * f[2] + z * 3.0 * f[3])) * ring->per_angle;
                gap[j] += f[0] + z * (f[1] + z * (f[2] + z * f[3]));
                slope[j] += own;
                p->passing[i][j] = own * speed;
                rate[j] -= own * speed;
            }
        }
        RS_EACH(j, Z) rate[j] += slope[j] * w[j];
    }
}

/* Torque on the rollers' orbits by what is sloped of the raceways, and what of it turning forms do. */
static void RS_SET(rs_plane_turning)(rs_bearing *p) {
    rs_given Ni = p->force[0], No = p->force[1], si = p->slope[0], so = p->slope[1];
    rs_given pi = p->passing[0], po = p->passing[1];
    rs_column turning = p->turning, driven = p->driven;
    RS_EACH(j, p->rollers) {
        turning[j] = Ni[j] * si[j] + No[j] * so[j];
        driven[j] = Ni[j] * pi[j] + No[j] * po[j];
    }
}

/* Forces without damping of a ring by its table; 1 where a gap lies beyond it. */
static int RS_SET(rs_plane_forces)(rs_bearing *p, int ring) {
    const rs_gap_table *t = &p->table[ring];
    const double per_root = t->per_root, end = (double)t->cells, last = end - 1.0, lowest = p->lowest_drop;
    const double *values = t->values;
    double place[RS_BATCH];
    int beyond = 0;
    for (size_t start = 0; start < p->rollers; start += RS_BATCH) {
        const size_t n = p->rollers - start < RS_BATCH ? p->rollers - start : RS_BATCH;
        rs_given gap = p->gap[ring] + start;
        rs_column to = p->elastic[ring] + start;
        RS_EACH(j, n) {
            double g = gap[j] - lowest;
            place[j] = sqrt(g > 0.0 ? g : 0.0) * per_root;
        }
        for (size_t j = 0; j < n; j++) beyond |= !(place[j] <= end);
        for (size_t j = 0; j < n; j++) {
            int i = (int)(place[j] < last ? place[j] : last);
            const double *a = values + 4 * (size_t)i, z = place[j] - (double)i;
            to[j] = a[0] + z * (a[1] + z * (a[2] + z * a[3]));
        }
    }
    return beyond;
}

/* Forces with damping, w_e g(c d'). */
static void RS_SET(rs_plane_damped)(rs_bearing *p, int ring) {
    const double damping = p->damping;
    rs_given elastic = p->elastic[ring], rate = p->rate[ring];
    rs_column force = p->force[ring];
    RS_EACH(j, p->rollers) {
        double z = damping * rate[j], parting = z < 0.0 ? z : 0.0;
        force[j] = elastic[j] * (1.0 + (z >= 0.0 ? z : parting / (1.0 - parting)));
    }
}

/* Where the rollers are in their pockets; which of them a bar may touch within a time, that is beyond the two reaches. */
static void RS_SET(rs_plane_pockets)(
    rs_bearing *p, const double *head, double time, double reach, double radial_reach, int *touch
) {
    const double x = head[CAGE_X], y = head[CAGE_Y], vx = head[CAGE_VX], vy = head[CAGE_VY], R = p->orbit_radius;
    const double wc = head[CAGE_SPEED];
    rs_given at = p->unknown[POSITION], w = p->unknown[ORBIT], rho = p->unknown[RADIAL], v = p->unknown[RISE];
    rs_given c = p->cosine, s = p->sine;
    rs_column place = p->place, closing = p->closing, height = p->height, rising = p->rising;
    int any = 0;
    RS_EACH(j, p->rollers) {
        double along = x * c[j] + y * s[j], across = y * c[j] - x * s[j];
        closing[j] = R * (w[j] - wc) + along * w[j] - (vy * c[j] - vx * s[j]);
        place[j] = at[j] - across;
        rising[j] = v[j] - (vx * c[j] + vy * s[j]) - across * w[j];
        height[j] = rho[j] - along;
    }
    for (size_t j = 0; j < p->rollers; j++) {
        touch[j] = (!(fabs(place[j]) + time * fabs(closing[j]) <= reach))
            | (!(fabs(height[j]) + time * fabs(rising[j]) <= radial_reach));
        any |= touch[j];
    }
    p->touched = any;
}

/* Whether all rollers stay within the two reaches of their pockets for a time. */
static int RS_SET(rs_plane_clear)(const rs_bearing *p, double time, double reach, double radial_reach) {
    rs_given place = p->place, closing = p->closing, height = p->height, rising = p->rising;
    int any = 0;
    for (size_t j = 0; j < p->rollers; j++)
        any |= (!(fabs(place[j]) + time * fabs(closing[j]) <= reach))
            | (!(fabs(height[j]) + time * fabs(rising[j]) <= radial_reach));
    return !any;
}

/* Tractions as they are in the middle of a step of 2 half, for which speed and spin had the rates `before` [block by
 * block]. */
static void RS_SET(rs_plane_implicit)(rs_bearing *p, const double *head, double half, rs_given before) {
    const double r = p->roller_radius, R = p->orbit_radius, gx = p->gravity_x, gy = p->gravity_y;
    const double m = p->roller_mass, per_J = 1.0 / p->roller_inertia;
    const double x = head[RING_X], y = head[RING_Y], cx = head[CAGE_X], cy = head[CAGE_Y];
    rs_given rho = p->unknown[RADIAL], v = p->unknown[RISE], c = p->cosine, s = p->sine;
    rs_given Ni = p->force[0], No = p->force[1], Si = p->resistance[0], So = p->resistance[1];
    rs_given push = p->push, lift = p->lift, moment = p->moment;
    rs_column w = p->unknown[ORBIT], spin = p->unknown[SPIN], Fi = p->traction[0], Fo = p->traction[1];
    rs_column Vi = p->sliding[0], Vo = p->sliding[1], ui = p->rolling[0], uo = p->rolling[1], di = p->rate[0];
    rs_column dn = p->rate[1];
    rs_given turning = p->turning, si = p->slope[0], so = p->slope[1];
    RS_EACH(j, p->rollers) {
        double ki = rs_friction_slope(&p->linear[0], Ni[j], j), ko = rs_friction_slope(&p->linear[1], No[j], j), ds, dw;
        double along = x * c[j] + y * s[j], across = y * c[j] - x * s[j], radius = R + rho[j];
        double cage_along = cx * c[j] + cy * s[j], cage_across = cy * c[j] - cx * s[j];
        double a = p->inner_radius + along + r, b = p->outer_radius - r, per_I = 1.0 / (m * radius * radius);
        double torque = Fi[j] * a + Si[j] * (a - 2.0 * r) - Ni[j] * across + Fo[j] * b - So[j] * (b + 2.0 * r)
            - push[j] * (R + cage_along) + lift[j] * cage_across + m * (gy * c[j] - gx * s[j]) * radius
            - turning[j];
        double turned = (r * (Fi[j] - Si[j] - Fo[j] - So[j]) - moment[j]) * per_J - before[j * BLOCK + SPIN];
        double orbit_change = torque * per_I - 2.0 * v[j] * w[j] / radius - before[j * BLOCK + ORBIT];
        rs_implicit_change(half, r, a, b, ki, ko, per_J, per_I, turned, orbit_change, &ds, &dw);
        double inside = -a * dw - r * ds, outside = r * ds - b * dw;
        spin[j] += ds;
        w[j] += dw;
        di[j] += (across + si[j]) * dw;
        dn[j] += so[j] * dw;
        Vi[j] += inside;
        Vo[j] += outside;
        ui[j] += 0.5 * inside + r * (ds + dw);
        uo[j] += r * (ds + dw) - 0.5 * outside;
        Fi[j] += ki * inside;
        Fo[j] += ko * outside;
    }
}

/* Rates of the rollers' unknowns, and what they add. */
static void RS_SET(rs_plane_rates)(rs_bearing *p, const double *head) {
    const size_t n = p->rollers;
    const double r = p->roller_radius, Ri = p->inner_radius, Ro = p->outer_radius, R = p->orbit_radius;
    const double m = p->roller_mass, per_m = 1.0 / m, per_inertia = 1.0 / p->roller_inertia;
    const double gx = p->gravity_x, gy = p->gravity_y, wc = head[CAGE_SPEED];
    const double x = head[RING_X], y = head[RING_Y], cx = head[CAGE_X], cy = head[CAGE_Y];
    const double drive_i = Ri * p->inner_speed, drive_o = Ro * p->outer_speed;
    rs_given w = p->unknown[ORBIT], rho = p->unknown[RADIAL], v = p->unknown[RISE], c = p->cosine, s = p->sine;
    rs_given Ni = p->force[0], No = p->force[1], Fi = p->traction[0], Fo = p->traction[1];
    rs_given Si = p->resistance[0], So = p->resistance[1], Vi = p->sliding[0], Vo = p->sliding[1];
    rs_given ui = p->rolling[0], uo = p->rolling[1], di = p->rate[0], dn = p->rate[1];
    rs_given Ei = p->elastic[0], Eo = p->elastic[1], push = p->push, lift = p->lift, moment = p->moment;
    rs_column orbit = p->rate_of[ORBIT], spin = p->rate_of[SPIN], rise = p->rate_of[RISE];
    rs_column position = p->rate_of[POSITION], lifted = p->rate_of[RADIAL];
    rs_column rx = p->added[TO_RING_X], ry = p->added[TO_RING_Y], rings = p->added[TO_WORK_RINGS];
    rs_column gravity = p->added[TO_WORK_GRAVITY], raceways = p->added[TO_WORK_RACEWAYS];
    rs_column lost_i = p->added[TO_LOST_INNER], lost_o = p->added[TO_LOST_OUTER], rolled = p->added[TO_LOST_ROLLING];
    rs_column damped = p->added[TO_LOST_DAMPING], turned = p->added[TO_IMPULSE_RINGS];
    rs_column weighed = p->added[TO_IMPULSE_GRAVITY];
    rs_given turning = p->turning, driven = p->driven;
    RS_EACH(j, n) {
        double along = x * c[j] + y * s[j], across = y * c[j] - x * s[j], radius = R + rho[j], per_radius = 1.0 / radius;
        double cage_along = cx * c[j] + cy * s[j], cage_across = cy * c[j] - cx * s[j];
        double weight = m * (gy * c[j] - gx * s[j]) * radius, heavy = gx * c[j] + gy * s[j];
        double torque = Fi[j] * (Ri + along + r) + Si[j] * (Ri + along - r) - Ni[j] * across
            + Fo[j] * (Ro - r) - So[j] * (Ro + r) - push[j] * (R + cage_along) + lift[j] * cage_across + weight
            - turning[j];
        position[j] = R * (w[j] - wc);
        orbit[j] = (torque * per_radius * per_m - 2.0 * v[j] * w[j]) * per_radius;
        spin[j] = (r * (Fi[j] - Si[j] - Fo[j] - So[j]) - moment[j]) * per_inertia;
        lifted[j] = v[j];
        rise[j] = radius * w[j] * w[j] + (Ni[j] - No[j] - lift[j]) * per_m + heavy;
        gravity[j] = weight * w[j] + m * heavy * v[j];
        weighed[j] = weight;
    }
    RS_EACH(j, n) {
        double on_ring = Fi[j] + Si[j], on_outer = Fo[j] - So[j];
        rx[j] = on_ring * s[j] - Ni[j] * c[j];
        ry[j] = -on_ring * c[j] - Ni[j] * s[j];
        rings[j] = drive_i * on_ring + drive_o * on_outer - driven[j];
        turned[j] = Ri * on_ring + Ro * on_outer - turning[j];
        raceways[j] = -(Ei[j] * di[j] + Eo[j] * dn[j]);
        damped[j] = (Ni[j] - Ei[j]) * di[j] + (No[j] - Eo[j]) * dn[j];
        lost_i[j] = Fi[j] * Vi[j];
        lost_o[j] = Fo[j] * Vo[j];
        rolled[j] = 2.0 * (Si[j] * ui[j] + So[j] * uo[j]);
    }
    if (p->touched) {
        rs_column to_x = p->added[TO_CAGE_X], to_y = p->added[TO_CAGE_Y], torque = p->added[TO_CAGE_TORQUE];
        rs_column work = p->added[TO_WORK_CAGE], lost = p->added[TO_LOST_POCKETS];
        rs_given stored = p->stored, dissipated = p->lost;
        RS_EACH(j, n) {
            to_x[j] = lift[j] * c[j] - push[j] * s[j];
            to_y[j] = lift[j] * s[j] + push[j] * c[j];
            torque[j] = push[j] * R - moment[j];
            work[j] = -stored[j];
            lost[j] = dissipated[j];
        }
    }
}

/* Sums of what the rollers add [ADDED]. */
static void RS_SET(rs_plane_totals)(const rs_bearing *p, double *sums) {
    for (int k = 0; k < ADDED; k++) sums[k] = rs_plane_idle(p, k) ? 0.0 : rs_total(p->added[k], p->rollers);
}

/* Tractions of a ring as they are held. */
static void RS_SET(rs_plane_tractions)(rs_bearing *p, int ring) { rs_linear_tractions(p, ring); }

static const rs_plane_loops RS_SET(rs_plane_loops) = {
    RS_SET(rs_plane_angles), RS_SET(rs_plane_places), RS_SET(rs_plane_forces), RS_SET(rs_plane_damped),
    RS_SET(rs_plane_pockets), RS_SET(rs_plane_clear), RS_SET(rs_plane_tractions), RS_SET(rs_plane_implicit),
    RS_SET(rs_plane_rates), RS_SET(rs_plane_totals), RS_SET(rs_plane_bent), RS_SET(rs_plane_turning)
};
