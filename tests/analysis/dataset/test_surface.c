/* Surfaces of bundles in datasets: what is kept of the fields, and files that read back. */
#include "analysis/dataset/surface.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "base/text.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

static int tear_down(void **state)
{
    wb_log_set_sink(NULL, NULL);
    return remove_folder(state);
}

static const char *path_of_file(void)
{
    static char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, "surface.csv"), WB_OK);
    return path;
}

/* A wire whose section has a node within its outline, and a tape; points tell their places. */
struct body_sizes {
    int outline, ring, stations;
    bool closed;
};

static struct wb_bundle_fields make_fields(const struct body_sizes *s)
{
    struct wb_bundle_fields f = {.n_bodies = 2};
    f.n_points = (s->outline + 1 + s->ring) * s->stations;
    f.bodies = wb_memory_take(&f.memory, 2, sizeof *f.bodies);
    f.position = wb_memory_take(&f.memory, (size_t)f.n_points, sizeof *f.position);
    f.von_mises = wb_memory_take(&f.memory, (size_t)f.n_points, sizeof *f.von_mises);
    assert_true(f.bodies && f.position && f.von_mises);
    f.bodies[0] = (struct wb_bundle_fields_body){.closed = true,
                                                 .n_nodes = s->outline + 1,
                                                 .n_stations = s->stations,
                                                 .n_outline = s->outline};
    f.bodies[1] = (struct wb_bundle_fields_body){.is_tape = true,
                                                 .closed = s->closed,
                                                 .n_nodes = s->ring,
                                                 .n_stations = s->stations,
                                                 .first = (s->outline + 1) * s->stations};
    f.bodies[0].outline = wb_memory_take(&f.memory, (size_t)s->outline, sizeof(int));
    assert_non_null(f.bodies[0].outline);
    for (int k = 0; k < s->outline; k++)
        f.bodies[0].outline[k] = s->outline - k; /* node 0 lies inside */
    for (int b = 0; b < 2; b++) {
        const struct wb_bundle_fields_body *body = &f.bodies[b];
        for (int i = 0; i < body->n_nodes * body->n_stations; i++) {
            double *at = f.position[body->first + i];
            at[0] = 1e-3 * (i / body->n_nodes);
            at[1] = 1e-3 * (i % body->n_nodes);
            at[2] = -1e-3 * b;
            f.von_mises[body->first + i] = 1e6 * (1 + i);
        }
    }
    return f;
}

static void small_meshes_are_kept_whole(void **unused)
{
    (void)unused;
    const struct body_sizes sizes = {4, 6, 3, true};
    struct wb_bundle_fields f = make_fields(&sizes);
    struct wb_surface surface;
    wb_surface_take(&surface, &f);
    assert_int_equal(surface.n, 2);
    const struct wb_surface_body *wire = &surface.bodies[0], *tape = &surface.bodies[1];
    assert_true(!wire->is_tape && wire->closed && tape->is_tape && tape->closed);
    assert_int_equal(wire->n_around, 4);
    assert_int_equal(wire->n_along, 3);
    assert_int_equal(tape->n_around, 6);
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 4; k++) {
            const struct wb_surface_node *node = &wire->nodes[4 * j + k];
            assert_close(node->position[0], 1e-3 * j, 0.0);
            assert_close(node->position[1], 1e-3 * (4 - k), 0.0);
            assert_close(node->von_mises, 1e6 * (1 + 5 * j + 4 - k), 0.0);
        }
    assert_close(tape->nodes[17].von_mises, 18e6, 0.0);
    assert_close(tape->nodes[17].position[2], -1e-3, 0.0);
    wb_surface_release(&surface);
    wb_surface_release(&surface);
    wb_bundle_fields_release(&f);
}

