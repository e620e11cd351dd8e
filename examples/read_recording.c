/* Reads a recording and prints whether it is complete, its streams, and the range of the load
 * cell's readings.
 *
 *     cc read_recording.c $(pkg-config --cflags --libs wirebench) -o read_recording
 *     ./read_recording recordings/type1-L85-1.wbr.zst
 */
#include <math.h>
#include <stdio.h>

#include <wirebench.h>

static int fail(void)
{
    fprintf(stderr, "read_recording: %s\n", wirebench_message());
    return 1;
}

static int print_streams(struct wirebench_recording *recording)
{
    struct wirebench_recording_info info = {.size = sizeof info};
    if (wirebench_recording_describe(recording, &info) < 0)
        return fail();
    printf("%s, %.3f s, %s\n", info.is_virtual ? "virtual rig" : "bench", info.duration,
           info.is_whole ? "whole" : "damaged");
    for (int i = 0; i < info.n_problems; i++)
        printf("problem: %s\n", wirebench_recording_problem(recording, i));
    for (int i = 0; i < info.n_streams; i++) {
        struct wirebench_stream stream = {.size = sizeof stream};
        if (wirebench_recording_stream(recording, i, &stream) < 0)
            return fail();
        printf("stream %d %s: %llu samples, %.1f/s\n", stream.id, stream.protocol,
               (unsigned long long)stream.samples, stream.rate);
    }
    return 0;
}

static int print_forces(struct wirebench_recording *recording)
{
    const struct wirebench_table *load;
    struct wirebench_column force = {.size = sizeof force};
    const enum wirebench_status status = wirebench_recording_table(recording, "load", &load);
    if (status < 0 || wirebench_table_find(load, "force_N", &force) < 0)
        return fail();
    if (status == WIREBENCH_INCOMPLETE)
        fprintf(stderr, "read_recording: %s\n", wirebench_message());
    double least = (double)INFINITY, largest = -(double)INFINITY;
    for (size_t i = 0; i < force.n; i++) {
        least = fmin(least, force.reals[i]); /* an invalid reading is NaN */
        largest = fmax(largest, force.reals[i]);
    }
    printf("load: %zu readings, %.9g to %.9g N\n", force.n, least, largest);
    return 0;
}

int main(int argc, char **argv)
{
    struct wirebench_recording *recording = NULL;
    if (argc != 2) {
        fprintf(stderr, "usage: read_recording REC.wbr\n");
        return 2;
    }
    if (wirebench_recording_open(&recording, argv[1]) < 0)
        return fail();
    int code = print_streams(recording);
    if (code == 0)
        code = print_forces(recording);
    wirebench_recording_close(recording);
    return code;
}
