/* Regions of fields: their areas against closed forms, joints without seams, jumps. */
#include "tests/check.h"

#include <stdlib.h>

#include "analysis/plot/contour.h"
#include "analysis/plot/palette.h"

static const double pi = 3.14159265358979323846;

/* Signed area within the loops of a level: counterclockwise counts. */
static double area_of(const struct wb_contour *contour, int level)
{
    double area = 0.0;
    for (int i = 0; i < contour->n_loops; i++) {
        const struct wb_contour_loop *const loop = &contour->loops[i];
        for (int k = 0; loop->level == level && k < loop->n; k++) {
            const double *const a = contour->points[loop->first + k];
            const double *const b = contour->points[loop->first + (k + 1) % loop->n];
            area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
        }
    }
    return area;
}

static int loops_of(const struct wb_contour *contour, int level)
{
    int n = 0;
    for (int i = 0; i < contour->n_loops; i++)
        n += contour->loops[i].level == level;
    return n;
}

typedef double field(double x, double y);

/* A face whose nodes are those of the square [x0, x0 + size]^2, moved by a map. */
static struct wb_contour_face face_of(double x0, double y0, double size, field *value,
                                      void (*map)(double *x, double *y))
{
    static const double at[8][2] = {{0, 0},   {1, 0},   {1, 1},   {0, 1},
                                    {0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}};
    struct wb_contour_face face;
    for (int i = 0; i < 8; i++) {
        face.x[i] = x0 + size * at[i][0];
        face.y[i] = y0 + size * at[i][1];
        if (map)
            map(&face.x[i], &face.y[i]);
        face.value[i] = value(face.x[i], face.y[i]);
    }
    return face;
}

static double x_itself(double x, double y)
{
    (void)y;
    return x;
}

static void a_linear_field_is_cut_where_it_reaches_each_level(void **state)
{
    (void)state;
    struct wb_contour_face faces[9];
    for (int i = 0; i < 9; i++)
        faces[i] = face_of(i % 3 / 3.0, i / 3 / 3.0, 1.0 / 3.0, x_itself, NULL);
    const struct wb_contour_levels levels = {0.0, 1.0, 10};
    struct wb_contour contour;
    assert_int_equal(wb_contour_create(&contour, 9, faces, &levels), WB_OK);
    for (int k = 0; k < 10; k++) {
        assert_close(area_of(&contour, k), 1.0 - 0.1 * k, 1e-9);
        /* Faces are joined: a rectangle, without points where they meet. */
        assert_int_equal(loops_of(&contour, k), 1);
    }
    assert_true(contour.n_points <= 10 * 8);
    wb_contour_release(&contour);
}

static double radius(double x, double y)
{
    return hypot(x, y);
}

/* The square [-1, 1]^2 onto the unit disc. */
static void to_disc(double *x, double *y)
{
    const double u = *x, v = *y;
    *x = u * sqrt(1.0 - 0.5 * v * v);
    *y = v * sqrt(1.0 - 0.5 * u * u);
}

static int disc(struct wb_contour_face *faces, int n, field *value)
{
    for (int i = 0; i < n * n; i++)
        faces[i] =
            face_of(-1.0 + 2.0 * (i % n) / n, -1.0 + 2.0 * (i / n) / n, 2.0 / n, value, to_disc);
    return n * n;
}

static void rings_of_a_disc_have_their_areas(void **state)
{
    (void)state;
    struct wb_contour_face faces[100];
    const int n = disc(faces, 10, radius);
    const struct wb_contour_levels levels = {0.0, 1.0, 5};
    struct wb_contour contour;
    assert_int_equal(wb_contour_create(&contour, n, faces, &levels), WB_OK);
    for (int k = 0; k < 5; k++)
        assert_close(area_of(&contour, k), pi * (1.0 - 0.04 * k * k), 2e-3 * pi);
    /* Outside and inside of a ring are two loops. */
    assert_int_equal(loops_of(&contour, 0), 1);
    assert_int_equal(loops_of(&contour, 3), 2);
    wb_contour_release(&contour);
}

static void a_mirrored_field_has_the_same_regions(void **state)
{
    (void)state;
    struct wb_contour_face faces[36];
    const int n = disc(faces, 6, x_itself);
    const struct wb_contour_levels levels = {-1.0, 1.0, 8};
    struct wb_contour one, two;
    assert_int_equal(wb_contour_create(&one, n, faces, &levels), WB_OK);
    /* Seen from behind: the faces' nodes run clockwise. */
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 8; k++)
            faces[i].y[k] = -faces[i].y[k];
    }
    assert_int_equal(wb_contour_create(&two, n, faces, &levels), WB_OK);
    for (int k = 0; k < 8; k++)
        assert_close(area_of(&one, k), area_of(&two, k), 1e-4);
    assert_close(area_of(&one, 4), 0.5 * pi, 3e-3);
    wb_contour_release(&one);
    wb_contour_release(&two);
}

static void a_jump_between_faces_stands_at_their_edge(void **state)
{
    (void)state;
    struct wb_contour_face faces[2] = {face_of(0.0, 0.0, 1.0, x_itself, NULL),
                                       face_of(1.0, 0.0, 1.0, x_itself, NULL)};
    for (int i = 0; i < 8; i++) {
        faces[0].value[i] = 0.25;
        faces[1].value[i] = 0.75;
    }
    const struct wb_contour_levels levels = {0.0, 1.0, 4};
    struct wb_contour contour;
    assert_int_equal(wb_contour_create(&contour, 2, faces, &levels), WB_OK);
    assert_close(area_of(&contour, 0), 2.0, 1e-12);
    assert_close(area_of(&contour, 1), 2.0, 1e-12);
    assert_int_equal(loops_of(&contour, 1), 1);
    /* Four corners for each level: below both values there is no edge between the faces. */
    assert_int_equal(contour.n_points, 16);
    assert_close(area_of(&contour, 2), 1.0, 1e-12);
    assert_close(area_of(&contour, 3), 1.0, 1e-12);
    wb_contour_release(&contour);
}

