/* `wirebench solve bundle` for one bare wire on a coarse mesh, to keep the test fast.
 * WIREBENCH_BINARY is the path of the tool. */
#include <stdlib.h>
#include <sys/wait.h>

#include "analysis/dataset/dataset.h"
#include "analysis/dataset/surface.h"
#include "base/file.h"
#include "base/json.h"
#include "tests/cli/tool.h"

static const char model[] =
    "name: one\nwires: [{wire: type3}]\npacking: hexagon\nlength_mm: 114\n"
    "interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}\n"
    "meshes: [{name: coarse, core_quads: 2, rings: 0, elements_along: 15}]\n"
    "run: {mesh: coarse, deflection_mm: 10, rows: 5, selective_mass_scaling: 100}\n"
    "loads: {weight: true, strand_mm: 760}\n";

static int set_up(void **state)
{
    char path[128];
    if (make_folder(state) != 0)
        return -1;
    snprintf(path, sizeof path, "%s/one.yaml", folder);
    FILE *file = fopen(path, "w");
    return file && fputs(model, file) >= 0 && fclose(file) == 0 ? 0 : -1;
}

static int solve(const char *arguments)
{
    char line[512];
    snprintf(line, sizeof line, "solve bundle one.yaml %s", arguments);
    tool(line);
    return o.code;
}

/* 3 E I d / L^3 of the wire, which hardly yields. */
static void json_has_the_curve_and_its_cost(void **unused)
{
    (void)unused;
    struct wb_json *root = NULL;
    bool chosen = true;
    assert_int_equal(solve("--json --dead-force --no-weight --duration-s 1.5"), 0);
    assert_int_equal(wb_json_parse(&root, o.out, "output"), WB_OK);
    assert_close(number(root, "elements"), 60.0, 0.0);
    assert_close(number(root, "shells"), 0.0, 0.0);
    assert_close(number(root, "duration_s"), 1.5, 0.0);
    assert_true(wb_json_get_boolean(root, "duration_chosen", &chosen) && !chosen);
    assert_close_relative(number(root, "steps") * number(root, "time_step_s"), 1.5, 1e-3);
    const struct wb_json *points = wb_json_get(root, "points");
    assert_int_equal(wb_json_length(points), 6);
    const struct wb_json *point = wb_json_item(points, 2);
    const double stiffness = 3.0 * 4528e6 * M_PI / 64.0 * pow(1.4e-3, 4.0) / pow(0.114, 3.0);
    assert_close_relative(number(point, "force_N"),
                          stiffness * number(point, "deflection_mm") * 1e-3, 0.05);
    const struct wb_json *largest = wb_json_get(root, "largest");
    assert_true(number(largest, "imbalance_over_external") < 0.01);
    assert_true(number(largest, "kinetic_over_internal") > 0.0);
    assert_true(number(largest, "kinetic_over_internal") < 0.5);
    assert_true(number(largest, "artificial_over_internal") < 0.05);
    const struct wb_json *energy = wb_json_get(root, "energy");
    static const char *const parts[] = {"kinetic_J",  "stored_J",   "plastic_J",   "contact_J",
                                        "cohesive_J", "friction_J", "artificial_J"};
    double sum = 0.0;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        sum += number(energy, parts[i]);
    assert_true(number(energy, "stored_J") > 0.9 * sum);
    assert_close_relative(sum, number(energy, "external_J"), 0.01);
    assert_true(number(root, "wall_s") > 0.0 && number(root, "cpu_s") > 0.0);
    assert_close_relative(
        number(root, "ns_per_element_step"),
        1e9 * number(root, "cpu_s") / (60.0 * number(root, "steps_of_all_attempts")), 0.01);
    wb_json_destroy(root);
}

/* On a terminal, that of script(1). */
static void a_line_shows_the_progress(void **unused)
{
    (void)unused;
    char command[1024];
    snprintf(
        command, sizeof command,
        "cd %s && script -qec '%s solve bundle one.yaml --duration-s 4 -o line' out </dev/null "
        ">/dev/null",
        folder, getenv("WIREBENCH_BINARY"));
    assert_int_equal(system(command), 0);
    read_all("out", o.out, sizeof o.out);
    static const char *const parts[] = {" of 6 rows, ", " s left, ",     "T 4 s, step ",    " mm",
                                        ", kinetic ",   ", artificial ", ", coming to rest"};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        if (!strstr(o.out, parts[i]))
            fail_msg("no '%s' in %s", parts[i], o.out);
}

