#include "fe/section/section_run.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

#define WB_LOG_DOMAIN "section"

enum {
    MAX_SHAPE = 1000,
    BISECTIONS = 100,
    CURVE_POINTS = 18 /* maximum number of points of M over kappa. Errors grow with the inverse
                         square of the distance between points: more points make the curve noisy */
};

/* Limit of the plastic strain of a tape on a circle, where only the tape's tension holds the wires
 * together. */
static const double circle_limit = 0.010;
static const double fold_limit = 0.5; /* limit of half the depth over the bend radius */
static const double small = 1e-5; /* over the length: deflection for linear elastic rigidities */

/* --- memory --- */

enum wb_status wb_section_run_init(struct wb_section_run *run, const struct wb_bundle_model *model,
                                   int n_shape)
{
    *run = (struct wb_section_run){0};
    if (n_shape < 2 || n_shape > MAX_SHAPE)
        return wb_fail(WB_ERR_ARGUMENT, "%d positions of a shape: expected 2 to %d", n_shape,
                       MAX_SHAPE);
    const size_t rows = (size_t)wb_bundle_model_rows(model), n = (size_t)n_shape;
    run->rows = wb_memory_new(rows, sizeof *run->rows);
    run->shape_s = wb_memory_new(n, sizeof *run->shape_s);
    run->shape = wb_memory_new(rows * n, sizeof *run->shape);
    run->curve = wb_memory_new((size_t)model->run.rows, sizeof *run->curve);
    run->capacity = (int)rows;
    run->n_shape = n_shape;
    for (int i = 0; i < n_shape; i++)
        run->shape_s[i] = model->length * i / (n_shape - 1);
    return WB_OK;
}

void wb_section_run_release(struct wb_section_run *run)
{
    free(run->rows);
    free(run->shape_s);
    free(run->shape);
    free(run->curve);
    *run = (struct wb_section_run){0};
}

/* Friction coefficient between the wires of a model; *is_mean: true if it is a mean of static and
 * kinetic friction. */
static double find_friction(const struct wb_bundle_model *model, bool *is_mean)
{
    const struct wb_friction *const f = &model->interface.friction;
    *is_mean = f->decay > 0.0 && f->mu_static != f->mu_kinetic;
    return *is_mean ? sqrt(f->mu_static * f->mu_kinetic) : f->mu_static;
}

/* --- rigidities --- */

/* Stiffness loss by slip at a = alpha L, relative to a = 0 with a free tip, in Newmark's theory: a
 * cantilever without slip at the clamp, with free slip or none (capped) at the tip. 1 (capped: 1/4)
 * at a = 0, decreasing with a. */
static double slip_loss(double a, bool is_capped)
{
    const double half = is_capped ? 0.5 * a : a;
    return 3.0 / (a * a) * (1.0 - tanh(half) / half);
}

static double find_alpha(const struct wb_bundle_model *model, double rigidity)
{
    const struct wb_bundle_rigidity limit = wb_bundle_model_rigidity(model);
    const double most = limit.bonded[0] / limit.sliding[0] - 1.0;
    const double part = (limit.bonded[0] / rigidity - 1.0) / most;
    const bool is_capped = model->tip == WB_BUNDLE_TIP_CAPPED;
    double low = log(1e-2), high = log(1e4);

    if (!(slip_loss(exp(low), is_capped) > part && slip_loss(exp(high), is_capped) < part))
        return (double)NAN;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = 0.5 * (low + high);
        *(slip_loss(exp(middle), is_capped) > part ? &low : &high) = middle;
    }
    return exp(low);
}

static enum wb_status find_rigidity(struct wb_section_run_rigidity *out,
                                    const struct wb_bundle_model *model, double length)
{
    const struct wb_section_solver_settings settings = {.beam = {.is_elastic = true}};
    struct wb_section_solver *solver;
    struct wb_section_solver_point point;
    struct wb_bundle_model *const other = wb_memory_new(1, sizeof *other);

    *other = *model;
    other->length = length;
    other->loads = (struct wb_bundle_loads){0};
    const enum wb_status status = wb_section_solver_create(&solver, other, &settings);
    if (status == WB_OK) {
        wb_section_solver_move(solver, small * length, &point);
        const double force =
            point.end == WB_SECTION_SOLVER_CONVERGED ? point.vertical : (double)NAN;
        out->length = length;
        out->rigidity = force * length * length / (3.0 * small);
        out->alpha = model->has_tape ? find_alpha(model, out->rigidity) : (double)NAN;
        wb_section_solver_destroy(solver);
    }
    free(other);
    return status;
}

