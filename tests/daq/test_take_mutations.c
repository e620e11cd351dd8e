/* Five hundred structural changes (rows, columns, separators, encodings, truncations) of a take in
 * each format, and of a table of the force. Either the file is rejected with a reason, or the take
 * counts its missing frames and has only positions of the file, possibly those of another row or
 * column. */
#include <math.h>
#include <stdlib.h>

#include "daq/take/force_table.h"
#include "daq/take/take_reader.h"
#include "tests/daq/take_example.h"
#include "tests/messages.h"
#include "tests/trials.h"

#define FRAMES 12
#define MUTATIONS 500

static uint64_t state_of_random;

static size_t below(size_t n)
{
    state_of_random ^= state_of_random << 13;
    state_of_random ^= state_of_random >> 7;
    state_of_random ^= state_of_random << 17;
    return n ? (size_t)(state_of_random % n) : 0;
}

struct text {
    char *bytes;
    size_t n;
};

/* Replaces bytes from..to by others. */
static void replace_bytes(struct text *text, size_t from, size_t to, const void *by, size_t n)
{
    char *const made = malloc(text->n - (to - from) + n + 1);
    char *const copy = malloc(n + 1);
    memcpy(copy, by, n);
    memcpy(made, text->bytes, from);
    memcpy(made + from, copy, n);
    memcpy(made + from + n, text->bytes + to, text->n - to);
    free(copy);
    free(text->bytes);
    text->bytes = made;
    text->n = text->n - (to - from) + n;
}

/* A part between two separators: a line, or a cell of a random line. */
static void part(const struct text *text, char separator, size_t *from, size_t *to)
{
    *from = below(text->n + 1);
    while (*from > 0 && text->bytes[*from - 1] != separator && text->bytes[*from - 1] != '\n')
        --*from;
    *to = *from;
    while (*to < text->n && text->bytes[*to] != separator && text->bytes[*to] != '\n')
        ++*to;
    *to += *to < text->n;
}

static void widen(struct text *text, bool big)
{
    char *const wide = malloc(2 * text->n + 1);
    for (size_t i = 0; i < text->n; i++) {
        wide[2 * i] = big ? 0 : text->bytes[i];
        wide[2 * i + 1] = big ? text->bytes[i] : 0;
    }
    free(text->bytes);
    text->bytes = wide;
    text->n *= 2;
}

static void replace_all(struct text *text, char from, char to)
{
    for (size_t i = 0; i < text->n; i++)
        if (text->bytes[i] == from)
            text->bytes[i] = to;
}

static void mutate_text(struct text *text, char separator)
{
    static const char *const words[] = {"",     "NaN", "abc",  "-",        "1e400",       "\"",
                                        "0x10", "1,5", "\xE9", "\xFF\xFE", "999999999999"};
    const char *const word = words[below(sizeof words / sizeof words[0])];
    size_t a, b, c, d;
    part(text, '\n', &a, &b);
    part(text, separator, &c, &d);
    switch (below(12)) {
    case 0: /* a line goes */
        replace_bytes(text, a, b, "", 0);
        break;
    case 1: /* a line twice */
        replace_bytes(text, b, b, text->bytes + a, b - a);
        break;
    case 2: { /* two lines change places */
        size_t e = b, f = b;
        while (f < text->n && text->bytes[f] != '\n')
            f++;
        f += f < text->n;
        char *const first = malloc(b - a + 1);
        memcpy(first, text->bytes + a, b - a);
        const size_t n = b - a;
        replace_bytes(text, f, f, first, n);
        replace_bytes(text, a, b, "", 0);
        free(first);
        (void)e;
        break;
    }
    case 3: /* a cell goes */
        replace_bytes(text, c, d, "", 0);
        break;
    case 4: /* a cell twice */
        replace_bytes(text, d, d, text->bytes + c, d - c);
        break;
    case 5: /* a cell is another thing */
        replace_bytes(text, c, d > c ? d - 1 : c, word, strlen(word));
        break;
    case 6: /* all separators are others */
        replace_all(text, separator, "\t;, |"[below(5)]);
        break;
    case 7: /* line ends */
        replace_all(text, '\n', "\r\n;\0"[below(4)]);
        break;
    case 8: /* the file is cut */
        text->n = below(text->n + 1);
        break;
    case 9:
        widen(text, below(2));
        break;
    case 10: /* a decimal comma */
        replace_all(text, '.', ',');
        break;
    default: /* an empty line, or one of separators */
        replace_bytes(text, a, a, below(2) ? ",,,,\n" : "\n", below(2) ? 1 : 0);
        break;
    }
}

