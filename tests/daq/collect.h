/* A sink that stores the samples and remarks of a driver, for the tests of drivers. */
#ifndef WB_TESTS_DAQ_COLLECT_H
#define WB_TESTS_DAQ_COLLECT_H

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "daq/protocol/driver.h"
#include "tests/check.h"

#define COLLECT_MAX 64

struct collect {
    int n_load, n_mocap, n_stage, n_probes, n_remarks;
    struct wb_load_sample load[COLLECT_MAX];
    struct wb_mocap_frame mocap; /* the last one */
    struct wb_stage_report stage[COLLECT_MAX];
    int n_settings;
    struct wb_stage_settings settings; /* the last ones */
    struct wb_clock_probe probes[COLLECT_MAX];
    struct {
        enum wb_log_level level;
        int64_t t_ns;
        char kind[32];
        char text[256];
    } remarks[COLLECT_MAX];
};

static inline void collect_load(void *context, const struct wb_load_sample *sample)
{
    struct collect *const collect = context;
    assert_true(collect->n_load < COLLECT_MAX);
    collect->load[collect->n_load++] = *sample;
}

static inline void collect_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct collect *const collect = context;
    collect->n_mocap++;
    collect->mocap = *frame;
}

static inline void collect_stage(void *context, const struct wb_stage_report *report)
{
    struct collect *const collect = context;
    assert_true(collect->n_stage < COLLECT_MAX);
    collect->stage[collect->n_stage++] = *report;
}

static inline void collect_settings(void *context, const struct wb_stage_settings *settings)
{
    struct collect *const collect = context;
    collect->n_settings++;
    collect->settings = *settings;
}

static inline void collect_probe(void *context, const struct wb_clock_probe *probe)
{
    struct collect *const collect = context;
    assert_true(collect->n_probes < COLLECT_MAX);
    collect->probes[collect->n_probes++] = *probe;
}

static inline void collect_remark(void *context, enum wb_log_level level, int64_t t_ns,
                                  const char *kind, const char *text)
{
    struct collect *const collect = context;
    assert_true(collect->n_remarks < COLLECT_MAX);
    const int i = collect->n_remarks++;
    collect->remarks[i].level = level;
    collect->remarks[i].t_ns = t_ns;
    snprintf(collect->remarks[i].kind, sizeof collect->remarks[i].kind, "%s", kind);
    snprintf(collect->remarks[i].text, sizeof collect->remarks[i].text, "%s", text);
}

static inline struct wb_sink collect_sink(struct collect *collect)
{
    return (struct wb_sink){.context = collect,
                            .load = collect_load,
                            .mocap = collect_mocap,
                            .stage = collect_stage,
                            .settings = collect_settings,
                            .probe = collect_probe,
                            .remark = collect_remark};
}

/* Number of remarks of a kind. */
static inline int collect_count(const struct collect *collect, const char *kind)
{
    int n = 0;
    for (int i = 0; i < collect->n_remarks; i++)
        n += strcmp(collect->remarks[i].kind, kind) == 0;
    return n;
}

/* The text of the first remark of a kind; "" when there is none. */
static inline const char *collect_text(const struct collect *collect, const char *kind)
{
    for (int i = 0; i < collect->n_remarks; i++)
        if (strcmp(collect->remarks[i].kind, kind) == 0)
            return collect->remarks[i].text;
    return "";
}

/* A driver with fresh state for a rig. */
static inline void *collect_open(const struct wb_driver *driver, const struct wb_rig *rig)
{
    void *const state = calloc(1, driver->state_size);
    assert_non_null(state);
    assert_int_equal(driver->init(state, rig), WB_OK);
    return state;
}

/* Entry i of an outbox, its size in *n. */
static inline const uint8_t *collect_entry(const struct wb_outbox *outbox, size_t i, size_t *n)
{
    assert_true(i < outbox->n_entries);
    const size_t begin = i ? outbox->ends[i - 1] : 0;
    *n = outbox->ends[i] - begin;
    return outbox->bytes + begin;
}

#endif