static void datasets_are_those_of_the_homogenised_beam(void **unused)
{
    (void)unused;
    struct wb_dataset dataset;
    char path[128];
    assert_int_equal(solve("--duration-s 1.5 -o ds"), 0);
    snprintf(path, sizeof path, "%s/ds", folder);
    assert_int_equal(wb_dataset_read(&dataset, path, NULL), WB_OK);
    assert_int_equal(dataset.n_rows, 6);
    assert_int_equal(dataset.n_shape_rows, 6 * 26);
    assert_close(dataset.info.outer_diameter, 1.4e-3, 1e-12);
    assert_close(dataset.info.poissons_ratio, 0.3, 0.0);
    assert_close(dataset.info.strand_length, 0.76, 1e-12);
    assert_close(dataset.info.gravity, 9.80665, 1e-9);
    assert_true(dataset.info.is_simulation);
    assert_close(dataset.rows[5].deflection, 10e-3, 1e-6);
    wb_dataset_release(&dataset);

    read_all("ds/energies.csv", o.out, sizeof o.out);
    int lines = 0;
    for (const char *c = o.out; *c; c++)
        lines += *c == '\n';
    assert_int_equal(lines, 7);
    assert_non_null(strstr(o.out, "kinetic_over_internal"));
}

static bool is_there(const char *name)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return wb_file_exists(path);
}

/* At the largest deflection; the tip's place is that of the last row. */
static void datasets_have_the_bent_surface(void **unused)
{
    (void)unused;
    struct wb_dataset dataset;
    struct wb_surface surface;
    struct wb_json *root = NULL;
    char path[128];
    assert_int_equal(solve("--duration-s 1.5 -o surface"), 0);
    snprintf(path, sizeof path, "%s/surface", folder);
    assert_int_equal(wb_dataset_read(&dataset, path, NULL), WB_OK);
    assert_int_equal(wb_surface_read(&surface, path, NULL), WB_OK);
    assert_int_equal(surface.n, 1);
    const struct wb_surface_body *wire = &surface.bodies[0];
    assert_int_equal(wire->n_along, 16);
    assert_int_equal(wire->n_around, 8);
    double tip[2] = {0.0}, most = 0.0;
    for (int k = 0; k < 8; k++)
        for (int c = 0; c < 2; c++)
            tip[c] += wire->nodes[15 * 8 + k].position[c] / 8;
    assert_close(tip[0], dataset.rows[5].tip_x, 2e-6);
    assert_close(tip[1], 10e-3, 20e-6); /* round the axis, not the mean over masses */
    for (int i = 0; i < 16 * 8; i++)
        most = fmax(most, wire->nodes[i].von_mises);
    /* It yields a little, at 4.52 MPa; an elastic wire would have 3 E r v / L^2. */
    assert_true(most > 4.6e6 && most < 3.0 * 4528e6 * 0.7e-3 * 0.01 / (0.114 * 0.114));
    wb_surface_release(&surface);
    wb_dataset_release(&dataset);
    read_all("surface/dataset.json", o.out, sizeof o.out);
    assert_int_equal(wb_json_parse(&root, o.out, "dataset.json"), WB_OK);
    assert_close(number(wb_json_get(root, "simulation"), "surface_deflection_mm"), 10.0, 1e-3);
    wb_json_destroy(root);
}

static int states_in(const char *name)
{
    int n = 0;
    read_all(name, o.out, sizeof o.out);
    for (const char *at = o.out; (at = strstr(at, "<DataSet ")); at++)
        n++;
    return n;
}

