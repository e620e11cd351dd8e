#include "fe/swept/swept_section.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "fe/swept/swept_private.h"

#define WB_LOG_DOMAIN "swept"

enum {
    MAX_DENSITY = 32
};

/* Factors on the distance of the core's corners from the centre, relative to equal widths of core
 * elements and rings, and on the bulge of its sides, relative to a circle's: they give within a few
 * percent the largest stable step of all meshes from 12 to 84 elements. */
static const double core_reach = 1.12;
static const double core_bulge = 0.5;

static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

static double shape(int a, double xi, double eta)
{
    return 0.25 * (1.0 + corner[a][0] * xi) * (1.0 + corner[a][1] * eta);
}

/* dN_a/dxi and dN_a/deta. */
static void shape_slope(int a, double xi, double eta, double slope[2])
{
    slope[0] = 0.25 * corner[a][0] * (1.0 + corner[a][1] * eta);
    slope[1] = 0.25 * corner[a][1] * (1.0 + corner[a][0] * xi);
}

/* Gradients in y and z of the shape functions and of xi eta; returns the map's determinant. */
static double gradients(double at[4][2], double xi, double eta, double gradient[2][4],
                        double product[2])
{
    double slope[4][2], J[2][2] = {{0.0}};

    for (int a = 0; a < 4; a++) {
        shape_slope(a, xi, eta, slope[a]);
        for (int i = 0; i < 4; i++)
            J[i / 2][i % 2] += at[a][i / 2] * slope[a][i % 2];
    }
    const double det = J[0][0] * J[1][1] - J[0][1] * J[1][0];
    const double inverse[2][2] = {{J[1][1] / det, -J[0][1] / det}, {-J[1][0] / det, J[0][0] / det}};
    for (int i = 0; i < 2; i++) {
        for (int a = 0; a < 4; a++)
            gradient[i][a] = slope[a][0] * inverse[0][i] + slope[a][1] * inverse[1][i];
        product[i] = eta * inverse[0][i] + xi * inverse[1][i];
    }
    return det;
}

/* gamma = (Gamma - (Gamma.y) B_y - (Gamma.z) B_z) / 4 with Gamma = (1, -1, 1, -1) (Flanagan and
 * Belytschko). */
static void hourglass_vector(double at[4][2], struct wb_swept_quad *out)
{
    static const double sign[4] = {0.25, -0.25, 0.25, -0.25};

    for (int a = 0; a < 4; a++) {
        out->hourglass[a] = sign[a];
        for (int b = 0; b < 4; b++)
            out->hourglass[a] -= sign[b] * (at[b][0] * out->gradient[0][a] + //
                                            at[b][1] * out->gradient[1][a]);
    }
}

void wb_swept_section_quad(const struct wb_swept_section *section, int quad,
                           struct wb_swept_quad *out)
{
    const double root = 1.0 / sqrt(3.0);
    double(*const at)[2] = out->corner;

    memset(out, 0, sizeof *out);
    for (int a = 0; a < 4; a++)
        memcpy(at[a], section->node[section->quad[quad][a]], sizeof at[a]);
    for (int q = 0; q < 4; q++) {
        const double xi = root * corner[q][0], eta = root * corner[q][1];
        double gradient[2][4], product[2];
        const double det = gradients(at, xi, eta, gradient, product);
        out->area += det;
        out->weight[q] = det;
        out->hourglass_slope += det * (product[0] * product[0] + product[1] * product[1]);
        for (int a = 0; a < 4; a++) {
            out->value[q][a] = shape(a, xi, eta);
            out->mean[a] += det * out->value[q][a];
            for (int i = 0; i < 2; i++) {
                out->at[q][i] += out->value[q][a] * at[a][i];
                out->gradient[i][a] += det * gradient[i][a];
            }
        }
    }
    for (int a = 0; a < 4; a++) {
        out->weight[a] /= out->area;
        out->mean[a] /= out->area;
        out->gradient[0][a] /= out->area;
        out->gradient[1][a] /= out->area;
    }
    hourglass_vector(at, out);
}

static void allocate(struct wb_swept_section *section, int n_nodes, int n_quads, int n_outline)
{
    *section = (struct wb_swept_section){.n_nodes = n_nodes, .n_quads = n_quads};
    section->node = wb_memory_take(&section->memory, (size_t)n_nodes, sizeof *section->node);
    section->share = wb_memory_take(&section->memory, (size_t)n_nodes, sizeof *section->share);
    section->quad = wb_memory_take(&section->memory, (size_t)n_quads, sizeof *section->quad);
    section->outline =
        wb_memory_take(&section->memory, (size_t)n_outline + 1, sizeof *section->outline);
    section->n_outline = n_outline;
}

void wb_swept_section_release(struct wb_swept_section *section)
{
    wb_memory_release(&section->memory);
    *section = (struct wb_swept_section){0};
}

