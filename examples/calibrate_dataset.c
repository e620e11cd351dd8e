/* Calibrates a wire on datasets and prints its properties and bending moments. Recordings are
 * aligned in memory; folders are those written by `wirebench align`.
 *
 *     cc calibrate_dataset.c $(pkg-config --cflags --libs wirebench) -o calibrate_dataset
 *     ./calibrate_dataset recordings/type1-L85-1.wbr.zst
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <wirebench.h>

enum {
    MOST = 16,
    CURVATURES = 4
};

static int fail(void)
{
    fprintf(stderr, "calibrate_dataset: %s\n", wirebench_message());
    return 1;
}

static int is_recording(const char *path)
{
    const char *const ending = strstr(path, ".wbr");
    return ending && (strcmp(ending, ".wbr") == 0 || strcmp(ending, ".wbr.zst") == 0);
}

static int get(struct wirebench_dataset **dataset, const char *path)
{
    const enum wirebench_status status = is_recording(path)
                                             ? wirebench_dataset_align(dataset, path, NULL)
                                             : wirebench_dataset_read(dataset, path);
    if (status == WIREBENCH_INCOMPLETE)
        fprintf(stderr, "calibrate_dataset: %s\n", wirebench_message());
    return status < 0 ? fail() : 0;
}

static int print(const struct wirebench_properties *properties)
{
    struct wirebench_properties_info info = {.size = sizeof info};
    struct wirebench_bending bending = {.size = sizeof bending};
    double curvature[CURVATURES], moment[CURVATURES];
    if (wirebench_properties_describe(properties, &info) < 0)
        return fail();
    printf("wire %s, method %s, %d sample%s\n", info.wire, info.method, info.n_samples,
           info.n_samples == 1 ? "" : "s");
    printf("EI %.9g N m2, candidates %.9g to %.9g\n", info.rigidity.value,
           info.rigidity.candidates_low, info.rigidity.candidates_high);
    for (int i = 0; i < CURVATURES; i++)
        curvature[i] = info.largest_curvature * (i + 1) / CURVATURES;
    if (wirebench_moments(properties, CURVATURES, curvature, moment) < 0 ||
        wirebench_bend(properties, info.largest_curvature, &bending) < 0)
        return fail();
    for (int i = 0; i < CURVATURES; i++)
        printf("M at %.4g 1/m: %.9g N m\n", curvature[i], moment[i]);
    printf("residual curvature ratio %.9g from %.4g 1/m\n", bending.residual_curvature_ratio,
           info.largest_curvature);
    return 0;
}

int main(int argc, char **argv)
{
    struct wirebench_dataset *datasets[MOST] = {NULL};
    struct wirebench_properties *properties = NULL;
    const int n = argc - 1;
    int code = 0;
    if (n < 1 || n > MOST) {
        fprintf(stderr, "usage: calibrate_dataset REC.wbr|DATASET...\n");
        return 2;
    }
    for (int i = 0; i < n && code == 0; i++)
        code = get(&datasets[i], argv[1 + i]);
    if (code == 0) {
        const enum wirebench_status status = wirebench_calibrate(
            &properties, (const struct wirebench_dataset *const *)datasets, (size_t)n, NULL);
        if (status == WIREBENCH_INCOMPLETE)
            fprintf(stderr, "calibrate_dataset: %s\n", wirebench_message());
        code = status < 0 ? fail() : print(properties);
    }
    wirebench_properties_destroy(properties);
    for (int i = 0; i < n; i++)
        wirebench_dataset_close(datasets[i]);
    return code;
}
