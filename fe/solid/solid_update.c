#include "fe/solid/solid_update.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"

/* Change of v when rotated by the rotation vector w (Rodrigues); `change` may be v. */
static void find_turn(const double w[3], const double v[3], double change[3])
{
    const double angle2 = wb_vec3_dot(w, w), angle = sqrt(angle2);
    /* sin a / a and (1 - cos a) / a^2 */
    const double s = angle < 1e-4 ? 1.0 - angle2 / 6.0 : sin(angle) / angle;
    const double half = angle < 1e-4 ? 1.0 : sin(0.5 * angle) / (0.5 * angle);
    const double c = 0.5 * half * half;
    double once[3], twice[3];

    wb_vec3_cross(w, v, once);
    wb_vec3_cross(w, once, twice);
    for (int i = 0; i < 3; i++)
        change[i] = s * once[i] + c * twice[i];
}

/* v rotated by w; out may be v. */
static void turn(const double w[3], const double v[3], double out[3])
{
    double change[3];

    find_turn(w, v, change);
    for (int i = 0; i < 3; i++)
        out[i] = v[i] + change[i];
}

void wb_solid_update_init(struct wb_solid_update *update, const struct wb_solid_mesh *mesh)
{
    *update = (struct wb_solid_update){.mesh = mesh};
    if (mesh->n_axis < 2)
        return;

    const double start = mesh->node[mesh->axis[0]][0];
    const double length = mesh->node[mesh->axis[mesh->n_axis - 1]][0] - start;
    const int n = mesh->n_axis;
    update->first = wb_memory_new((size_t)n + 2, sizeof *update->first);
    update->node = wb_memory_new((size_t)mesh->n_nodes, sizeof *update->node);
    update->section = wb_memory_new((size_t)n, sizeof *update->section);
    update->n_sections = n;

    /* Counting sort by section; first[s + 1] is the next index of section s, finally its end. */
    for (int pass = 0; pass < 2; pass++)
        for (int a = 0; a < mesh->n_nodes; a++) {
            const int s = (int)lround((mesh->node[a][0] - start) / length * (n - 1));
            if (pass == 0)
                update->first[s + 1]++;
            else
                update->node[update->first[s]++] = a;
            if (pass == 0 && a == mesh->n_nodes - 1)
                for (int k = 0; k < n; k++)
                    update->first[k + 1] += update->first[k];
        }
    for (int s = n; s > 0; s--)
        update->first[s] = update->first[s - 1];
    update->first[0] = 0;
}

void wb_solid_update_release(struct wb_solid_update *update)
{
    free(update->first);
    free(update->node);
    free(update->section);
    *update = (struct wb_solid_update){0};
}

/* Mean of a vector field (3 n_nodes) over a section's nodes; with `positions` of X + u. */
static void mean(const struct wb_solid_update *update, int s, const double *field, bool positions,
                 double result[3])
{
    result[0] = result[1] = result[2] = 0.0;
    for (int k = update->first[s]; k < update->first[s + 1]; k++) {
        const int a = update->node[k];
        for (int i = 0; i < 3; i++)
            result[i] += field[3 * a + i] + (positions ? update->mesh->node[a][i] : 0.0);
    }
    for (int i = 0; i < 3; i++)
        result[i] /= update->first[s + 1] - update->first[s];
}

static void offset(const struct wb_solid_update *update, int a, const double *u,
                   const double centre[3], double r[3])
{
    for (int i = 0; i < 3; i++)
        r[i] = update->mesh->node[a][i] + u[3 * a + i] - centre[i];
}

/* Solves (sum |r|^2 I - r r^T) w = moment. */
static void solve_rotation(const double J[6], const double moment[3], double w[3])
{
    const double A[3][3] = {{J[0], J[3], J[5]}, {J[3], J[1], J[4]}, {J[5], J[4], J[2]}};
    double minor[3];

    wb_vec3_cross(A[1], A[2], minor);
    const double determinant = wb_vec3_dot(A[0], minor);
    for (int k = 0; k < 3; k++) {
        wb_vec3_cross(A[(k + 1) % 3], A[(k + 2) % 3], minor);
        w[k] = wb_vec3_dot(moment, minor) / determinant;
    }
}

static void add_inertia(const double r[3], double J[6])
{
    J[0] += r[1] * r[1] + r[2] * r[2];
    J[1] += r[0] * r[0] + r[2] * r[2];
    J[2] += r[0] * r[0] + r[1] * r[1];
    J[3] -= r[0] * r[1];
    J[4] -= r[1] * r[2];
    J[5] -= r[2] * r[0];
}

/* Change of a vector v that rotates by w and grows by `growth`, which includes the linear part of
 * the rotation. Only changes are summed: added to positions, small changes would lose digits. */
static void change_vector(const double w[3], const double v[3], const double growth[3],
                          double change[3])
{
    double linear[3], stretched[3], turned[3];

    wb_vec3_cross(w, v, linear);
    for (int i = 0; i < 3; i++)
        stretched[i] = v[i] + growth[i] - linear[i];
    find_turn(w, stretched, turned);
    for (int i = 0; i < 3; i++)
        change[i] = growth[i] - linear[i] + turned[i];
}

