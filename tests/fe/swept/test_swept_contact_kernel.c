/* The contact kernels compared with a slow twin and with each other, in parts, and across a
 * checkpoint; the bound for the stable step compared with the largest eigenvalue. */
#include "base/vec3.h"
#include "fe/swept/swept_contact.h"
#include "fe/swept/swept_private.h"

#include "tests/fe/swept/contacts.h"

#define WB_LOG_DOMAIN "test"

enum {
    WIRES = 7,
    STATIONS = 37,
    MAX_PAIRS = 16
};

static const double dt = 1e-6;

static uint64_t seed = 1;

static double random_number(void)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-52 - 1.0;
}

/* Seven wires of three diameters around one, bent, twisted and slipped. */
static void make_bundle(struct contacts *c, const struct wb_swept_contact_settings *settings,
                        double depth)
{
    double radius[WIRES];

    for (int w = 0; w < WIRES; w++)
        radius[w] = w == 0 ? 0.7e-3 : 0.698e-3 + 0.002e-3 * (w % 3);
    contacts_init(c, settings, WIRES, radius, STATIONS, 1e-3);
    for (int w = 0; w < WIRES; w++) {
        const double away = w == 0 ? 0.0 : radius[0] + radius[w] - depth, angle = M_PI / 3.0 * w;
        const double y = away * cos(angle), z = away * sin(angle);
        for (int j = 0; j < STATIONS; j++) {
            const double s = 1e-3 * j + 0.4e-3 * w, R = 60e-3;
            double T[3][3];
            contacts_rotation((double[3]){0.1 * w, 0.0, s / R}, T);
            contacts_place(c, w, j, (double[3]){(R - y) * sin(s / R), R - (R - y) * cos(s / R), z},
                           T);
        }
    }
}

static void jitter(struct contacts *c, double size)
{
    for (int w = 0; w < c->n_wires; w++) {
        for (size_t i = 0; i < wb_swept_size(&c->layout); i++)
            c->position[w][i] += size * random_number();
    }
}

/* Drags wires along by different amounts. */
static void slide(struct contacts *c, double size)
{
    for (int w = 0; w < c->n_wires; w++) {
        for (int n = 0; n < CONTACTS_NODES * c->n_stations; n++)
            c->position[w][contacts_index(c, n / c->n_stations, w % 3, n % c->n_stations)] +=
                size * (w - 2);
    }
}

/* ---- The twin: one station of one pair after another, in the simplest form. ---- */

struct twin {
    const struct contacts *c;
    const struct wb_swept_contact_settings *settings;
    bool started;
    double *before[WIRES];
    double drag[WIRES][WIRES][STATIONS][3];
    double *force[WIRES];
    double normal, tangential, friction;
};

/* Gaussian elimination of a positive definite system. */
static void solve3(double A[3][3], const double right[3], double x[3])
{
    double B[3][4];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            B[i][j] = A[i][j];
        B[i][3] = right[i];
    }
    for (int k = 0; k < 3; k++) {
        for (int i = k + 1; i < 3; i++) {
            const double f = B[i][k] / B[k][k];
            for (int j = k; j < 4; j++)
                B[i][j] -= f * B[k][j];
        }
    }
    for (int i = 2; i >= 0; i--) {
        x[i] = B[i][3];
        for (int j = i + 1; j < 3; j++)
            x[i] -= B[i][j] * x[j];
        x[i] /= B[i][i];
    }
}

/* Weights of node k in the least-squares fit value + slope_y y + slope_z z. */
static void weights_of(const struct contacts *c, int w, int k, double weight[3])
{
    double A[3][3] = {{0.0}}, right[3];
    for (int n = 0; n < CONTACTS_SURFACE; n++) {
        const double row[3] = {1.0, 1e3 * c->node[w][n][0], 1e3 * c->node[w][n][1]};
        for (int i = 0; i < 9; i++)
            A[i / 3][i % 3] += row[i / 3] * row[i % 3];
        for (int i = 0; n == k && i < 3; i++)
            right[i] = row[i];
    }
    solve3(A, right, weight);
    weight[1] *= 1e3;
    weight[2] *= 1e3;
}

