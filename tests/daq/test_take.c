/* Takes of motion capture from files: layouts, special cases and errors of each format. */
#include <stdlib.h>

#include "daq/take/take_reader.h"
#include "tests/daq/take_example.h"
#include "tests/daq/take_missing.h"
#include "tests/messages.h"

#define FRAMES 20

static struct wb_take take;
static struct wb_reason why;
static struct example_bytes c3d;

static const struct example_csv plain = {23, "Meters", 1.0, ',', '.', "\n"};

static enum wb_status read_bytes(const void *bytes, size_t n)
{
    const struct wb_take_reader *reader = NULL;
    wb_take_release(&take);
    why = (struct wb_reason){.text = ""};
    /* A copy of exactly its size, so that a sanitizer detects an overrun. */
    uint8_t *const copy = malloc(n ? n : 1);
    memcpy(copy, bytes, n);
    const enum wb_status status = wb_take_read(&take, "a.csv", copy, n, &reader, &why);
    free(copy);
    return status;
}

static enum wb_status read_text(const char *text)
{
    return read_bytes(text, strlen(text));
}

/* Replaces the first `from` in the text. */
static char *with(const char *text, const char *from, const char *to)
{
    const char *const at = strstr(text, from);
    assert_non_null(at);
    struct wb_text out = {0};
    wb_text_append_bytes(&out, text, (size_t)(at - text));
    wb_text_append(&out, "%s%s", to, at + strlen(from));
    return out.bytes;
}

static void assert_refused(const char *text, const char *part)
{
    assert_int_equal(read_text(text), WB_ERR_FORMAT);
    if (!strstr(why.text, part))
        fail_msg("'%s' does not contain '%s'", why.text, part);
    assert_null(take.frames);
}

/* All frames and places of the example, to a tolerance in m. */
static void assert_example(double tolerance)
{
    assert_int_equal(take.n_frames, FRAMES);
    assert_int_equal(take.n_points, EXAMPLE_MARKERS);
    for (int f = 0; f < FRAMES; f++) {
        assert_close(take.frames[f].t - take.frames[0].t, f * 0.01, 1e-12);
        size_t i = take.frames[f].first;
        for (int m = 0; m < EXAMPLE_MARKERS; m++) {
            if (!example_seen(f, m))
                continue;
            /* Rows list markers in the order in which they were first seen. */
            assert_true(i < take.frames[f + 1].first);
            assert_int_equal(take.places[i].point, m);
            for (int k = 0; k < 3; k++)
                assert_close((double)take.places[i].position[k], example_at(f, m, k), tolerance);
            i++;
        }
        assert_int_equal(i, take.frames[f + 1].first);
    }
    assert_close(take_missing(&take), FRAMES / 5 / (3.0 * FRAMES), 1e-12);
}

static void every_layout_of_motive_gives_the_same_take(void **state)
{
    (void)state;
    static const struct example_csv forms[] = {
        {11, "Meters", 1.0, ',', '.', "\n"},         {21, "Meters", 1.0, ',', '.', "\r\n"},
        {22, "Meters", 1.0, ',', '.', "\n"},         {23, "Millimeters", 1e-3, ',', '.', "\n"},
        {24, "Centimeters", 1e-2, ',', '.', "\r\n"}, {25, "Meters", 1.0, ',', '.', "\r"},
        {23, "Meters", 1.0, ';', ',', "\r\n"},       {24, "Meters", 1.0, '\t', ',', "\r\r\n"},
    };
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        struct wb_text text = {0};
        example_motive(&text, &forms[i], FRAMES);
        assert_int_equal(read_text(text.bytes), WB_OK);
        assert_example(1.1e-6);
        assert_int_equal(take.skipped_rows, 0);
        assert_int_equal(take.declared_frames, FRAMES);
        wb_text_release(&text);
    }
}