void wb_solid_update_advance(struct wb_solid_update *update, double *u, const double *increment,
                             double scale)
{
    const struct wb_solid_mesh *mesh = update->mesh;
    double mean_before[3] = {0};

    if (update->n_sections == 0) {
        for (int i = 0; i < 3 * mesh->n_nodes; i++)
            u[i] += scale * increment[i];
        return;
    }
    for (int s = 0; s < update->n_sections; s++) {
        struct wb_solid_update_section *section = &update->section[s];
        double J[6] = {0}, moment[3] = {0}, step[3];

        mean(update, s, u, true, section->centre);
        mean(update, s, increment, false, step);
        for (int k = update->first[s]; k < update->first[s + 1]; k++) {
            const int a = update->node[k];
            double r[3], arm[3];
            offset(update, a, u, section->centre, r);
            wb_vec3_cross(r, increment + 3 * a, arm);
            for (int i = 0; i < 3; i++)
                moment[i] += scale * arm[i];
            add_inertia(r, J);
        }
        solve_rotation(J, moment, section->rotation);

        /* The chord from the previous section rotates by the mean rotation of its two ends. */
        for (int i = 0; i < 3; i++)
            section->shift[i] = scale * step[i];
        if (s > 0) {
            const struct wb_solid_update_section *before = section - 1;
            double w[3], chord[3], growth[3];
            for (int i = 0; i < 3; i++) {
                w[i] = 0.5 * (before->rotation[i] + section->rotation[i]);
                chord[i] = section->centre[i] - before->centre[i];
                growth[i] = scale * (step[i] - mean_before[i]);
            }
            change_vector(w, chord, growth, section->shift);
            for (int i = 0; i < 3; i++)
                section->shift[i] += before->shift[i];
        }
        memcpy(mean_before, step, sizeof mean_before);

        for (int k = update->first[s]; k < update->first[s + 1]; k++) {
            const int a = update->node[k];
            double r[3], growth[3], change[3];
            offset(update, a, u, section->centre, r);
            for (int i = 0; i < 3; i++)
                growth[i] = scale * (increment[3 * a + i] - step[i]);
            change_vector(section->rotation, r, growth, change);
            for (int i = 0; i < 3; i++)
                u[3 * a + i] += section->shift[i] + change[i];
        }
    }
}

/* Finite rotation from a section's offsets at `before` to those at `now`, by least squares:
 * Gauss-Newton on the rotation vector, starting from zero. */
static void find_rotation(const struct wb_solid_update *update, int s, const double *before,
                          const double *now, double w[3])
{
    double from[3], to[3];

    mean(update, s, before, true, from);
    mean(update, s, now, true, to);
    w[0] = w[1] = w[2] = 0.0;
    for (int pass = 0; pass < 4; pass++) {
        double J[6] = {0}, moment[3] = {0}, more[3];
        for (int k = update->first[s]; k < update->first[s + 1]; k++) {
            double r[3], target[3], arm[3];
            offset(update, update->node[k], before, from, r);
            offset(update, update->node[k], now, to, target);
            turn(w, r, r);
            wb_vec3_cross(r, target, arm);
            for (int i = 0; i < 3; i++)
                moment[i] += arm[i];
            add_inertia(r, J);
        }
        solve_rotation(J, moment, more);
        for (int i = 0; i < 3; i++)
            w[i] += more[i];
    }
}

/* now + ratio (now - R(w) before), rotated by ratio w. */
static void continue_vector(const double before[3], const double now[3], const double w[3],
                            double ratio, double next[3])
{
    double carried[3], on[3];

    turn(w, before, carried);
    for (int i = 0; i < 3; i++) {
        on[i] = ratio * w[i];
        carried[i] = now[i] + ratio * (now[i] - carried[i]);
    }
    turn(on, carried, next);
}

void wb_solid_update_extrapolate(struct wb_solid_update *update, const double *before,
                                 const double *now, double ratio, double *next)
{
    const struct wb_solid_mesh *mesh = update->mesh;
    double centre_before[3] = {0};

    if (update->n_sections == 0) {
        for (int i = 0; i < 3 * mesh->n_nodes; i++)
            next[i] = now[i] + ratio * (now[i] - before[i]);
        return;
    }
    for (int s = 0; s < update->n_sections; s++) {
        struct wb_solid_update_section *section = &update->section[s];
        double from[3];

        mean(update, s, before, true, from);
        mean(update, s, now, true, section->centre);
        find_rotation(update, s, before, now, section->rotation);
        for (int i = 0; i < 3; i++)
            section->moved[i] = section->centre[i] + ratio * (section->centre[i] - from[i]);
        if (s > 0) {
            const struct wb_solid_update_section *last = section - 1;
            double w[3], chord_before[3], chord[3];
            for (int i = 0; i < 3; i++) {
                w[i] = 0.5 * (last->rotation[i] + section->rotation[i]);
                chord_before[i] = from[i] - centre_before[i];
                chord[i] = section->centre[i] - last->centre[i];
            }
            continue_vector(chord_before, chord, w, ratio, chord);
            for (int i = 0; i < 3; i++)
                section->moved[i] = last->moved[i] + chord[i];
        }
        memcpy(centre_before, from, sizeof centre_before);

        for (int k = update->first[s]; k < update->first[s + 1]; k++) {
            const int a = update->node[k];
            double r_before[3], r[3];
            offset(update, a, before, from, r_before);
            offset(update, a, now, section->centre, r);
            continue_vector(r_before, r, section->rotation, ratio, r);
            for (int i = 0; i < 3; i++)
                next[3 * a + i] = section->moved[i] + r[i] - mesh->node[a][i];
        }
    }
}