static void vtk_files_are_written_for_every_row_or_some(void **unused)
{
    (void)unused;
    assert_int_equal(solve("--duration-s 1.5 --vtk all --json"), 0);
    assert_int_equal(states_in("all/one.pvd"), 6);
    assert_true(is_there("all/one-0000.vtu") && is_there("all/one-0005.vtu"));
    assert_false(is_there("all/one-0006.vtu"));
    assert_non_null(strstr(o.out, "timestep=\"0\""));

    assert_int_not_equal(solve("--duration-s 1.5 --vtk all"), 0);
    assert_non_null(strstr(o.err, "--force"));
    assert_int_equal(solve("--duration-s 1.5 --vtk all --force"), 0);

    /* Rows 0, 3 and the last, 5. */
    assert_int_equal(solve("--duration-s 1.5 --vtk some --vtk-every 3"), 0);
    assert_int_equal(states_in("some/one.pvd"), 3);
    assert_false(is_there("some/one-0003.vtu"));

    /* Runs that begin anew leave nothing behind. */
    assert_int_equal(solve("--vtk anew --mass-scaling 400 --json"), 0);
    struct wb_json *root = NULL;
    assert_int_equal(wb_json_parse(&root, o.out, "output"), WB_OK);
    assert_true(number(root, "attempts") >= 2.0);
    wb_json_destroy(root);
    assert_int_equal(states_in("anew/one.pvd"), 6);

    assert_int_not_equal(solve("--vtk-every 2"), 0);
    assert_non_null(strstr(o.err, "--vtk-every needs --vtk"));
}

static void overridden_values_are_reported(void **unused)
{
    (void)unused;
    struct wb_json *root = NULL;
    bool flag = false;
    assert_int_equal(solve("--duration-s 0.5 --friction 0.3,0.2,1.5 --cohesive-stiffness 60 "
                           "--dead-force --mass-scaling 100 -o over"),
                     0);
    read_all("over/dataset.json", o.out, sizeof o.out);
    assert_int_equal(wb_json_parse(&root, o.out, "dataset.json"), WB_OK);
    const struct wb_json *simulation = wb_json_get(root, "simulation");
    const struct wb_json *over = wb_json_get(simulation, "overridden");
    assert_non_null(over);
    assert_close(number(over, "duration_s"), 0.5, 0.0);
    assert_close(number(over, "mass_scaling"), 100.0, 0.0);
    assert_close_relative(number(over, "cohesive_stiffness_N_mm3"), 60.0, 1e-15);
    assert_close(number(wb_json_get(over, "friction"), "static"), 0.3, 0.0);
    assert_close(number(wb_json_get(over, "friction"), "kinetic"), 0.2, 0.0);
    assert_close_relative(number(wb_json_get(over, "friction"), "decay_s_mm"), 1.5, 1e-15);
    assert_close(number(wb_json_get(simulation, "friction"), "kinetic"), 0.2, 0.0);
    assert_true(wb_json_get_boolean(over, "dead_force", &flag) && flag);
    assert_null(wb_json_get(over, "no_weight"));
    assert_null(wb_json_get(over, "mesh"));
    wb_json_destroy(root);

    assert_int_equal(solve("--duration-s 0.5 --friction 0.25 -o constant"), 0);
    read_all("constant/dataset.json", o.out, sizeof o.out);
    assert_int_equal(wb_json_parse(&root, o.out, "dataset.json"), WB_OK);
    const struct wb_json *friction = wb_json_get(wb_json_get(root, "simulation"), "friction");
    assert_close(number(friction, "static"), 0.25, 0.0);
    assert_close(number(friction, "kinetic"), 0.25, 0.0);
    assert_close(number(friction, "decay_s_mm"), 0.0, 0.0);
    wb_json_destroy(root);
}