/* --- rows --- */

static void add_row(struct wb_section_run *run, const struct wb_section_beam *beam,
                    const struct wb_section_solver_point *point, int branch)
{
    struct wb_section_run_row *const row = &run->rows[run->n_rows];
    const struct wb_section_beam_energies e = beam->energies;

    if (run->n_rows == 0)
        run->zero_force = point->vertical;
    *row = (struct wb_section_run_row){
        .cycle = branch / 2 + 1,
        .phase = point->slack ? WB_PHASE_SLACK
                 : branch % 2 ? WB_PHASE_UNLOAD
                              : WB_PHASE_LOAD,
        .force = point->vertical - run->zero_force,
        .point = *point,
        .energies = e,
    };
    for (int i = 0; i < run->n_shape; i++) {
        double *const place = run->shape[(size_t)run->n_rows * (size_t)run->n_shape + (size_t)i];
        double angle;
        wb_section_beam_place(beam, run->shape_s[i], &place[0], &place[1], &angle);
        place[2] = 0.0;
    }
    run->n_rows++;
    run->iterations += point->iterations;
    run->increments += point->increments;
    run->residual = fmax(run->residual, point->residual);
    run->missing = fmax(run->missing, point->missing);
    run->tape_plastic = fmax(run->tape_plastic, point->tape_plastic);
}

static void find_imbalance(struct wb_section_run *run)
{
    double most = 0.0;

    for (int i = 0; i < run->n_rows; i++) {
        const struct wb_section_beam_energies *const e = &run->rows[i].energies;
        const double lost = e->external - e->wires - e->tape - e->bonds - e->friction;
        most = fmax(most, fabs(e->external));
        if (most > 0.0)
            run->imbalance = fmax(run->imbalance, fabs(lost) / most);
    }
}

static void make_rows(struct wb_section_run *run, const struct wb_bundle_model *model,
                      struct wb_section_solver *solver,
                      const struct wb_section_run_settings *wanted)
{
    const int rows = model->run.rows;

    for (int i = 0; i < run->capacity; i++) {
        /* Rows 1 to `rows` are the first branch, the next `rows` the second, and so on. */
        const int branch = i > 0 ? (i - 1) / rows : 0, step = i > 0 ? (i - 1) % rows + 1 : 0;
        const double part = (double)(branch % 2 ? rows - step : step) / rows;
        struct wb_section_solver_point point;

        run->stopped = wanted->stop && wanted->stop(wanted->context);
        if (run->stopped)
            return;
        wb_section_solver_move(solver, part * model->run.deflection, &point);
        if (point.end != WB_SECTION_SOLVER_CONVERGED) {
            run->converged = false;
            run->lost = point;
            return;
        }
        add_row(run, wb_section_solver_beam(solver), &point, branch);
        if (wanted->until_free && branch == 2 * model->run.cycles - 1 &&
            !(run->rows[i].force > 0.0))
            return;
    }
}

/* The first row of the first unloading without force, and the part of the step to it at which the
 * force is zero. NULL: none. */
static const struct wb_section_run_row *find_free(const struct wb_section_run *run, double *part)
{
    for (int i = 1; i < run->n_rows && run->rows[i].cycle == 1; i++) {
        const struct wb_section_run_row *const row = &run->rows[i], *const before = row - 1;
        if (row->point.deflection < before->point.deflection && !(row->force > 0.0)) {
            *part = before->force / (before->force - row->force);
            return row;
        }
    }
    return NULL;
}

double wb_section_run_springback(const struct wb_section_run *run)
{
    double part, most = 0.0;
    const struct wb_section_run_row *const row = find_free(run, &part);
    if (!row)
        return (double)NAN;
    for (const struct wb_section_run_row *at = run->rows; at < row; at++)
        most = fmax(most, at->point.deflection);
    const double before = row[-1].point.deflection;
    return 1.0 - (before + part * (row->point.deflection - before)) / most;
}

