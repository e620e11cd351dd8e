/* Any bytes are read as a C3D take or rejected. */
#include "tests/daq/fuzz_take.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    return fuzz_take(&wb_c3d, bytes, n);
}

#ifndef WB_LIBFUZZER

int main(int argc, char **argv)
{
    static struct example_bytes files[4];
    const uint8_t *seeds[4];
    size_t sizes[4];
    for (int i = 0; i < 4; i++) {
        const struct example_c3d form = {
            .processor = 84 + i % 3, .real = i % 2, .unsigned_analog = i == 2};
        example_c3d(&files[i], &form, 6);
        seeds[i] = files[i].bytes;
        sizes[i] = files[i].n;
    }
    return fuzz_main(argc, argv, seeds, sizes, 4, 50000);
}

#endif
