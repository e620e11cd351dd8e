/* CalculiX bends a solid cylinder with our card, compared with our beam of the same wire: the tip
 * is raised and lowered again, without weight. CALCULIX is the path of the program. */
#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "fe/solid/solid_mesh.h"
#include "fe/trial/cantilever.h"
#include "tests/analysis/cards/wires.h"
#include "tests/own_folder.h"

#define LENGTH 0.06
#define TOP 0.03 /* m */

enum {
    WAY = 5, /* rows of each branch */
    ROWS = 2 * WAY,
    MOST_SETS = 40
};

/* Deflection of row k, from 1. */
static double target(int k)
{
    return TOP * (k <= WAY ? k : ROWS - k) / WAY;
}

/* --- the deck --- */

/* The clamp's nodes whose coordinate is 0. */
static void put_clamp_line(struct wb_text *deck, const struct wb_solid_mesh *mesh, int coordinate,
                           const char *name)
{
    wb_text_append(deck, "*NSET, NSET=%s\n", name);
    for (int i = 0; i < mesh->n_clamp; i++) {
        if (fabs(mesh->node[mesh->clamp[i]][coordinate]) < 1e-9)
            wb_text_append(deck, "%d,\n", mesh->clamp[i] + 1);
    }
}

static void put_nodes(struct wb_text *deck, const struct wb_solid_mesh *mesh)
{
    wb_text_append(deck, "*NODE, NSET=ALL\n");
    for (int i = 0; i < mesh->n_nodes; i++)
        wb_text_append(deck, "%d, %.10e, %.10e, %.10e\n", i + 1, mesh->node[i][0], mesh->node[i][1],
                       mesh->node[i][2]);
    /* The clamped section stays plane but may contract, as in the beam. */
    wb_text_append(deck, "*NSET, NSET=CLAMP\n");
    for (int i = 0; i < mesh->n_clamp; i++)
        wb_text_append(deck, "%d,\n", mesh->clamp[i] + 1);
    put_clamp_line(deck, mesh, 1, "LEVEL");
    put_clamp_line(deck, mesh, 2, "MIDDLE");
    /* Line through the tip normal to the plane of bending: its height does not change when the tip
     * rotates. */
    wb_text_append(deck, "*NSET, NSET=TIP\n");
    for (int i = 0; i < mesh->n_nodes; i++) {
        if (fabs(mesh->node[i][0] - LENGTH) < 1e-9 && fabs(mesh->node[i][1]) < 1e-9)
            wb_text_append(deck, "%d,\n", i + 1);
    }
}

static void put_set(struct wb_text *deck, const struct wb_solid_mesh *mesh, int set)
{
    wb_text_append(deck, "*ELEMENT, TYPE=C3D20R, ELSET=SET%d\n", set);
    for (int e = 0; e < mesh->n_elements; e++) {
        wb_text_append(deck, "%d", set * mesh->n_elements + e + 1);
        for (int k = 0; k < WB_SOLID_MESH_NODES; k++)
            wb_text_append(deck, ",%s%d", k == 10 ? "\n" : " ", mesh->element[e][k] + 1);
        wb_text_append(deck, "\n");
    }
}

/* A copy of the elements for each material that the card defines. */
static int put_sets(struct wb_text *deck, const struct wb_solid_mesh *mesh, const char *card)
{
    static const char keyword[] = "*MATERIAL, NAME=";
    int n = 0;
    for (const char *at = strstr(card, keyword); at; at = strstr(at, keyword)) {
        at += strlen(keyword);
        put_set(deck, mesh, n);
        wb_text_append(deck, "*SOLID SECTION, ELSET=SET%d, MATERIAL=%.*s\n", n++,
                       (int)strcspn(at, "\n"), at);
        assert_true(n < MOST_SETS);
    }
    return n;
}

static void write_deck(const char *path, const struct wb_card_source *source, const char *card)
{
    struct wb_solid_mesh mesh;
    struct wb_text deck = {0};
    const struct wb_solid_mesh_wire wire = {.length = LENGTH,
                                            .n_parts = 1,
                                            .outer_diameter = {source->properties.outer_diameter},
                                            .elements_along = 16,
                                            .section_density = 1};
    assert_int_equal(wb_solid_mesh_sweep(&mesh, &wire), WB_OK);
    put_nodes(&deck, &mesh);
    wb_text_append(&deck, "%s", card);
    print_message("    %d sets of %d elements\n", put_sets(&deck, &mesh, card), mesh.n_elements);
    wb_text_append(&deck,
                   "*BOUNDARY\nCLAMP, 1, 1\nLEVEL, 2, 2\nMIDDLE, 3, 3\n"
                   "*TIME POINTS, NAME=ROWS, GENERATE\n%g, 1., %g\n",
                   1.0 / WAY, 1.0 / WAY);
    /* Each step begins with a small increment, which has no tangent of a previous one. */
    for (int way = 1; way <= 2; way++)
        wb_text_append(&deck,
                       "*STEP, NLGEOM, INC=1000\n*STATIC\n0.01, 1., 1e-5, 0.05\n*BOUNDARY\n"
                       "TIP, 2, 2, %.10e\n*NODE PRINT, NSET=TIP, TOTALS=ONLY, TIME POINTS=ROWS\n"
                       "RF\n*END STEP\n",
                       target(way * WAY));
    assert_int_equal(wb_file_write_text(path, &deck), WB_OK);
    wb_text_release(&deck);
    wb_solid_mesh_release(&mesh);
}

