#include "fe/bundle/bundle_run.h"

#include <math.h>
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
#include "fe/swept/swept_hex.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "bundle"

enum {
    MOST_SHAPE = 1000,
    MOST_BLOCK = 50,       /* steps between two samples of the force */
    SAMPLES_OF_A_ROW = 40, /* at least, where its steps allow it */
    LOOKS_OF_A_ROW = 4,    /* at all energies */
    REST_SAMPLES = 40,     /* of the force at zero */
    MOST_IDENTITY = 512
};

static const double usual_from = 2.0 * WB_MM; /* where ratios begin to count */
static const double pilot_share = 1.5;        /* of that, where a duration is judged */
static const double margin = 1.06;            /* on a duration that follows from a ratio */
static const double late_margin = 1.1;        /* on one that follows from a later ratio */
static const double too_slow = 0.75;          /* a needed duration over the present one */
static const double usual_interval = 600.0;   /* s between checkpoints */
static const double slack_gap = 1e-3;         /* over the deflection: the strand is slack, surely */
static const double lost_balance = 0.05;      /* imbalance over work: the run is no solution */

/* The straight line through forces against the target, of one row. */
struct line {
    double n, x, y, xx, xy, yy;
};

/* Clocks of this process, s. */
struct clocks {
    double wall, cpu;
};

/* A test under way. */
struct run {
    struct wb_bundle_result *result;
    const struct wb_bundle_model *model;
    struct wb_bundle_run_options options;
    struct wb_bundle *bundle;
    enum wb_status status;
    struct clocks begun, saved; /* clocks of this process */
    double wall_before;         /* s, in the processes before */
    double cpu_before;
    bool may_resume;
    char program[WB_SHA256_TEXT]; /* this binary's, where there are checkpoints */

    /* From here on all is in a checkpoint: visit_place(). */
    struct wb_bundle_state state;
    double from;   /* m: ratios count from here on */
    bool counting; /* the tip was there */
    bool judged;   /* the duration is accepted */
    double begin;  /* s of the bundle's time: the loading's */
    double next;   /* s: duration of the next attempt */
    double kinetic, artificial;
    double most_external;

    int branch;      /* ways made so far */
    bool under_way;  /* on another */
    int place;       /* the row that is passed, from 1; 0: the half step before them */
    int looks;       /* the next look in it, from 1 */
    long long left;  /* steps to there; -1: not begun */
    double way[2];   /* m: from, to */
    bool hangs;      /* the strand went slack on this way, the tip rests */
    double way_time; /* s: its begin */
    int block;       /* steps between samples */
    struct line vertical, tension;
    int slack_samples;        /* beside these */
    bool samples_before;      /* the row's place */
    struct wb_bundle_row row; /* passed, its mean not complete */
};

/* --- memory --- */

