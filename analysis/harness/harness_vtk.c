#include "analysis/harness/harness_vtk.h"

#include <math.h>

#include "base/memory.h"
#include "base/units.h"
#include "base/vec3.h"
#include "fe/output/vtk_file.h"

enum {
    AROUND = 12, /* points of a ring, and quads between two rings */
    CORNERS = 4,
    QUAD = 9 /* VTK's cell type */
};

struct state {
    const struct wb_harness_result_set *set;
    const struct wb_harness_place *places; /* (set->n_places) */
    int *first;                            /* (n_bands) place before each band of quads */
    int n_bands;
};

static void find_bands(struct state *state)
{
    for (int i = 0; i + 1 < state->set->n_places; i++) {
        if (state->places[i + 1].branch == state->places[i].branch)
            state->first[state->n_bands++] = i;
    }
}

/* --- values of the arrays in the file, by index --- */

static const struct wb_harness_place *place_at(const void *state, size_t point)
{
    return &((const struct state *)state)->places[point / AROUND];
}

static double position(const void *context, size_t i)
{
    const struct state *const state = context;
    const size_t point = i / 3, k = i % 3;
    const struct wb_harness_place *const p = place_at(state, point);
    const struct wb_harness_plan *const plan = state->set->plan;
    const double radius = 0.5 * plan->wires[plan->branches[p->branch].wire].diameter;
    const double angle = 2.0 * M_PI * (double)(point % AROUND) / AROUND;
    double side[3];
    wb_vec3_cross(p->direction, p->up, side);
    return (p->position[k] + radius * (cos(angle) * p->up[k] + sin(angle) * side[k])) / WB_MM;
}

static double curvature(const void *state, size_t i)
{
    return place_at(state, i)->curvature;
}

static double moment(const void *state, size_t i)
{
    return place_at(state, i)->moment / WB_NMM;
}

static double torque(const void *state, size_t i)
{
    return place_at(state, i)->torque / WB_NMM;
}

static double tension(const void *state, size_t i)
{
    return place_at(state, i)->tension;
}

static double branch(const void *context, size_t i)
{
    const struct state *const state = context;
    return state->places[state->first[i / AROUND]].branch + 1.0;
}

static double connectivity(const void *context, size_t i)
{
    const struct state *const state = context;
    const size_t cell = i / CORNERS, corner = i % CORNERS, around = cell % AROUND;
    const size_t ring = (size_t)state->first[cell / AROUND] + (corner >= 2);
    const bool next = corner == 1 || corner == 2;
    return (double)(ring * AROUND + (around + next) % AROUND);
}

static double offset(const void *state, size_t i)
{
    (void)state;
    return (double)(CORNERS * (i + 1));
}

static double type(const void *state, size_t i)
{
    (void)state, (void)i;
    return QUAD;
}

static enum wb_status write_state(const struct state *state, const char *path)
{
    const size_t points = AROUND * (size_t)state->set->n_places;
    const size_t cells = AROUND * (size_t)state->n_bands;
    const struct wb_vtk_file_array arrays[] = {
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT64, "curvature_1_m", NULL, points, curvature},
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT64, "moment_N_mm", NULL, points, moment},
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT64, "torque_N_mm", NULL, points, torque},
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT64, "tension_N", NULL, points, tension},
        {WB_VTK_FILE_CELLS, WB_VTK_FILE_INT32, "branch", NULL, cells, branch},
        {WB_VTK_FILE_POSITIONS, WB_VTK_FILE_FLOAT64, "position_mm", " NumberOfComponents=\"3\"",
         3 * points, position},
        {WB_VTK_FILE_TOPOLOGY, WB_VTK_FILE_INT32, "connectivity", NULL, CORNERS * cells,
         connectivity},
        {WB_VTK_FILE_TOPOLOGY, WB_VTK_FILE_INT32, "offsets", NULL, cells, offset},
        {WB_VTK_FILE_TOPOLOGY, WB_VTK_FILE_UINT8, "types", NULL, cells, type},
    };
    return wb_vtk_file_write(path, (int)points, (int)cells, arrays,
                             sizeof arrays / sizeof arrays[0], state);
}

static enum wb_status add_state(struct wb_vtk_file_series *series, const struct state *state,
                                double time)
{
    char path[WB_PATH];
    WB_TRY(wb_vtk_file_series_path(series, time, path));
    WB_TRY(write_state(state, path));
    return wb_vtk_file_series_count(series, time);
}

enum wb_status wb_harness_vtk_write(const struct wb_harness_result_set *set, const char *folder)
{
    struct wb_memory memory = {0};
    struct wb_vtk_file_series series = {.n = 0};
    struct state state = {.set = set, .places = set->natural};
    state.first = wb_memory_take(&memory, (size_t)set->n_places, sizeof *state.first);
    find_bands(&state);
    enum wb_status status = wb_vtk_file_series_init(&series, folder, set->plan->name);
    for (int i = 0; i < set->n_shapes && status == WB_OK; i++) {
        state.places = set->shapes[i].places;
        status = add_state(&series, &state, set->shapes[i].time);
    }
    wb_vtk_file_series_release(&series);
    wb_memory_release(&memory);
    return status;
}