/* Ends are kept; a closed ring is thinned evenly, a strip with both of its edges. */
static void large_meshes_are_thinned(void **unused)
{
    (void)unused;
    for (int closed = 0; closed < 2; closed++) {
        const struct body_sizes sizes = {72, 100, 385, closed};
        struct wb_bundle_fields f = make_fields(&sizes);
        struct wb_surface surface;
        wb_surface_take(&surface, &f);
        const struct wb_surface_body *wire = &surface.bodies[0], *tape = &surface.bodies[1];
        assert_int_equal(wire->n_along, WB_SURFACE_ALONG);
        assert_int_equal(wire->n_around, WB_SURFACE_AROUND_WIRE);
        assert_int_equal(tape->n_around, WB_SURFACE_AROUND_TAPE);
        assert_int_equal(tape->n_along, closed ? WB_SURFACE_ALONG : WB_SURFACE_ALONG_STRIP);
        const int last = (WB_SURFACE_ALONG - 1) * WB_SURFACE_AROUND_WIRE;
        assert_close(wire->nodes[0].position[0], 0.0, 0.0);
        assert_close(wire->nodes[last].position[0], 0.384, 1e-12);
        for (int k = 0; k < WB_SURFACE_AROUND_WIRE; k++)
            assert_close(wire->nodes[k].position[1], 1e-3 * (72 - 3 * k), 1e-12);
        const double end = tape->nodes[WB_SURFACE_AROUND_TAPE - 1].position[1];
        assert_close(tape->nodes[0].position[1], 0.0, 0.0);
        assert_close(end, closed ? 97e-3 : 99e-3, 1e-12);
        wb_surface_release(&surface);
        wb_bundle_fields_release(&f);
    }
}

static void files_read_back(void **unused)
{
    (void)unused;
    const struct body_sizes sizes = {4, 6, 3, false};
    struct wb_bundle_fields f = make_fields(&sizes);
    struct wb_surface written, read;
    wb_surface_take(&written, &f);
    written.bodies[0].nodes[7].position[1] = -0.0123456789;
    written.bodies[0].nodes[7].von_mises = 12345678.0;
    written.bodies[0].nodes[8].position[2] = -1e-12;
    assert_int_equal(wb_surface_write(&written, folder), WB_OK);
    assert_int_equal(wb_surface_read(&read, folder, NULL), WB_OK);
    assert_int_equal(read.n, 2);
    for (int b = 0; b < 2; b++) {
        const struct wb_surface_body *a = &written.bodies[b], *c = &read.bodies[b];
        assert_int_equal(a->is_tape, c->is_tape);
        assert_int_equal(a->closed, c->closed);
        assert_int_equal(a->n_around, c->n_around);
        assert_int_equal(a->n_along, c->n_along);
        for (int i = 0; i < a->n_around * a->n_along; i++) {
            for (int k = 0; k < 3; k++)
                assert_close(c->nodes[i].position[k], a->nodes[i].position[k], 0.5001e-6);
            assert_close_relative(c->nodes[i].von_mises, a->nodes[i].von_mises, 0.5001e-3);
        }
    }
    char *text;
    assert_int_equal(wb_file_read(path_of_file(), &text, NULL), WB_OK);
    assert_non_null(strstr(text, "\n0,wire,1,3,1,-12.346,0,12.35\n"));
    assert_non_null(strstr(text, "\n0,wire,2,0,2,4,0,"));
    assert_non_null(strstr(text, "\n1,strip,0,0,0,0,-1,1\n"));
    free(text);
    wb_surface_release(&read);
    wb_surface_release(&written);
    wb_bundle_fields_release(&f);

    /* None takes the file away. */
    assert_int_equal(wb_surface_write(&written, folder), WB_OK);
    assert_false(wb_file_exists(path_of_file()));
    assert_int_equal(wb_surface_write(&written, folder), WB_OK);
    assert_int_equal(wb_surface_read(&read, folder, NULL), WB_OK);
    assert_int_equal(read.n, 0);
}

static void what_is_not_finite_is_not_written(void **unused)
{
    (void)unused;
    const struct body_sizes sizes = {4, 6, 3, true};
    struct wb_bundle_fields f = make_fields(&sizes);
    struct wb_surface surface;
    wb_surface_take(&surface, &f);
    wb_log_set_sink(discard_message, NULL);
    surface.bodies[1].nodes[3].von_mises = (double)NAN;
    assert_int_equal(wb_surface_write(&surface, folder), WB_ERR_DATA);
    assert_false(wb_file_exists(path_of_file()));
    wb_surface_release(&surface);
    wb_bundle_fields_release(&f);
}

#define HEAD "body,kind,station,node,x_mm,y_mm,z_mm,von_mises_MPa\n"
#define AT(j, k, y, z) "0,wire," j "," k ",0," y "," z ",1\n"
#define RING(j) "0,wire," j ",0,0,0,0,1\n0,wire," j ",1,0,1,0,1\n0,wire," j ",2,0,0,1,1\n"