static void options_of_other_commands_are_rejected(void **unused)
{
    (void)unused;
    assert_int_equal(solve("--span-mm 5"), 2);
    assert_non_null(strstr(o.err, "--span-mm"));
    assert_int_equal(solve("--mesh none"), 2);
    assert_non_null(strstr(o.err, "mesh 'none'"));
    assert_int_equal(solve("--mesh ''"), 2);
    assert_non_null(strstr(o.err, "--mesh: expected NAME, not ''"));
    assert_int_equal(solve("--checkpoint-minutes 10"), 2);
    assert_non_null(strstr(o.err, "--checkpoint-minutes needs --checkpoint"));
    assert_non_null(strstr(o.err, "Try `wirebench solve bundle --help'"));
    assert_int_not_equal(solve("--mass-scaling 0.5"), 0);
    assert_int_not_equal(solve("--cohesive-stiffness 0"), 0);
    assert_int_not_equal(solve("--friction 0.3,0.2"), 0);
    assert_non_null(strstr(o.err, "expected S or S,K,D"));
    assert_int_not_equal(solve("--friction 0.3,0.2,1,4"), 0);
    assert_int_not_equal(solve("--friction 0.3,,1"), 0);
    assert_int_not_equal(solve("--friction 0.2,0.3,1"), 0);
    assert_non_null(strstr(o.err, "more than the static one"));
    assert_int_not_equal(solve("--friction 11"), 0);
}

/* --- the section model --- */

static void the_section_model_names_itself_in_a_dataset_of_the_same_shape(void **unused)
{
    (void)unused;
    struct wb_dataset dataset;
    struct wb_json *root = NULL;
    char path[128];
    const char *solver = NULL;
    tool("solve bundle 7-type3 --model section --friction 0.4 -o section");
    assert_int_equal(o.code, 0);
    assert_string_equal(o.err, "");
    snprintf(path, sizeof path, "%s/section", folder);
    assert_int_equal(wb_dataset_read(&dataset, path, NULL), WB_OK);
    assert_int_equal(dataset.n_rows, 54);
    assert_int_equal(dataset.n_shape_rows, 54 * 26);
    assert_true(dataset.info.is_simulation);
    assert_close(dataset.info.outer_diameter, 4.6e-3, 1e-12);
    assert_close(dataset.info.strand_length, 0.76, 1e-12);
    assert_close(dataset.rows[0].force, 0.0, 0.0);
    assert_true(dataset.rows[0].tension > 0.02); /* the weight */
    assert_close(dataset.rows[53].deflection, 53e-3, 1e-9);
    /* The last marker is the tip. */
    const struct wb_shape_row *const tip = &dataset.shape_rows[dataset.n_shape_rows - 1];
    assert_close(tip->x, dataset.rows[53].tip_x, 1e-9);
    assert_close(tip->y, 53e-3, 1e-9);
    wb_dataset_release(&dataset);

    read_all("section/energies.csv", o.out, sizeof o.out);
    assert_non_null(strstr(o.out, "t_s,deflection_mm,external_J,wires_J,tape_J,cohesive_J,"
                                  "friction_J,imbalance_J\n"));
    read_all("section/dataset.json", o.out, sizeof o.out);
    assert_int_equal(wb_json_parse(&root, o.out, "dataset.json"), WB_OK);
    const struct wb_json *const simulation = wb_json_get(root, "simulation");
    assert_true(wb_json_get_text(simulation, "model", &solver));
    assert_string_equal(solver, "section");
    assert_close(number(simulation, "friction_used"), 0.4, 0.0);
    assert_true(number(wb_json_get(simulation, "largest"), "residual") <= 1e-6);
    assert_true(number(wb_json_get(simulation, "largest"), "imbalance_over_external") < 1e-3);
    const struct wb_json *const beam =
        wb_json_get(simulation, "homogenised_beam_of_this_length_and_these_ends");
    const struct wb_json *const elastic = wb_json_get(beam, "elastic");
    assert_int_equal(wb_json_length(elastic), 3);
    static const double length[] = {57.0, 114.0, 228.0};
    double first = 0.0;
    for (int i = 0; i < 3; i++) {
        const struct wb_json *const item = wb_json_item(elastic, i);
        const double alpha = number(item, "newmark_alpha_L") / length[i];
        assert_close(number(item, "length_mm"), length[i], 1e-9);
        /* Newmark's alpha is one of the section. */
        first = i > 0 ? first : alpha;
        assert_close_relative(alpha, first, 0.03);
    }
    const struct wb_json *const curve = wb_json_get(beam, "moment_curvature");
    assert_int_equal(wb_json_length(curve), 18);
    assert_close_relative(number(wb_json_item(curve, 0), "secant_rigidity_N_mm2"),
                          number(wb_json_item(elastic, 1), "flexural_rigidity_N_mm2"), 0.03);
    wb_json_destroy(root);
}

