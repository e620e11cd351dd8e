/* Queried stresses of swept hexahedra compared with the kernels' energies, the flow stress and
 * closed forms. */
#include "fe/swept/swept_hex_stress.h"
#include "fe/swept/swept_private.h"

#include "tests/check.h"
#include "tests/fe/swept/swept_bodies.h"

static const struct wb_material elastic = {
    .hardening = WB_HARDENING_NONE_ELASTIC, .youngs_modulus = 4e9, .poissons_ratio = 0.4};
static const struct wb_material yielding = {.hardening = WB_HARDENING_ISOTROPIC_POWER,
                                            .youngs_modulus = 4e9,
                                            .poissons_ratio = 0.4,
                                            .yield_stress = 20e6,
                                            .strength_coefficient = 60e6,
                                            .hardening_exponent = 0.5};

static struct swept_body make(const struct wb_swept_section *section,
                              const struct wb_material *material,
                              enum wb_swept_hex_formulation formulation)
{
    const struct wb_swept_hex_model model = {
        .section = section,
        .material = *material,
        .n_elements = 19, /* more than a block */
        .element_length = 1e-3,
        .formulation = formulation,
        .double_precision = true,
    };
    return swept_body_create(&model);
}

/* Lateral strains as in a bar: only the axial stress remains, on its rotated section. */
static void a_turned_and_stretched_bar_has_axial_stress_only(void **unused)
{
    (void)unused;
    const double along = 0.004, across = -0.4 * along;
    const double stretch[3] = {exp(along), exp(across), exp(across)}, c[3] = {0.1, -0.2, 0.3};
    double R[3][3], F[3][3];
    swept_rotation(1.1, R);
    for (int i = 0; i < 9; i++)
        F[i / 3][i % 3] = R[i / 3][i % 3] * stretch[i % 3];
    struct wb_swept_section section = swept_distorted_section(1e-3);
    for (int f = WB_SWEPT_HEX_FOUR_POINTS; f <= WB_SWEPT_HEX_ONE_POINT; f++) {
        struct swept_body body = make(&section, &elastic, (enum wb_swept_hex_formulation)f);
        struct wb_swept_hex_stress out[4];
        const double expected = 4e9 * along / exp(along + 2.0 * across);
        const int n = wb_swept_hex_stress_points(body.hex);
        swept_set_linear(&body, F, c);
        assert_int_equal(n, f == WB_SWEPT_HEX_ONE_POINT ? 1 : 4);
        wb_swept_hex_stress_find(body.hex, body.state, body.position, 2, 17, out);
        for (int q = 0; q < n; q++) {
            assert_close_relative(out[q].stress[0], expected, 1e-4);
            for (int i = 1; i < 6; i++)
                assert_close(out[q].stress[i], 0.0, 1e-4 * expected);
            assert_close_relative(wb_material_von_mises(out[q].stress), expected, 1e-4);
            assert_close(out[q].plastic, 0.0, 0.0);
        }
        swept_body_destroy(&body);
    }
    wb_swept_section_release(&section);
}

/* A stretched, bent, twisted and sheared wire; no two points have the same strain. */
static void deform(struct swept_body *body, double size)
{
    const struct wb_swept_hex_model *m = wb_swept_hex_get_model(body->hex);
    for (int k = 0; k < m->section->n_nodes; k++) {
        const double y = m->section->node[k][0], z = m->section->node[k][1];
        for (int j = 0; j <= m->n_elements; j++) {
            const double x = j * m->element_length, s = x / (m->n_elements * m->element_length);
            const double bent = 12.0 * size * s * (1.0 + s), twist = 9.0 * size * s;
            double *at = body->position + swept_at(&body->layout, k, 0, j);
            at[0] = x * (1.0 + 0.9 * size) - y * bent + 0.2 * size * z * bent;
            at[body->layout.stride] =
                y * (1.0 - 0.3 * size) - twist * z + 0.5 * bent * x + 0.2 * size * z;
            at[2 * (size_t)body->layout.stride] = z * (1.0 - 0.2 * size) + twist * y;
        }
    }
}

