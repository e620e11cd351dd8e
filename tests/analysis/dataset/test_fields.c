/* fields.csv: what is written is read again, and what is wrong is refused with line and column. */
#include "tests/messages.h"
#include "tests/own_folder.h"

#include <stdlib.h>
#include <unistd.h>

#include "analysis/dataset/fields.h"
#include "base/file.h"

static void fill(struct wb_field *field, double seed)
{
    for (int f = 0; f < field->n_faces; f++) {
        field->faces[f].part = f % 2;
        for (int k = 0; k < 8; k++) {
            struct wb_field_node *const node = &field->faces[f].node[k];
            const double v = seed + f + 0.1 * k;
            for (int i = 0; i < 3; i++) {
                node->reference[i] = 1e-3 * (v + i / 3.0);
                node->position[i] = -2e-3 * (v - i / 7.0);
            }
            node->von_mises = 1e8 * v / 3.0;
            node->axial = k == 3 ? 0.0 : -1e8 * v / 7.0;
            node->plastic = 1e-5 * v / 9.0;
            if (k == 5)
                node->position[2] = -3e-18;
        }
    }
}

static void make_fields(struct wb_fields *fields)
{
    struct wb_field *field;
    *fields = (struct wb_fields){0};
    assert_int_equal(wb_fields_add(fields, "unloaded", (double)NAN, 3, &field, NULL), WB_OK);
    fill(field, 1.0);
    assert_int_equal(wb_fields_add(fields, "unloaded", 3.26e-3, 2, &field, NULL), WB_OK);
    fill(field, 2.0);
    assert_int_equal(wb_fields_add(fields, "unloaded", 50e-3, 1, &field, NULL), WB_OK);
    fill(field, 3.0);
    assert_int_equal(wb_fields_add(fields, "loaded", (double)NAN, 5, &field, NULL), WB_OK);
    fill(field, 4.0);
}

/* To the 6 digits that are kept. */
static void assert_kept(double actual, double written)
{
    assert_close(actual, fabs(written) < 1e-15 ? 0.0 : written, 5.01e-6 * fabs(written));
}

static void fields_come_back(void **state)
{
    (void)state;
    struct wb_fields written, read, again;
    make_fields(&written);
    assert_int_equal(wb_fields_write(&written, folder), WB_OK);
    assert_int_equal(wb_fields_read(&read, folder, NULL), WB_OK);
    assert_int_equal(read.n, written.n);
    for (int i = 0; i < read.n; i++) {
        const struct wb_field *const a = &read.items[i], *const b = &written.items[i];
        assert_string_equal(a->state, b->state);
        assert_true(isnan(a->x) ? isnan(b->x) : a->x == b->x);
        assert_int_equal(a->n_faces, b->n_faces);
        for (int f = 0; f < a->n_faces; f++) {
            assert_int_equal(a->faces[f].part, b->faces[f].part);
            for (int k = 0; k < 8; k++) {
                const struct wb_field_node *const p = &a->faces[f].node[k];
                const struct wb_field_node *const q = &b->faces[f].node[k];
                for (int j = 0; j < 3; j++) {
                    assert_kept(p->reference[j], q->reference[j]);
                    assert_kept(p->position[j], q->position[j]);
                }
                assert_kept(p->von_mises, q->von_mises);
                assert_kept(p->axial, q->axial);
                assert_kept(p->plastic, q->plastic);
            }
        }
    }
    /* What was rounded once stays, bit for bit. */
    assert_int_equal(wb_fields_write(&read, folder), WB_OK);
    assert_int_equal(wb_fields_read(&again, folder, NULL), WB_OK);
    for (int i = 0; i < read.n; i++)
        assert_memory_equal(again.items[i].faces, read.items[i].faces,
                            (size_t)read.items[i].n_faces * sizeof *read.items[i].faces);
    wb_fields_release(&written);
    wb_fields_release(&read);
    wb_fields_release(&again);
    wb_fields_release(&again);
}

