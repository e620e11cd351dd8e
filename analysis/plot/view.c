/* Sheets are refined by Catmull-Rom's splines into small quadrilaterals, two triangles each, which
 * are drawn into a buffer of depths with several samples a pixel. */
#include "analysis/plot/view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"

#define WB_LOG_DOMAIN "figure"

enum {
    SAMPLES = 3, /* of a pixel, in each direction */
    ROUND = 48,  /* points around a sheet at least */
    ALONG = 160, /* and along */
    COLOURS = 256,
    MOST_PIXELS = 8000
};

/* In the picture's axes: from the scene to the light. */
static const double light[3] = {-0.40, 0.65, 0.65};
static const double ambient = 0.55, diffuse = 0.45; /* parts of a colour */
static const double rim = 0.30;                     /* of it is lost where a surface turns away */
static const double gloss = 0.18, sharpness = 24.0; /* white that is added: mirrored light, */
static const double sheen = 0.10;                   /* and a little where light falls */

struct vertex {
    double at[3];     /* samples to the right, samples down, towards the eye */
    double normal[3]; /* in the picture's axes */
    double value;
};

/* Depths of the nearest solid and the nearest glass, minus infinity where there is none; colours of
 * 0 to 255. */
struct sample {
    float depth, glass_depth;
    uint8_t solid[3], glass[4];
};

struct painter {
    const struct wb_view_scene *scene;
    int width, height; /* samples */
    double scale[2];   /* samples for a unit */
    double right[3], up[3], toward[3];
    struct wb_colour colours[COLOURS];
    struct sample *samples;
    /* The sheet in work, refined. */
    int n_along, n_around;
    struct vertex *grid; /* (n_along x n_around) */
};

/* --- vectors --- */

static void find_axes(const struct wb_view_camera *camera, double right[3], double up[3],
                      double toward[3])
{
    memcpy(toward, camera->toward, 3 * sizeof *toward);
    wb_vec3_normalise(toward);
    wb_vec3_cross(camera->up, toward, right);
    wb_vec3_normalise(right);
    wb_vec3_cross(toward, right, up);
}

void wb_view_project(const struct wb_view_camera *camera, const double place[3], double out[3])
{
    double right[3], up[3], toward[3];

    find_axes(camera, right, up, toward);
    out[0] = wb_vec3_dot(place, right);
    out[1] = wb_vec3_dot(place, up);
    out[2] = wb_vec3_dot(place, toward);
}

/* --- refining --- */

/* Weights of four nodes between the middle two, at t. */
static void spline(double t, double weight[4])
{
    const double t2 = t * t, t3 = t2 * t;
    weight[0] = 0.5 * (-t + 2.0 * t2 - t3);
    weight[1] = 0.5 * (2.0 - 5.0 * t2 + 3.0 * t3);
    weight[2] = 0.5 * (t + 4.0 * t2 - 3.0 * t3);
    weight[3] = 0.5 * (-t2 + t3);
}

/* The four nodes round the one before `t`, and their weights; beyond an end the last node counts as
 * the straight line's. */
static void find_nodes(double t, int n, bool closed, int node[4], double weight[4])
{
    int first = (int)floor(t);
    if (!closed && first > n - 2)
        first = n - 2;
    spline(t - first, weight);
    for (int i = 0; i < 4; i++)
        node[i] = closed ? (first - 1 + i + n) % n : first - 1 + i;
    if (closed)
        return;
    if (node[0] < 0) {
        node[0] = 0;
        weight[1] += 2.0 * weight[0];
        weight[2] -= weight[0];
        weight[0] = 0.0;
    }
    if (node[3] > n - 1) {
        node[3] = n - 1;
        weight[2] += 2.0 * weight[3];
        weight[1] -= weight[3];
        weight[3] = 0.0;
    }
}

static void place_vertex(const struct painter *p, const struct wb_view_sheet *sheet, double along,
                         double around, struct vertex *out)
{
    const double *low = p->scene->low, *high = p->scene->high;
    int j[4], k[4];
    double a[4], b[4], at[3] = {0.0}, least = (double)INFINITY, most = -(double)INFINITY;

    find_nodes(along, sheet->n_along, false, j, a);
    find_nodes(around, sheet->n_around, sheet->closed, k, b);
    out->value = 0.0;
    for (int i = 0; i < 16; i++) {
        const int node = j[i / 4] * sheet->n_around + k[i % 4];
        const double weight = a[i / 4] * b[i % 4];
        for (int c = 0; c < 3; c++)
            at[c] += weight * sheet->position[node][c];
        if (!sheet->value)
            continue;
        out->value += weight * sheet->value[node];
        least = fmin(least, sheet->value[node]);
        most = fmax(most, sheet->value[node]);
    }
    if (sheet->value) /* splines swing over */
        out->value = fmin(fmax(out->value, least), most);
    out->at[0] = (wb_vec3_dot(at, p->right) - low[0]) * p->scale[0];
    out->at[1] = (high[1] - wb_vec3_dot(at, p->up)) * p->scale[1];
    out->at[2] = wb_vec3_dot(at, p->toward);
}