/* Centre and the section's two vectors. */
static void frame_of(const struct twin *twin, const double *position, int w, int j,
                     double frame[3][3])
{
    memset(frame, 0, 9 * sizeof(double));
    for (int k = 0; k < CONTACTS_SURFACE; k++) {
        double weight[3];
        weights_of(twin->c, w, k, weight);
        for (int i = 0; i < 9; i++)
            frame[i / 3][i % 3] += weight[i / 3] * position[contacts_index(twin->c, k, i % 3, j)];
    }
}

static void inertia(double p[3], double q[3], double J[3][3])
{
    for (int i = 0; i < 9; i++)
        J[i / 3][i % 3] = (i / 3 == i % 3 ? wb_vec3_dot(p, p) + wb_vec3_dot(q, q) : 0.0) -
                          p[i / 3] * p[i % 3] - q[i / 3] * q[i % 3];
}

/* Current centre, its motion and the section's rotation in this step. */
static void motion_of(const struct twin *twin, int w, int j, double now[3], double step[3],
                      double turn[3])
{
    double after[3][3], before[3][3], middle[3][3], J[3][3], work[3], part[3];

    frame_of(twin, twin->c->position[w], w, j, after);
    frame_of(twin, twin->started ? twin->before[w] : twin->c->position[w], w, j, before);
    for (int i = 0; i < 9; i++)
        middle[i / 3][i % 3] = 0.5 * (before[i / 3][i % 3] + after[i / 3][i % 3]);
    memset(work, 0, sizeof work);
    for (int a = 1; a < 3; a++) {
        double change[3];
        for (int i = 0; i < 3; i++)
            change[i] = after[a][i] - before[a][i];
        wb_vec3_cross(middle[a], change, part);
        for (int i = 0; i < 3; i++)
            work[i] += part[i];
    }
    inertia(middle[1], middle[2], J);
    solve3(J, work, turn);
    for (int i = 0; i < 3; i++) {
        now[i] = after[0][i];
        step[i] = after[0][i] - before[0][i];
    }
}

static void motion_between(const struct twin *twin, int w, double place, double now[3],
                           double step[3], double turn[3])
{
    const int j = (int)fmin(place, twin->c->n_stations - 2);
    double a[3][3], b[3][3];
    motion_of(twin, w, j, a[0], a[1], a[2]);
    motion_of(twin, w, j + 1, b[0], b[1], b[2]);
    for (int i = 0; i < 3; i++) {
        const double f = place - j;
        now[i] = (1.0 - f) * a[0][i] + f * b[0][i];
        step[i] = (1.0 - f) * a[1][i] + f * b[1][i];
        turn[i] = (1.0 - f) * a[2][i] + f * b[2][i];
    }
}

static void load_station(struct twin *twin, int w, int j, double share, const double F[3],
                         const double M[3])
{
    double frame[3][3], J[3][3], m[3], part[2][3];
    frame_of(twin, twin->c->position[w], w, j, frame);
    inertia(frame[1], frame[2], J);
    solve3(J, M, m);
    wb_vec3_cross(m, frame[1], part[0]);
    wb_vec3_cross(m, frame[2], part[1]);
    for (int k = 0; k < CONTACTS_SURFACE; k++) {
        double weight[3];
        weights_of(twin->c, w, k, weight);
        for (int i = 0; i < 3; i++)
            twin->force[w][contacts_index(twin->c, k, i, j)] +=
                share * (weight[0] * F[i] + weight[1] * part[0][i] + weight[2] * part[1][i]);
    }
}

static void load_between(struct twin *twin, int w, double place, const double F[3],
                         const double M[3])
{
    const int j = (int)fmin(place, twin->c->n_stations - 2);
    load_station(twin, w, j, 1.0 - (place - j), F, M);
    load_station(twin, w, j + 1, place - j, F, M);
}