static void the_section_model_names_the_friction_used_for_a_decaying_one(void **unused)
{
    (void)unused;
    tool("solve bundle 7-type3 --model section --json");
    assert_int_equal(o.code, 0);
    assert_non_null(strstr(o.err, "mu = 0.2, the geometric mean"));
}

static void unsupported_inputs_of_the_section_model_name_the_explicit_one(void **unused)
{
    (void)unused;
    static const char *const explicit_options[] = {
        "--vtk states",   "--checkpoint kept", "--threads 2",   "--mesh paper",
        "--duration-s 1", "--mass-scaling 4",  "--selective 10"};
    char line[128], option[32];

    for (size_t i = 0; i < sizeof explicit_options / sizeof explicit_options[0]; i++) {
        snprintf(line, sizeof line, "solve bundle 7-type3 --model section %s", explicit_options[i]);
        tool(line);
        assert_int_equal(o.code, 2);
        snprintf(option, sizeof option, "%.*s applies", (int)strcspn(explicit_options[i], " "),
                 explicit_options[i]);
        if (!strstr(o.err, option))
            fail_msg("'%s' does not say '%s'", o.err, option);
    }
    tool("solve bundle 7-type3-helix --model section -o helix");
    assert_int_equal(o.code, 1);
    assert_non_null(strstr(o.err, "--model explicit"));
    assert_false(is_there("helix"));
}

static void the_section_model_reports_where_the_tape_detaches(void **unused)
{
    (void)unused;
    tool("solve bundle 12-type3-circle --model section --friction 0.2 --json");
    assert_int_equal(o.code, 0);
    assert_non_null(strstr(o.err, "from 4"));
    assert_non_null(strstr(o.err, "above 0.01"));
    tool("solve bundle 7-type3-circle --model section --friction 0.2 --dead-force --no-weight "
         "--json");
    assert_int_equal(o.code, 0);
    assert_string_equal(o.err, "");
}

static void the_section_model_reports_the_end_of_its_range(void **unused)
{
    (void)unused;
    static const char strand[] = "strand_mm: ";
    char path[WB_PATH], *text;
    size_t size;
    tool("solve bundle 7-type3 --model section --friction 0.2 --length-mm 5 --deflection-mm 2.3");
    assert_int_equal(o.code, 0);
    assert_non_null(strstr(o.err, "from 2 mm on the bundle"));
    assert_non_null(strstr(o.err, "radius below its own depth"));
    /* The strand of 760 mm becomes one of 20 mm, which lies level before the tip is at 90 mm. */
    assert_int_equal(wb_file_find_fixture(path, "bundles", "template", NULL), WB_OK);
    assert_int_equal(wb_file_read(path, &text, &size), WB_OK);
    char *const at = strstr(text, strand);
    assert_non_null(at);
    memcpy(at + strlen(strand), "20 ", 3);
    snprintf(path, sizeof path, "%s/level.yaml", folder);
    assert_int_equal(wb_file_write(path, text, size), WB_OK);
    free(text);
    tool("solve bundle level.yaml --model section --deflection-mm 90");
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.err, "no equilibrium was found beyond "));
    assert_non_null(strstr(o.err, "strand may be too short"));
}

