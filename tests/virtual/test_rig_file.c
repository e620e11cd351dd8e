#include "fixtures/virtual/rig_file.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "daq/protocol/rig.h"
#include "tests/check.h"

static const struct wb_rig_file file = {
    .load_cell = "pty:/dev/pts/7",
    .mocap = "udp:127.0.0.1:40001",
    .stage = "pty:/dev/pts/8",
    .time_scale = 10.0,
    .truth = "    seed: 3\n    bow_mm: -2.5\n",
};

static void format(const char *path, struct wb_text *text)
{
    *text = (struct wb_text){0};
    assert_int_equal(wb_rig_file_format(path, &file, text), WB_OK);
}

static void the_paper_rig_keeps_everything_but_its_addresses(void **state)
{
    (void)state;
    static const char *const names[] = {"fixtures/rigs/paper.yaml",
                                        "fixtures/rigs/paper-bundles.yaml"};
    for (int i = 0; i < 2; i++) {
        char path[WB_PATH];
        struct wb_rig before, after;
        struct wb_text text;
        assert_int_equal(wb_file_find_data(path, names[i]), WB_OK);
        assert_int_equal(wb_rig_read(path, &before), WB_OK);
        format(path, &text);
        assert_int_equal(wb_rig_parse(wb_text_string(&text), "rig.yaml", &after, NULL), WB_OK);
        assert_string_equal(after.load_cell.address, file.load_cell);
        assert_string_equal(after.mocap.address, file.mocap);
        assert_string_equal(after.stage.address, file.stage);
        assert_true(after.is_virtual);
        assert_close(after.time_scale, 10.0, 0.0);
        assert_int_equal(strncmp(after.name, "virtual rig", 11), 0);
        assert_non_null(strstr(wb_text_string(&text), "bow_mm: -2.5"));
        /* Everything else is unchanged. */
        strcpy(after.load_cell.address, before.load_cell.address);
        strcpy(after.mocap.address, before.mocap.address);
        strcpy(after.stage.address, before.stage.address);
        memcpy(after.name, before.name, sizeof after.name);
        after.is_virtual = before.is_virtual;
        after.time_scale = before.time_scale;
        assert_memory_equal(&after.load_cell, &before.load_cell, sizeof after.load_cell);
        assert_memory_equal(&after.limits, &before.limits, sizeof after.limits);
        assert_memory_equal(&after.strand, &before.strand, sizeof after.strand);
        assert_close(after.stage.travel, before.stage.travel, 0.0);
        assert_close(after.mocap.frame_rate, before.mocap.frame_rate, 0.0);
        assert_close(after.gravity, before.gravity, 0.0);
        wb_text_release(&text);
    }
}

/* Formatting its own output again: nothing is duplicated. */
static void formatting_again_changes_nothing(void **state)
{
    (void)state;
    char path[WB_PATH], copy[] = "/tmp/wb-rig-XXXXXX";
    struct wb_text once, twice;
    assert_int_equal(wb_file_find_data(path, "fixtures/rigs/paper.yaml"), WB_OK);
    format(path, &once);
    close(mkstemp(copy));
    assert_int_equal(wb_file_write(copy, wb_text_string(&once), once.length), WB_OK);
    format(copy, &twice);
    /* The first line names the template. */
    assert_string_equal(strchr(wb_text_string(&once), '\n'), strchr(wb_text_string(&twice), '\n'));
    unlink(copy);
    wb_text_release(&once);
    wb_text_release(&twice);
}

static void odd_texts_survive(void **state)
{
    (void)state;
    char path[] = "/tmp/wb-rig-XXXXXX";
    static const char *const load =
        "name: \"odd: 'name' # not a comment\"\n"
        "load_cell: {address: 'serial:/dev/ttyUSB0', protocol: generic, capacity_g: 20,\n"
        "  filter_delay_ms: 50, filter_delay_uncertainty_ms: 5, unit: g,\n"
        "  serial_number: 'A \"B\" \\', tare_command: \"\\x02T\\t\\r\\n\", delimiter: ';',\n"
        "  column: 2, overload_tokens: [\"O,L\", '-99']}\n"
        "mocap: {address: 'udp:h:1', protocol: natnet, up: z}\n"
        "stage: {address: 'serial:/dev/a', protocol: grbl, axis: X, down: -1, travel_mm: 60,\n"
        "  speed_mm_s: 1}\n";
    struct wb_rig before, after;
    struct wb_text text;
    close(mkstemp(path));
    assert_int_equal(wb_file_write(path, load, strlen(load)), WB_OK);
    assert_int_equal(wb_rig_read(path, &before), WB_OK);
    format(path, &text);
    assert_int_equal(wb_rig_parse(wb_text_string(&text), "rig.yaml", &after, NULL), WB_OK);
    assert_string_equal(after.load_cell.serial_number, before.load_cell.serial_number);
    assert_string_equal(after.load_cell.tare_command, before.load_cell.tare_command);
    assert_string_equal(after.load_cell.overload_tokens[0], "O,L");
    assert_string_equal(after.load_cell.overload_tokens[1], "-99");
    assert_int_equal(after.load_cell.delimiter, ';');
    assert_string_equal(after.name, "virtual rig: odd: 'name' # not a comment");
    assert_int_equal(after.stage.down, -1);
    unlink(path);
    wb_text_release(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_paper_rig_keeps_everything_but_its_addresses),
        cmocka_unit_test(formatting_again_changes_nothing),
        cmocka_unit_test(odd_texts_survive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