/* Slip, spring, limit; `drag` is the force per length on the first wire. */
static void rub(struct twin *twin, double k_t, double length, double N, const double n[3],
                const double slip[3], const double turn[3], double drag[3])
{
    const struct wb_swept_contact_settings *s = twin->settings;
    double turned[3], twice[3], before[3], tangential[3], trial[3];

    wb_vec3_cross(turn, drag, turned);
    wb_vec3_cross(turn, turned, twice);
    for (int i = 0; i < 3; i++)
        before[i] = drag[i] + turned[i] + 0.5 * twice[i];
    const double out = wb_vec3_dot(before, n), along = wb_vec3_dot(slip, n);
    for (int i = 0; i < 3; i++) {
        before[i] -= out * n[i];
        tangential[i] = slip[i] - along * n[i];
        trial[i] = before[i] + k_t * tangential[i];
    }
    const double rate = sqrt(wb_vec3_dot(tangential, tangential)) / dt;
    const double mu = s->friction.mu_kinetic + (s->friction.mu_static - s->friction.mu_kinetic) *
                                                   exp(-s->friction.decay * rate);
    const double size = sqrt(wb_vec3_dot(trial, trial));
    for (int i = 0; i < 3; i++) {
        drag[i] = size > mu * N ? trial[i] * mu * N / size : trial[i];
        twin->friction += length * 0.5 * (before[i] + drag[i]) * (trial[i] - drag[i]) / k_t;
    }
    twin->tangential += length * 0.5 * wb_vec3_dot(drag, drag) / k_t;
}

static void press_point(struct twin *twin, const struct contacts_pair *pair,
                        const struct wb_swept_contact_point *point, int j)
{
    const double end = twin->c->n_stations - 1, half = 0.5 * fabs(point->shift);
    const double middle = fmax(half, fmin(end - half, j));
    const double r[2] = {twin->c->radius[pair->wire[0]], twin->c->radius[pair->wire[1]]};
    double at[2][3], step[2][3], turn[2][3], D[3], n[3], slip[3], F[3], M[3], mean[3], part[3];
    double middle_D[3], lever[3];

    for (int side = 0; side < 2; side++)
        motion_between(twin, pair->wire[side], middle + (side ? 0.5 : -0.5) * point->shift,
                       at[side], step[side], turn[side]);
    for (int i = 0; i < 3; i++) {
        D[i] = at[1][i] - at[0][i];
        slip[i] = step[1][i] - step[0][i];
        middle_D[i] = D[i] - 0.5 * slip[i];
        mean[i] = 0.5 * (turn[0][i] + turn[1][i]);
    }
    const double distance = sqrt(wb_vec3_dot(D, D)), depth = fmax(0.0, r[0] + r[1] - distance);
    const double N = pair->stiffness * depth;
    for (int i = 0; i < 3; i++)
        n[i] = D[i] / distance;
    /* Surface points move with their own wires: c_b - lever_b, c_a + lever_a. */
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < 3; i++)
            lever[i] = middle_D[i] * r[side] / (r[0] + r[1]);
        wb_vec3_cross(turn[side], lever, part);
        for (int i = 0; i < 3; i++)
            slip[i] -= part[i];
    }
    double *drag = twin->drag[pair->wire[0]][pair->wire[1]][j];
    rub(twin, twin->settings->tangential_ratio * pair->stiffness, point->length, N, n, slip, mean,
        drag);
    twin->normal += point->length * 0.5 * N * depth;
    for (int i = 0; i < 3; i++)
        F[i] = point->length * (drag[i] - N * n[i]);
    for (int side = 0; side < 2; side++) {
        double own[3];
        for (int i = 0; i < 3; i++) {
            own[i] = side ? -F[i] : F[i];
            lever[i] = (side ? -1.0 : 1.0) * D[i] * r[side] / (r[0] + r[1]);
        }
        wb_vec3_cross(lever, own, M);
        load_between(twin, pair->wire[side], middle + (side ? 0.5 : -0.5) * point->shift, own, M);
    }
}