static void file_is_as_documented(void **state)
{
    (void)state;
    struct wb_fields fields;
    char path[WB_PATH], *text;
    make_fields(&fields);
    assert_int_equal(wb_fields_write(&fields, folder), WB_OK);
    wb_fields_release(&fields);
    assert_int_equal(wb_file_join(path, folder, "fields.csv"), WB_OK);
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    static const char begin[] =
        "state,section,at_mm,face,part,node,X_mm,Y_mm,Z_mm,x_mm,y_mm,z_mm,von_mises_MPa,axial_MPa,"
        "plastic_strain\n"
        "unloaded,longitudinal,,0,0,0,1,1.33333,1.66667,-2,-1.71429,-1.42857,33.3333,"
        "-14.2857,0.00000111111\n";
    assert_memory_equal(text, begin, strlen(begin));
    assert_non_null(strstr(text, "\nunloaded,cross,3.26,1,1,7,3.7,"));
    free(text);
}

static void field_is_found_by_state_and_place(void **state)
{
    (void)state;
    struct wb_fields fields;
    make_fields(&fields);
    assert_ptr_equal(wb_fields_find(&fields, "unloaded", (double)NAN), &fields.items[0]);
    assert_ptr_equal(wb_fields_find(&fields, "unloaded", 0.0), &fields.items[1]);
    assert_ptr_equal(wb_fields_find(&fields, "unloaded", 26.6e-3), &fields.items[1]);
    assert_ptr_equal(wb_fields_find(&fields, "unloaded", 26.7e-3), &fields.items[2]);
    assert_ptr_equal(wb_fields_find(&fields, "loaded", (double)NAN), &fields.items[3]);
    assert_null(wb_fields_find(&fields, "loaded", 50e-3));
    assert_null(wb_fields_find(&fields, "nothing", (double)NAN));
    wb_fields_release(&fields);
}

static void no_fields_is_no_file(void **state)
{
    (void)state;
    struct wb_fields fields = {0}, read;
    char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, "fields.csv"), WB_OK);
    assert_int_equal(wb_fields_write(&fields, folder), WB_OK);
    assert_false(wb_file_exists(path));
    assert_int_equal(wb_fields_read(&read, folder, NULL), WB_OK);
    assert_int_equal(read.n, 0);

    /* Those of an older run do not stay. */
    make_fields(&fields);
    assert_int_equal(wb_fields_write(&fields, folder), WB_OK);
    wb_fields_release(&fields);
    assert_true(wb_file_exists(path));
    assert_int_equal(wb_fields_write(&fields, folder), WB_OK);
    assert_false(wb_file_exists(path));
}

static void impossible_fields_are_refused(void **state)
{
    (void)state;
    struct wb_fields fields = {0};
    struct wb_field *field;
    static const char *const names[] = {"", "a,b", "a\"b", "a\nb",
                                        "a name of more than thirty-one bytes"};
    keep_messages();
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        assert_int_equal(wb_fields_add(&fields, names[i], 0.0, 1, &field, NULL), WB_ERR_ARGUMENT);
    assert_int_equal(wb_fields_add(&fields, "a", 0.0, 0, &field, NULL), WB_ERR_ARGUMENT);

    make_fields(&fields);
    fields.items[1].faces[1].node[5].axial = (double)NAN;
    assert_int_equal(wb_fields_write(&fields, folder), WB_ERR_DATA);
    assert_message("state unloaded, face 1: axial_MPa");
    fields.items[1].faces[1].node[5].axial = 0.0;
    fields.items[3].faces[0].node[0].position[2] = HUGE_VAL;
    assert_int_equal(wb_fields_write(&fields, folder), WB_ERR_DATA);
    assert_message("state loaded, face 0: z_mm");
    wb_fields_release(&fields);
    wb_log_set_sink(NULL, NULL);
}

