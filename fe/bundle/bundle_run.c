#include "fe/bundle/bundle_run.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/checkpoint.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/memory.h"
#include "base/units.h"
#include "base/version.h"
#include "fe/bundle/bundle_parts.h"
#include "fe/model/model_inputs.h"
#include "fe/swept/swept.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "bundle"

enum {
    MAX_SHAPE = 1000,
    MAX_BLOCK = 50,        /* maximum steps between two samples of the force */
    SAMPLES_OF_A_ROW = 40, /* minimum number of samples in a row, if the steps allow it */
    LOOKS_OF_A_ROW = 4,    /* at all energies */
    REST_SAMPLES = 40,     /* samples of the force in row 0 */
    MAX_IDENTITY = 512
};

static const double default_from =
    2.0 *
    WB_MM; /* deflection from which energy ratios count, unless it exceeds half the final one */
static const double pilot_share =
    1.5;                           /* times that deflection: where a chosen duration is checked */
static const double margin = 1.06; /* on a duration estimated from the first ratio */
static const double late_margin = 1.1; /* on a duration estimated from a later ratio */
static const double too_slow =
    0.75; /* restart if the duration needed is below this fraction of the current one */
static const double default_interval = 600.0; /* s between checkpoints */
static const double slack_gap =
    1e-3; /* deflection minus target over the deflection that marks a slack strand */
static const double lost_balance =
    0.05; /* energy imbalance over work above which the run is invalid */

/* Linear regression of a force over the target, for one row. */
struct line {
    double n, x, y, xx, xy, yy;
};

/* Clocks of this process, s. */
struct clocks {
    double wall, cpu;
};

/* A test in progress. */
struct run {
    struct wb_bundle_result *result;
    const struct wb_bundle_model *model;
    struct wb_bundle_run_options options;
    struct wb_bundle *bundle;
    enum wb_status status;
    struct clocks begun, saved; /* clocks of this process */
    double wall_before;         /* s, in earlier processes */
    double cpu_before;
    bool may_resume;
    char program[WB_SHA256_TEXT]; /* hash of this binary, if there are checkpoints */

    /* Everything from here on is saved in checkpoints: visit_run(). */
    struct wb_bundle_state state;
    double from;   /* m: deflection from which energy ratios count */
    bool counting; /* that deflection was reached */
    bool judged;   /* the duration is accepted */
    double begin;  /* s of the bundle's time: start of the loading */
    double next;   /* s: duration of the next attempt */
    double kinetic, artificial;
    double most_external;

    int branch;              /* number of completed branches */
    bool under_way;          /* a branch is in progress */
    int place;               /* current row, from 1; 0: the half step before the first */
    int looks;               /* next part of the row, from 1 */
    long long left;          /* steps to the end of that part; -1: not started */
    double branch_target[2]; /* m: target at its start and end */
    bool tip_released;       /* the strand became slack on this branch; the tip is at rest */
    double branch_start;     /* s: start of the branch */
    int block;               /* steps between samples */
    struct line vertical, tension;
    int slack_samples;        /* not in these lines */
    bool samples_before;      /* there were samples before the row's target */
    struct wb_bundle_row row; /* the row was passed, its mean force is not complete */
};

/* --- memory --- */

enum wb_status wb_bundle_result_init(struct wb_bundle_result *result,
                                     const struct wb_bundle_model *model, int n_shape)
{
    *result = (struct wb_bundle_result){0};
    if (n_shape < 0 || n_shape == 1 || n_shape > MAX_SHAPE)
        return wb_fail(WB_ERR_ARGUMENT, "%d positions of a shape: expected none or 2 to %d",
                       n_shape, MAX_SHAPE);

    const size_t rows = (size_t)wb_bundle_model_rows(model), n = (size_t)n_shape;
    result->rows = wb_memory_new(rows, sizeof *result->rows);
    result->shape_s = wb_memory_new(n, sizeof *result->shape_s);
    result->shape = wb_memory_new(rows * n, sizeof *result->shape);
    result->capacity = (int)rows;
    result->n_shape = n_shape;
    for (int i = 0; i < n_shape; i++)
        result->shape_s[i] = model->length * i / (n_shape - 1);
    return WB_OK;
}

void wb_bundle_result_release(struct wb_bundle_result *result)
{
    if (!result)
        return;
    free(result->rows);
    free(result->shape_s);
    free(result->shape);
    *result = (struct wb_bundle_result){0};
}