static void twin_init(struct twin *twin, const struct contacts *c,
                      const struct wb_swept_contact_settings *settings)
{
    *twin = (struct twin){.c = c, .settings = settings};
    for (int w = 0; w < c->n_wires; w++) {
        twin->before[w] = calloc(wb_swept_size(&c->layout), sizeof(double));
        twin->force[w] = calloc(wb_swept_size(&c->layout), sizeof(double));
        assert_non_null(twin->before[w]);
        assert_non_null(twin->force[w]);
    }
}

static void twin_release(struct twin *twin)
{
    for (int w = 0; w < WIRES; w++) {
        free(twin->before[w]);
        free(twin->force[w]);
    }
}

static void twin_step(struct twin *twin)
{
    const struct contacts *c = twin->c;

    twin->normal = twin->tangential = twin->friction = 0.0;
    for (int w = 0; w < c->n_wires; w++)
        memset(twin->force[w], 0, wb_swept_size(&c->layout) * sizeof(double));
    for (int p = 0; p < wb_swept_contact_pairs(c->contact); p++) {
        struct contacts_pair pair;
        pair = contacts_pair(c, p);
        for (int j = 0; j < c->n_stations; j++) {
            struct wb_swept_contact_point point;
            wb_swept_contact_get_point(c->contact, p, j, &point);
            if (point.gap < 0.3e-3)
                press_point(twin, &pair, &point, j);
        }
    }
    for (int w = 0; w < c->n_wires; w++)
        memcpy(twin->before[w], c->position[w], wb_swept_size(&c->layout) * sizeof(double));
    twin->started = true;
}

/* Largest difference of forces, as part of the largest force. */
static double difference(const struct contacts *c, double *const *force)
{
    double largest = 0.0, worst = 0.0;
    for (int w = 0; w < c->n_wires; w++) {
        for (int n = 0; n < 3 * CONTACTS_NODES * c->n_stations; n++) {
            const int j = n % c->n_stations, i = n / c->n_stations % 3;
            const int k = n / c->n_stations / 3;
            const double f = force[w][contacts_index(c, k, i, j)];
            const double off = fabs(contacts_force(c, w, k, i, j) - f);
            largest = fmax(largest, fabs(f));
            worst = off <= worst ? worst : off;
        }
    }
    assert_true(largest > 1e-3);
    return worst / largest;
}

static void check_against_twin(const struct wb_swept_contact_settings *settings, double tolerance)
{
    struct contacts c;
    struct twin twin;
    double friction = 0.0;

    seed = 5;
    make_bundle(&c, settings, 3e-6);
    twin_init(&twin, &c, settings);
    for (int step = 0; step < 20; step++) {
        contacts_step(&c, dt);
        twin_step(&twin);
        assert_true(difference(&c, twin.force) < tolerance);
        assert_close_relative(c.energies.normal, twin.normal, tolerance);
        assert_close(c.energies.tangential, twin.tangential, tolerance * twin.normal);
        assert_close(c.energies.friction, twin.friction, tolerance * twin.normal);
        friction += twin.friction;
        jitter(&c, 1e-8);
        slide(&c, 1e-7);
    }
    assert_int_equal(wb_swept_contact_pairs(c.contact), 12);
    assert_true(friction > 0.05 * twin.normal && twin.tangential > 0.01 * twin.normal);
    twin_release(&twin);
    contacts_release(&c);
}

