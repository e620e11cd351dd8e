#include "fe/rod/beam_element.h"

#include "tests/fe/rod/wires.h"

/* A linear elastic element, curved and with random strains. */
static const double EA = 5000.0, GA = 1500.0, EI = 4e-4, ES = 0.05, h = 1.7e-3;

struct element {
    struct wb_rod_shape shape;
    struct wb_beam_node nodes[WB_BEAM_ELEMENT_NODES];
    struct wb_beam_point points[WB_BEAM_ELEMENT_POINTS];
};

static double *unknown(struct element *e, int i)
{
    struct wb_beam_node *node = &e->nodes[i / 3];
    return i % 3 == 0 ? &node->x : i % 3 == 1 ? &node->y : &node->t;
}

static void respond(struct element *e)
{
    for (int g = 0; g < WB_BEAM_ELEMENT_POINTS; g++) {
        struct wb_beam_point *p = &e->points[g];
        wb_beam_element_kinematics(&e->shape, g, e->nodes, p);
        p->N = EA * (p->a - 1.0) + ES * p->k;
        p->M = ES * (p->a - 1.0) + EI * p->k;
        p->Q = GA * p->b;
        p->D11 = EA;
        p->D12 = ES;
        p->D22 = EI;
        p->G = GA;
    }
}

static double stored_work(struct element *e)
{
    double work = 0.0;
    respond(e);
    for (int g = 0; g < WB_BEAM_ELEMENT_POINTS; g++) {
        const struct wb_beam_point *p = &e->points[g];
        work += 0.5 * e->shape.weight * (p->N * (p->a - 1.0) + p->M * p->k + p->Q * p->b);
    }
    return work;
}

static void forces(struct element *e, double f[9])
{
    memset(f, 0, 9 * sizeof *f);
    respond(e);
    for (int g = 0; g < WB_BEAM_ELEMENT_POINTS; g++)
        wb_beam_element_add_forces(&e->shape, g, &e->points[g], f);
}

static struct element make_element(uint64_t *random)
{
    struct element e;
    const double turn = 6.0 * test_random(random);
    wb_rod_shape_init(&e.shape, h);
    for (int i = 0; i < 3; i++) {
        const double s = 0.5 * h * i;
        e.nodes[i].x = s * cos(turn) + 1e-3 * h * test_random(random);
        e.nodes[i].y = s * sin(turn) + 1e-3 * h * test_random(random);
        e.nodes[i].t = turn + 0.02 * test_random(random);
    }
    return e;
}

static void forces_are_the_derivative_of_the_stored_work(void **unused)
{
    (void)unused;
    uint64_t random = 7;
    for (int trial = 0; trial < 10; trial++) {
        struct element e = make_element(&random);
        double f[9];
        forces(&e, f);
        for (int i = 0; i < 9; i++) {
            const double d = i % 3 == 2 ? 1e-5 : 1e-5 * h;
            struct element low = e, high = e;
            *unknown(&low, i) -= d;
            *unknown(&high, i) += d;
            const double slope = (stored_work(&high) - stored_work(&low)) / (2.0 * d);
            assert_close(f[i], slope, 1e-6 * (i % 3 == 2 ? EA * h * 0.01 : EA * 0.01));
        }
    }
}

static void stiffness_is_the_derivative_of_the_forces(void **unused)
{
    (void)unused;
    uint64_t random = 8;
    for (int trial = 0; trial < 10; trial++) {
        struct element e = make_element(&random);
        struct wb_beam_element_stiffness K;
        respond(&e);
        wb_beam_element_stiffness(&e.shape, e.points, &K);
        const double *block[3][3] = {
            {K.K11, K.K12, K.K13}, {NULL, K.K22, K.K23}, {NULL, NULL, K.K33}};
        for (int j = 0; j < 9; j++) {
            const double d = j % 3 == 2 ? 1e-6 : 1e-6 * h;
            struct element low = e, high = e;
            double f_low[9], f_high[9];
            *unknown(&low, j) -= d;
            *unknown(&high, j) += d;
            forces(&low, f_low);
            forces(&high, f_high);
            for (int i = 0; i < 9; i++) {
                /* Blocks below the diagonal are the transposes of those above. */
                const double entry = i / 3 <= j / 3 ? block[i / 3][j / 3][3 * (i % 3) + j % 3]
                                                    : block[j / 3][i / 3][3 * (j % 3) + i % 3];
                const double unit = (i % 3 == 2 ? h : 1.0) * (j % 3 == 2 ? h : 1.0) * EA / h;
                assert_close(entry / unit, (f_high[i] - f_low[i]) / (2.0 * d) / unit, 1e-6);
            }
        }
    }
}

static void rigid_motion_causes_no_strain(void **unused)
{
    (void)unused;
    for (double turn = -3.0; turn < 3.0; turn += 0.7) {
        struct element e;
        double f[9];
        wb_rod_shape_init(&e.shape, h);
        for (int i = 0; i < 3; i++) {
            e.nodes[i].x = 2.0 + 0.5 * h * i * cos(turn);
            e.nodes[i].y = 3.0 + 0.5 * h * i * sin(turn);
            e.nodes[i].t = turn;
        }
        forces(&e, f);
        for (int i = 0; i < 9; i++)
            assert_close(f[i], 0.0, 1e-11 * EA);
    }
}

static void forces_of_an_element_balance(void **unused)
{
    (void)unused;
    uint64_t random = 9;
    struct element e = make_element(&random);
    double f[9], x = 0.0, y = 0.0, m = 0.0;
    forces(&e, f);
    for (int i = 0; i < 3; i++) {
        x += f[3 * i];
        y += f[3 * i + 1];
        m += f[3 * i + 2] + e.nodes[i].x * f[3 * i + 1] - e.nodes[i].y * f[3 * i];
    }
    assert_close(x, 0.0, 1e-12 * EA);
    assert_close(y, 0.0, 1e-12 * EA);
    assert_close(m, 0.0, 1e-12 * EA * h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_are_the_derivative_of_the_stored_work),
        cmocka_unit_test(stiffness_is_the_derivative_of_the_forces),
        cmocka_unit_test(rigid_motion_causes_no_strain),
        cmocka_unit_test(forces_of_an_element_balance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