/* Place in the picture's axes, up again up and in units. */
static void unscaled(const struct painter *p, const struct vertex *v, double out[3])
{
    out[0] = v->at[0] / p->scale[0];
    out[1] = -v->at[1] / p->scale[1];
    out[2] = v->at[2];
}

/* From the neighbours; which way it points does not matter. */
static void find_normal(struct painter *p, int j, int k, bool closed)
{
    const int n = p->n_around;
    const int before = closed ? (k + n - 1) % n : k > 0 ? k - 1 : 0;
    const int after = closed ? (k + 1) % n : k < n - 1 ? k + 1 : n - 1;
    const int below = j > 0 ? j - 1 : 0, above = j < p->n_along - 1 ? j + 1 : j;
    double a[3], b[3], c[3], d[3];

    unscaled(p, &p->grid[j * n + before], a);
    unscaled(p, &p->grid[j * n + after], b);
    unscaled(p, &p->grid[below * n + k], c);
    unscaled(p, &p->grid[above * n + k], d);
    for (int i = 0; i < 3; i++) {
        b[i] -= a[i];
        d[i] -= c[i];
    }
    struct vertex *v = &p->grid[j * n + k];
    wb_vec3_cross(b, d, v->normal);
    wb_vec3_normalise(v->normal);
}

static void refine(struct painter *p, const struct wb_view_sheet *sheet)
{
    const int spans = sheet->closed ? sheet->n_around : sheet->n_around - 1;
    const int finer = (ROUND + spans - 1) / spans;
    const int finer_along = (ALONG + sheet->n_along - 2) / (sheet->n_along - 1);

    p->n_around = spans * finer + (sheet->closed ? 0 : 1);
    p->n_along = (sheet->n_along - 1) * finer_along + 1;
    p->grid = wb_memory_new((size_t)p->n_along * (size_t)p->n_around, sizeof *p->grid);
    for (int j = 0; j < p->n_along; j++)
        for (int k = 0; k < p->n_around; k++)
            place_vertex(p, sheet, (double)j / finer_along, (double)k / finer,
                         &p->grid[j * p->n_around + k]);
    for (int j = 0; j < p->n_along; j++)
        for (int k = 0; k < p->n_around; k++)
            find_normal(p, j, k, sheet->closed);
}

/* --- colours --- */

static const struct wb_colour *colour_of(const struct painter *p, double value)
{
    const struct wb_figure_colours *c = &p->scene->colours;
    const double part = (value - c->low) / (c->high - c->low);
    const int i = (int)(part * COLOURS);

    return &p->colours[!(part > 0.0) ? 0 : i > COLOURS - 1 ? COLOURS - 1 : i];
}

/* A colour under the light, on the side that the eye sees; how much it faces the eye. */
static double shade(const struct wb_colour *colour, const double normal[3], uint8_t out[3])
{
    const double side = normal[2] < 0.0 ? -1.0 : 1.0, facing = side * normal[2];
    const double lit = fmax(0.0, side * wb_vec3_dot(normal, light));
    const double factor = (ambient + diffuse * lit) * (1.0 - rim + rim * sqrt(facing));
    /* The mirrored light along the view. */
    const double mirrored = 2.0 * lit * facing - light[2];
    const double white =
        sheen * lit * lit + (mirrored > 0.0 ? gloss * pow(mirrored, sharpness) : 0.0);
    const double rgb[3] = {colour->red, colour->green, colour->blue};

    for (int i = 0; i < 3; i++)
        out[i] = (uint8_t)(255.0 * fmin(1.0, rgb[i] * factor + white) + 0.5);
    return facing;
}