/* --- reading what others wrote --- */

#define HEADER                                                                                     \
    "state,section,at_mm,face,part,node,X_mm,Y_mm,Z_mm,x_mm,y_mm,z_mm,von_mises_MPa,axial_MPa,"    \
    "plastic_strain\n"

static enum wb_status read_bytes(const char *text, size_t size, struct wb_fields *fields)
{
    char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, "fields.csv"), WB_OK);
    FILE *const file = fopen(path, "w");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    keep_messages();
    const enum wb_status status = wb_fields_read(fields, folder, NULL);
    /* Who asks for the reason gets the same message, and the log gets nothing. */
    if (status != WB_OK) {
        struct wb_reason why = {.text = ""};
        const int before = kept.n;
        assert_int_equal(wb_fields_read(fields, folder, &why), status);
        assert_string_equal(why.text, kept.last);
        assert_int_equal(kept.n, before);
    }
    wb_log_set_sink(NULL, NULL);
    assert_int_equal(unlink(path), 0);
    return status;
}

/* A face of 8 rows with the same begin and numbers. */
static void append_face(char *text, size_t size, const char *place, int face, int part)
{
    for (int k = 0; k < 8; k++) {
        const size_t used = strlen(text);
        snprintf(text + used, size - used, "%s,%d,%d,%d,1,2,3,4,5,6,7,8,9\n", place, face, part, k);
    }
}

static void refusals_name_line_and_column(void **state)
{
    (void)state;
    static const struct {
        const char *line, *by, *expected;
    } cases[] = {
        {HEADER, "state\n", ":1: 1 fields, expected 15"},
        {HEADER,
         "state,section,x_mm,face,part,node,X_mm,Y_mm,Z_mm,x_mm,y_mm,z_mm,von_mises_MPa,axial_MPa,"
         "plastic_strain\n",
         ":1: expected column 'at_mm', not 'x_mm'"},
        {"a,cross,5,0,0,1,1,", "a,cross,5,0,0,2,1,", ":3: node: expected node 1"},
        {"a,cross,5,0,0,1,1,", "b,cross,5,0,0,1,1,", ":3: node: expected node 1"},
        {"a,cross,5,0,0,1,1,", "a,cross,6,0,0,1,1,", ":3: node: expected node 1"},
        {"a,cross,5,0,0,1,1,", "a,cross,5,1,0,1,1,", ":3: face: expected face 0"},
        {"a,cross,5,0,0,1,1,", "a,cross,5,0,1,1,1,", ":3: face: expected face 0 in one part"},
        {"a,cross,5,0,0,1,1,", "a,cross,5,0,2,1,1,", ":3: part: expected a whole number"},
        {"a,cross,5,0,0,1,1,", "a,cross,5,0,0,1,,", ":3: X_mm: expected a number"},
        {"a,cross,5,0,0,1,1,", "a,cross,5,0,0,1,nan,", ":3: X_mm: expected a number, not 'nan'"},
        {"a,cross,5,0,0,1,1,", "a,cross,5,0,0,1,1,1,", ":3: 16 fields, expected 15"},
        {"a,cross,5,0,0,1,1,", "a,cross,,0,0,1,1,", ":3: at_mm: expected a number"},
        {"a,cross,5,0,0,1,1,", "a,long,5,0,0,1,1,", ":3: section: expected longitudinal or"},
        {"a,cross,5,0,0,1,1,", "a,longitudinal,5,0,0,1,1,", ":3: at_mm: expected nothing"},
        {"a,cross,5,0,0,1,1,", ",cross,5,0,0,1,1,", ":3: state: expected the name of a step"},
        {"a,cross,5,1,1,0,1,", "a,cross,5,2,1,0,1,", ":10: face: expected face 1"},
        {"a,cross,5,1,1,0,1,", "a,cross,5,-1,1,0,1,", ":10: face: expected a whole number"},
        {"a,cross,5,1,1,7,1,", "a,cross,5,1,1,8,1,", ":17: node: expected a whole number"},
        {"b,longitudinal,,0,0,0", "b,longitudinal,,1,0,0", ":18: face: expected face 0"},
    };
    char text[4096] = HEADER;
    struct wb_fields fields;
    append_face(text, sizeof text, "a,cross,5", 0, 0);
    append_face(text, sizeof text, "a,cross,5", 1, 1);
    append_face(text, sizeof text, "b,longitudinal,", 0, 0);
    assert_int_equal(read_bytes(text, strlen(text), &fields), WB_OK);
    assert_int_equal(fields.n, 2);
    assert_int_equal(fields.items[0].n_faces, 2);
    assert_close(fields.items[1].faces[0].node[7].von_mises, 7e6, 0.0);
    wb_fields_release(&fields);

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char changed[4096];
        const char *const at = strstr(text, cases[i].line);
        assert_non_null(at);
        snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, cases[i].by,
                 at + strlen(cases[i].line));
        const enum wb_status status = read_bytes(changed, strlen(changed), &fields);
        if (status != WB_ERR_FORMAT || kept.n != 1 || !strstr(kept.last, cases[i].expected))
            fail_msg("'%s': status %d, '%s' does not hold '%s'", cases[i].by, status, kept.last,
                     cases[i].expected);
        assert_int_equal(fields.n, 0);
        assert_null(fields.items);
    }
}

