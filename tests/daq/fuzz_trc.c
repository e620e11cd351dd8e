/* Any bytes are read as a TRC take or rejected. */
#include "tests/daq/fuzz_take.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    return fuzz_take(&wb_trc, bytes, n);
}

#ifndef WB_LIBFUZZER

int main(int argc, char **argv)
{
    struct wb_text texts[2] = {{0}};
    const uint8_t *seeds[2];
    size_t sizes[2];
    for (int i = 0; i < 2; i++) {
        example_trc(&texts[i], 6, i ? "\r\r\n" : "\n");
        seeds[i] = (const uint8_t *)texts[i].bytes;
        sizes[i] = texts[i].length;
    }
    const int code = fuzz_main(argc, argv, seeds, sizes, 2, 50000);
    for (int i = 0; i < 2; i++)
        wb_text_release(&texts[i]);
    return code;
}

#endif
