/* Any bytes from a load cell give readings or are rejected, independent of the division into reads.
 * Input: a byte of settings, then the bytes of the line. With bit 6 the settings are those of a
 * preset. */
#include "tests/daq/fuzz_driver.h"

#include <math.h>

#include "daq/protocol/drivers.h"
#include "daq/protocol/loadcell_preset.h"

/* A hash of everything but the time, which the cuts do change. */
static void take_load(void *context, const struct wb_load_sample *sample)
{
    const struct fuzz_total *const total = context;
    FUZZ_REQUIRE(sample->index == total->n);
    FUZZ_REQUIRE(sample->valid == (bool)isfinite(sample->force));
    FUZZ_REQUIRE(!(sample->overload && sample->valid));
    fuzz_count(context, sample->force,
               (uint64_t)sample->valid | (uint64_t)sample->unstable << 1 |
                   (uint64_t)sample->overload << 2);
}

static struct wb_rig rig_of(uint8_t settings)
{
    static const char *const terminators[] = {"any", "cr", "lf", "crlf"};
    struct wb_rig rig = {.gravity = 9.80665, .time_scale = 1.0};
    rig.load_cell.scale = 1.0;
    rig.load_cell.sign = 1;
    rig.load_cell.overload = 1.0;
    rig.load_cell.decimal_comma = settings & 1;
    if (settings & 2) {
        rig.load_cell.delimiter = ';';
        rig.load_cell.column = 2;
    }
    if (settings & 4)
        strcpy(rig.load_cell.unit, "g");
    strcpy(rig.load_cell.terminator, terminators[settings >> 3 & 3]);
    if (settings & 32) {
        strcpy(rig.load_cell.overload_tokens[0], "HIGH");
        strcpy(rig.load_cell.overload_tokens[1], "32767");
        strcpy(rig.load_cell.unstable_tokens[0], "moving");
    }
    if (settings & 64) {
        size_t n = 0;
        while (wb_loadcell_preset_at(n))
            n++;
        wb_loadcell_preset_apply(wb_loadcell_preset_at((settings & 63) % n), &rig.load_cell);
        rig.load_cell.settle_ns = 0;
    }
    return rig;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    if (n < 1)
        return 0;
    const struct wb_rig rig = rig_of(bytes[0]);
    struct wb_line_reading reading;
    double force;
    const struct wb_loadcell_preset *const preset = wb_loadcell_preset_find(rig.load_cell.preset);
    if (preset)
        wb_loadcell_preset_decode(preset, (const char *)bytes + 1, n - 1, &rig.load_cell, &reading);
    else
        wb_line_decode((const char *)bytes + 1, n - 1, &rig.load_cell, &reading);
    FUZZ_REQUIRE(memchr(reading.unit, 0, sizeof reading.unit) != NULL);
    FUZZ_REQUIRE((reading.kind == WB_LINE_REFUSED) == (reading.reason != NULL));
    if (reading.kind == WB_LINE_VALUE)
        FUZZ_REQUIRE(isfinite(reading.value));
    if (wb_line_force(&reading, &rig.load_cell, rig.gravity, &force))
        FUZZ_REQUIRE(reading.kind != WB_LINE_VALUE || !isnan(force));
    static const struct wb_driver *const drivers[] = {WB_DRIVERS(WB_DRIVERS_ADDRESS)};
    for (size_t i = 0; i < sizeof drivers / sizeof drivers[0]; i++)
        if (drivers[i]->role == WB_ROLE_LOAD)
            fuzz_cuts(drivers[i], &rig, (struct wb_sink){.load = take_load}, bytes + 1, n - 1);
    return 0;
}

#ifndef WB_LIBFUZZER

int main(int argc, char **argv)
{
    static const char *const seeds[] = {
        "\x18S S     100.00 g\r\nS D      -0.52 g\r\nS +\r\nES\r\nI4 A \"B1\"\r\n",
        "\x14\n0.1234\n-0.5\n8388607\n",
        "\x10xx\nReading: 0.123 kg\nReading: 0.124 kg\n",
        "\x10\nST,GS,+  4.876kg\nUS,NT,-  4.876kg\nOL,+9999999E+19\n",
        "\x18\r\n-18.78 lbF\r\n4.285 N\r\n*10\r\n",
        "\x09\r1,234 g\r+  12,34 G S\r",
        "\x16\n12;0.5 g;3\n13;-0.25 g;4\n",
        "\x30HIGH\nmoving: 3 g\n32767\n3 g ?\n",
        "@\nA\r\n0.021\r\n-1.5\r\n",
        "B\n-18.78 lbF\r\n4.285 N\r\n*10\r\n",
        "C\nA00\r\n+  12.34 G S\r\n-  12.34 GHU\r\n+ 999.99 G E\r\nE01\r\n",
        "D\n        0.0 g  \r\n -     12.3    \r\n       Error\r\n",
        "E\nLoad_cell output val: -3.25\r\n8388607\r\n",
        "F\none reading:\t12.5\t| average:\t11.90000\r\n",
        "H\n\x06\r\nUS,-0183.96  g\r\nOL,+9999999E+19\r\nEC,E01\r\n",
        "I\nOK!\r\n      0.01 g ?\r\nErr 8.3\r\n",
        "K\n+    12.34 g  \r\n-    12.34    \r\n      H       \r\nStat       C\r\n",
        "L\nC1 A\r\nSI ?       18.5 kg \r\nSI ^     1234.5 g  \r\n? -    2.237 lb \r\n",
        "N\nST,GS,     0.250,kg\r\nUS,NT,      -12, g\r\nERR04\r\n",
        "O\r+0012.345\r?\r",
        "\x10S ? -  12.3 g\nS ^ 1 g\n+  12.34 GLE\n12.5E-3 kN\n3 \xC2\xB5N\n",
    };
    return fuzz_main_text(argc, argv, seeds, sizeof seeds / sizeof seeds[0], 100000);
}

#endif