static void byte_order_marks_and_utf_16_are_read(void **state)
{
    (void)state;
    struct wb_text text = {0}, marked = {0};
    example_motive(&text, &plain, FRAMES);
    wb_text_append(&marked, "\xEF\xBB\xBF%s", text.bytes);
    assert_int_equal(read_text(marked.bytes), WB_OK);
    assert_example(1.1e-6);
    char *const wide = malloc(2 * text.length + 2);
    for (int order = 0; order < 4; order++) {
        size_t n = 0;
        if (order < 2) {
            wide[n++] = (char)(order ? 0xfe : 0xff);
            wide[n++] = (char)(order ? 0xff : 0xfe);
        }
        for (size_t i = 0; i < text.length; i++) {
            wide[n++] = order % 2 ? 0 : text.bytes[i];
            wide[n++] = order % 2 ? text.bytes[i] : 0;
        }
        assert_int_equal(read_bytes(wide, n), WB_OK);
        assert_example(1.1e-6);
    }
    free(wide);
    wb_text_release(&text);
    wb_text_release(&marked);
}

static void columns_are_found_by_their_header(void **state)
{
    (void)state;
    /* Y before X, and a solved marker between. */
    assert_int_equal(
        read_text(
            "Format Version,1.23,Length Units,Meters,Capture Frame Rate,100\n,,,\n"
            ",Type,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,Marker,Marker,Marker\n"
            ",Name,R,R,R,M,M,M\n,ID,1,1,1,2,2,2\n"
            ",,Position,Position,Position,Position,Position,Position\n"
            "Frame,Time (Seconds),X,Y,Z,Y,X,Z\n7,0.07,9,9,9,2,1,3\n"),
        WB_OK);
    assert_int_equal(take.n_points, 2);
    assert_int_equal(take.points[0].kind, WB_TAKE_SOLVED);
    assert_int_equal(take.points[1].kind, WB_TAKE_MARKER);
    static struct wb_mocap_frame frame;
    assert_int_equal(wb_take_frame_at(&take, 0, &frame), 0);
    assert_int_equal(frame.n_markers, 1);
    for (int k = 0; k < 3; k++)
        assert_close((double)frame.markers[0].position[k], k + 1.0, 1e-6);
    assert_int_equal(frame.frame_number, 7);
    assert_int_equal(frame.t_ns, 70000000);
}

static void rounded_times_are_recomputed_from_the_rate(void **state)
{
    (void)state;
    assert_int_equal(read_text("Format Version,1.23,Length Units,Meters,Export Frame Rate,120\n"
                               ",Type,Marker,Marker,Marker\n,Name,M,M,M\n,ID,2,2,2\n"
                               ",,Position,Position,Position\nFrame,Time (Seconds),X,Y,Z\n"
                               "0,0,1,2,3\n1,0.008,1,2,3\n2,0.017,1,2,3\n6,0.05,1,2,3\n"),
                     WB_OK);
    assert_close(take.frames[1].t, 1.0 / 120.0, 1e-15);
    assert_close(take.frames[2].t, 2.0 / 120.0, 1e-15);
    assert_int_equal(take.jumps, 1);
    assert_int_equal(take.jumped, 3);
}

static void invalid_rows_are_skipped_and_counted(void **state)
{
    (void)state;
    struct wb_text text = {0};
    example_motive(&text, &plain, FRAMES);
    /* A missing cell in frame 3: all cells after it would be wrong. */
    char *const cut = with(text.bytes, "3,0.030000,0.003000,", "3,0.030000,");
    assert_int_equal(read_text(cut), WB_OK);
    assert_int_equal(take.skipped_rows, 1);
    assert_int_equal(take.first_skipped, 11);
    assert_int_equal(take.n_frames, FRAMES - 1);
    assert_int_equal(take.jumped, 1);
    /* Frame 3 a second time, out of order. */
    char *const twice = with(text.bytes, "\n5,0.05", "\n3,0.05");
    assert_int_equal(read_text(twice), WB_OK);
    assert_int_equal(take.skipped_rows, 1);
    /* A file truncated within its last number. */
    assert_int_equal(read_bytes(text.bytes, text.length - 3), WB_OK);
    assert_int_equal(take.n_frames, FRAMES - 1);
    assert_int_equal(take.skipped_rows, 1);
    assert_int_equal(take.declared_frames, FRAMES);
    free(cut);
    free(twice);
    wb_text_release(&text);
}

