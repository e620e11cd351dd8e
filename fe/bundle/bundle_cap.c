#include "fe/bundle/bundle_cap.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/vec3.h"

enum {
    MAX_ITERATIONS = 20
};

/* A body's nodes at the last station. */
struct part {
    const struct wb_bundle_body *body;
    bool turns_only;  /* directors only rotate */
    double (*arm)[3]; /* (n_nodes) m: from the centre of the straight bundle */
};

/* The state of the cap. */
struct motion {
    double centre[3], velocity[3]; /* m, m/s */
    double turned[4]; /* rotation since creation: a unit quaternion, its real part first */
    double turn[3];   /* rotation in the last step, rad */
    double kinetic;   /* J */
};

struct wb_bundle_cap {
    const struct wb_bundle_bodies *bodies; /* borrowed */
    int n_parts;
    struct part part[WB_BUNDLE_MOST_BODIES];
    double mass;         /* kg, scaled */
    double moment[3][3]; /* S of the straight bundle, kg m2, scaled */
    struct motion motion;
};

/* --- small algebra --- */

static void apply(double m[3][3], const double v[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = wb_vec3_dot(m[i], v);
}

/* Solves m x = v, m symmetric and positive definite. */
static void solve(double m[3][3], const double v[3], double x[3])
{
    double c[3][3];

    for (int i = 0; i < 3; i++)
        wb_vec3_cross(m[(i + 1) % 3], m[(i + 2) % 3], c[i]);
    const double determinant = wb_vec3_dot(m[0], c[0]);
    for (int i = 0; i < 3; i++)
        x[i] = (c[0][i] * v[0] + c[1][i] * v[1] + c[2][i] * v[2]) / determinant;
}

/* sin t / t and (1 - cos t) / t^2. */
static void find_sines(const double turn[3], double *a, double *b)
{
    const double square = wb_vec3_dot(turn, turn), t = sqrt(square);

    if (t < 1e-4) {
        *a = 1.0 - square / 6.0;
        *b = 0.5 - square / 24.0;
        return;
    }
    *a = sin(t) / t;
    *b = 2.0 * pow(sin(0.5 * t) / t, 2.0);
}

static void rotation_of(const double q[4], double out[3][3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double m[3][3] = {
        {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
        {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
        {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)},
    };
    for (int i = 0; i < 9; i++)
        out[i / 3][i % 3] = m[i / 3][i % 3];
}

/* Rotates q by a rotation vector. */
static void rotate_quaternion(double q[4], const double turn[3])
{
    const double t = sqrt(wb_vec3_dot(turn, turn)), c = cos(0.5 * t);
    const double s = t > 1e-8 ? sin(0.5 * t) / t : 0.5;
    const double p[4] = {c, s * turn[0], s * turn[1], s * turn[2]};
    const double product[4] = {
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    };
    double size = 0.0;
    for (int i = 0; i < 4; i++)
        size += product[i] * product[i];
    for (int i = 0; i < 4; i++)
        q[i] = product[i] / sqrt(size);
}

/* R S R^T. */
static void turn_moment(double r[3][3], double s[3][3], double out[3][3])
{
    for (int i = 0; i < 3; i++) {
        double half[3]; /* row i of R S */
        for (int j = 0; j < 3; j++)
            half[j] = r[i][0] * s[0][j] + r[i][1] * s[1][j] + r[i][2] * s[2][j];
        for (int j = 0; j < 3; j++)
            out[i][j] = wb_vec3_dot(half, r[j]);
    }
}

/* --- the motion --- */

/* sum r x (change of r by a rotation), for the next step (direction = 1) or the last one (-1). */
static void angular(double S[3][3], const double turn[3], double direction, double out[3])
{
    const double trace = S[0][0] + S[1][1] + S[2][2];
    double a, b, St[3], gyration[3];

    find_sines(turn, &a, &b);
    apply(S, turn, St);
    wb_vec3_cross(St, turn, gyration);
    for (int i = 0; i < 3; i++)
        out[i] = a * (trace * turn[i] - St[i]) + direction * b * gyration[i];
}

/* The rotation that gives the angular momentum `momentum` (times the step). It is small in one
 * step, so a few iterations suffice. */
static void find_turn(double S[3][3], const double momentum[3], double turn[3])
{
    const double trace = S[0][0] + S[1][1] + S[2][2];
    double J[3][3];

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            J[i][j] = (i == j ? trace : 0.0) - S[i][j];
    solve(J, momentum, turn);
    for (int n = 0; n < MAX_ITERATIONS; n++) {
        double now[3], rest[3], more[3];
        angular(S, turn, 1.0, now);
        for (int i = 0; i < 3; i++)
            rest[i] = momentum[i] - now[i];
        solve(J, rest, more);
        for (int i = 0; i < 3; i++)
            turn[i] += more[i];
        if (!(wb_vec3_dot(more, more) > 1e-30 * wb_vec3_dot(turn, turn)))
            return;
    }
}

/* 1/2 v-.M' v+ of rotation, times the square of the step: (exp(t x) - 1) S (1 - exp(-t x))^T. */
static double turning_energy(double S[3][3], const double before[3], const double after[3])
{
    double A[3][3], B[3][3], sum = 0.0;

    for (int side = 0; side < 2; side++) {
        const double *t = side ? before : after;
        const double square = wb_vec3_dot(t, t), sign = side ? -1.0 : 1.0;
        double spin[3][3] = {{0.0, -t[2], t[1]}, {t[2], 0.0, -t[0]}, {-t[1], t[0], 0.0}};
        double a, b;
        find_sines(t, &a, &b);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                const double twice = t[i] * t[j] - (i == j ? square : 0.0);
                (side ? B : A)[i][j] = a * spin[i][j] + sign * b * twice;
            }
    }
    for (int i = 0; i < 3; i++) {
        double SB[3];
        apply(S, B[i], SB);
        sum += wb_vec3_dot(A[i], SB);
    }
    return 0.5 * sum;
}

static size_t end_of(const struct part *part, int node, int component)
{
    const struct wb_swept_layout *layout = &part->body->layout;
    return (size_t)(3 * node + component) * (size_t)layout->stride + (size_t)layout->n_stations - 1;
}

static void add_loads(const struct part *part, double R[3][3], double force[3], double torque[3])
{
    for (int k = 0; k < part->body->layout.n_nodes; k++) {
        double f[3], r[3], moment[3];
        for (int c = 0; c < 3; c++)
            f[c] = wb_bundle_body_force(part->body, end_of(part, k, c));
        apply(R, part->arm[k], r);
        wb_vec3_cross(r, f, moment);
        for (int c = 0; c < 3; c++) {
            force[c] += part->turns_only ? 0.0 : f[c];
            torque[c] += moment[c];
        }
    }
}

/* Sets the velocities that move all nodes to their new positions. */
static void set_node_velocities(const struct wb_bundle_cap *cap, double R[3][3])
{
    for (int p = 0; p < cap->n_parts; p++) {
        const struct part *part = &cap->part[p];
        for (int k = 0; k < part->body->layout.n_nodes; k++) {
            double r[3];
            apply(R, part->arm[k], r);
            for (int c = 0; c < 3; c++) {
                const size_t at = end_of(part, k, c);
                const double place = r[c] + (part->turns_only ? 0.0 : cap->motion.centre[c]);
                part->body->velocity[at] =
                    (place - part->body->position[at]) / cap->bodies->time_step;
            }
        }
    }
}

void wb_bundle_cap_advance(struct wb_bundle_cap *cap, double half)
{
    struct motion *m = &cap->motion;
    const double dt = cap->bodies->time_step;
    const double gravity = -cap->bodies->gravity / cap->bodies->model->run.mass_scaling;
    double R[3][3], S[3][3], force[3] = {0.0}, torque[3] = {0.0}, momentum[3], next[3];

    rotation_of(m->turned, R);
    turn_moment(R, cap->moment, S);
    for (int p = 0; p < cap->n_parts; p++)
        add_loads(&cap->part[p], R, force, torque);
    angular(S, m->turn, -1.0, momentum);
    for (int i = 0; i < 3; i++)
        momentum[i] += half * dt * dt * torque[i];
    find_turn(S, momentum, next);
    m->kinetic = turning_energy(S, m->turn, next) / (dt * dt);
    for (int i = 0; i < 3; i++) {
        const double before = m->velocity[i];
        m->velocity[i] += half * dt * (force[i] / cap->mass + (i == 1 ? gravity : 0.0));
        m->kinetic += 0.5 * cap->mass * before * m->velocity[i];
        m->centre[i] += dt * m->velocity[i];
        m->turn[i] = next[i];
    }
    rotate_quaternion(m->turned, m->turn);
    rotation_of(m->turned, R);
    set_node_velocities(cap, R);
}

double wb_bundle_cap_kinetic(const struct wb_bundle_cap *cap)
{
    return cap->motion.kinetic;
}

void wb_bundle_cap_stop(struct wb_bundle_cap *cap)
{
    for (int i = 0; i < 3; i++)
        cap->motion.velocity[i] = cap->motion.turn[i] = 0.0;
    cap->motion.kinetic = 0.0;
}

void wb_bundle_cap_visit(struct wb_bundle_cap *cap, struct wb_checkpoint *c)
{
    wb_checkpoint_enter(c, "cap");
    wb_checkpoint_visit_member(c, cap, motion);
    wb_checkpoint_leave(c);
}

/* --- creation --- */

static void list_parts(struct wb_bundle_cap *cap, struct wb_bundle_bodies *bodies)
{
    struct wb_bundle_body *body[WB_BUNDLE_MOST_BODIES];

    cap->bodies = bodies;
    cap->n_parts = wb_bundle_bodies_list(bodies, body);
    for (int p = 0; p < cap->n_parts; p++)
        cap->part[p] = (struct part){body[p], .turns_only = body[p] == &bodies->directors};
}

static void find_arms(struct wb_bundle_cap *cap, double length)
{
    for (int p = 0; p < cap->n_parts; p++) {
        struct part *part = &cap->part[p];
        for (int k = 0; k < part->body->layout.n_nodes && !part->turns_only; k++) {
            const double mass = part->body->node_mass[k] * length;
            cap->mass += mass;
            for (int c = 0; c < 3; c++)
                cap->motion.centre[c] += mass * part->body->position[end_of(part, k, c)];
        }
    }
    for (int c = 0; c < 3; c++)
        cap->motion.centre[c] /= cap->mass;
    for (int p = 0; p < cap->n_parts; p++) {
        struct part *part = &cap->part[p];
        const int n = part->body->layout.n_nodes;
        part->arm = wb_memory_new((size_t)n, sizeof *part->arm);
        for (int k = 0; k < n; k++)
            for (int c = 0; c < 3; c++)
                part->arm[k][c] = part->body->position[end_of(part, k, c)] -
                                  (part->turns_only ? 0.0 : cap->motion.centre[c]);
    }
}

/* M' = beta M - (beta - 1) M 1 1^T M / (1^T M 1), of each body. */
static void find_moment(struct wb_bundle_cap *cap, double length)
{
    const double beta = cap->bodies->model->run.selective;

    for (int p = 0; p < cap->n_parts; p++) {
        const struct part *part = &cap->part[p];
        double mass = 0.0, first[3] = {0.0};
        for (int k = 0; k < part->body->layout.n_nodes; k++) {
            const double m = part->body->node_mass[k] * length;
            mass += m;
            for (int i = 0; i < 3; i++) {
                first[i] += m * part->arm[k][i];
                for (int j = 0; j < 3; j++)
                    cap->moment[i][j] += beta * m * part->arm[k][i] * part->arm[k][j];
            }
        }
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                cap->moment[i][j] -= (beta - 1.0) * first[i] * first[j] / mass;
    }
}

struct wb_bundle_cap *wb_bundle_cap_create(struct wb_bundle_bodies *bodies)
{
    const double length = 0.5 * bodies->spacing * bodies->model->run.mass_scaling;
    struct wb_bundle_cap *const cap = wb_memory_new(1, sizeof *cap);
    cap->motion.turned[0] = 1.0;
    list_parts(cap, bodies);
    find_arms(cap, length);
    find_moment(cap, length);
    wb_bundle_bodies_hold(bodies, bodies->extent.n_stations - 1);
    return cap;
}

void wb_bundle_cap_destroy(struct wb_bundle_cap *cap)
{
    if (!cap)
        return;
    for (int p = 0; p < cap->n_parts; p++)
        free(cap->part[p].arm);
    free(cap);
}
