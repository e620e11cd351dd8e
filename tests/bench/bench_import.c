/* CPU time and memory of importing a take of ten minutes at 120 frames/s with 50 markers, 7 of them
 * on a wire that is loaded and unloaded, and a force table of 100 readings/s. Baseline in the same
 * run: strtod() on every number of both files. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "analysis/import/mocap_import.h"
#include "base/file.h"
#include "tests/bench/clock.h"

enum {
    FRAMES = 72000,
    MARKERS = 50,
    ON_WIRE = 7
};
static const double rate = 120.0, readings_a_second = 100.0;
static const double clock_offset = 12.34; /* s: clock of the force minus clock of the markers */
static const double goal_s = 3.0, goal_MB = 300.0;

static char folder[] = "/tmp/wirebench-import-XXXXXX";
static char take[64], force[64], output[64], specimen[64];

static void stop(const char *what)
{
    fprintf(stderr, "bench_import: %s failed\n", what);
    exit(EXIT_FAILURE);
}

static FILE *start_file(const char *path)
{
    FILE *const file = fopen(path, "w");
    if (!file)
        stop(path);
    return file;
}

/* mm: ten seconds at rest, then nine cycles of one minute. */
static double deflection(double t)
{
    const double phase = fmod(fmax(t - 10.0, 0.0), 60.0);
    return t > 550.0 ? 0.0 : phase < 30.0 ? phase : 60.0 - phase;
}

/* Position of the marker at arc length s (mm) of a 100 mm wire that bends to a circular arc. */
static void place_on_wire(double s, double d, double at[3])
{
    const double angle = 2.0 * asin(d / 100.0), turn = angle * s / 100.0;
    at[0] = angle < 1e-6 ? s : 100.0 / angle * sin(turn);
    at[1] = 1200.0 - (angle < 1e-6 ? 0.0 : 100.0 / angle * (1.0 - cos(turn)));
    at[2] = 50.0;
}

static void write_take(void)
{
    static const double s[ON_WIRE] = {0, 16.7, 33.3, 50, 66.7, 83.3, 100};
    FILE *const file = start_file(take);
    fprintf(file,
            "Format Version,1.23,Take Name,t,Capture Frame Rate,120.000000,Export Frame Rate,"
            "120.000000,Total Exported Frames,%d,Length Units,Millimeters,Coordinate Space,"
            "Global\n\n",
            FRAMES);
    static const char *const rows[] = {",Type", ",Name", ",ID", ",", "Frame,Time (Seconds)"};
    for (int r = 0; r < 5; r++) {
        fprintf(file, "%s", rows[r]);
        for (int i = 0; i < 3 * MARKERS; i++) {
            if (r == 1)
                fprintf(file, ",Unlabeled %d", 1000 + i / 3);
            else
                fprintf(file, ",%s",
                        r == 0   ? "Marker"
                        : r == 2 ? "90AF"
                        : r == 3 ? "Position"
                                 : (const char *[]){"X", "Y", "Z"}[i % 3]);
        }
        fprintf(file, "\n");
    }
    unsigned noise = 1;
    for (int f = 0; f < FRAMES; f++) {
        const double t = f / rate, d = deflection(t);
        fprintf(file, "%d,%.6f", f, t);
        for (int m = 0; m < MARKERS; m++) {
            double at[3] = {1000.0 + 37.0 * m, 300.0 + 11.0 * m, 400.0};
            if (m < ON_WIRE)
                place_on_wire(s[m], d, at);
            for (int k = 0; k < 3; k++) {
                noise = noise * 1664525U + 1013904223U;
                fprintf(file, ",%.4f", at[k] + 0.1 * ((noise >> 8) / 16777216.0 - 0.5));
            }
        }
        fprintf(file, "\n");
    }
    if (fclose(file) != 0)
        stop(take);
}

static void write_force(void)
{
    FILE *const file = start_file(force);
    fprintf(file, "Time (s),Force (mN)\n");
    for (int i = 0; i < (int)(FRAMES / rate * readings_a_second); i++) {
        const double t = i / readings_a_second;
        fprintf(file, "%.4f,%.5f\n", t + clock_offset, 26.5 + 2.0 * deflection(t));
    }
    if (fclose(file) != 0)
        stop(force);
}

static double baseline(const char *path, double *sum)
{
    char *bytes, *end;
    size_t size;
    const double start = cpu_seconds();
    if (wb_file_read(path, &bytes, &size) != WB_OK)
        stop(path);
    for (char *at = bytes; *at; at = *end ? end + 1 : end) {
        *sum += strtod(at, &end);
        end += strcspn(end, ",\n");
    }
    free(bytes);
    return cpu_seconds() - start;
}

static double peak_MB(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_maxrss / 1024.0;
}

int main(int argc, char **argv)
{
    struct wb_mocap_import result;
    double sum = 0.0;
    if (argc != 2 || !mkdtemp(folder))
        stop("a temporary folder or the rig file");
    snprintf(take, sizeof take, "%s/take.csv", folder);
    snprintf(force, sizeof force, "%s/force.csv", folder);
    snprintf(output, sizeof output, "%s/r.wbr", folder);
    snprintf(specimen, sizeof specimen, "%s/specimen.yaml", folder);
    write_take();
    write_force();
    FILE *const file = start_file(specimen);
    fprintf(file, "wire: type1\nlength_mm: 100\nsample: 1\n"
                  "markers_mm: [0, 16.7, 33.3, 50, 66.7, 83.3, 100]\nmarker_offset_mm: 0\n");
    if (fclose(file) != 0)
        stop(specimen);
    const struct wb_mocap_import_request request = {
        .take_path = take,
        .force_path = force,
        .specimen_path = specimen,
        .rig_path = argv[1],
        .output = output,
        .offset = (double)NAN,
        .tare = (double)NAN,
    };
    const double start = cpu_seconds();
    const enum wb_status status = wb_mocap_import_run(&result, &request);
    const double spent = cpu_seconds() - start, memory = peak_MB();
    const double by_strtod = baseline(take, &sum) + baseline(force, &sum);
    if (status == WB_OK && isfinite(sum))
        printf("import of %zu frames and %zu readings: %.2f s of CPU (goal %g), %.0f MB (goal %g); "
               "strtod() on every number: %.2f s; import over it %.2f; clock offset %.3f s "
               "(true: %.3f s)\n",
               result.n_frames, result.n_readings, spent, goal_s, memory, goal_MB, by_strtod,
               spent / by_strtod, -result.offset, clock_offset - result.filter_delay);
    unlink(take);
    unlink(force);
    unlink(output);
    unlink(specimen);
    rmdir(folder);
    return status == WB_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