double wb_section_run_residual_curvature(const struct wb_section_run *run)
{
    double part, most = 0.0;
    const struct wb_section_run_row *const row = find_free(run, &part);
    if (!row)
        return (double)NAN;
    for (const struct wb_section_run_row *at = run->rows; at < row; at++)
        most = fmax(most, at->point.fold);
    return (row[-1].point.fold + part * (row->point.fold - row[-1].point.fold)) / most;
}

double wb_section_run_loosens(const struct wb_section_run *run, const struct wb_bundle_model *model)
{
    if (!model->has_tape || !model->tape.round)
        return (double)NAN;
    for (int i = 0; i < run->n_rows; i++)
        if (run->rows[i].point.tape_plastic > circle_limit)
            return run->rows[i].point.deflection;
    return (double)NAN;
}

double wb_section_run_folds(const struct wb_section_run *run)
{
    for (int i = 0; i < run->n_rows; i++)
        if (run->rows[i].point.fold > fold_limit)
            return run->rows[i].point.deflection;
    return (double)NAN;
}

/* --- the homogenised beam --- */

/* Computes the moment-curvature curve from a loading without weight by a vertical force: the run's
 * own rows if they are such a loading, otherwise another computation. */
static enum wb_status find_curve(struct wb_section_run *run, const struct wb_bundle_model *model,
                                 const struct wb_section_solver_settings *settings)
{
    const bool is_own = !model->loads.weight && !(model->loads.strand_length > 0.0);
    const int rows = is_own && run->n_rows <= model->run.rows ? run->n_rows - 1 : model->run.rows;
    const int stride = (model->run.rows + CURVE_POINTS - 1) / CURVE_POINTS;
    struct wb_bundle_model *const other = is_own ? NULL : wb_memory_new(1, sizeof *other);
    struct wb_section_solver *solver = NULL;
    int n = 0;

    if (!is_own) {
        *other = *model;
        other->loads = (struct wb_bundle_loads){0};
        const enum wb_status status = wb_section_solver_create(&solver, other, settings);
        if (status != WB_OK) {
            free(other);
            return status;
        }
    }
    for (int i = 1; i <= rows; i++) {
        struct wb_section_solver_point point = run->rows[is_own ? i : 0].point;
        if (!is_own)
            wb_section_solver_move(solver, model->run.deflection * i / model->run.rows, &point);
        if (point.end != WB_SECTION_SOLVER_CONVERGED)
            break;
        if ((model->run.rows - i) % stride != 0)
            continue;
        run->curve[n].deflection = point.deflection;
        run->curve[n++].force = point.vertical;
    }
    wb_section_solver_destroy(solver);
    free(other);
    run->n_curve = wb_section_homogenise(n, run->curve, model->length);
    return WB_OK;
}

enum wb_status wb_section_run(struct wb_section_run *run, const struct wb_bundle_model *model,
                              const struct wb_section_run_settings *wanted)
{
    static const struct wb_section_run_settings nothing = {0};
    struct wb_section_solver *solver;
    struct wb_section_solver_settings settings = {0};

    run->friction = settings.friction = find_friction(model, &run->is_mean);
    WB_TRY(wb_section_solver_create(&solver, model, &settings));
    const struct wb_section_beam *const beam = wb_section_solver_beam(solver);
    run->converged = true;
    run->is_mirrored = beam->layout.is_mirrored;
    run->elements = beam->n_elements;
    run->unknowns = beam->n_unknowns;
    make_rows(run, model, solver, wanted ? wanted : &nothing);
    find_imbalance(run);
    wb_section_solver_destroy(solver);
    if (run->stopped || run->n_rows == 0)
        return WB_OK;
    for (int i = 0; i < WB_SECTION_RUN_LENGTHS && !(wanted && wanted->no_rigidities); i++)
        WB_TRY(find_rigidity(&run->rigidity[i], model, model->length * ldexp(0.5, i)));
    return find_curve(run, model, &settings);
}