static bool has_instructions(enum wb_swept_instructions set)
{
    struct wb_swept_contact_settings settings = contacts_settings();
    static const double radius = 1e-3;
    struct wb_swept_contact *contact = NULL;
    static const int surface[3] = {0, 1, 2};
    static const double node[3][2] = {{1e-3, 0.0}, {0.0, 1e-3}, {-1e-3, 0.0}};
    const struct wb_swept_wire wire = {
        3, 3, surface, node, .radius = radius, .youngs_modulus = 1e9};

    settings.instructions = set;
    wb_log_set_sink(discard_message, NULL);
    const enum wb_status status = wb_swept_contact_create(&contact, &settings, 1, &wire, 4, 1e-3);
    wb_log_set_sink(NULL, NULL);
    assert_true(status == WB_OK || status == WB_ERR_UNSUPPORTED);
    wb_swept_contact_destroy(contact);
    return status == WB_OK;
}

static void every_kernel_agrees_with_the_slow_twin(void **state)
{
    (void)state;
    assert_true(has_instructions(WB_SWEPT_BASELINE));
    assert_false(has_instructions((enum wb_swept_instructions)7));
    for (int set = WB_SWEPT_BASELINE; set <= WB_SWEPT_AVX512; set++) {
        if (!has_instructions((enum wb_swept_instructions)set))
            continue;
        for (int type = 0; type < 2; type++) {
            struct wb_swept_contact_settings settings = contacts_settings();
            settings.instructions = (enum wb_swept_instructions)set;
            settings.double_precision = type == 1;
            settings.refresh_interval = 5;
            settings.friction.mu_kinetic = 0.1;
            settings.friction.decay = 10.0; /* slips are at 0.1 m/s and more */
            check_against_twin(&settings, type == 1 ? 1e-6 : 2e-4);
        }
    }
}

/* Blocks one by one, in any order within a pass. */
static void blocks_can_be_computed_separately(void **state)
{
    struct wb_swept_contact_settings settings = contacts_settings();
    struct wb_swept_contact_energies energies;
    struct contacts whole, parts;

    (void)state;
    make_bundle(&whole, &settings, 3e-6);
    make_bundle(&parts, &settings, 3e-6);
    const int n = wb_swept_contact_blocks(parts.contact);
    assert_int_equal(n, 3);
    for (int step = 0; step < 10; step++) {
        seed = 11 + (uint64_t)step;
        jitter(&whole, 1e-7);
        seed = 11 + (uint64_t)step;
        jitter(&parts, 1e-7);
        contacts_step(&whole, dt);
        for (int w = 0; w < WIRES; w++)
            memset(parts.force[w], 0, wb_swept_size(&parts.layout) * sizeof(double));
        wb_swept_contact_gather(parts.contact, (const double *const *)parts.position, 2, 3);
        wb_swept_contact_gather(parts.contact, (const double *const *)parts.position, 0, 2);
        assert_int_equal(wb_swept_contact_refresh(parts.contact), WB_OK);
        for (int b = n - 1; b >= 0; b--)
            wb_swept_contact_press(parts.contact, dt, b, b + 1);
        wb_swept_contact_scatter(parts.contact, parts.force, 1, 3);
        wb_swept_contact_scatter(parts.contact, parts.force, 0, 1);
        assert_int_equal(wb_swept_contact_finish(parts.contact, &energies), WB_OK);
        assert_close_relative(energies.normal, whole.energies.normal, 1e-14);
        assert_close(energies.tangential, whole.energies.tangential, 1e-14 * energies.normal);
        assert_close(energies.friction, whole.energies.friction, 1e-14 * energies.normal);
        assert_close_relative(energies.deepest, whole.energies.deepest, 1e-14);
        for (int w = 0; w < WIRES; w++)
            assert_memory_equal(whole.force[w], parts.force[w],
                                wb_swept_size(&parts.layout) * sizeof(double));
    }
    contacts_release(&whole);
    contacts_release(&parts);
}