static void values_beyond_the_levels_belong_to_the_first_and_the_last(void **state)
{
    (void)state;
    struct wb_contour_face face = face_of(0.0, 0.0, 1.0, x_itself, NULL);
    const struct wb_contour_levels levels = {0.4, 0.6, 2};
    struct wb_contour contour;
    assert_int_equal(wb_contour_create(&contour, 1, &face, &levels), WB_OK);
    assert_close(area_of(&contour, 0), 1.0, 1e-12);
    assert_close(area_of(&contour, 1), 0.5, 1e-9);
    wb_contour_release(&contour);
    for (int i = 0; i < 8; i++)
        face.value[i] *= 1e300;
    assert_int_equal(wb_contour_create(&contour, 1, &face, &levels), WB_OK);
    assert_close(area_of(&contour, 0), 1.0, 1e-12);
    wb_contour_release(&contour);
}

static void faces_that_are_not_finite_or_flat_are_left_out(void **state)
{
    (void)state;
    struct wb_contour_face faces[3] = {face_of(0.0, 0.0, 1.0, x_itself, NULL),
                                       face_of(1.0, 0.0, 1.0, x_itself, NULL),
                                       face_of(2.0, 0.0, 1.0, x_itself, NULL)};
    faces[1].value[5] = (double)NAN;
    for (int i = 0; i < 8; i++)
        faces[2].y[i] = 0.0;
    const struct wb_contour_levels levels = {0.0, 1.0, 2};
    struct wb_contour contour;
    assert_int_equal(wb_contour_create(&contour, 3, faces, &levels), WB_OK);
    assert_close(area_of(&contour, 0), 1.0, 1e-12);
    wb_contour_release(&contour);
    assert_int_equal(wb_contour_create(&contour, 0, faces, &levels), WB_OK);
    assert_int_equal(contour.n_loops, 0);
    wb_contour_release(&contour);
}

static void levels_without_extent_are_refused(void **state)
{
    (void)state;
    wb_log_set_sink(discard_message, NULL);
    const struct wb_contour_levels wrong[] = {
        {1.0, 1.0, 4}, {0.0, (double)NAN, 4}, {0.0, 1.0, 0}, {0.0, (double)INFINITY, 4}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct wb_contour contour;
        assert_int_equal(wb_contour_create(&contour, 0, NULL, &wrong[i]), WB_ERR_ARGUMENT);
    }
    wb_log_set_sink(NULL, NULL);
}

/* --- colours --- */

/* CIE lightness L*, which has nothing to do with the space the maps are interpolated in. */
static double lightness(struct wb_colour colour)
{
    const double channels[3] = {colour.red, colour.green, colour.blue};
    static const double weights[3] = {0.2126, 0.7152, 0.0722};
    double luminance = 0.0;
    for (int i = 0; i < 3; i++)
        luminance +=
            weights[i] * (channels[i] <= 0.04045 ? channels[i] / 12.92
                                                 : pow((channels[i] + 0.055) / 1.055, 2.4));
    return luminance > 0.008856 ? 116.0 * cbrt(luminance) - 16.0 : 903.3 * luminance;
}

static void the_sequential_map_gains_lightness_evenly(void **state)
{
    (void)state;
    const double first = lightness(wb_palette_map(WB_PALETTE_SEQUENTIAL, 0.0));
    const double last = lightness(wb_palette_map(WB_PALETTE_SEQUENTIAL, 1.0));
    assert_true(last - first > 70.0);
    for (int i = 0; i <= 100; i++)
        assert_close(lightness(wb_palette_map(WB_PALETTE_SEQUENTIAL, i / 100.0)),
                     first + (last - first) * i / 100.0, 2.0);
}

static void the_diverging_map_is_white_in_the_middle_and_falls_to_both_sides(void **state)
{
    (void)state;
    const struct wb_colour middle = wb_palette_map(WB_PALETTE_DIVERGING, 0.5);
    assert_close(middle.red, middle.blue, 0.01);
    double before = lightness(middle);
    assert_true(before > 95.0);
    for (int i = 1; i <= 50; i++) {
        const double low = lightness(wb_palette_map(WB_PALETTE_DIVERGING, 0.5 - i / 100.0));
        const double high = lightness(wb_palette_map(WB_PALETTE_DIVERGING, 0.5 + i / 100.0));
        assert_close(low, high, 6.0);
        assert_true(fmax(low, high) < before);
        before = fmax(low, high);
    }
    /* Blue below, red above, and beyond the ends nothing new. */
    assert_true(wb_palette_map(WB_PALETTE_DIVERGING, -3.0).blue > 0.6);
    assert_true(wb_palette_map(WB_PALETTE_DIVERGING, 3.0).red > 0.6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_linear_field_is_cut_where_it_reaches_each_level),
        cmocka_unit_test(rings_of_a_disc_have_their_areas),
        cmocka_unit_test(a_mirrored_field_has_the_same_regions),
        cmocka_unit_test(a_jump_between_faces_stands_at_their_edge),
        cmocka_unit_test(values_beyond_the_levels_belong_to_the_first_and_the_last),
        cmocka_unit_test(faces_that_are_not_finite_or_flat_are_left_out),
        cmocka_unit_test(levels_without_extent_are_refused),
        cmocka_unit_test(the_sequential_map_gains_lightness_evenly),
        cmocka_unit_test(the_diverging_map_is_white_in_the_middle_and_falls_to_both_sides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