static void put(struct painter *p, const struct wb_view_sheet *sheet, int x, int y, double depth,
                const struct vertex *v)
{
    struct sample *sample = &p->samples[(size_t)y * (size_t)p->width + (size_t)x];

    if (sheet->opacity >= 1.0) {
        if (!((float)depth > sample->depth))
            return;
        sample->depth = (float)depth;
        (void)shade(sheet->value ? colour_of(p, v->value) : &sheet->tint, v->normal, sample->solid);
        return;
    }
    if (!((float)depth > sample->glass_depth))
        return;
    sample->glass_depth = (float)depth;
    const double facing = shade(&sheet->tint, v->normal, sample->glass);
    /* Along its rim one looks through more of it. */
    const double alpha = fmin(1.0, sheet->opacity * (0.7 + 1.3 * (1.0 - facing)));
    sample->glass[3] = (uint8_t)(255.0 * alpha + 0.5);
}

/* --- triangles --- */

static double edge(const struct vertex *a, const struct vertex *b, double x, double y)
{
    return (b->at[0] - a->at[0]) * (y - a->at[1]) - (b->at[1] - a->at[1]) * (x - a->at[0]);
}

static void draw_triangle(struct painter *p, const struct wb_view_sheet *sheet,
                          const struct vertex *const v[3])
{
    const double area = edge(v[0], v[1], v[2]->at[0], v[2]->at[1]);
    double low[2], high[2];

    if (!isfinite(area) || area == 0.0)
        return;
    for (int i = 0; i < 2; i++) {
        low[i] = fmin(v[0]->at[i], fmin(v[1]->at[i], v[2]->at[i]));
        high[i] = fmax(v[0]->at[i], fmax(v[1]->at[i], v[2]->at[i]));
    }
    const int x_end = (int)fmin(ceil(high[0] - 0.5), p->width - 1.0);
    const int y_end = (int)fmin(ceil(high[1] - 0.5), p->height - 1.0);
    for (int y = (int)fmax(floor(low[1] - 0.5), 0.0); y <= y_end; y++) {
        for (int x = (int)fmax(floor(low[0] - 0.5), 0.0); x <= x_end; x++) {
            const double at[2] = {x + 0.5, y + 0.5};
            const double w[3] = {edge(v[1], v[2], at[0], at[1]) / area,
                                 edge(v[2], v[0], at[0], at[1]) / area,
                                 edge(v[0], v[1], at[0], at[1]) / area};
            struct vertex here = {.value = 0.0};
            double depth = 0.0;
            if (!(w[0] >= 0.0 && w[1] >= 0.0 && w[2] >= 0.0))
                continue;
            for (int i = 0; i < 3; i++) {
                depth += w[i] * v[i]->at[2];
                here.value += w[i] * v[i]->value;
                for (int c = 0; c < 3; c++)
                    here.normal[c] += w[i] * v[i]->normal[c];
            }
            wb_vec3_normalise(here.normal);
            put(p, sheet, x, y, depth, &here);
        }
    }
}

/* A flat fan over the ring at one end. */
static void draw_cap(struct painter *p, const struct wb_view_sheet *sheet, int station)
{
    struct wb_view_sheet plain = *sheet;
    const struct vertex *ring = &p->grid[station * p->n_around];
    struct vertex middle = {.value = 0.0};
    double a[3], b[3], c[3];

    for (int k = 0; k < p->n_around; k++) {
        for (int i = 0; i < 3; i++)
            middle.at[i] += ring[k].at[i] / p->n_around;
    }
    plain.value = NULL;
    unscaled(p, &middle, c);
    unscaled(p, &ring[0], a);
    unscaled(p, &ring[p->n_around / 4], b);
    for (int i = 0; i < 3; i++) {
        a[i] -= c[i];
        b[i] -= c[i];
    }
    wb_vec3_cross(a, b, middle.normal);
    wb_vec3_normalise(middle.normal);
    for (int k = 0; k < p->n_around; k++) {
        struct vertex first = ring[k], second = ring[(k + 1) % p->n_around];
        memcpy(first.normal, middle.normal, sizeof first.normal);
        memcpy(second.normal, middle.normal, sizeof second.normal);
        const struct vertex *const corner[3] = {&middle, &first, &second};
        draw_triangle(p, &plain, corner);
    }
}

static void draw_sheet(struct painter *p, const struct wb_view_sheet *sheet)
{
    refine(p, sheet);
    const int n = p->n_around, spans = sheet->closed ? n : n - 1;

    for (int j = 0; j < p->n_along - 1; j++)
        for (int k = 0; k < spans; k++) {
            const struct vertex *a = &p->grid[j * n + k], *b = &p->grid[j * n + (k + 1) % n];
            const struct vertex *c = a + n, *d = b + n;
            const struct vertex *const first[3] = {a, b, d}, *const second[3] = {a, d, c};
            draw_triangle(p, sheet, first);
            draw_triangle(p, sheet, second);
        }
    if (sheet->capped && sheet->closed) {
        draw_cap(p, sheet, 0);
        draw_cap(p, sheet, p->n_along - 1);
    }
    free(p->grid);
}