static void invalid_motive_file_is_rejected_with_line_and_column(void **state)
{
    (void)state;
    struct wb_text text = {0};
    example_motive(&text, &plain, FRAMES);
    static const char *const cases[][3] = {
        {"2,0.020000,0.002000", "2,0.020000,zero",
         "a.csv:10: column 3: expected a position, not 'z"},
        {"2,0.020000", "2,then", "a.csv:10: column 2: expected a time"},
        {"\n2,0.02", "\ntwo,0.02", "a.csv:10: column 1: expected a frame number"},
        {"Meters", "Furlongs", "a.csv:1: column 10: unknown unit of length 'Furlongs'"},
        {"Global", "Local", "a.csv:1: column 12: "},
        {"Length Units", "Weight", "a.csv:1: column 1: 'Length Units'"},
        {"1.23", "3.14", "a.csv:1: column 2: Format Version"},
        {"\nFrame,Time (Seconds),X,Y,Z", "\nFrame,Time (Seconds),X,Y,W", "column 5: "},
        {"\nFrame,Time (Seconds),X", "\nFrame,Hour,X", "the column 'Time'"},
        {"\nFrame,Time", "\nFigure,Time", "column 1: no row begins with 'Frame'"},
        {"0.002000", "2000000", "2e+06 m"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *const changed = with(text.bytes, cases[i][0], cases[i][1]);
        assert_refused(changed, cases[i][2]);
        free(changed);
    }
    assert_refused("0,0.0,1,2,3\n1,0.01,1,2,3\n", "a.csv:1: column 1: ");
    assert_refused("", "a.csv:1");
    wb_text_release(&text);
}

static void rows_of_motive_are_rejected_at_the_damage(void **state)
{
    (void)state;
    static const char head[] = "comment,a\ninfo,version,1.1\n";
    struct wb_text text = {0};
    wb_text_append(&text, "%sframe,0,0.0,0,2,1,2,3,7\n", head);
    assert_refused(text.bytes, "a.csv:3: column 9: the row ends within marker 2 of 2");
    wb_text_release(&text);
    wb_text_append(&text, "%sframe,0,0.0,0,2,1,NAN,3,7,1,2,3,8\nfigure,1\n", head);
    assert_refused(
        text.bytes,
        "a.csv:4: column 1: expected a row of frame, info, rigidbody or comment, not 'figure'");
    wb_text_release(&text);
    wb_text_append(&text, "%sframe,0,0.0,0,2,1,NAN,3,7,\"A\",1,2,3,8,\"B\"\n", head);
    assert_int_equal(read_text(text.bytes), WB_OK);
    assert_int_equal(take.n_points, 2);
    assert_string_equal(take.points[1].name, "B:8");
    assert_int_equal(take.points[0].n_seen, 0);
    wb_text_release(&text);
}

static void trc_is_read_with_all_line_ends(void **state)
{
    (void)state;
    static const char *const ends[] = {"\n", "\r\n", "\r\r\n", "\r"};
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        struct wb_text text = {0};
        example_trc(&text, FRAMES, ends[i]);
        assert_int_equal(read_text(text.bytes), WB_OK);
        assert_example(1e-6);
        assert_string_equal(take.points[2].name, "C");
        wb_text_release(&text);
    }
}