static void fields_cut_short_or_given_twice_are_refused(void **state)
{
    (void)state;
    char text[4096] = HEADER;
    struct wb_fields fields;
    append_face(text, sizeof text, "a,cross,5", 0, 0);
    assert_int_equal(read_bytes(text, (size_t)(strstr(text, "a,cross,5,0,0,7") - text), &fields),
                     WB_ERR_FORMAT);
    assert_message(":8: node: the last face ends before node 7");
    append_face(text, sizeof text, "a,longitudinal,", 0, 0);
    append_face(text, sizeof text, "a,cross,6", 0, 0);
    assert_int_equal(read_bytes(text, strlen(text), &fields), WB_OK);
    assert_int_equal(fields.n, 3);
    wb_fields_release(&fields);
    append_face(text, sizeof text, "a,cross,5", 0, 0);
    assert_int_equal(read_bytes(text, strlen(text), &fields), WB_ERR_FORMAT);
    assert_message(":26: section: this field of state a appears twice");
}

static void broken_files_are_read_or_refused(void **state)
{
    (void)state;
    static const char strange[] = "\0\xff,\n-e9nan\r\"";
    char text[4096] = HEADER, changed[4096];
    struct wb_fields fields;
    append_face(text, sizeof text, "a,cross,5", 0, 0);
    append_face(text, sizeof text, "a,cross,5", 1, 1);
    const size_t n = strlen(text);
    assert_int_equal(read_bytes(text, 0, &fields), WB_ERR_FORMAT);
    assert_message(":1: empty file");
    int refused = 0;
    for (size_t i = 1; i < n; i++) {
        memcpy(changed, text, n);
        changed[i] = strange[i % (sizeof strange - 1)];
        for (int way = 0; way < 2; way++) {
            const enum wb_status status = read_bytes(changed, way == 0 ? i : n, &fields);
            assert_true(status == WB_OK || kept.n == 1);
            refused += status != WB_OK;
            wb_fields_release(&fields);
        }
    }
    assert_true(refused > (int)n);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fields_come_back),
        cmocka_unit_test(file_is_as_documented),
        cmocka_unit_test(field_is_found_by_state_and_place),
        cmocka_unit_test(no_fields_is_no_file),
        cmocka_unit_test(impossible_fields_are_refused),
        cmocka_unit_test(refusals_name_line_and_column),
        cmocka_unit_test(fields_cut_short_or_given_twice_are_refused),
        cmocka_unit_test(broken_files_are_read_or_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
