#include "base/memory.h"

#include <stdint.h>
#include <string.h>

#include "tests/check.h"

static void arrays_are_zeroed_and_apart(void **unused)
{
    (void)unused;
    struct wb_memory memory = {0};
    unsigned char *arrays[40];
    for (int i = 0; i < 40; i++) {
        arrays[i] = wb_memory_take(&memory, (size_t)i, 3);
        assert_non_null(arrays[i]);
        for (int k = 0; k < 3 * i; k++)
            assert_int_equal(arrays[i][k], 0);
        memset(arrays[i], i, 3 * (size_t)i);
    }
    for (int i = 0; i < 40; i++)
        for (int k = 0; k < 3 * i; k++)
            assert_int_equal(arrays[i][k], i);
    assert_false(memory.failed);
    wb_memory_release(&memory);
    assert_true(memory.blocks == NULL && memory.n == 0);
}

static void one_that_fails_is_remembered(void **unused)
{
    (void)unused;
    struct wb_memory memory = {0};
    assert_non_null(wb_memory_take(&memory, 1, 1));
    assert_null(wb_memory_take(&memory, SIZE_MAX / 2, 16));
    assert_non_null(wb_memory_take(&memory, 1, 1));
    assert_true(memory.failed);
    wb_memory_release(&memory);
    assert_null(wb_memory_keep(&memory, NULL));
    assert_true(memory.failed);
    wb_memory_release(&memory);
    assert_false(memory.failed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrays_are_zeroed_and_apart),
        cmocka_unit_test(one_that_fails_is_remembered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