static void padding_has_no_effect(void **state)
{
    struct contacts clean, dirty;

    (void)state;
    for (int type = 0; type < 2; type++) {
        struct wb_swept_contact_settings settings = contacts_settings();
        settings.double_precision = type == 1;
        make_bundle(&clean, &settings, 3e-6);
        make_bundle(&dirty, &settings, 3e-6);
        for (int w = 0; w < WIRES; w++) {
            for (int r = 0; r < 3 * CONTACTS_NODES; r++) {
                for (int j = STATIONS; j < dirty.layout.stride; j++)
                    dirty.position[w][r * dirty.layout.stride + j] = (double)NAN;
            }
        }
        for (int step = 0; step < 3; step++) {
            contacts_step(&clean, dt);
            contacts_step(&dirty, dt);
            slide(&clean, 1e-7);
            slide(&dirty, 1e-7);
            for (int n = 0; n < WIRES * CONTACTS_NODES * 3 * STATIONS; n++) {
                const int w = n % WIRES, k = n / WIRES % CONTACTS_NODES;
                const int i = n / WIRES / CONTACTS_NODES % 3;
                const int j = n / WIRES / CONTACTS_NODES / 3;
                assert_true(contacts_force(&clean, w, k, i, j) ==
                            contacts_force(&dirty, w, k, i, j));
            }
        }
        contacts_release(&clean);
        contacts_release(&dirty);
    }
}

static void a_checkpoint_continues_bit_for_bit(void **state)
{
    (void)state;
    for (int type = 0; type < 2; type++) {
        struct wb_swept_contact_settings settings = contacts_settings();
        struct contacts c, later;
        settings.double_precision = type == 1;
        settings.refresh_interval = 7;
        make_bundle(&c, &settings, 3e-6);
        make_bundle(&later, &settings, 3e-6);
        seed = 21;
        for (int step = 0; step < 40; step++) {
            contacts_step(&c, dt);
            jitter(&c, 1e-8);
            slide(&c, 1e-7);
        }
        struct wb_checkpoint saved = {.status = WB_OK};
        wb_swept_contact_visit(c.contact, &saved);
        wb_checkpoint_rewind(&saved);
        wb_swept_contact_visit(later.contact, &saved);
        assert_int_equal(wb_checkpoint_finish(&saved), WB_OK);
        for (int step = 0; step < 40; step++) {
            for (int w = 0; w < WIRES; w++)
                memcpy(later.position[w], c.position[w], wb_swept_size(&c.layout) * sizeof(double));
            contacts_step(&c, dt);
            contacts_step(&later, dt);
            for (int w = 0; w < WIRES; w++)
                assert_memory_equal(c.force[w], later.force[w],
                                    wb_swept_size(&c.layout) *
                                        (type == 1 ? sizeof(double) : sizeof(float)));
            assert_memory_equal(&c.energies, &later.energies, sizeof c.energies);
            jitter(&c, 1e-8);
            slide(&c, 1e-7);
        }
        wb_checkpoint_release(&saved);
        contacts_release(&c);
        contacts_release(&later);
    }
}

/* ---- The bound for the stable step. ---- */

struct vibration {
    struct contacts c;
    double *rest[WIRES], *mode[WIRES], *acceleration[WIRES];
    double mass[CONTACTS_NODES], selective; /* kg/m */
    struct wb_checkpoint saved;
};

/* -M^-1 df for a small displacement along the mode, with sticking friction. */
static void accelerate(struct vibration *v)
{
    const double h = 1e-9;

    for (int w = 0; w < WIRES; w++)
        memset(v->acceleration[w], 0, wb_swept_size(&v->c.layout) * sizeof(double));
    for (int side = -1; side <= 1; side += 2) {
        wb_checkpoint_rewind(&v->saved);
        wb_swept_contact_visit(v->c.contact, &v->saved);
        for (int w = 0; w < WIRES; w++) {
            for (size_t i = 0; i < wb_swept_size(&v->c.layout); i++)
                v->c.position[w][i] = v->rest[w][i] + side * h * v->mode[w][i];
        }
        contacts_step(&v->c, dt);
        for (int w = 0; w < WIRES; w++) {
            for (size_t i = 0; i < wb_swept_size(&v->c.layout); i++)
                v->acceleration[w][i] -= side * ((double *)v->c.force[w])[i] / (2.0 * h);
        }
    }
    for (int n = 0; n < WIRES * 3 * STATIONS; n++) {
        const int w = n % WIRES, i = n / WIRES % 3, j = n / WIRES / 3;
        const double half = j == 0 || j == STATIONS - 1 ? 0.5 : 1.0;
        double mean = 0.0, total = 0.0; /* kg */
        for (int k = 0; k < CONTACTS_NODES; k++) {
            mean += v->acceleration[w][contacts_index(&v->c, k, i, j)];
            total += half * 1e-3 * v->mass[k];
        }
        mean /= total;
        for (int k = 0; k < CONTACTS_NODES; k++) {
            double *a = &v->acceleration[w][contacts_index(&v->c, k, i, j)];
            *a = mean + (*a / (half * 1e-3 * v->mass[k]) - mean) / v->selective;
        }
    }
}