enum wb_status wb_bundle_result_init(struct wb_bundle_result *result,
                                     const struct wb_bundle_model *model, int n_shape)
{
    *result = (struct wb_bundle_result){0};
    if (n_shape < 0 || n_shape == 1 || n_shape > MOST_SHAPE)
        return wb_fail(WB_ERR_ARGUMENT, "%d positions of a shape: expected none or 2 to %d",
                       n_shape, MOST_SHAPE);

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

/* Into the result, what was spent so far. */
static void take_time(struct run *r)
{
    const struct clocks at = read_clocks();
    double cpu = at.cpu - r->begun.cpu;

    wb_team_sum(&cpu, 1);
    r->result->wall = r->wall_before + (at.wall - r->begun.wall);
    r->result->cpu = r->cpu_before + cpu;
}

/* --- checkpoints --- */

/* What a checkpoint belongs to: all that decides a single bit of the result. */
static void identify(const struct run *r, char text[MOST_IDENTITY])
{
    const struct wb_bundle_model *m = r->model;
    const char *mesh = r->options.mesh ? r->options.mesh : m->run.mesh;
    char hash[WB_SHA256_TEXT];
    struct wb_json *const inputs = wb_json_create();

    wb_model_inputs_bundle(inputs, m, wb_bundle_model_mesh(m, mesh));
    wb_model_inputs_sum(inputs, hash);
    wb_json_destroy(inputs);
    snprintf(text, MOST_IDENTITY,
             "bundle %s, mesh %s, settings %.12s, %d shape positions, %d parts (threads x ranks), "
             "%s precision, %s, wirebench %s, program %.12s",
             m->name, mesh, hash, r->result->n_shape,
             wb_bundle_parts_of(m, mesh, r->options.threads),
             m->run.double_precision ? "double" : "single", wb_swept_hex_best_instructions(),
             wb_version_revision(), r->program);
}

/* Its memory stays; what it holds is saved or restored. */
static void visit_result(struct wb_bundle_result *h, struct wb_checkpoint *c)
{
    const size_t rows = (size_t)h->capacity, places = rows * (size_t)h->n_shape;

    wb_checkpoint_enter(c, "result");
    wb_checkpoint_visit_member(c, h, n_rows);
    wb_checkpoint_visit(c, "rows", h->rows, rows * sizeof *h->rows);
    wb_checkpoint_visit(c, "shape", h->shape, places * sizeof *h->shape);
    wb_checkpoint_visit_member(c, h, converged);
    wb_checkpoint_visit_member(c, h, reason);
    wb_checkpoint_visit_member(c, h, zero_force);
    wb_checkpoint_visit_member(c, h, duration);
    wb_checkpoint_visit_member(c, h, chosen);
    wb_checkpoint_visit_member(c, h, exceeded);
    wb_checkpoint_visit_member(c, h, attempts);
    wb_checkpoint_visit_member(c, h, all_steps);
    wb_checkpoint_visit_member(c, h, largest);
    wb_checkpoint_visit_member(c, h, wall);
    wb_checkpoint_visit_member(c, h, cpu);
    wb_checkpoint_leave(c);
}

/* How far the test has come. */
static void visit_place(struct run *r, struct wb_checkpoint *c)
{
    wb_checkpoint_visit_member(c, r, state);
    wb_checkpoint_visit_member(c, r, from);
    wb_checkpoint_visit_member(c, r, counting);
    wb_checkpoint_visit_member(c, r, judged);
    wb_checkpoint_visit_member(c, r, begin);
    wb_checkpoint_visit_member(c, r, next);
    wb_checkpoint_visit_member(c, r, kinetic);
    wb_checkpoint_visit_member(c, r, artificial);
    wb_checkpoint_visit_member(c, r, most_external);
    wb_checkpoint_visit_member(c, r, branch);
    wb_checkpoint_visit_member(c, r, under_way);
    wb_checkpoint_visit_member(c, r, place);
    wb_checkpoint_visit_member(c, r, looks);
    wb_checkpoint_visit_member(c, r, left);
    wb_checkpoint_visit_member(c, r, way);
    wb_checkpoint_visit_member(c, r, hangs);
    wb_checkpoint_visit_member(c, r, way_time);
    wb_checkpoint_visit_member(c, r, block);
    wb_checkpoint_visit_member(c, r, vertical);
    wb_checkpoint_visit_member(c, r, tension);
    wb_checkpoint_visit_member(c, r, slack_samples);
    wb_checkpoint_visit_member(c, r, samples_before);
    wb_checkpoint_visit_member(c, r, row);
}

/* All but the bundle. */
static void visit_run(struct run *r, struct wb_checkpoint *c)
{
    const struct wb_bundle_observer *observer = r->options.observer;

    visit_result(r->result, c);
    if (observer && observer->visit) {
        wb_checkpoint_enter(c, "observer");
        observer->visit(observer->context, c);
        wb_checkpoint_leave(c);
    }
    visit_place(r, c);
}

static enum wb_status save(struct run *r)
{
    struct wb_checkpoint c;
    char identity[MOST_IDENTITY];

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

/* Reads what an earlier process left into `c`, which restores then; nothing where there is none.
 * All ranks get what rank 0 reads. */
static enum wb_status find_checkpoint(struct run *r, struct wb_checkpoint *c)
{
    char identity[MOST_IDENTITY];
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

/* Restores the bundle, after all else. */
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
    GO_ON,
    DONE,  /* or stopped, or lost: nothing more is to be done */
    ANEW,  /* with another duration */
    FAILED /* an error that is not the run's */
};

static int branches_of(const struct wb_bundle_model *model)
{
    return model->run.cycles == 0 ? 1 : 2 * model->run.cycles;
}

static enum verdict lose(struct run *r)
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

/* Whether the caller wants to go on. */
static bool is_wanted(const struct run *r, bool rests)
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

/* While it comes to rest there are no checkpoints: with rows behind it, it stops at the next place
 * where there are. Rank 0 decides. */
static bool rest_is_wanted(void *context)
{
    struct run *r = context;

    wb_bundle_get_state(r->bundle, &r->state);
    bool wanted = is_wanted(r, true) || r->result->n_rows > 0;
    wb_team_share(&wanted, sizeof wanted, 0);
    r->result->stopped = !wanted;
    return wanted;
}

enum motion {
    STEPS,
    SETTLING,
    LETTING_GO
};

static enum verdict move(struct run *r, enum motion motion, int n)
{
    const struct wb_bundle_watch watch = {rest_is_wanted, r};
    struct wb_reason *const reason = &r->result->reason;

    *reason = (struct wb_reason){0};
    switch (motion) {
    case STEPS:
        r->status = wb_bundle_advance(r->bundle, n, reason);
        break;
    case SETTLING:
        r->status = wb_bundle_settle(r->bundle, &watch, reason);
        break;
    case LETTING_GO:
        r->status = wb_bundle_let_go(r->bundle, &watch, reason);
        break;
    }
    if (r->status != WB_OK)
        return lose(r);
    wb_bundle_get_state(r->bundle, &r->state);
    return r->result->stopped ? DONE : GO_ON;
}

static enum verdict advance(struct run *r, int n)
{
    return move(r, STEPS, n);
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

/* What a ratio says of the duration while the first loading goes on. */
static enum verdict judge(struct run *r)
{
    struct wb_bundle_result *h = r->result;
    const double limit = r->model->run.kinetic_limit;
    const double needed = h->duration * sqrt(h->largest.kinetic / limit);
    const bool last = h->attempts == WB_BUNDLE_RUN_ATTEMPTS;

    if (!h->chosen || (!r->judged && r->state.target < pilot_share * r->from))
        return GO_ON;
    h->exceeded = h->largest.kinetic > limit;
    if (h->exceeded && !last) {
        r->next = needed * (r->judged ? late_margin : margin);
        return ANEW;
    }
    if (!r->judged && h->attempts == 1 && needed * margin < too_slow * h->duration) {
        r->next = needed * margin;
        return ANEW;
    }
    r->judged = true;
    return GO_ON;
}

static enum verdict look(struct run *r, struct wb_bundle_energies *e)
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
        return GO_ON;

    largest->kinetic = fmax(largest->kinetic, r->kinetic);
    largest->artificial = fmax(largest->artificial, r->artificial);
    largest->imbalance = fmax(largest->imbalance, imbalance);
    if (!(imbalance <= lost_balance)) {
        wb_reason_set(&r->result->reason,
                      "energy is not kept: at %.3g mm, after %lld steps, %.3g of the external work "
                      "are missing or too much",
                      r->state.deflection / WB_MM, r->state.steps, imbalance);
        r->status = WB_ERR_DATA;
        return lose(r);
    }
    return r->branch == 0 ? judge(r) : GO_ON;
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

/* Its value at x; at one place only, or with too few points, the mean. */
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

static void take_place(struct run *r)
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

    /* A strand that swings about zero is slack for a step and taut for the next. Where the tip
     * hangs there are no samples: it was slack there, whatever comes after. */
    if (!r->hangs && r->samples_before)
        row->phase = r->slack_samples > r->vertical.n ? WB_PHASE_SLACK : phase_of(r);
    if (r->vertical.n == 0.0)
        sample(r);
    if (r->vertical.n == 0.0)
        row->phase = WB_PHASE_SLACK;
    /* Where the strand is taut the target is the deflection. */
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

/* Rank 0 decides: clocks and signals differ. */
static enum verdict report(struct run *r)
{
    const char *file = r->options.checkpoint;
    const bool wanted = is_wanted(r, false);
    bool choice[2] = {wanted, file && (!wanted || read_clocks().wall - r->saved.wall >=
                                                      r->options.checkpoint_interval)};

    wb_team_share(choice, sizeof choice, 0);
    const bool saved = choice[1] && save(r) == WB_OK;
    if (choice[1] && !saved)
        wb_warn("%s: this checkpoint is not written", file);
    if (choice[0])
        return GO_ON;
    r->result->stopped = true;
    r->result->kept = saved;
    return DONE;
}

/* --- ways --- */

/* Time over duration at which a fifth-order smooth step has made the share of its way. */
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

/* The target at a place of the way, m: 0 is its begin, the rows are at 1, 2, ... */
static double target_of(const struct run *r, double place)
{
    const double share = place / r->model->run.rows;
    return r->model->run.deflection * (unloads(r) ? 1.0 - share : share);
}

/* During unloading a strand is slack when the tip stays behind the target; a single force below
 * zero is an oscillation. */
static bool went_slack(const struct run *r)
{
    return unloads(r) && r->model->loads.strand_length > 0.0 && !r->hangs &&
           r->state.deflection - r->state.target > slack_gap * r->model->run.deflection;
}

/* Goes on to a place of the way, sampling; energies are looked at four times a row. Here, between
 * two blocks of steps, checkpoints are made, and here a run goes on from one. Where the strand goes
 * slack the tip comes to rest, and nothing moves any more on this way. */
static enum verdict go_to(struct run *r, double place, bool look_there)
{
    const double dt = r->result->time_step;
    const double share =
        fmin(1.0, fmax(0.0, (target_of(r, place) - r->way[0]) / (r->way[1] - r->way[0])));
    const double end = r->way_time + r->result->duration * time_of(share);
    struct wb_bundle_energies energies;

    if (r->left < 0)
        r->left = r->hangs ? 0 : llround((end - r->state.time) / dt);
    while (r->left > 0) {
        const int n = (int)(r->left < r->block ? r->left : r->block);
        enum verdict verdict = advance(r, n);
        if (verdict != GO_ON)
            return verdict;
        sample(r);
        r->left -= n;
        if (went_slack(r)) {
            verdict = move(r, LETTING_GO, 0);
            if (verdict != GO_ON)
                return verdict;
            r->hangs = true;
            r->left = 0;
        }
        verdict = report(r);
        if (verdict != GO_ON)
            return verdict;
    }
    r->left = -1;
    return look_there ? look(r, &energies) : GO_ON;
}

static enum verdict show_place(struct run *r)
{
    const struct wb_bundle_observer *observer = r->options.observer;

    if (!observer || !observer->place)
        return GO_ON;
    (void)wb_bundle_whole(r->bundle); /* all ranks take part in that */
    r->status = wb_team_agree(observer->place(observer->context, r->result, &r->row, r->bundle));
    return r->status == WB_OK ? GO_ON : FAILED;
}

/* From half a step before a row's place to half a step after it. */
static enum verdict pass_row(struct run *r)
{
    enum verdict verdict = GO_ON;

    for (; r->looks <= LOOKS_OF_A_ROW && verdict == GO_ON; r->looks++) {
        const double at = r->place - 0.5 + (double)r->looks / LOOKS_OF_A_ROW;
        const bool there = 2 * r->looks == LOOKS_OF_A_ROW;
        if (at > r->model->run.rows)
            break;
        verdict = go_to(r, at, !there);
        if (verdict == GO_ON && there) {
            take_place(r);
            verdict = look(r, &r->row.energies);
            if (verdict == GO_ON)
                verdict = show_place(r);
        }
    }
    if (verdict == GO_ON)
        finish_row(r);
    return verdict;
}

static void begin_way(struct run *r)
{
    const double duration = r->result->duration;
    const double steps =
        duration / (1.875 * r->model->run.rows * r->result->time_step * SAMPLES_OF_A_ROW);

    r->block = (int)fmin(fmax(steps, 1.0), MOST_BLOCK);
    r->way_time = r->state.time;
    r->way[0] = r->hangs ? r->state.target : target_of(r, 0.0);
    r->way[1] = target_of(r, r->model->run.rows);
    wb_bundle_lead(r->bundle, r->way[1], duration);
    r->hangs = false;
    r->under_way = true;
    r->place = 0;
    r->left = -1;
}

static enum verdict make_way(struct run *r)
{
    const int rows = r->model->run.rows;
    enum verdict verdict = GO_ON;

    if (!r->under_way)
        begin_way(r);
    if (r->place == 0) {
        verdict = go_to(r, 0.5, false);
        if (verdict != GO_ON)
            return verdict;
        /* What is nearer to where the last way ended belongs to its last row, not to the first. */
        begin_line(r);
        r->place = r->looks = 1;
    }
    while (r->place <= rows && verdict == GO_ON) {
        verdict = pass_row(r);
        if (verdict == GO_ON) {
            r->place++;
            r->looks = 1;
        }
    }
    if (verdict == GO_ON)
        r->under_way = false;
    return verdict;
}

/* Row 0: at rest, with the weight on. The strand is taut: it carries part of it. */
static enum verdict rest(struct run *r)
{
    enum verdict verdict = move(r, SETTLING, 0);

    if (verdict != GO_ON)
        return verdict;
    r->begin = r->state.time;
    take_place(r);
    verdict = show_place(r);
    if (verdict != GO_ON)
        return verdict;
    for (int i = 0; i < REST_SAMPLES && r->model->loads.weight; i++) {
        verdict = advance(r, MOST_BLOCK);
        if (verdict != GO_ON)
            return verdict;
        sample(r);
    }
    if (!r->model->loads.weight) /* nothing has moved, nothing acts */
        sample(r);
    wb_bundle_get_energies(r->bundle, &r->row.energies);
    finish_row(r);
    r->begin = r->state.time;
    return GO_ON;
}

static void begin_attempt(struct run *r)
{
    struct wb_bundle_result *h = r->result;

    h->n_rows = 0;
    h->exceeded = false;
    h->largest = (struct wb_bundle_extremes){0};
    h->attempts++;
    r->counting = r->judged = r->under_way = r->hangs = false;
    r->kinetic = r->artificial = (double)NAN;
    r->most_external = 0.0;
    begin_line(r);
    r->branch = 0;
}

static enum verdict attempt(struct run *r)
{
    struct wb_bundle_result *h = r->result;
    struct wb_checkpoint checkpoint = {.bytes = NULL};
    enum verdict verdict = GO_ON;

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
        verdict = rest(r);
    while (r->branch < branches_of(r->model) && verdict == GO_ON) {
        verdict = make_way(r);
        r->branch += verdict == GO_ON;
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

/* A guess, s: the ratio where it begins to count, of a tip that follows the smooth step while the
 * beam keeps its static shape. Its rigidity is between sliding and bonded wires. Half the time that
 * would do: what is too short is soon found. */
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
        .from = fmin(usual_from, 0.5 * model->run.deflection),
        .left = -1,
    };
    enum verdict verdict;

    if (options)
        r.options = *options;
    if (r.options.checkpoint_interval == 0.0)
        r.options.checkpoint_interval = usual_interval;
    if (result->capacity < wb_bundle_model_rows(model))
        return wb_fail(WB_ERR_ARGUMENT,
                       "the result has room for %d rows: expected the %d of the test",
                       result->capacity, wb_bundle_model_rows(model));
    if (r.options.checkpoint)
        WB_TRY(wb_team_agree(wb_hash_file("/proc/self/exe", r.program)));
    begin_result(&r);
    do {
        verdict = attempt(&r);
        if (verdict == ANEW)
            result->duration = r.next;
    } while (verdict == ANEW);
    take_time(&r);
    return r.status;
}