static bool is_value_of_file(double value, int axis)
{
    for (int f = 0; f < FRAMES; f++)
        for (int m = 0; m < EXAMPLE_MARKERS; m++)
            if (fabs(value - example_at(f, m, axis)) < 3e-5)
                return true;
    return false;
}

/* True when it was read. Any place must be one of the file's on each axis, unless the mutation
 * itself wrote a number there. */
static bool read_and_check(const struct text *text, size_t *n_frames, size_t *strange)
{
    struct wb_take take;
    struct wb_reason why = {.text = ""};
    uint8_t *const copy = malloc(text->n ? text->n : 1);
    memcpy(copy, text->bytes, text->n);
    const enum wb_status status = wb_take_read(&take, "a", copy, text->n, NULL, &why);
    free(copy);
    if (status != WB_OK) {
        assert_true(why.text[0] != '\0');
        assert_null(take.frames);
        return false;
    }
    *n_frames = take.n_frames;
    assert_true(take.n_frames > 0);
    /* Missing frames are counted as skipped rows or jumps. */
    if (take.n_frames < FRAMES && take.declared_frames == FRAMES)
        assert_true(take.n_frames + take.skipped_rows + take.jumped <= FRAMES + 2);
    for (size_t i = 0; i < take.n_places; i++)
        for (int k = 0; k < 3; k++)
            *strange += !is_value_of_file((double)take.places[i].position[k], k);
    wb_take_release(&take);
    return true;
}

static void mutate_format(const struct wb_text *seed, char separator, const char *name,
                          size_t most_strange)
{
    size_t n_read = 0, strange = 0;
    for (int i = 0; i < MUTATIONS; i++) {
        struct text text = {.bytes = malloc(seed->length + 1), .n = seed->length};
        size_t n_frames = 0;
        memcpy(text.bytes, seed->bytes, seed->length);
        mutate_text(&text, separator);
        n_read += read_and_check(&text, &n_frames, &strange);
        free(text.bytes);
    }
    count_trials("Takes of motion capture with rows, columns, separators and encodings changed",
                 MUTATIONS, "%s files: rejected, or missing data counted", name);
    printf("%s: %zu of %d changed files are read, %zu strange places\n", name, n_read, MUTATIONS,
           strange);
    assert_true(n_read > 0 && n_read < MUTATIONS);
    assert_true(strange <= most_strange);
}

static void changed_motive_files_are_rejected_or_counted(void **state)
{
    (void)state;
    for (int version = 21; version <= 25; version += 2) {
        const struct example_csv form = {version, "Meters", 1.0, ',', '.', "\n"};
        struct wb_text text = {0};
        example_motive(&text, &form, FRAMES);
        mutate_format(&text, ',', "Motive CSV", 0);
        wb_text_release(&text);
    }
}

static void changed_rows_of_motive_are_rejected_or_counted(void **state)
{
    (void)state;
    const struct example_csv form = {11, "Meters", 1.0, ',', '.', "\n"};
    struct wb_text text = {0};
    example_motive(&text, &form, FRAMES);
    mutate_format(&text, ',', "Motive CSV 1.1", 0);
    wb_text_release(&text);
}

static void changed_trc_files_are_rejected_or_counted(void **state)
{
    (void)state;
    struct wb_text text = {0};
    example_trc(&text, FRAMES, "\n");
    /* Of the cells that became "1,5" some are positions, with a decimal comma. */
    mutate_format(&text, '\t', "TRC", 3);
    wb_text_release(&text);
}

/* --- tables of the force --- */

#define READINGS 40

static double time_of(int i)
{
    return 10.0 + 0.0125 * i;
}

static double load_of(int i)
{
    return 3.0 + 0.1 * i + 0.001 * i * i;
}

/* Readings that are in no row of the file, except those written by the mutation. */
static size_t count_strange(const struct wb_force_table *table)
{
    size_t n = 0;
    for (size_t k = 0; k < table->n; k++) {
        bool found = table->force[k] > 1e6;
        for (int i = 0; i < READINGS && !found; i++)
            found = fabs(table->t[k] - time_of(i)) < 1e-9 &&
                    fabs(table->force[k] - 1e-3 * load_of(i)) < 1e-9;
        n += !found;
    }
    return n;
}

