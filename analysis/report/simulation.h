/* A dataset of a simulation that a campaign wants: where it lies, how this program makes it, and
 * whether they can be used.
 *
 * A dataset that is not there is no error: reports say so, and how to make it.
 */
#ifndef WB_ANALYSIS_REPORT_SIMULATION_H
#define WB_ANALYSIS_REPORT_SIMULATION_H

#include <stdbool.h>
#include <stdio.h>

#include "analysis/dataset/dataset.h"
#include "analysis/keys/keys.h"
#include "analysis/report/campaign.h"
#include "analysis/solve/solve_settings.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"

/* A dataset that a campaign wants. */
struct wb_simulation {
    bool wanted;
    char name[256];     /* for readers: no path of this machine */
    char path[WB_PATH]; /* of its folder, which may not be there */
    char log[128];      /* a name for a log and a checkpoint, of this dataset alone */
    struct wb_solve_settings settings; /* with which it is computed; the model's path is owned */
    struct wb_text command; /* that computes it, for readers: without paths of this machine */
    struct wb_json *inputs; /* that it must have been computed of; owned */
    char inputs_sha256[WB_SHA256_TEXT];
};

/* Path and name of a dataset. A name lies among the campaign's simulations, by default the shipped
 * ones; whatever holds a '/' is a path from the campaign file. */
WB_MUST_CHECK enum wb_status wb_simulation_find(struct wb_simulation *simulation,
                                                const struct wb_campaign *campaign,
                                                const char *given);

/* Then the settings with which it is computed, and its command, which shows the model, where there
 * is one, as `shown`. A wire's name is borrowed. The inputs are the dataset's
 * (analysis/dataset/simulated.h); the simulation owns them from here on. */
void wb_simulation_set(struct wb_simulation *simulation, const struct wb_solve_settings *settings,
                       const char *shown, struct wb_json *inputs);

void wb_simulation_release(struct wb_simulation *simulation); /* accepts a zeroed one */

/* --- datasets that exist --- */

enum wb_simulation_state {
    WB_SIMULATION_NOT_WANTED,
    WB_SIMULATION_MISSING, /* there is no such dataset */
    WB_SIMULATION_STALE,   /* of other inputs, or cut short: to be made again */
    WB_SIMULATION_REFUSED, /* it is something else, damaged, ... */
    WB_SIMULATION_USABLE
};

struct wb_simulation_result {
    enum wb_simulation_state state;
    struct wb_text problem;      /* why it cannot be used */
    char revision[64];           /* of the program that made it */
    char sha256[WB_SHA256_TEXT]; /* of its force_deflection.csv */
    double cpu_s;                /* that it took; NaN: not known */
    struct wb_dataset dataset;   /* of a usable one */
};

/* How a kind of report looks at a dataset that was read. */
struct wb_simulation_reader {
    /* Takes its data from a dataset that fits and is complete; NULL: nothing. */
    enum wb_status (*take)(void *context, struct wb_reason *why);
    void *context;
};

/* Reads the wanted dataset into a zeroed result. An error is kept in the result. */
void wb_simulation_load(struct wb_simulation_result *result, const struct wb_simulation *wanted,
                        const struct wb_simulation_reader *reader);
void wb_simulation_result_release(struct wb_simulation_result *result);

/* Keys that wb_simulation_describe() sets. */
extern const struct wb_keys wb_simulation_state_keys;

/* Sets its name, state, command, and problem. */
void wb_simulation_describe(struct wb_json *object, const struct wb_simulation *wanted,
                            const struct wb_simulation_result *result);

/* Whether it is to be made (again). */
bool wb_simulation_is_missing(const struct wb_simulation_result *result);

/* A number of a dataset's description; NaN where there is none. */
double wb_simulation_number(const struct wb_json *object, const char *key);

/* The dataset's `simulation`. */
const struct wb_json *wb_simulation_of(const struct wb_simulation_result *result);

/* --- all of a report --- */

struct wb_simulation_entry {
    const struct wb_simulation *wanted;
    const struct wb_simulation_result *result;
    double cost;       /* of making it, beside the others; 0: not known */
    bool is_resumable; /* the run takes --threads, and --checkpoint FILE to continue where it
                          was stopped */
};

/* How a kind of report lists its datasets: the one at an index; false after the last. */
typedef bool wb_simulation_list(const void *results, int index, struct wb_simulation_entry *entry);

/* How many are wanted and usable. */
void wb_simulation_count(wb_simulation_list *list, const void *results, int *n_wanted,
                         int *n_usable);

/* Prints which cannot be used, why, and how to make them. */
void wb_simulation_print_missing(FILE *out, wb_simulation_list *list, const void *results);

/* Prints all that are wanted with their state and the inputs that they must have, as a document. */
void wb_simulation_print_json(FILE *out, wb_simulation_list *list, const void *results);

#endif