static void bad_files_are_refused(void **unused)
{
    (void)unused;
    static const char *const bad[] = {
        "",
        "body,kind\n",
        "body,kind,station,node,x_mm,y_mm,z_mm,von_mises\n",
        HEAD "0,wire,0,0,0,0,0\n",
        HEAD "0,rope,0,0,0,0,0,1\n",
        HEAD "x,wire,0,0,0,0,0,1\n",
        HEAD "0,wire,-1,0,0,0,0,1\n",
        HEAD "0,wire,0,0,0,zero,0,1\n",
        HEAD RING("0"),                                  /* one station */
        HEAD RING("0") "0,wire,1,0,0,0,0,1\n",           /* not whole */
        HEAD RING("0") RING("2"),                        /* one left out */
        HEAD RING("0") RING("1") "2,wire,0,0,0,0,0,1\n", /* a body left out */
        HEAD RING("0") RING("1") "0,tape,2,0,0,0,0,1\n", /* another kind */
        HEAD RING("0") RING("1") "0,wire,1,3,0,0,0,1\n", /* one too many */
        HEAD RING("0") "1,wire,0,0,0,0,0,1\n",           /* the next too early */
        HEAD "0,wire,0,0,0,0,0,1\n0,wire,0,1,0,0,0,1\n"  /* a ring of two */
             "0,wire,1,0,0,0,0,1\n0,wire,1,1,0,0,0,1\n",
        /* a station at one place, the first or the last */
        HEAD AT("0", "0", "1", "1") AT("0", "1", "1", "1") AT("0", "2", "1", "1") RING("1"),
        HEAD RING("0") AT("1", "0", "1", "1") AT("1", "1", "1", "1") AT("1", "2", "1", "1"),
        HEAD RING("0") AT("1", "0", "1e300", "0") AT("1", "1", "0", "0") AT("1", "2", "0", "1"),
        HEAD RING("0") AT("1", "0", "-100001", "0") AT("1", "1", "0", "0") AT("1", "2", "0", "1"),
        HEAD RING("0") "0,wire,1,0,0,0,0,1e10\n0,wire,1,1,0,1,0,1\n0,wire,1,2,0,0,1,1\n",
    };
    struct wb_surface surface;
    keep_messages();
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct wb_reason why = {.text = ""};
        assert_int_equal(wb_file_write(path_of_file(), bad[i], strlen(bad[i])), WB_OK);
        if (wb_surface_read(&surface, folder, NULL) != WB_ERR_FORMAT)
            fail_msg("was taken: %s", bad[i]);
        assert_int_equal(surface.n, 0);
        /* Who asks for the reason gets the same message, and the log gets nothing. */
        char logged[sizeof kept.last];
        memcpy(logged, kept.last, sizeof kept.last);
        kept.last[0] = '\0';
        assert_int_equal(wb_surface_read(&surface, folder, &why), WB_ERR_FORMAT);
        assert_string_equal(why.text, logged);
        assert_string_equal(kept.last, "");
    }
    /* The place of a node that is beyond int, and 100000 modulo 2^32. */
    struct wb_text text = {0};
    wb_text_append(&text, "%s", HEAD);
    for (int k = 0; k < 100000; k++)
        wb_text_append(&text, "0,wire,0,%d,0,%d,0,1\n", k, k % 2);
    wb_text_append(&text, "0,wire,42950,67296,0,0,0,1\n");
    assert_int_equal(wb_file_write(path_of_file(), wb_text_string(&text), text.length), WB_OK);
    keep_messages();
    assert_int_equal(wb_surface_read(&surface, folder, NULL), WB_ERR_FORMAT);
    assert_message(":100002: node: station 42950, node 67296 ");
    wb_text_release(&text);

    static const char good[] = HEAD RING("0") RING("1");
    assert_int_equal(wb_file_write(path_of_file(), good, strlen(good)), WB_OK);
    assert_int_equal(wb_surface_read(&surface, folder, NULL), WB_OK);
    assert_int_equal(surface.bodies[0].n_along, 2);
    wb_surface_release(&surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_meshes_are_kept_whole),
        cmocka_unit_test(large_meshes_are_thinned),
        cmocka_unit_test(files_read_back),
        cmocka_unit_test(what_is_not_finite_is_not_written),
        cmocka_unit_test(bad_files_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, tear_down);
}