/* A short look without a copy of the file. */
static void test_and_piece_are_options_as_of_the_cantilever(void **unused)
{
    (void)unused;
    struct wb_json *root = NULL;
    struct wb_dataset dataset;
    char path[128];
    tool("solve bundle 7-type3 --model section --friction 0.2 --dead-force --no-weight "
         "--deflection-mm 8 --points 4 --cycles 1 --length-mm 57 --packing densest --layers 1 "
         "--outline circle --bond-reach-mm 0.005 --json -o look");
    assert_int_equal(o.code, 0);
    assert_int_equal(wb_json_parse(&root, o.out, "output"), WB_OK);
    const struct wb_json *const points = wb_json_get(root, "points");
    assert_int_equal(wb_json_length(points), 9);
    assert_close(number(wb_json_item(points, 4), "deflection_mm"), 8.0, 1e-9);
    wb_json_destroy(root);
    snprintf(path, sizeof path, "%s/look", folder);
    assert_int_equal(wb_dataset_read(&dataset, path, NULL), WB_OK);
    assert_close(dataset.info.length, 0.057, 1e-15);
    const struct wb_json *const given =
        wb_json_get(wb_json_get(dataset.document, "simulation"), "overridden");
    const char *text = "";
    assert_close(number(given, "length_mm"), 57.0, 1e-9);
    assert_close(number(given, "rows"), 4.0, 0.0);
    assert_close(number(given, "layers"), 1.0, 0.0);
    assert_close(number(given, "bond_reach_mm"), 0.005, 1e-9);
    assert_true(wb_json_get_text(given, "packing", &text) && strcmp(text, "densest") == 0);
    wb_dataset_release(&dataset);

    assert_int_equal(solve("--deflection-mm 4 --points 2 --length-mm 60 --duration-s 0.5 --json"),
                     0);
    assert_int_equal(wb_json_parse(&root, o.out, "output"), WB_OK);
    assert_int_equal(wb_json_length(wb_json_get(root, "points")), 3);
    assert_close(number(wb_json_item(wb_json_get(root, "points"), 2), "tip_x_mm"), 60.0, 0.5);
    wb_json_destroy(root);
}

static void impossible_geometry_is_reported_with_its_options(void **unused)
{
    (void)unused;
    assert_int_equal(solve("--length-mm 10"), 2);
    assert_non_null(strstr(o.err, "--length-mm"));
    tool("solve bundle 7-type3 --packing triangle");
    assert_int_equal(o.code, 1);
    assert_non_null(strstr(o.err, "7 wires do not fill a triangle; 6 or 12 do"));
    assert_int_equal(solve("--packing places"), 2);
    assert_non_null(strstr(o.err, "expected file, hexagon, triangle or densest"));
    assert_int_equal(solve("--layers 1"), 1);
    assert_non_null(strstr(o.err, "applies to a tape"));
    tool("solve wire3d none --cycles 2");
    assert_int_equal(o.code, 2);
    assert_non_null(strstr(o.err, "--cycles applies to cantilever and bundle and bending3p"));
}

/* The last one: it changes the model. */
static void cycles_have_rows_up_and_down(void **unused)
{
    char command[256];
    (void)unused;
    snprintf(command, sizeof command, "cd %s && sed -i 's/rows: 5/rows: 5, cycles: 2/' one.yaml",
             folder);
    assert_int_equal(system(command), 0);
    assert_int_equal(solve("--duration-s 1.5 -o cycles"), 0);
    struct wb_dataset dataset;
    snprintf(command, sizeof command, "%s/cycles", folder);
    assert_int_equal(wb_dataset_read(&dataset, command, NULL), WB_OK);
    assert_int_equal(dataset.n_rows, 21);
    assert_int_equal(dataset.rows[20].cycle, 2);
    assert_close(dataset.rows[15].deflection, 10e-3, 1e-6);
    wb_dataset_release(&dataset);
}

static double json_number(const struct wb_json *object, const char *key)
{
    double value = (double)NAN;
    assert_true(wb_json_get_number(object, key, &value));
    return value;
}

/* Of the template that users copy: bands, table, figure, ranking, and none of it left behind by a
 * run without. */
