/* Checkpoints of a run. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/file.h"
#include "base/units.h"
#include "base/version.h"
#include "fe/bundle/bundle_parts.h"
#include "fe/bundle/bundle_run_private.h"
#include "fe/swept/swept_hex.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "bundle"

enum {
    MOST_IDENTITY = 512
};

static double seconds_of(clockid_t clock)
{
    struct timespec time;
    clock_gettime(clock, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

struct wb_bundle_run_clock wb_bundle_run_clock(void)
{
    return (struct wb_bundle_run_clock){seconds_of(CLOCK_MONOTONIC),
                                        seconds_of(CLOCK_PROCESS_CPUTIME_ID)};
}

void wb_bundle_run_take_time(struct wb_bundle_run_now *r)
{
    const struct wb_bundle_run_clock at = wb_bundle_run_clock();
    double cpu = at.cpu - r->begun.cpu;

    wb_team_sum(&cpu, 1);
    r->history->wall = r->wall_before + (at.wall - r->begun.wall);
    r->history->cpu = r->cpu_before + cpu;
}

/* What a checkpoint belongs to: all that decides a single bit of the result. */
static void identify(const struct wb_bundle_run_now *r, char text[MOST_IDENTITY])
{
    const struct wb_bundle_model *m = r->model;
    const struct wb_bundle_interface *i = &m->interface;
    const char *mesh = r->options.mesh ? r->options.mesh : m->run.mesh;
    char settings[1024], hash[WB_SHA256_TEXT];

    snprintf(settings, sizeof settings,
             "%s %d %d %d %d %.17g %.17g %.17g %.17g %.17g %.17g %d %.17g %.17g %.17g %d %.17g "
             "%.17g %.17g %.17g %.17g %.17g",
             m->sha256, m->has_tape, (int)m->tip, m->run.rows, m->run.cycles, m->run.deflection,
             m->run.duration, m->run.mass_scaling, m->run.selective, m->run.kinetic_limit,
             m->loads.strand_length, m->loads.weight, m->length, i->normal_stiffness,
             i->shear_stiffness, i->has_damage, i->damage.strength, i->damage.shear_strength,
             i->damage.fracture_energy, i->friction_static, i->friction_kinetic, i->friction_decay);
    wb_hash_bytes(settings, strlen(settings), hash);
    snprintf(text, MOST_IDENTITY,
             "bundle %s, mesh %s, settings %.12s, %d shape positions, %d parts (threads x ranks), "
             "%s precision, %s, wirebench %s, program %.12s",
             m->name, mesh, hash, r->history->n_shape,
             wb_bundle_parts_of(m, mesh, r->options.threads),
             m->run.double_precision ? "double" : "single", wb_swept_hex_best_instructions(),
             wb_version_revision(), r->program);
}

/* Its memory stays; what it holds is saved or restored. */
static void visit_history(struct wb_bundle_history *h, struct wb_checkpoint *c)
{
    const size_t rows = (size_t)h->capacity, places = rows * (size_t)h->n_shape;

    wb_checkpoint_enter(c, "history");
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
static void visit_place(struct wb_bundle_run_now *r, struct wb_checkpoint *c)
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

void wb_bundle_run_visit(struct wb_bundle_run_now *r, struct wb_checkpoint *c)
{
    const struct wb_bundle_observer *observer = r->options.observer;

    visit_history(r->history, c);
    if (observer && observer->visit) {
        wb_checkpoint_enter(c, "observer");
        observer->visit(observer->context, c);
        wb_checkpoint_leave(c);
    }
    visit_place(r, c);
}

enum wb_status wb_bundle_run_save(struct wb_bundle_run_now *r)
{
    struct wb_checkpoint c;
    char identity[MOST_IDENTITY];

    wb_checkpoint_init(&c);
    wb_bundle_run_take_time(r);
    wb_bundle_run_visit(r, &c);
    wb_bundle_visit(r->bundle, &c);
    enum wb_status status = wb_checkpoint_finish(&c);
    identify(r, identity);
    if (status == WB_OK && wb_team_rank() == 0)
        status = wb_checkpoint_write(&c, r->options.checkpoint, identity);
    wb_checkpoint_release(&c);
    r->saved = wb_bundle_run_clock();
    return wb_team_agree(status);
}

/* Into `c`, which restores then, what an earlier process left; nothing where there is none. All
 * ranks get what rank 0 reads. */
enum wb_status wb_bundle_run_find(struct wb_bundle_run_now *r, struct wb_checkpoint *c)
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
        c->bytes = malloc(size);
        c->size = size;
        c->restores = c->bytes;
        if (!c->bytes)
            status = wb_fail(WB_ERR_MEMORY, "out of memory for a checkpoint of %zu bytes", size);
    }
    WB_TRY(wb_team_agree(status));
    wb_team_share(c->bytes, size, 0);
    return WB_OK;
}

enum wb_status wb_bundle_run_resume(struct wb_bundle_run_now *r, struct wb_checkpoint *c)
{
    struct wb_bundle_history *h = r->history;

    wb_bundle_visit(r->bundle, c);
    WB_TRY(wb_team_agree(wb_checkpoint_finish(c)));
    h->resumed = true;
    r->wall_before = h->wall;
    r->cpu_before = h->cpu;
    wb_info("%s: goes on at %.2f mm, step %lld, of a run of %.0f s so far", r->options.checkpoint,
            r->state.deflection / WB_MM, r->state.steps, h->wall);
    return WB_OK;
}
