/* For kernels: contact law with friction for vectors of points: a penalty on the distance of two
 * points, and an elastic tangential spring returned to Coulomb's limit. */
#ifndef WB_FE_SWEPT_SWEPT_CONTACT_LAW_H
#define WB_FE_SWEPT_SWEPT_CONTACT_LAW_H

#include "fe/material/friction.h"
#include "fe/swept/swept_simd.h"

/* a x b added to out. */
INLINE void add_cross(const vec a[3], const vec b[3], vec out[3])
{
    out[0] += a[1] * b[2] - a[2] * b[1];
    out[1] += a[2] * b[0] - a[0] * b[2];
    out[2] += a[0] * b[1] - a[1] * b[0];
}

INLINE vec positive_part(vec x)
{
    return maximum(x, splat(0));
}

/* Inverse root of a square that may be 0: then a large number, whose product with the square is
 * 0. */
INLINE vec safe_inverse_root(vec square)
{
    return inverse_root(maximum(square, splat((real)1e-30)));
}

INLINE struct wide splat_wide(double x)
{
    struct wide out;
    for (int i = 0; i < PARTS; i++)
        out.of[i] = x - (part){0};
    return out;
}

INLINE void store_wide(double *at, struct wide x)
{
    for (int i = 0; i < PARTS; i++)
        *(part_anywhere *)(at + i * PART_LANES) = x.of[i];
}

/* exp(-x) for x >= 0 with a relative error of 2e-7: powers of two, and a polynomial for 2^f, |f| <=
 * 1/2. */
INLINE vec decay_of(vec x)
{
    const real magic = (real)1.5 * (real)(1LL << MANTISSA);
    const vec power = (real)-1.4426950408889634 * minimum(x, splat(80));
    const vec shifted = power + magic;
    const vec f = power - (shifted - magic), f2 = f * f;
    const vec_bits exponent = ((vec_bits)shifted - (vec_bits)splat(magic)) << MANTISSA;
    const vec low = 1 + (real)6.9314718055994531e-01 * f;
    const vec middle = (real)2.4022650695910071e-01 + (real)5.5504108664821580e-02 * f;
    const vec high = (real)9.6181291076284772e-03 + (real)1.3333558146428443e-03 * f +
                     (real)1.5403530393381610e-04 * f2;

    return (vec)((vec_bits)(low + f2 * (middle + f2 * high)) + exponent);
}

/* Two points whose surfaces may touch; forces act on the first one, per unit of length or area like
 * the stiffnesses. */
struct meeting {
    vec between[3]; /* from the first point to the second */
    vec depth;      /* penetration, 0 if apart */
    vec step[3];    /* change of `between` in this step */
    vec slip[3];    /* relative displacement in this step of the two touching surface points; its
                       normal part is ignored */
    vec turn[3];    /* rotation of the tangent plane in this step */
};

struct contact_law {
    vec normal, tangential;  /* stiffnesses */
    vec compliance;          /* 1 / tangential */
    vec damping;             /* relaxation time / time step */
    vec mu_kinetic, mu_drop; /* mu_k, mu_s - mu_k */
    vec decay;               /* decay / time step */
};

struct contact_energy {
    vec normal, tangential, friction, damping;
};

INLINE void set_friction(struct contact_law *law, const struct wb_friction *friction,
                         double time_step)
{
    law->mu_kinetic = splat((real)friction->mu_kinetic);
    law->mu_drop = splat((real)(friction->mu_static - friction->mu_kinetic));
    law->decay = splat((real)(friction->decay / time_step));
}

/* N = k (depth - tau d(gap)/dt), never tensile. `unit` is the normal, from first to second. */
INLINE vec normal_force(const struct contact_law *law, const struct meeting *at, vec unit[3],
                        struct contact_energy *energy)
{
    const vec inverse = safe_inverse_root(dot(at->between, at->between));

    for (int i = 0; i < 3; i++)
        unit[i] = at->between[i] * inverse;
    const vec opening = dot(unit, at->step);
    const vec elastic = law->normal * at->depth;
    const vec damped = elastic - law->normal * law->damping * opening;
    const vec force = choose(above(at->depth, splat(0)), positive_part(damped), splat(0));
    energy->normal = (real)0.5 * elastic * at->depth;
    energy->damping = (elastic - force) * opening;
    return force;
}

/* Rotates the spring's force `drag` with the tangent plane, adds this step's slip and returns it to
 * mu N. The rounding error of the sum is kept for the next step (Kahan), because the slip of a step
 * may be far below the force's last digit. The dissipated energy is the mean of the forces before
 * and after times the plastic slip: the work of central differences in a step is then the energy
 * stored and dissipated. */
INLINE void friction_force(const struct contact_law *law, const struct meeting *at,
                           const vec unit[3], vec normal, vec drag[3], vec lost[3],
                           struct contact_energy *energy)
{
    vec before[3], slip[3], twice[3] = {splat(0), splat(0), splat(0)};
    vec middle[3], turned[3] = {splat(0), splat(0), splat(0)};

    add_cross(at->turn, drag, twice);
    for (int i = 0; i < 3; i++)
        middle[i] = drag[i] + (real)0.5 * twice[i];
    add_cross(at->turn, middle, turned);
    const vec out_of_plane = dot(drag, unit) + dot(turned, unit), along = dot(at->slip, unit);
    for (int i = 0; i < 3; i++) {
        const vec change = turned[i] - out_of_plane * unit[i];
        slip[i] = at->slip[i] - along * unit[i];
        before[i] = drag[i] + change;
        const vec added = change + law->tangential * slip[i] - lost[i];
        const vec sum = drag[i] + added;
        lost[i] = (sum - drag[i]) - added;
        drag[i] = sum;
    }
    const vec square = dot(slip, slip);
    const vec rate = law->decay * square * safe_inverse_root(square);
    const vec limit = (law->mu_kinetic + law->mu_drop * decay_of(rate)) * normal;
    const vec kept = minimum(limit * safe_inverse_root(dot(drag, drag)), splat(1));
    vec work = splat(0);
    for (int i = 0; i < 3; i++) {
        const vec trial = drag[i];
        drag[i] *= kept;
        lost[i] *= kept;
        work += (before[i] + drag[i]) * trial;
    }
    energy->tangential = (real)0.5 * law->compliance * dot(drag, drag);
    energy->friction = (real)0.5 * law->compliance * (1 - kept) * work;
}

#endif