/* Elastic energy of the points' stresses, and the number of points away from the flow stress. */
static double energy_of(struct swept_body *body, int *off, double *most_plastic)
{
    const struct wb_swept_hex_model *m = wb_swept_hex_get_model(body->hex);
    const double mu = m->material.youngs_modulus / (2.0 * (1.0 + m->material.poissons_ratio));
    const double kappa =
        m->material.youngs_modulus / (3.0 * (1.0 - 2.0 * m->material.poissons_ratio));
    const int n = wb_swept_hex_stress_points(body->hex);
    double sum = 0.0;

    *off = 0;
    *most_plastic = 0.0;
    for (int e = 0; e < m->section->n_quads; e++) {
        struct wb_swept_quad quad;
        wb_swept_section_quad(m->section, e, &quad);
        for (int j = 0; j < m->n_elements; j++) {
            struct wb_swept_hex_stress out[4];
            wb_swept_hex_stress_find(body->hex, body->state, body->position, e, j, out);
            for (int q = 0; q < n; q++) {
                const double p =
                    wb_swept_hex_history(body->state, e, j, q, WB_SWEPT_HEX_ACCUMULATED);
                const double flow =
                    m->material.yield_stress +
                    m->material.strength_coefficient * pow(p, m->material.hardening_exponent);
                /* Kirchhoff stress: Cauchy's times the volume ratio exp(trace). */
                const double pressure =
                    (out[q].stress[0] + out[q].stress[1] + out[q].stress[2]) / 3.0;
                double trace = pressure / kappa;
                for (int i = 0; i < 20; i++)
                    trace = pressure * exp(trace) / kappa;
                const double von_mises = wb_material_von_mises(out[q].stress) * exp(trace);
                assert_close(out[q].plastic, p, 0.0);
                *off += p > 0.0 && !(fabs(von_mises - flow) <= 1e-4 * flow);
                *most_plastic = fmax(*most_plastic, p);
                sum += quad.area * m->element_length * (n == 1 ? 1.0 : quad.weight[q]) *
                       (von_mises * von_mises / (6.0 * mu) + 0.5 * kappa * trace * trace);
            }
        }
    }
    return sum;
}

static void points_have_the_kernels_energy_and_the_flow_stress(void **unused)
{
    (void)unused;
    struct wb_swept_section section = swept_distorted_section(1e-3);
    for (int f = WB_SWEPT_HEX_FOUR_POINTS; f <= WB_SWEPT_HEX_ONE_POINT; f++) {
        struct swept_body body = make(&section, &yielding, (enum wb_swept_hex_formulation)f);
        struct wb_swept_hex_sums sums = {0};
        double plastic;
        int off;
        for (int i = 1; i <= 200; i++) {
            deform(&body, 1e-3 * i / 20.0);
            sums = swept_forces(&body);
        }
        assert_close_relative(energy_of(&body, &off, &plastic), sums.stored, 1e-5);
        assert_int_equal(off, 0);
        assert_true(plastic > 0.01);
        swept_body_destroy(&body);
    }
    wb_swept_section_release(&section);
}

/* Axial stretch that is linear over the section: the stress is also linear, up to the corners. */
static void corners_extrapolate_linear_fields(void **unused)
{
    (void)unused;
    struct wb_swept_section section = swept_circle(1.4e-3, 6, 2);
    struct swept_body body = make(&section, &elastic, WB_SWEPT_HEX_FOUR_POINTS);
    struct wb_swept_hex_stress out[4], corners[4];
    const double curvature = 2.0;
    for (int k = 0; k < section.n_nodes; k++)
        for (int j = 0; j <= 19; j++)
            body.position[swept_at(&body.layout, k, 0, j)] =
                1e-3 * j * (1.0 - curvature * section.node[k][0]);
    for (int e = 0; e < section.n_quads; e++) {
        wb_swept_hex_stress_find(body.hex, body.state, body.position, e, 3, out);
        wb_swept_hex_stress_at_corners(body.hex, out, corners);
        double mean = 0.0;
        for (int a = 0; a < 4; a++)
            mean += 0.25 * section.node[section.quad[e][a]][0];
        for (int a = 0; a < 4; a++) {
            /* Within an element 2 mu times the variation: constant volume. */
            const double off = section.node[section.quad[e][a]][0] - mean;
            const double all = -curvature * mean * 4e9 * 0.6 / (1.4 * 0.2);
            const double expected = all - curvature * off * 4e9 / 1.4;
            assert_close(corners[a].stress[0], expected, 0.01 * curvature * 0.7e-3 * 8e9);
        }
    }
    swept_body_destroy(&body);
    wb_swept_section_release(&section);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_turned_and_stretched_bar_has_axial_stress_only),
        cmocka_unit_test(points_have_the_kernels_energy_and_the_flow_stress),
        cmocka_unit_test(corners_extrapolate_linear_fields),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