static void changed_tables_of_the_force_are_rejected_or_counted(void **state)
{
    (void)state;
    struct wb_rig rig = {.gravity = 9.80665};
    struct wb_text seed = {0};
    size_t n_read = 0, strange = 0;
    rig.load_cell.sign = 1;
    wb_text_append(&seed, "Time (s)\tLoad (mN)\n");
    for (int i = 0; i < READINGS; i++)
        wb_text_append(&seed, "%.4f\t%.4f\n", time_of(i), load_of(i));
    for (int i = 0; i < MUTATIONS; i++) {
        struct text text = {.bytes = malloc(seed.length + 1), .n = seed.length};
        struct wb_reason why = {.text = ""};
        struct wb_force_table table;
        char taken[WB_FORCE_TABLE_LIST];
        memcpy(text.bytes, seed.bytes, seed.length);
        mutate_text(&text, '\t');
        if (wb_force_table_parse(&table, "a", text.bytes, text.n, "", taken, &rig, &why) == WB_OK) {
            size_t lines = 0;
            bool below_header = false;
            for (size_t k = 0; k < text.n; k++) {
                below_header = below_header || (k > 0 && text.bytes[k - 1] == '\n' &&
                                                text.bytes[k] >= '0' && text.bytes[k] <= '9');
                lines += below_header && text.bytes[k] == '\n';
            }
            n_read++;
            strange += count_strange(&table);
            for (size_t k = 1; k < table.n; k++)
                assert_true(table.t[k] > table.t[k - 1]);
            /* Below the header every line is a reading or counted; line ends may be others. */
            assert_true(table.n + table.skipped_rows + table.empty_rows >= lines);
            wb_force_table_release(&table);
        } else {
            assert_true(why.text[0] != '\0');
        }
        free(text.bytes);
    }
    wb_text_release(&seed);
    count_trials("Tables of the force with rows, columns, separators and encodings changed",
                 MUTATIONS, "files: rejected, or missing data counted");
    printf("force: %zu of %d changed files are read, %zu strange readings\n", n_read, MUTATIONS,
           strange);
    assert_true(n_read > 100 && n_read < MUTATIONS - 100);
    assert_int_equal(strange, 0);
}

/* Bytes of header and parameters, words turned round, cuts. */
static void changed_c3d_files_are_rejected_or_counted(void **state)
{
    (void)state;
    static struct example_bytes seed;
    size_t n_read = 0, strange = 0;
    for (int i = 0; i < MUTATIONS; i++) {
        const struct example_c3d form = {.processor = 84 + i % 3, .real = i % 2};
        example_c3d(&seed, &form, FRAMES);
        struct text text = {.bytes = malloc(seed.n + 1), .n = seed.n};
        memcpy(text.bytes, seed.bytes, seed.n);
        const size_t at = below(3 * 512);
        size_t n_frames = 0;
        switch (below(4)) {
        case 0:
            text.bytes[at] = (char)below(256);
            break;
        case 1: {
            const char byte = text.bytes[at];
            text.bytes[at] = text.bytes[at + 1];
            text.bytes[at + 1] = byte;
            break;
        }
        case 2:
            text.n = below(text.n);
            break;
        default:
            replace_bytes(&text, at, at + 1 + below(4), "", 0);
        }
        size_t ignored = 0;
        n_read += read_and_check(&text, &n_frames, &ignored);
        strange += ignored > 0;
        free(text.bytes);
    }
    /* A changed scale or rate gives another valid file, which a reader cannot detect. */
    count_trials("Takes of motion capture with changed bytes", MUTATIONS,
                 "C3D files: rejected, or missing data counted");
    printf("C3D: %zu of %d changed files are read, %zu of them otherwise\n", n_read, MUTATIONS,
           strange);
    assert_true(n_read > 0 && n_read < MUTATIONS);
}

static int begin(void **state)
{
    (void)state;
    state_of_random = UINT64_C(0x9e3779b97f4a7c15);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(changed_motive_files_are_rejected_or_counted, begin),
        cmocka_unit_test_setup(changed_rows_of_motive_are_rejected_or_counted, begin),
        cmocka_unit_test_setup(changed_trc_files_are_rejected_or_counted, begin),
        cmocka_unit_test_setup(changed_tables_of_the_force_are_rejected_or_counted, begin),
        cmocka_unit_test_setup(changed_c3d_files_are_rejected_or_counted, begin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