/* --- time --- */

static double seconds_of(clockid_t clock)
{
    struct timespec time;
    clock_gettime(clock, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static struct clocks read_clocks(void)
{
    return (struct clocks){seconds_of(CLOCK_MONOTONIC), seconds_of(CLOCK_PROCESS_CPUTIME_ID)};
}

/* Writes the time used so far to the result. */
static void take_time(struct run *r)
{
    const struct clocks at = read_clocks();
    double cpu = at.cpu - r->begun.cpu;

    wb_team_sum(&cpu, 1);
    r->result->wall = r->wall_before + (at.wall - r->begun.wall);
    r->result->cpu = r->cpu_before + cpu;
}

/* --- checkpoints --- */

/* Identity of a checkpoint: everything that influences any bit of the result. */
static void identify(const struct run *r, char text[MAX_IDENTITY])
{
    const struct wb_bundle_model *m = r->model;
    const char *mesh = r->options.mesh ? r->options.mesh : m->run.mesh;
    char hash[WB_SHA256_TEXT];
    struct wb_json *const inputs = wb_json_create();

    wb_model_inputs_bundle(inputs, m, wb_bundle_model_mesh(m, mesh));
    wb_model_inputs_sum(inputs, hash);
    wb_json_destroy(inputs);
    snprintf(text, MAX_IDENTITY,
             "bundle %s, mesh %s, settings %.12s, %d shape positions, %d parts (threads x ranks), "
             "%s precision, %s, wirebench %s, program %.12s",
             m->name, mesh, hash, r->result->n_shape,
             wb_bundle_parts_of(m, mesh, r->options.threads),
             m->run.double_precision ? "double" : "single",
             wb_swept_instructions_name(WB_SWEPT_BEST), wb_version_revision(), r->program);
}

/* Saves or restores the members of a struct from an offset on. */
static void visit_from(struct wb_checkpoint *c, void *object, size_t offset, size_t size)
{
    wb_checkpoint_visit(c, "members", (char *)object + offset, size - offset);
}

/* Saves or restores the contents of the result; its memory stays. */
static void visit_result(struct wb_bundle_result *h, struct wb_checkpoint *c)
{
    const size_t rows = (size_t)h->capacity, places = rows * (size_t)h->n_shape;

    wb_checkpoint_enter(c, "result");
    visit_from(c, h, offsetof(struct wb_bundle_result, n_rows), sizeof *h);
    wb_checkpoint_visit(c, "rows", h->rows, rows * sizeof *h->rows);
    wb_checkpoint_visit(c, "shape", h->shape, places * sizeof *h->shape);
    wb_checkpoint_leave(c);
}

/* Saves or restores everything except the bundle. */
static void visit_run(struct run *r, struct wb_checkpoint *c)
{
    const struct wb_bundle_observer *observer = r->options.observer;

    visit_result(r->result, c);
    if (observer && observer->visit) {
        wb_checkpoint_enter(c, "observer");
        observer->visit(observer->context, c);
        wb_checkpoint_leave(c);
    }
    visit_from(c, r, offsetof(struct run, state), sizeof *r);
}

static enum wb_status save(struct run *r)
{
    struct wb_checkpoint c;
    char identity[MAX_IDENTITY];

    wb_checkpoint_init(&c);
    take_time(r);
    visit_run(r, &c);
    wb_bundle_visit(r->bundle, &c);
    enum wb_status status = wb_checkpoint_finish(&c);
    identify(r, identity);
    if (status == WB_OK && wb_team_rank() == 0)
        status = wb_checkpoint_write(&c, r->options.checkpoint, identity);
    wb_checkpoint_release(&c);
    r->saved = read_clocks();
    return wb_team_agree(status);
}

/* Reads the checkpoint of an earlier process into `c`, which then restores; leaves `c` empty if
 * there is none. All ranks receive what rank 0 reads. */
static enum wb_status find_checkpoint(struct run *r, struct wb_checkpoint *c)
{
    char identity[MAX_IDENTITY];
    enum wb_status status = WB_OK;
    size_t size = 0;

    if (!r->options.checkpoint || !r->may_resume)
        return WB_OK;
    r->may_resume = false;
    identify(r, identity);
    if (wb_team_rank() == 0 && wb_file_exists(r->options.checkpoint)) {
        status = wb_checkpoint_read(c, r->options.checkpoint, identity);
        size = c->size;
    }
    WB_TRY(wb_team_agree(status));
    wb_team_share(&size, sizeof size, 0);
    if (wb_team_rank() > 0 && size > 0) {
        c->bytes = wb_memory_new(size, 1);
        c->size = size;
        wb_checkpoint_rewind(c);
    }
    wb_team_share(c->bytes, size, 0);
    return WB_OK;
}

/* Restores the bundle, after everything else. */
static enum wb_status resume(struct run *r, struct wb_checkpoint *c)
{
    struct wb_bundle_result *h = r->result;

    wb_bundle_visit(r->bundle, c);
    WB_TRY(wb_team_agree(wb_checkpoint_finish(c)));
    h->resumed = true;
    r->wall_before = h->wall;
    r->cpu_before = h->cpu;
    wb_info("%s: continues at %.2f mm, step %lld, after %.0f s of computation",
            r->options.checkpoint, r->state.deflection / WB_MM, r->state.steps, h->wall);
    return WB_OK;
}

/* --- one attempt --- */

enum verdict {
    CONTINUE,
    DONE,    /* also stopped, or failed */
    RESTART, /* with another duration */
    FAILED   /* an error of the program or system */
};

static int branches_of(const struct wb_bundle_model *model)
{
    return model->run.cycles == 0 ? 1 : 2 * model->run.cycles;
}

static enum verdict handle_failure(struct run *r)
{
    const struct wb_reason *const reason = &r->result->reason;

    if (r->status != WB_ERR_DATA && r->status != WB_ERR_CONVERGENCE) {
        if (reason->text[0])
            wb_error("%s", reason->text);
        return FAILED;
    }
    r->status = WB_OK;
    r->result->converged = false;
    return DONE;
}

/* Asks the caller whether to continue. */
static bool should_continue(const struct run *r, bool rests)
{
    const struct wb_bundle_result *h = r->result;
    const struct wb_bundle_observer *observer = r->options.observer;
    const double whole = h->duration * branches_of(r->model);
    const struct wb_bundle_progress progress = {
        .attempt = h->attempts,
        .steps = r->state.steps,
        .done = h->n_rows == 0 ? 0.0 : fmin(1.0, (r->state.time - r->begin) / whole),
        .rests = rests,
        .deflection = r->state.deflection,
        .kinetic = r->kinetic,
        .artificial = r->artificial,
    };

    return !observer || !observer->progress || observer->progress(observer->context, &progress);
}

/* There are no checkpoints during damping: if rows would be lost, the run continues to the next
 * point where a checkpoint can be written. Rank 0 decides. */
static bool damping_should_continue(void *context)
{
    struct run *r = context;

    wb_bundle_get_state(r->bundle, &r->state);
    bool wanted = should_continue(r, true) || r->result->n_rows > 0;
    wb_team_share(&wanted, sizeof wanted, 0);
    r->result->stopped = !wanted;
    return wanted;
}

/* The verdict after a motion of the bundle that ended with `status`. */
static enum verdict judge_motion(struct run *r, enum wb_status status)
{
    r->status = status;
    if (status != WB_OK)
        return handle_failure(r);
    wb_bundle_get_state(r->bundle, &r->state);
    return r->result->stopped ? DONE : CONTINUE;
}

static enum verdict advance(struct run *r, int n)
{
    return judge_motion(r, wb_bundle_advance(r->bundle, n, &r->result->reason));
}

/* --- energies --- */

static double over(double part, double whole)
{
    return whole > 0.0 ? part / whole : (double)INFINITY;
}

static void count_limits(struct run *r)
{
    struct wb_bundle_extremes *largest = &r->result->largest;
    struct wb_bundle_limits limits;

    wb_bundle_get_limits(r->bundle, &limits);
    largest->strain = fmax(largest->strain, limits.largest_strain);
    largest->penetration = fmax(largest->penetration, limits.deepest);
    largest->beyond = largest->beyond || limits.beyond > 0;
}

/* Checks the chosen duration by the energy ratio, during the first loading. */
static enum verdict check_duration(struct run *r)
{
    struct wb_bundle_result *h = r->result;
    const double limit = r->model->run.kinetic_limit;
    const double needed = h->duration * sqrt(h->largest.kinetic / limit);
    const bool last = h->attempts == WB_BUNDLE_RUN_ATTEMPTS;

    if (!h->chosen || (!r->judged && r->state.target < pilot_share * r->from))
        return CONTINUE;
    h->exceeded = h->largest.kinetic > limit;
    if (h->exceeded && !last) {
        r->next = needed * (r->judged ? late_margin : margin);
        return RESTART;
    }
    if (!r->judged && h->attempts == 1 && needed * margin < too_slow * h->duration) {
        r->next = needed * margin;
        return RESTART;
    }
    r->judged = true;
    return CONTINUE;
}

static enum verdict check_energies(struct run *r, struct wb_bundle_energies *e)
{
    struct wb_bundle_extremes *largest = &r->result->largest;

    wb_bundle_get_energies(r->bundle, e);
    const double internal = wb_bundle_internal(e);
    r->kinetic = over(e->kinetic, internal);
    r->artificial = over(e->artificial, internal);
    r->most_external = fmax(r->most_external, fabs(e->external));
    count_limits(r);
    r->counting = r->counting || r->state.target >= r->from;
    const double imbalance = over(fabs(wb_bundle_imbalance(e)), r->most_external);
    if (!r->counting)
        return CONTINUE;

    largest->kinetic = fmax(largest->kinetic, r->kinetic);
    largest->artificial = fmax(largest->artificial, r->artificial);
    largest->imbalance = fmax(largest->imbalance, imbalance);
    if (!(imbalance <= lost_balance)) {
        wb_reason_set(&r->result->reason,
                      "energy balance violated at %.3g mm, after %lld steps: the imbalance is %.3g "
                      "of the external work",
                      r->state.deflection / WB_MM, r->state.steps, imbalance);
        r->status = WB_ERR_DATA;
        return handle_failure(r);
    }
    return r->branch == 0 ? check_duration(r) : CONTINUE;
}

/* --- rows --- */

static void add_to_line(struct line *line, double x, double y)
{
    line->n += 1.0;
    line->x += x;
    line->y += y;
    line->xx += x * x;
    line->xy += x * y;
    line->yy += y * y;
}

/* The line's value at x; the mean if there are too few points or only one x. */
static double value_at(const struct line *line, double x, double *deviation)
{
    const double mean = line->y / line->n, at = line->x / line->n;
    const double spread = line->xx / line->n - at * at;
    const double together = line->xy / line->n - at * mean;
    const bool has_slope = line->n > 2.0 && spread > 1e-9 * line->xx / line->n;
    const double slope = has_slope ? together / spread : 0.0;

    *deviation = sqrt(fmax(0.0, line->yy / line->n - mean * mean - slope * together));
    return mean + slope * (x - at);
}

static enum wb_phase phase_of(const struct run *r)
{
    return r->branch % 2 == 0 ? WB_PHASE_LOAD : WB_PHASE_UNLOAD;
}

static void record_state(struct run *r)
{
    struct wb_bundle_row *row = &r->row;
    const double length = r->model->length, last = 0.01 * length;
    const double s[2] = {length - last, length};
    double ends[2][3];

    wb_bundle_shape(r->bundle, 2, s, ends);
    *row = (struct wb_bundle_row){
        .time = r->state.time - r->begin,
        .cycle = 1 + r->branch / 2,
        .phase = r->state.slack ? WB_PHASE_SLACK : phase_of(r),
        .deflection = r->state.deflection,
        .tip = {ends[1][0], ends[1][1], ends[1][2]},
        .tip_angle = atan2(ends[1][1] - ends[0][1], ends[1][0] - ends[0][0]),
    };
    if (r->result->n_shape > 0)
        wb_bundle_shape(r->bundle, r->result->n_shape, r->result->shape_s,
                        r->result->shape + (size_t)r->result->n_rows * (size_t)r->result->n_shape);
    r->samples_before = r->vertical.n + r->slack_samples > 0.0;
}

static void sample(struct run *r)
{
    if (r->state.slack) {
        r->slack_samples++;
        return;
    }
    add_to_line(&r->vertical, r->state.target, r->state.vertical);
    add_to_line(&r->tension, r->state.target, r->state.tension);
}

static void begin_line(struct run *r)
{
    r->vertical = r->tension = (struct line){0};
    r->slack_samples = 0;
}

static void finish_row(struct run *r)
{
    struct wb_bundle_result *h = r->result;
    struct wb_bundle_row *row = &r->row;
    double ignored;

    /* A strand that oscillates about zero tension is slack and taut in turn: the majority of
     * samples decides. While the tip is at rest with a slack strand there are no samples. */
    if (!r->tip_released && r->samples_before)
        row->phase = r->slack_samples > r->vertical.n ? WB_PHASE_SLACK : phase_of(r);
    if (r->vertical.n == 0.0)
        sample(r);
    if (r->vertical.n == 0.0)
        row->phase = WB_PHASE_SLACK;
    /* While the strand is taut, the deflection equals the target. */
    if (row->phase != WB_PHASE_SLACK) {
        row->vertical_force = value_at(&r->vertical, row->deflection, &row->standard_deviation);
        row->tension = value_at(&r->tension, row->deflection, &ignored);
    }
    if (h->n_rows == 0)
        h->zero_force = row->vertical_force;
    row->force = row->vertical_force - h->zero_force;
    h->rows[h->n_rows++] = *row;
    begin_line(r);
}

/* Rank 0 decides, because clocks and signals differ between ranks. */
static enum verdict report_progress(struct run *r)
{
    const char *file = r->options.checkpoint;
    const bool wanted = should_continue(r, false);
    bool choice[2] = {wanted, file && (!wanted || read_clocks().wall - r->saved.wall >=
                                                      r->options.checkpoint_interval)};

    wb_team_share(choice, sizeof choice, 0);
    const bool saved = choice[1] && save(r) == WB_OK;
    if (choice[1] && !saved)
        wb_warn("%s: checkpoint not written; the run continues", file);
    if (choice[0])
        return CONTINUE;
    r->result->stopped = true;
    r->result->kept = saved;
    return DONE;
}

/* --- branches --- */

/* Time over duration at which a fifth-order smooth step has completed a fraction of its path. */
static double time_of(double share)
{
    double low = 0.0, high = 1.0;

    for (int i = 0; i < 60; i++) {
        const double t = 0.5 * (low + high);
        if (t * t * t * (10.0 + t * (6.0 * t - 15.0)) < share)
            low = t;
        else
            high = t;
    }
    return 0.5 * (low + high);
}

static bool unloads(const struct run *r)
{
    return r->branch % 2 == 1;
}

/* The target at a position of the branch, m: 0 is its start, the rows are at 1, 2, ... */
static double target_of(const struct run *r, double place)
{
    const double share = place / r->model->run.rows;
    return r->model->run.deflection * (unloads(r) ? 1.0 - share : share);
}

/* During unloading a strand is slack if the tip stays behind the target; a single negative force is
 * an oscillation. */
static bool went_slack(const struct run *r)
{
    return unloads(r) && r->model->loads.strand_length > 0.0 && !r->tip_released &&
           r->state.deflection - r->state.target > slack_gap * r->model->run.deflection;
}

/* Advances to a position of the branch, with samples of the force. Between two blocks of steps
 * checkpoints are written, and here a restored run continues. When the strand becomes slack the tip
 * is damped to rest, and nothing moves for the rest of the branch. */
static enum verdict advance_to(struct run *r, double place, bool look_there)
{
    const double dt = r->result->time_step;
    const double share = fmin(1.0, fmax(0.0, (target_of(r, place) - r->branch_target[0]) /
                                                 (r->branch_target[1] - r->branch_target[0])));
    const double end = r->branch_start + r->result->duration * time_of(share);
    struct wb_bundle_energies energies;

    if (r->left < 0)
        r->left = r->tip_released ? 0 : llround((end - r->state.time) / dt);
    while (r->left > 0) {
        const int n = (int)(r->left < r->block ? r->left : r->block);
        enum verdict verdict = advance(r, n);
        if (verdict != CONTINUE)
            return verdict;
        sample(r);
        r->left -= n;
        if (went_slack(r)) {
            const struct wb_bundle_watch watch = {damping_should_continue, r};
            verdict = judge_motion(r, wb_bundle_release_tip(r->bundle, &watch, &r->result->reason));
            if (verdict != CONTINUE)
                return verdict;
            r->tip_released = true;
            r->left = 0;
        }
        verdict = report_progress(r);
        if (verdict != CONTINUE)
            return verdict;
    }
    r->left = -1;
    return look_there ? check_energies(r, &energies) : CONTINUE;
}

static enum verdict call_observer(struct run *r)
{
    const struct wb_bundle_observer *observer = r->options.observer;

    if (!observer || !observer->place)
        return CONTINUE;
    (void)wb_bundle_whole(r->bundle); /* collective: called on all ranks */
    r->status = wb_team_agree(observer->place(observer->context, r->result, &r->row, r->bundle));
    return r->status == WB_OK ? CONTINUE : FAILED;
}

/* Advances from half a row before a row's target to half a row after it. */
static enum verdict pass_row(struct run *r)
{
    enum verdict verdict = CONTINUE;

    for (; r->looks <= LOOKS_OF_A_ROW && verdict == CONTINUE; r->looks++) {
        const double at = r->place - 0.5 + (double)r->looks / LOOKS_OF_A_ROW;
        const bool there = 2 * r->looks == LOOKS_OF_A_ROW;
        if (at > r->model->run.rows)
            break;
        verdict = advance_to(r, at, !there);
        if (verdict == CONTINUE && there) {
            record_state(r);
            verdict = check_energies(r, &r->row.energies);
            if (verdict == CONTINUE)
                verdict = call_observer(r);
        }
    }
    if (verdict == CONTINUE)
        finish_row(r);
    return verdict;
}

static void begin_branch(struct run *r)
{
    const double duration = r->result->duration;
    const double steps =
        duration / (1.875 * r->model->run.rows * r->result->time_step * SAMPLES_OF_A_ROW);

    r->block = (int)fmin(fmax(steps, 1.0), MAX_BLOCK);
    r->branch_start = r->state.time;
    r->branch_target[0] = r->tip_released ? r->state.target : target_of(r, 0.0);
    r->branch_target[1] = target_of(r, r->model->run.rows);
    wb_bundle_move_tip(r->bundle, r->branch_target[1], duration);
    r->tip_released = false;
    r->under_way = true;
    r->place = 0;
    r->left = -1;
}

static enum verdict run_branch(struct run *r)
{
    const int rows = r->model->run.rows;
    enum verdict verdict = CONTINUE;

    if (!r->under_way)
        begin_branch(r);
    if (r->place == 0) {
        verdict = advance_to(r, 0.5, false);
        if (verdict != CONTINUE)
            return verdict;
        /* Samples nearer to the end of the last branch belong to its last row, not to the first row
         * of this branch. */
        begin_line(r);
        r->place = r->looks = 1;
    }
    while (r->place <= rows && verdict == CONTINUE) {
        verdict = pass_row(r);
        if (verdict == CONTINUE) {
            r->place++;
            r->looks = 1;
        }
    }
    if (verdict == CONTINUE)
        r->under_way = false;
    return verdict;
}

/* Row 0: at rest, with the weight applied. The strand is taut and carries part of it. */
static enum verdict settle(struct run *r)
{
    const struct wb_bundle_watch watch = {damping_should_continue, r};
    enum verdict verdict = judge_motion(r, wb_bundle_settle(r->bundle, &watch, &r->result->reason));

    if (verdict != CONTINUE)
        return verdict;
    r->begin = r->state.time;
    record_state(r);
    verdict = call_observer(r);
    if (verdict != CONTINUE)
        return verdict;
    for (int i = 0; i < REST_SAMPLES && r->model->loads.weight; i++) {
        verdict = advance(r, MAX_BLOCK);
        if (verdict != CONTINUE)
            return verdict;
        sample(r);
    }
    if (!r->model->loads.weight) /* no motion and no load */
        sample(r);
    wb_bundle_get_energies(r->bundle, &r->row.energies);
    finish_row(r);
    r->begin = r->state.time;
    return CONTINUE;
}

static void begin_attempt(struct run *r)
{
    struct wb_bundle_result *h = r->result;

    h->n_rows = 0;
    h->exceeded = false;
    h->largest = (struct wb_bundle_extremes){0};
    h->attempts++;
    r->counting = r->judged = r->under_way = r->tip_released = false;
    r->kinetic = r->artificial = (double)NAN;
    r->most_external = 0.0;
    begin_line(r);
    r->branch = 0;
}

static enum verdict attempt(struct run *r)
{
    struct wb_bundle_result *h = r->result;
    struct wb_checkpoint checkpoint = {.bytes = NULL};
    enum verdict verdict = CONTINUE;

    r->status = find_checkpoint(r, &checkpoint);
    const bool resumes = r->status == WB_OK && checkpoint.restores;
    if (r->status == WB_OK && !resumes)
        begin_attempt(r);
    else if (resumes)
        visit_run(r, &checkpoint);
    const struct wb_bundle_settings settings = {
        .mesh = r->options.mesh, .duration = h->duration, .threads = r->options.threads};
    if (r->status == WB_OK)
        r->status = wb_bundle_create(&r->bundle, r->model, &settings);
    if (r->status == WB_OK && resumes)
        r->status = resume(r, &checkpoint);
    wb_checkpoint_release(&checkpoint);
    if (r->status != WB_OK) {
        wb_bundle_destroy(r->bundle);
        r->bundle = NULL;
        return FAILED;
    }
    h->time_step = wb_bundle_time_step(r->bundle);
    h->hexahedra = wb_bundle_hexahedra(r->bundle);
    h->shells = wb_bundle_shells(r->bundle);
    h->parts = wb_bundle_parts(r->bundle);

    if (!resumes)
        verdict = settle(r);
    while (r->branch < branches_of(r->model) && verdict == CONTINUE) {
        verdict = run_branch(r);
        r->branch += verdict == CONTINUE;
    }
    wb_bundle_get_state(r->bundle, &r->state);
    h->steps = r->state.steps;
    h->all_steps += h->steps;
    h->exceeded = h->largest.kinetic > r->model->run.kinetic_limit;
    wb_bundle_destroy(r->bundle);
    r->bundle = NULL;
    return verdict;
}

/* --- the duration --- */

/* Initial guess of the duration, s: the ratio at the deflection where it begins to count, for a tip
 * that follows the smooth step and a beam that keeps its static shape, with a rigidity between
 * sliding and bonded wires. Half that duration, because too short a duration is detected early. */
static double guess_duration(const struct wb_bundle_model *model, double from)
{
    const struct wb_bundle_rigidity rigidity = wb_bundle_model_rigidity(model);
    const double ei = sqrt(rigidity.sliding[0] * rigidity.bonded[0]), length = model->length;
    const double mass = (wb_bundle_model_wire_mass(model) + wb_bundle_model_tape_mass(model)) *
                        model->run.mass_scaling;
    const double t = time_of(from / model->run.deflection);
    /* m/s for a duration of 1 s */
    const double speed = 30.0 * model->run.deflection * t * t * (1.0 - t) * (1.0 - t);
    const double ratio =
        33.0 / 140.0 * mass * pow(length, 4.0) * speed * speed / (3.0 * ei * from * from);
    return 0.5 * sqrt(ratio / model->run.kinetic_limit);
}

static void begin_result(struct run *r)
{
    struct wb_bundle_result *h = r->result;

    h->chosen = r->model->run.duration == 0.0;
    h->duration = h->chosen ? guess_duration(r->model, r->from) : r->model->run.duration;
    h->converged = true;
    h->stopped = h->kept = h->resumed = false;
    h->reason = (struct wb_reason){0};
    h->attempts = 0;
    h->all_steps = 0;
}

enum wb_status wb_bundle_run(struct wb_bundle_result *result, const struct wb_bundle_model *model,
                             const struct wb_bundle_run_options *options)
{
    struct run r = {
        .result = result,
        .model = model,
        .begun = read_clocks(),
        .saved = read_clocks(),
        .may_resume = true,
        .from = fmin(default_from, 0.5 * model->run.deflection),
        .left = -1,
    };
    enum verdict verdict;

    if (options)
        r.options = *options;
    if (r.options.checkpoint_interval == 0.0)
        r.options.checkpoint_interval = default_interval;
    if (result->capacity < wb_bundle_model_rows(model))
        return wb_fail(WB_ERR_ARGUMENT,
                       "the result has room for %d rows: expected the %d of the test",
                       result->capacity, wb_bundle_model_rows(model));
    if (r.options.checkpoint)
        WB_TRY(wb_team_agree(wb_hash_file("/proc/self/exe", r.program)));
    begin_result(&r);
    do {
        verdict = attempt(&r);
        if (verdict == RESTART)
            result->duration = r.next;
    } while (verdict == RESTART);
    take_time(&r);
    return r.status;
}