/* --- pixels --- */

/* Colour times alpha, and alpha, of one sample. */
static void see(const struct sample *sample, double out[4])
{
    const double solid = sample->depth > -INFINITY ? 1.0 : 0.0;
    const double glass = sample->glass_depth > sample->depth ? sample->glass[3] / 255.0 : 0.0;

    for (int i = 0; i < 3; i++)
        out[i] = ((1.0 - glass) * solid * sample->solid[i] + glass * sample->glass[i]) / 255.0;
    out[3] = glass + (1.0 - glass) * solid;
}

static void resolve(const struct painter *p, uint32_t *pixels)
{
    for (int y = 0; y < p->scene->height; y++)
        for (int x = 0; x < p->scene->width; x++) {
            double sum[4] = {0.0};
            for (int s = 0; s < SAMPLES * SAMPLES; s++) {
                const size_t row = (size_t)(y * SAMPLES + s / SAMPLES) * (size_t)p->width;
                double one[4];
                see(&p->samples[row + (size_t)(x * SAMPLES + s % SAMPLES)], one);
                for (int i = 0; i < 4; i++)
                    sum[i] += one[i];
            }
            uint32_t byte[4];
            for (int i = 0; i < 4; i++)
                byte[i] = (uint32_t)(255.0 * sum[i] / (SAMPLES * SAMPLES) + 0.5);
            pixels[(size_t)y * (size_t)p->scene->width + (size_t)x] =
                byte[3] << 24 | byte[0] << 16 | byte[1] << 8 | byte[2];
        }
}

static enum wb_status check(const struct wb_view_scene *scene)
{
    if (scene->width < 1 || scene->width > MOST_PIXELS || scene->height < 1 ||
        scene->height > MOST_PIXELS)
        return wb_fail(WB_ERR_ARGUMENT, "the image has %d x %d pixels: expected 1 to %d each way",
                       scene->width, scene->height, MOST_PIXELS);
    if (!(scene->high[0] > scene->low[0] && scene->high[1] > scene->low[1]) ||
        !(scene->colours.high > scene->colours.low))
        return wb_fail(WB_ERR_ARGUMENT,
                       "the view is %g x %g large and its colours run from %g to %g: expected "
                       "extents and a range above 0",
                       scene->high[0] - scene->low[0], scene->high[1] - scene->low[1],
                       scene->colours.low, scene->colours.high);
    for (int i = 0; i < scene->n_sheets; i++) {
        const struct wb_view_sheet *sheet = &scene->sheets[i];
        if (sheet->n_along < 2 || sheet->n_around < (sheet->closed ? 3 : 2))
            return wb_fail(WB_ERR_ARGUMENT,
                           "surface %d has %d x %d nodes: expected at least 2 x %d", i,
                           sheet->n_along, sheet->n_around, sheet->closed ? 3 : 2);
    }
    return WB_OK;
}

static void set_up(struct painter *p)
{
    const struct wb_view_scene *scene = p->scene;
    const size_t n = (size_t)p->width * (size_t)p->height;

    find_axes(&scene->camera, p->right, p->up, p->toward);
    p->scale[0] = p->width / (scene->high[0] - scene->low[0]);
    p->scale[1] = p->height / (scene->high[1] - scene->low[1]);
    for (int i = 0; i < COLOURS; i++)
        p->colours[i] = wb_palette_map(scene->colours.map, (i + 0.5) / COLOURS);
    for (size_t i = 0; i < n; i++)
        p->samples[i].depth = p->samples[i].glass_depth = -INFINITY;
}

enum wb_status wb_view_draw(const struct wb_view_scene *scene, uint32_t *pixels)
{
    WB_TRY(check(scene));
    struct painter p = {
        .scene = scene, .width = SAMPLES * scene->width, .height = SAMPLES * scene->height};
    p.samples = wb_memory_new((size_t)p.width * (size_t)p.height, sizeof *p.samples);
    set_up(&p);
    for (int i = 0; i < scene->n_sheets; i++)
        draw_sheet(&p, &scene->sheets[i]);
    resolve(&p, pixels);
    free(p.samples);
    return WB_OK;
}