void wb_swept_section_integrate(struct wb_swept_section *section)
{
    double moment[2] = {0.0, 0.0}, nearest = (double)INFINITY;

    section->area = 0.0;
    memset(section->share, 0, (size_t)section->n_nodes * sizeof *section->share);
    for (int e = 0; e < section->n_quads; e++) {
        struct wb_swept_quad quad;
        wb_swept_section_quad(section, e, &quad);
        section->area += quad.area;
        for (int a = 0; a < 4; a++) {
            const int node = section->quad[e][a];
            section->share[node] += quad.area * quad.mean[a];
            moment[0] += quad.area * quad.mean[a] * section->node[node][0];
            moment[1] += quad.area * quad.mean[a] * section->node[node][1];
        }
    }
    for (int k = 0; k < section->n_nodes; k++) {
        const double distance = hypot(section->node[k][0] - moment[0] / section->area,
                                      section->node[k][1] - moment[1] / section->area);
        section->share[k] /= section->area;
        if (distance < nearest * (1.0 - 1e-9)) {
            nearest = distance;
            section->centre = k;
        }
    }
}

/* A point of the core's grid, u and v from -1 to 1: between a square and a disc, with corners at
 * `reach` from the centre. */
static void core_point(double u, double v, double bulge, double reach, double at[2])
{
    double disc[2];

    if (fabs(u) >= fabs(v)) {
        const double angle = u != 0.0 ? M_PI_4 * v / u : 0.0;
        disc[0] = u * cos(angle);
        disc[1] = u * sin(angle);
    } else {
        const double angle = M_PI_4 * u / v;
        disc[0] = v * sin(angle);
        disc[1] = v * cos(angle);
    }
    at[0] = reach * (bulge * disc[0] + (1.0 - bulge) * M_SQRT1_2 * u);
    at[1] = reach * (bulge * disc[1] + (1.0 - bulge) * M_SQRT1_2 * v);
}

/* Grid index of the core's perimeter, counter-clockwise from the +y axis. */
static int perimeter(int core, int place)
{
    const int side = (place + core / 2) / core % 4, along = (place + core / 2) % core;
    const int i[4] = {core, core - along, 0, along}, j[4] = {along, core, core - along, 0};
    return i[side] * (core + 1) + j[side];
}

static int ring_node(int core, int ring, int place)
{
    place %= 4 * core;
    return ring == 0 ? perimeter(core, place)
                     : (core + 1) * (core + 1) + (ring - 1) * 4 * core + place;
}

static void number_circle(struct wb_swept_section *section, int core, int rings)
{
    int e = 0;

    for (int i = 0; i < core; i++) {
        for (int j = 0; j < core; j++) {
            const int a = i * (core + 1) + j;
            const int quad[4] = {a, a + core + 1, a + core + 2, a + 1};
            memcpy(section->quad[e++], quad, sizeof quad);
        }
    }
    for (int ring = 0; ring < rings; ring++) {
        for (int p = 0; p < 4 * core; p++) {
            const int quad[4] = {ring_node(core, ring, p), ring_node(core, ring + 1, p),
                                 ring_node(core, ring + 1, p + 1), ring_node(core, ring, p + 1)};
            memcpy(section->quad[e++], quad, sizeof quad);
        }
    }
    for (int p = 0; p < 4 * core; p++)
        section->outline[p] = ring_node(core, rings, p);
}

enum wb_status wb_swept_section_init_circle(struct wb_swept_section *section, double diameter,
                                            int core, int rings)
{
    if (core < 2 || core > MAX_DENSITY || core % 2 != 0 || rings < 0 || rings > MAX_DENSITY)
        return wb_fail(WB_ERR_ARGUMENT,
                       "circle: core %d, rings %d: expected an even core from 2 to %d, and 0 to %d "
                       "rings",
                       core, rings, MAX_DENSITY, MAX_DENSITY);
    if (!wb_swept_is_positive(diameter))
        return wb_fail(WB_ERR_ARGUMENT, "circle: diameter %g m: expected a number above 0",
                       diameter);
    allocate(section, (core + 1) * (core + 1) + 4 * core * rings, core * core + 4 * core * rings,
             4 * core);

    const double share = 0.5 * core / (0.5 * core + rings);
    const double reach = rings > 0 ? fmin(core_reach * share, 0.9) : 1.0;
    const double bulge = rings > 0 ? core_bulge : 1.0;
    for (int i = 0; i <= core; i++) {
        for (int j = 0; j <= core; j++)
            core_point(2.0 * i / core - 1.0, 2.0 * j / core - 1.0, bulge, reach,
                       section->node[i * (core + 1) + j]);
    }
    for (int p = 0; p < 4 * core; p++) {
        const double angle = 2.0 * M_PI * p / (4 * core);
        const double *inner = section->node[perimeter(core, p)];
        for (int ring = 1; ring <= rings; ring++) {
            const double f = (double)ring / rings;
            double *at = section->node[ring_node(core, ring, p)];
            at[0] = (1.0 - f) * inner[0] + f * cos(angle);
            at[1] = (1.0 - f) * inner[1] + f * sin(angle);
        }
    }
    number_circle(section, core, rings);
    wb_swept_section_integrate(section);
    wb_swept_section_scale(section, 0.5 * diameter);
    section->centre = core / 2 * (core + 1) + core / 2;
    return WB_OK;
}

void wb_swept_section_scale(struct wb_swept_section *section, double factor)
{
    for (int k = 0; k < section->n_nodes; k++) {
        section->node[k][0] *= factor;
        section->node[k][1] *= factor;
    }
    section->area *= factor * factor;
}
