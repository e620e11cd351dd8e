/* Any bytes are read as a take of Motive or rejected. */
#include "tests/daq/fuzz_take.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    return fuzz_take(&wb_motive_csv, bytes, n);
}

#ifndef WB_LIBFUZZER

int main(int argc, char **argv)
{
    static const struct example_csv forms[] = {
        {11, "Meters", 1.0, ',', '.', "\n"},
        {21, "Millimeters", 1e-3, ',', '.', "\r\n"},
        {23, "Meters", 1.0, ';', ',', "\r"},
        {25, "Meters", 1.0, ',', '.', "\n"},
    };
    struct wb_text texts[4] = {{0}};
    const uint8_t *seeds[4];
    size_t sizes[4];
    for (int i = 0; i < 4; i++) {
        example_motive(&texts[i], &forms[i], 6);
        seeds[i] = (const uint8_t *)texts[i].bytes;
        sizes[i] = texts[i].length;
    }
    const int code = fuzz_main(argc, argv, seeds, sizes, 4, 50000);
    for (int i = 0; i < 4; i++)
        wb_text_release(&texts[i]);
    return code;
}

#endif