/* Reads the forces of the rows, N, from the program's print file. */
static void read_forces(const char *path, double forces[ROWS])
{
    char *text;
    int n = 0;
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    for (const char *at = text; (at = strstr(at, "total force")) && n < ROWS; n++) {
        double x, y, z, time;
        at = strstr(at, "time");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "time %lf %lf %lf %lf", &time, &x, &y, &z), 4);
        assert_close(time, (n + 1.0) / WAY, 1e-4);
        forces[n] = y;
    }
    free(text);
    assert_int_equal(n, ROWS);
}

static void run_calculix(const struct wb_card_source *source, double forces[ROWS])
{
    const struct wb_card_settings settings = card_defaults();
    struct wb_text card = card_of("calculix", source, &settings);
    char path[WB_PATH], command[2 * WB_PATH];
    const char *const program = getenv("CALCULIX");
    assert_non_null(program);
    assert_int_equal(wb_file_join(path, folder, "wire.inp"), WB_OK);
    write_deck(path, source, wb_text_string(&card));
    wb_text_release(&card);
    snprintf(command, sizeof command,
             "cd '%s' && rm -f wire.dat && OMP_NUM_THREADS=1 '%s' wire > wire.log", folder,
             program);
    if (system(command) != 0)
        print_message("    %s failed\n", program);
    assert_int_equal(wb_file_join(path, folder, "wire.dat"), WB_OK);
    read_forces(path, forces);
}

/* --- the beam --- */

static void run_beam(const struct wb_card_source *source, double forces[ROWS])
{
    const struct wb_properties *const p = &source->properties;
    struct wb_section section;
    struct wb_cantilever_model model;
    struct wb_cantilever *cantilever;
    assert_int_equal(wb_section_init_law(&section, p->outer_diameter, &p->law, 100), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = LENGTH;
    model.gravity_y = 0.0;
    assert_int_equal(wb_cantilever_create(&cantilever, &model, NULL), WB_OK);
    for (int k = 0; k < ROWS; k++) {
        struct wb_cantilever_point point;
        assert_int_equal(
            wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, target(k + 1), &point), WB_OK);
        assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
        forces[k] = point.tension;
    }
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

/* The difference must be within a part of the largest force, and the wire must have yielded. */
static void compare(const char *properties, double tolerance)
{
    const struct wb_card_source source = source_of(properties);
    double theirs[ROWS], ours[ROWS], largest = 0.0, worst = 0.0;
    run_beam(&source, ours);
    run_calculix(&source, theirs);
    for (int k = 0; k < ROWS; k++)
        largest = fmax(largest, ours[k]);
    for (int k = 0; k < ROWS; k++) {
        const double difference = (theirs[k] - ours[k]) / largest;
        print_message("    %5.2f mm: %8.3f mN, beam %8.3f mN, %+.4f of F_max\n",
                      target(k + 1) / WB_MM, theirs[k] / WB_MN, ours[k] / WB_MN, difference);
        worst = fmax(worst, fabs(difference));
    }
    print_message("    worst %.4f\n", worst);
    assert_true(ours[ROWS - 1] < -0.1 * largest);
    assert_close(worst, 0.0, tolerance);
}

static void ludwiks_law_agrees_with_the_beam(void **state)
{
    (void)state;
    compare(PROPERTIES, 0.02);
}

static void kinematic_parallel_parts_agree_with_the_beam(void **state)
{
    (void)state;
    compare(PROPERTIES KINEMATIC, 0.02);
}

static void mixed_parallel_parts_agree_with_the_beam(void **state)
{
    (void)state;
    compare(PROPERTIES MIXED, 0.02);
}

static void combined_parallel_parts_agree_with_the_beam(void **state)
{
    (void)state;
    compare(PROPERTIES GROWING, 0.02);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ludwiks_law_agrees_with_the_beam),
        cmocka_unit_test(kinematic_parallel_parts_agree_with_the_beam),
        cmocka_unit_test(mixed_parallel_parts_agree_with_the_beam),
        cmocka_unit_test(combined_parallel_parts_agree_with_the_beam),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