static void trc_rows_may_end_after_a_marker_but_not_within_one(void **state)
{
    (void)state;
    struct wb_text text = {0};
    example_trc(&text, FRAMES, "\n");
    char *const short_row = with(text.bytes, "\t202.0000\t996.0000\t500.0000\n", "\n");
    assert_int_equal(read_text(short_row), WB_OK);
    assert_int_equal(take.n_frames, FRAMES);
    assert_int_equal(take.points[2].n_seen, FRAMES - 1);
    free(short_row);
    char *const broken = with(text.bytes, "\t996.0000\t500.0000\n", "\t996.0000\n");
    assert_int_equal(read_text(broken), WB_OK);
    assert_int_equal(take.n_frames, FRAMES - 1);
    assert_int_equal(take.skipped_rows, 1);
    free(broken);
    static const char *const cases[][3] = {
        {"mm\t100", "ft\t100", "a.csv:3: column 5: unknown unit of length 'ft'"},
        {"\t3\tmm", "\t4\tmm", "3 names of markers, but NumMarkers is 4"},
        {"X2", "W2", "column 6: expected an axis X"},
        {"\t996.0000", "\tnine", "a.csv:9: column 4: expected a position, not 'nine'"},
        {"Frame#", "Figure", "a.csv:4: column 1: expected 'Frame#'"},
        {"NumFrames", "Frames", "the header has no 'NumFrames'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *const changed = with(text.bytes, cases[i][0], cases[i][1]);
        assert_refused(changed, cases[i][2]);
        free(changed);
    }
    wb_text_release(&text);
}

static void c3d_of_every_processor_is_the_same(void **state)
{
    (void)state;
    for (int processor = 84; processor <= 86; processor++)
        for (int form = 0; form < 4; form++) {
            const struct example_c3d f = {
                .processor = processor, .real = form & 1, .unsigned_analog = form & 2};
            example_c3d(&c3d, &f, FRAMES);
            assert_int_equal(read_bytes(c3d.bytes, c3d.n), WB_OK);
            assert_example(2.6e-5); /* half of the integers' scale */
            assert_close(take.frames[0].t, 0.01, 1e-12);
            assert_int_equal(take.points[2].kind, WB_TAKE_UNLABELLED);
            assert_int_equal(take.n_channels, 1);
            assert_int_equal(take.per_frame, 2);
            assert_string_equal(take.channels[0].name, "Fz");
            assert_string_equal(take.channels[0].unit, "N");
            for (int i = 0; i < 2 * FRAMES; i++)
                assert_close((double)take.analog[i], 0.25 * i, 1e-4);
        }
}

static void truncated_c3d_has_the_frames_before(void **state)
{
    (void)state;
    const struct example_c3d form = {.processor = 84, .real = true};
    example_c3d(&c3d, &form, FRAMES);
    assert_int_equal(read_bytes(c3d.bytes, 3 * 512 + 56 * 7 + 20), WB_OK);
    assert_int_equal(take.n_frames, 7);
    assert_int_equal(take.declared_frames, FRAMES);
    assert_int_equal(read_bytes(c3d.bytes, 3 * 512 + 20), WB_ERR_FORMAT);
    assert_int_equal(read_bytes(c3d.bytes, 600), WB_ERR_FORMAT);
    assert_non_null(strstr(why.text, "byte 0"));
    c3d.bytes[512 + 3] = 83;
    assert_int_equal(read_bytes(c3d.bytes, c3d.n), WB_ERR_FORMAT);
    assert_non_null(strstr(why.text, "byte 515: processor"));
}

static int forget(void **state)
{
    (void)state;
    wb_take_release(&take);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_of_motive_gives_the_same_take),
        cmocka_unit_test(byte_order_marks_and_utf_16_are_read),
        cmocka_unit_test(columns_are_found_by_their_header),
        cmocka_unit_test(rounded_times_are_recomputed_from_the_rate),
        cmocka_unit_test(invalid_rows_are_skipped_and_counted),
        cmocka_unit_test(invalid_motive_file_is_rejected_with_line_and_column),
        cmocka_unit_test(rows_of_motive_are_rejected_at_the_damage),
        cmocka_unit_test(trc_is_read_with_all_line_ends),
        cmocka_unit_test(trc_rows_may_end_after_a_marker_but_not_within_one),
        cmocka_unit_test(c3d_of_every_processor_is_the_same),
        cmocka_unit_test(truncated_c3d_has_the_frames_before),
    };
    return cmocka_run_group_tests(tests, NULL, forget);
}
