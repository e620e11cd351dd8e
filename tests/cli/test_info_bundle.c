/* `wirebench info` for bundle files. WIREBENCH_BINARY is the path of the tool. */
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/json.h"
#include "tests/cli/tool.h"

static void a_bundle_is_described(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "bundle 19-mixed\n", "10 x type3, 1.4 mm\n", "9 x type2, 1.25 mm\n", "hexagon\n",
        "tape, sleeve\n",    "114 mm (inferred)\n",  "outer diameter",       "engineering",
        "612864 hexahedra",  "E I, wires bonded",
    };
    /* The tool runs in another folder, where this path does not exist. */
    expect("info fixtures/bundles/19-mixed.yaml", 0, "");
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        if (!strstr(o.out, lines[i]))
            fail_msg("no '%s' in %s", lines[i], o.out);
    }
    assert_string_equal(o.err, "");
}

/* Every command finds a shipped file by its name, even if the current folder has a subfolder of
 * that name, and a file by its path. */
static void shipped_files_are_found_by_name_or_path(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "info 7-type3",
        "info fixtures/bundles/7-type3.yaml",
        "solve bundle 7-type3 --model section -o named",
        "solve bundle copy --model section -o copied",
        "solve bending3p type1 --span-mm 40 --deflection-mm 1",
        "solve cantilever --wire type1 --length-mm 100 --deflection-mm 1",
        "export type1 --to table -o card.txt",
    };
    char *text;
    size_t size;
    char path[WB_PATH];
    assert_int_equal(wb_file_find_fixture(path, "bundles", "7-type3", NULL), WB_OK);
    assert_int_equal(wb_file_read(path, &text, &size), WB_OK);
    assert_int_equal(wb_file_write(path_of("copy"), text, size), WB_OK);
    free(text);
    assert_int_equal(wb_file_make_folder(path_of("7-type3")), WB_OK);
    assert_int_equal(wb_file_make_folder(path_of("type1")), WB_OK);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        expect(lines[i], 0, "");
    static const char *const wrong[] = {
        "info no-such",
        "solve bundle no-such",
        "solve wire3d no-such",
        "solve wire1d no-such",
        "solve bending3p no-such --span-mm 40 --deflection-mm 1",
        "export no-such --to table -o other.txt",
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        expect(wrong[i], 1, "no 'no-such' among the shipped ");
}

static void json_has_the_geometry_and_rigidities(void **state)
{
    (void)state;
    struct wb_json *root;
    expect("info fixtures/bundles/7-type3.yaml --json", 0, "");
    assert_int_equal(wb_json_parse(&root, o.out, "info"), WB_OK);
    assert_close(number(root, "outer_diameter_mm"), 4.6, 1e-9);
    assert_close_relative(number(root, "density_at_published_diameter_g_cm3"),
                          number(root, "published_density_g_cm3"), 0.005);
    assert_true(number(root, "sliding_EI_N_mm2") < number(root, "published_EI_N_mm2"));
    assert_true(number(root, "published_EI_N_mm2") < number(root, "bonded_EI_N_mm2"));
    const struct wb_json *const wires = wb_json_get(root, "wires");
    assert_int_equal(wb_json_length(wires), 7);
    assert_close(number(wb_json_item(wires, 0), "tape_contact_degrees"), 0.0, 0.0);
    assert_close(number(wb_json_item(wires, 3), "tape_contact_degrees"), 60.0, 1e-9);
    assert_close(
        hypot(number(wb_json_item(wires, 3), "y_mm"), number(wb_json_item(wires, 3), "z_mm")), 1.4,
        1e-9);
    const struct wb_json *const meshes = wb_json_get(root, "meshes");
    assert_int_equal(wb_json_length(meshes), 2);
    assert_close(number(wb_json_item(meshes, 1), "hexahedra"), 225792.0, 0.0);
    wb_json_destroy(root);
}

/* A circular tape touches the outer wires only along lines; it is bonded where the gap is within
 * reach. The angle of this range, seen from a wire's centre, follows from the law of cosines. */