static void bands_are_written_beside_the_curve_and_summarised(void **unused)
{
    (void)unused;
    char path[WB_PATH];
    struct wb_json *document;
    tool("solve bundle template --uncertain --runs 30 --sweep layers=1,2 -o bands");
    assert_int_equal(o.code, 0);
    assert_non_null(strstr(o.out, "90 % bands of 30 runs a case"));
    assert_non_null(strstr(o.out, "\nlayers=2 "));
    read_all("bands/bands.csv", o.out, sizeof o.out);
    assert_non_null(strstr(o.out, "\nfile,force_N,53,"));
    assert_non_null(strstr(o.out, "\nlayers=1,deflection_springback,53,"));
    assert_non_null(strstr(o.out, "\nlayers=2,moment_N_mm,"));
    read_all("bands/cases.csv", o.out, sizeof o.out);
    assert_non_null(strstr(o.out, "\nlayers=1,7,hexagon,1,hull,30,0,0,53,"));
    snprintf(path, sizeof path, "%s/bands/bands.svg", folder);
    assert_true(wb_file_exists(path));
    snprintf(path, sizeof path, "%s/bands/dataset.json", folder);
    assert_int_equal(wb_json_read(&document, path), WB_OK);
    const struct wb_json *const member =
        wb_json_get(wb_json_get(document, "simulation"), "uncertainty");
    assert_close(json_number(member, "model_error"), 0.02, 0.0);
    assert_int_equal(wb_json_length(wb_json_get(member, "cases")), 3);
    const struct wb_json *const file = wb_json_item(wb_json_get(member, "cases"), 0);
    const struct wb_json *const force = wb_json_get(file, "force_N");
    assert_true(json_number(force, "low") < json_number(force, "runs_low"));
    assert_true(json_number(force, "runs_low") < json_number(force, "median"));
    assert_int_equal(wb_json_length(wb_json_get(file, "ranking")), 3);
    wb_json_destroy(document);
    tool("solve bundle 7-type3 --model section -o bands --force");
    assert_int_equal(o.code, 0);
    static const char *const gone[] = {"bands.csv", "cases.csv", "bands.svg"};
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/bands/%s", folder, gone[i]);
        assert_false(wb_file_exists(path));
    }
}

static void bands_without_stated_uncertainties_are_rejected(void **unused)
{
    (void)unused;
    tool("solve bundle 7-type3 --uncertain");
    assert_int_equal(o.code, 2);
    assert_non_null(strstr(o.err, "uncertainty: this section is missing"));
    tool("solve bundle template --uncertain --friction 0.2");
    assert_int_equal(o.code, 2);
    assert_non_null(strstr(o.err, "--friction: bands"));
    tool("solve bundle template --uncertain --cohesive-stiffness 20");
    assert_int_equal(o.code, 2);
    assert_non_null(strstr(o.err, "--cohesive-stiffness: bands"));
    tool("solve bundle template --sweep layers=1");
    assert_int_not_equal(o.code, 0);
    assert_non_null(strstr(o.err, "--sweep needs --uncertain"));
    tool("solve bundle template --model section --runs 30");
    assert_int_equal(o.code, 2);
    assert_non_null(strstr(o.err, "--runs and --seed"));
    tool("solve bundle template --uncertain --runs 30 --sweep colour=1");
    assert_int_equal(o.code, 2);
    assert_non_null(strstr(o.err, "--sweep: 'colour=1'"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(json_has_the_curve_and_its_cost),
        cmocka_unit_test(a_line_shows_the_progress),
        cmocka_unit_test(datasets_are_those_of_the_homogenised_beam),
        cmocka_unit_test(datasets_have_the_bent_surface),
        cmocka_unit_test(vtk_files_are_written_for_every_row_or_some),
        cmocka_unit_test(overridden_values_are_reported),
        cmocka_unit_test(options_of_other_commands_are_rejected),
        cmocka_unit_test(the_section_model_names_itself_in_a_dataset_of_the_same_shape),
        cmocka_unit_test(the_section_model_names_the_friction_used_for_a_decaying_one),
        cmocka_unit_test(unsupported_inputs_of_the_section_model_name_the_explicit_one),
        cmocka_unit_test(the_section_model_reports_where_the_tape_detaches),
        cmocka_unit_test(the_section_model_reports_the_end_of_its_range),
        cmocka_unit_test(bands_are_written_beside_the_curve_and_summarised),
        cmocka_unit_test(bands_without_stated_uncertainties_are_rejected),
        cmocka_unit_test(test_and_piece_are_options_as_of_the_cantilever),
        cmocka_unit_test(impossible_geometry_is_reported_with_its_options),
        cmocka_unit_test(cycles_have_rows_up_and_down),
    };
    return cmocka_run_group_tests(tests, set_up, check_and_remove_folder);
}
