#include "fe/output/vtk.h"

#include <math.h>
#include <stdbool.h>

#include "base/memory.h"
#include "base/units.h"
#include "fe/material/material.h"
#include "fe/output/vtk_private.h"

#define WB_LOG_DOMAIN "vtk"

enum {
    CELL_NODES = WB_SOLID_MESH_NODES,
    QUADRATIC_HEXAHEDRON = 25 /* VTK's cell type; its order of nodes is the same as ours */
};

/* A state and the points of its file: a node appears once for each part that it belongs to. */
struct state {
    const struct wb_solid_mesh *mesh;
    const struct wb_wire3d_fields *fields;
    int n;
    int *number; /* (n_parts x n_nodes), -1 if the node does not belong to the part */
    int *node, *element, *slot; /* (n): source of a point's values */
    struct wb_memory memory;    /* of all arrays */
};

static void number_points(struct state *state)
{
    const struct wb_solid_mesh *const mesh = state->mesh;
    const size_t most = (size_t)mesh->n_parts * (size_t)mesh->n_nodes;
    state->number = wb_memory_take(&state->memory, most, sizeof *state->number);
    state->node = wb_memory_take(&state->memory, most, sizeof *state->node);
    state->element = wb_memory_take(&state->memory, most, sizeof *state->element);
    state->slot = wb_memory_take(&state->memory, most, sizeof *state->slot);
    for (size_t i = 0; i < most; i++)
        state->number[i] = -1;
    for (int e = 0; e < mesh->n_elements; e++) {
        for (int k = 0; k < CELL_NODES; k++) {
            int *number = &state->number[mesh->part[e] * mesh->n_nodes + mesh->element[e][k]];
            if (*number >= 0)
                continue;
            *number = state->n++;
            state->node[*number] = mesh->element[e][k];
            state->element[*number] = e;
            state->slot[*number] = k;
        }
    }
}

static bool are_finite(const double *values, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

/* Checks all values, including those that no point of the file uses. */
static enum wb_status check_fields(const struct wb_solid_mesh *mesh,
                                   const struct wb_wire3d_fields *fields)
{
    const size_t values = (size_t)mesh->n_elements * CELL_NODES;
    if (are_finite(&fields->position[0][0], 3 * (size_t)mesh->n_nodes) &&
        are_finite(&fields->stress[0][0][0], 6 * values) &&
        are_finite(&fields->plastic[0][0], values))
        return WB_OK;
    return wb_fail(WB_ERR_DATA, "a field has values that are not finite");
}

/* --- the arrays' numbers --- */

static double displacement(const void *context, size_t i)
{
    const struct state *const s = context;
    const int node = s->node[i / 3];
    return (s->fields->position[node][i % 3] - s->mesh->node[node][i % 3]) / WB_MM;
}

static const double *stress_of(const struct state *s, size_t point)
{
    return s->fields->stress[s->element[point]][s->slot[point]];
}

static double stress(const void *context, size_t i)
{
    return stress_of(context, i / 6)[i % 6] / WB_MPA;
}

static double von_mises(const void *context, size_t i)
{
    return wb_material_von_mises(stress_of(context, i)) / WB_MPA;
}

static double plastic(const void *context, size_t i)
{
    const struct state *const s = context;
    return s->fields->plastic[s->element[i]][s->slot[i]];
}

static double part(const void *context, size_t i)
{
    return ((const struct state *)context)->mesh->part[i];
}

static double position(const void *context, size_t i)
{
    const struct state *const s = context;
    return s->mesh->node[s->node[i / 3]][i % 3] / WB_MM;
}

static double connectivity(const void *context, size_t i)
{
    const struct state *const s = context;
    const size_t e = i / CELL_NODES;
    return s->number[s->mesh->part[e] * s->mesh->n_nodes + s->mesh->element[e][i % CELL_NODES]];
}

static double end(const void *context, size_t i)
{
    (void)context;
    return (double)(i + 1) * CELL_NODES;
}

static double type(const void *context, size_t i)
{
    (void)context;
    (void)i;
    return QUADRATIC_HEXAHEDRON;
}

static enum wb_status write_state(const char *path, const struct state *state)
{
    static const char vector[] = " NumberOfComponents=\"3\"";
    static const char tensor[] =
        " NumberOfComponents=\"6\" ComponentName0=\"xx\" ComponentName1=\"yy\" "
        "ComponentName2=\"zz\" ComponentName3=\"xy\" ComponentName4=\"yz\" ComponentName5=\"xz\"";
    const size_t n = (size_t)state->n, cells = (size_t)state->mesh->n_elements;
    const struct wb_vtk_file_array arrays[] = {
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT64, "displacement_mm", vector, 3 * n, displacement},
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT64, "stress_MPa", tensor, 6 * n, stress},
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT64, "von_mises_MPa", NULL, n, von_mises},
        {WB_VTK_FILE_POINTS, WB_VTK_FILE_FLOAT64, "plastic_strain", NULL, n, plastic},
        {WB_VTK_FILE_CELLS, WB_VTK_FILE_INT32, "part", NULL, cells, part},
        {WB_VTK_FILE_POSITIONS, WB_VTK_FILE_FLOAT64, "position_mm", vector, 3 * n, position},
        {WB_VTK_FILE_TOPOLOGY, WB_VTK_FILE_INT32, "connectivity", NULL, CELL_NODES * cells,
         connectivity},
        {WB_VTK_FILE_TOPOLOGY, WB_VTK_FILE_INT32, "offsets", NULL, cells, end},
        {WB_VTK_FILE_TOPOLOGY, WB_VTK_FILE_UINT8, "types", NULL, cells, type},
    };

    return wb_vtk_file_write(path, state->n, state->mesh->n_elements, arrays,
                             sizeof arrays / sizeof arrays[0], state);
}

enum wb_status wb_vtk_write(const char *path, const struct wb_solid_mesh *mesh,
                            const struct wb_wire3d_fields *fields)
{
    struct state state = {.mesh = mesh, .fields = fields};
    WB_TRY(check_fields(mesh, fields));
    number_points(&state);
    const enum wb_status status = write_state(path, &state);
    wb_memory_release(&state.memory);
    return status;
}

enum wb_status wb_vtk_add(struct wb_vtk_file_series *series, double time,
                          const struct wb_solid_mesh *mesh, const struct wb_wire3d_fields *fields)
{
    char path[WB_PATH];
    WB_TRY(wb_vtk_file_series_path(series, time, path));
    WB_TRY(wb_vtk_write(path, mesh, fields));
    return wb_vtk_file_series_count(series, time);
}