static void circular_tape_is_bonded_to_wires_within_reach(void **state)
{
    (void)state;
    struct wb_json *root;
    const double R = 2.1, r = 0.7, a = 1.4, reach = 0.005, far = r + reach;
    const double expected = 2.0 * acos((R * R - a * a - far * far) / (2.0 * a * far));
    expect("info fixtures/bundles/7-type3-circle.yaml --json", 0, "");
    assert_int_equal(wb_json_parse(&root, o.out, "info"), WB_OK);
    const struct wb_json *const wires = wb_json_get(root, "wires");
    int touching = 0;
    for (int i = 0; i < 7; i++) {
        const struct wb_json *const wire = wb_json_item(wires, i);
        const bool outer = hypot(number(wire, "y_mm"), number(wire, "z_mm")) > 1.0;
        bool touches = false;
        assert_true(wb_json_get_boolean(wire, "touches_tape", &touches));
        assert_int_equal(touches, outer);
        touching += touches;
        assert_close(number(wire, "tape_contact_degrees"), outer ? expected * 180.0 / M_PI : 0.0,
                     0.05);
    }
    assert_close(number(root, "wires_at_tape"), touching, 0.0);
    wb_json_destroy(root);
}

static void a_section_is_drawn(void **state)
{
    (void)state;
    static const char *const beginnings[] = {"<?xml", "\x89PNG", "%PDF"};
    static const char *const names[] = {"a.svg", "a.png", "a.pdf"};
    for (int i = 0; i < 3; i++) {
        char arguments[128], text[4096];
        snprintf(arguments, sizeof arguments, "info fixtures/bundles/12-type3.yaml --figure %s",
                 names[i]);
        expect(arguments, 0, "");
        assert_non_null(strstr(o.out, names[i]));
        read_all(names[i], text, sizeof text);
        assert_memory_equal(text, beginnings[i], 4);
    }
    /* An existing figure is replaced only with --force; a finer mesh gives a larger file. */
    char *first, *second;
    size_t n_first, n_second;
    assert_int_equal(wb_file_read(path_of("a.svg"), &first, &n_first), WB_OK);
    expect("info fixtures/bundles/12-type3.yaml --figure a.svg --mesh paper", 1, "--force");
    expect("info fixtures/bundles/12-type3.yaml --figure a.svg --mesh paper --force", 0, "");
    assert_int_equal(wb_file_read(path_of("a.svg"), &second, &n_second), WB_OK);
    assert_true(n_second > n_first);
    free(first);
    free(second);
}

static void wrong_usage_and_files_are_rejected(void **state)
{
    (void)state;
    expect("info fixtures/bundles/12-type3.yaml --figure a.gif", 2, "--figure");
    expect("info fixtures/bundles/12-type3.yaml --mesh paper", 2, "--mesh needs --figure");
    expect("info a.wbr --figure b.svg", 2, "--figure applies to bundles, and 'a.wbr'");
    expect("info", 2, "name a file");
    expect("info none.yaml", 1, "none.yaml");
    expect("info fixtures/bundles/12-type3.yaml --figure b.svg --mesh none", 2, "mesh 'none'");
    expect("info fixtures/bundles/12-type3.yaml --figure b.svg --mesh ''", 2, "--mesh: ");
    assert_false(wb_file_exists(path_of("b.svg")));
    expect("info fixtures/wires/type1.yaml --figure b.svg", 2, "is not a bundle");
    expect("info fixtures/bundles/12-type3.yaml --figure none/b.svg", 1, "none/b.svg");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bundle_is_described),
        cmocka_unit_test(shipped_files_are_found_by_name_or_path),
        cmocka_unit_test(json_has_the_geometry_and_rigidities),
        cmocka_unit_test(circular_tape_is_bonded_to_wires_within_reach),
        cmocka_unit_test(a_section_is_drawn),
        cmocka_unit_test(wrong_usage_and_files_are_rejected),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