static double largest_eigenvalue(struct vibration *v)
{
    double value = 0.0;

    for (int n = 0; n < 150; n++) {
        double size = 0.0, along = 0.0;
        accelerate(v);
        for (int w = 0; w < WIRES; w++) {
            for (size_t i = 0; i < wb_swept_size(&v->c.layout); i++) {
                size += v->acceleration[w][i] * v->acceleration[w][i];
                along += v->mode[w][i] * v->acceleration[w][i];
            }
        }
        value = along;
        for (int w = 0; w < WIRES; w++) {
            for (size_t i = 0; i < wb_swept_size(&v->c.layout); i++)
                v->mode[w][i] = v->acceleration[w][i] / sqrt(size);
        }
    }
    return value;
}

static void check_bound(double selective)
{
    struct wb_swept_contact_settings settings = contacts_settings();
    struct vibration v = {.selective = selective};
    double bound = 0.0;

    settings.friction.mu_static = settings.friction.mu_kinetic = 1e3;
    make_bundle(&v.c, &settings, 3e-6);
    contacts_step(&v.c, dt);
    seed = 31;
    for (int k = 0; k < CONTACTS_NODES; k++)
        v.mass[k] = k == CONTACTS_NODES - 1 ? 5e-3 : 1e-3 * (1.0 + 0.2 * k);
    for (int w = 0; w < WIRES; w++) {
        const size_t n = wb_swept_size(&v.c.layout);
        v.rest[w] = calloc(n, sizeof(double));
        v.mode[w] = calloc(n, sizeof(double));
        v.acceleration[w] = calloc(n, sizeof(double));
        assert_true(v.rest[w] && v.mode[w] && v.acceleration[w]);
        memcpy(v.rest[w], v.c.position[w], n * sizeof(double));
        for (int j = 0; j < 3 * CONTACTS_NODES * STATIONS; j++)
            v.mode[w][j / STATIONS * v.c.layout.stride + j % STATIONS] = random_number();
        bound = fmax(bound, wb_swept_contact_stiffness_per_mass(v.c.contact, w, v.mass, selective));
    }
    wb_swept_contact_visit(v.c.contact, &v.saved);
    const double value = largest_eigenvalue(&v);
    assert_int_equal(wb_checkpoint_finish(&v.saved), WB_OK);
    printf("beta %g: largest eigenvalue %.4g 1/s2, bound %.4g\n", selective, value, bound);
    assert_true(value <= bound);
    assert_true(value >= 0.25 * bound);
    for (int w = 0; w < WIRES; w++) {
        free(v.rest[w]);
        free(v.mode[w]);
        free(v.acceleration[w]);
    }
    wb_checkpoint_release(&v.saved);
    contacts_release(&v.c);
}

static void the_bound_holds_and_is_close(void **state)
{
    (void)state;
    check_bound(1.0);
    check_bound(10.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kernel_agrees_with_the_slow_twin),
        cmocka_unit_test(blocks_can_be_computed_separately),
        cmocka_unit_test(padding_has_no_effect),
        cmocka_unit_test(a_checkpoint_continues_bit_for_bit),
        cmocka_unit_test(the_bound_holds_and_is_close),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
