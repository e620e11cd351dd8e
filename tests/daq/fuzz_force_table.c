/* Any bytes are read as a table of force over time, ordered and finite, or rejected. */
#include <math.h>

#include "base/reason.h"
#include "daq/take/force_table.h"
#include "tests/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    struct wb_rig rig = {.gravity = 9.80665};
    char taken[WB_FORCE_TABLE_LIST];
    struct wb_force_table table;
    struct wb_reason why = {.text = ""};
    rig.load_cell.sign = 1;
    if (wb_force_table_parse(&table, "a", bytes, n, "", taken, &rig, &why) != WB_OK) {
        FUZZ_REQUIRE(why.text[0] != '\0');
        FUZZ_REQUIRE(table.t == NULL && table.force == NULL);
        return 0;
    }
    FUZZ_REQUIRE(table.n >= 2);
    for (size_t i = 0; i < table.n; i++) {
        FUZZ_REQUIRE(isfinite(table.t[i]) && isfinite(table.force[i]));
        FUZZ_REQUIRE(i == 0 || table.t[i] > table.t[i - 1]);
    }
    wb_force_table_release(&table);
    return 0;
}

#ifndef WB_LIBFUZZER

int main(int argc, char **argv)
{
    static const char *const texts[] = {
        "Time (s),Load (mN)\n0,1.5\n0.1,1.75\n0.2,\n0.3,2\n",
        "Zeit [ms];Kraft [N]\r\n0;0,001\r\n100;0,002\r\n200;0,003\r\n",
        "t/s\tF/N\n0\t1\n1\t2\n2\t3\n",
    };
    const uint8_t *seeds[3];
    size_t sizes[3];
    for (int i = 0; i < 3; i++) {
        seeds[i] = (const uint8_t *)texts[i];
        sizes[i] = strlen(texts[i]);
    }
    return fuzz_main(argc, argv, seeds, sizes, 3, 50000);
}

#endif
