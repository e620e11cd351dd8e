#include "analysis/harness/harness_follow.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/harness/harness_output.h"
#include "analysis/keys/row.h"
#include "base/config.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "harness"

#define ITEM(member) WB_AT(struct wb_harness_item, member)
#define BRANCH(member) WB_AT(struct wb_harness_plan_branch, member)

/* How much of the shape an answer has. */
enum shapes {
    NO_SHAPES,
    POSITIONS,
    ALL_COLUMNS
};

static const char *const shape_words[] = {"false", "true", "all", NULL};

/* A line while it is answered. */
struct line {
    struct wb_harness_session *session;
    const struct wb_config_node *map; /* the line's top node */
    bool (*watch)(void *context, double fraction);
    void *context;
    struct wb_reason why;
    int shapes;
    bool describes, quits;
};

/* --- keys of the answers --- */

static const struct wb_key place_rows[] = {
    {"name", TEXT, "root, connector or clip"},
    {"mounted", FLAG, "it is held"},
    {"at_mm", NUMBER | LIST, "where the wire is there"},
    {"direction", NUMBER | LIST, "direction of the wire there"},
    {"up", NUMBER | LIST, "direction upwards of its section"},
};
static WB_KEYS(place, "harness_item_place", "Where an item is.");

static const struct wb_key shape_rows[] = {
    {"branch", TEXT, "branch"},
    {"s_mm", NUMBER | LIST, "places along the branch"},
    {"x_mm", NUMBER | LIST, "their positions"},
    {"y_mm", NUMBER | LIST, "their positions"},
    {"z_mm", NUMBER | LIST, "their positions"},
    {"direction_x", NUMBER | LIST | OPTIONAL, "direction of the wire"},
    {"direction_y", NUMBER | LIST | OPTIONAL, "direction of the wire"},
    {"direction_z", NUMBER | LIST | OPTIONAL, "direction of the wire"},
    {"curvature_1_m", NUMBER | LIST | OPTIONAL, "curvature"},
    {"twist_1_m", NUMBER | LIST | OPTIONAL, "twist"},
    {"moment_N_mm", NUMBER | LIST | OPTIONAL, "bending moment"},
    {"torque_N_mm", NUMBER | LIST | OPTIONAL, "torque"},
    {"tension_N", NUMBER | LIST | OPTIONAL, "axial force"},
};
static WB_KEYS(shape, "harness_shape", "Places along a branch.");

static const struct wb_key state_rows[] = {
    {"state", INTEGER, "number of steps from the stress-free harness on"},
    {NULL, OBJECT, NULL, &wb_harness_output_step_keys},
    {"items", OBJECT | LIST, "root, connectors and clips", &place_keys},
    {"shapes", OBJECT | LIST | OPTIONAL, "shapes of the branches", &shape_keys},
};
static WB_KEYS(state, "harness_state", "A state, the answer to a step.");

static const struct wb_key item_rows[] = {
    {"name", ITEM(name), "root, connector or clip"},
    {"kind", WB_CHOICE(struct wb_harness_item, kind), "what it is",
     .choices = "root|connector|clip"},
    {"branch", TEXT | OPTIONAL, "branch on which it is"},
    {"at_mm", ITEM(at), "place along the branch"},
    {"holds", WB_CHOICE(struct wb_harness_item, hold), "what it holds where it is mounted",
     .choices = "nothing|plane|point|axis|all|slide"},
    {"most_force_N", ITEM(largest_force), "limit of the force; 0: none"},
    {"most_moment_N_mm", ITEM(largest_moment), "limit of the moment; 0: none"},
};
static WB_KEYS(item, "harness_item", "An item of a harness.");

static const struct wb_key branch_rows[] = {
    {"name", BRANCH(name), "branch"},
    {"from", BRANCH(from), "node at which it begins"},
    {"to", BRANCH(to), "node at which it ends"},
    {"wire", TEXT, "its wire"},
    {"outer_diameter_mm", NUMBER, "outer diameter of the wire"},
    {"length_mm", BRANCH(length), "length"},
    {"least_radius_mm", BRANCH(least_radius), "limit of the bend radius; 0: none"},
};
static WB_KEYS(branch, "harness_plan_branch", "A branch of a harness.");

static const struct wb_key step_rows[] = {
    {"name", TEXT, "step"},
};
static WB_KEYS(step, "harness_plan_step", "A step of the harness file.");

static const struct wb_key description_rows[] = {
    {"state", INTEGER, "number of the current state"},
    {"harness", TEXT, "name of the harness"},
    {"branches", OBJECT | LIST, "branches", &branch_keys},
    {"items", OBJECT | LIST, "root, connectors and clips", &item_keys},
    {"steps", OBJECT | LIST, "steps of the harness file", &step_keys},
};
static WB_KEYS(description, "harness_description", "The answer to `describe`.");

static const struct wb_key error_rows[] = {
    {"error", TEXT, "what is wrong in the line, and what was expected"},
    {"state", INTEGER, "number of the current state"},
};
static WB_KEYS(error, "harness_error", "The answer to a line that is wrong.");

static const struct wb_key quit_rows[] = {
    {"quit", FLAG, "the session has ended"},
};
static WB_KEYS(quit, "harness_quit", "The answer to `quit`.");

static const struct wb_keys *const answers[] = {&state_keys, &description_keys, &error_keys,
                                                &quit_keys, NULL};
const struct wb_keys wb_harness_follow_keys = {
    "harness-answer", "A line that `wirebench solve harness --follow` prints.",
    .alternatives = answers};

/* --- answers --- */

static void put_vector(struct wb_json *object, const char *key, const double vector[3], double unit)
{
    struct wb_json *const list = wb_json_set_array(object, key);
    for (int k = 0; k < 3; k++)
        wb_json_append_number(list, vector[k] / unit);
}

static void put_items(struct wb_json *object, const struct wb_harness_session *session)
{
    const struct wb_harness_plan *const plan = wb_harness_session_plan(session);
    struct wb_json *const list = wb_json_set_array(object, "items");
    for (int i = 0; i < plan->n_items; i++) {
        struct wb_json *const item = wb_json_append_object(list);
        const struct wb_rod_node node = wb_harness_session_item(session, i);
        double R[9];
        wb_rod_element_matrix(node.rotation, R);
        wb_json_set_text(item, "name", plan->items[i].name);
        wb_json_set_boolean(item, "mounted",
                            wb_harness_session_state(session)->assembly.is_mounted[i]);
        put_vector(item, "at_mm", node.position, WB_MM);
        put_vector(item, "direction", (const double[]){R[0], R[3], R[6]}, 1.0);
        put_vector(item, "up", (const double[]){R[2], R[5], R[8]}, 1.0);
    }
}

static void put_shapes(struct wb_json *object, const struct wb_harness_session *session, bool all)
{
    const struct wb_harness_plan *const plan = wb_harness_session_plan(session);
    const struct wb_harness_place *const places = wb_harness_session_state(session)->result.places;
    const int n = wb_harness_session_n_places(session);
    struct wb_json *const list = wb_json_set_array(object, "shapes");
    for (int first = 0, next; first < n; first = next) {
        struct wb_json *const shape = wb_json_append_object(list);
        for (next = first; next < n && places[next].branch == places[first].branch; next++)
            continue;
        wb_json_set_text(shape, "branch", plan->branches[places[first].branch].name);
        for (int c = 0; c < (all ? WB_HARNESS_OUTPUT_COLUMNS : WB_HARNESS_OUTPUT_POSITION); c++) {
            const struct wb_harness_output_column *const column = &wb_harness_output_columns[c];
            struct wb_json *const values = wb_json_set_array(shape, column->key);
            for (int i = first; i < next; i++)
                wb_json_append_number(values, wb_harness_output_value(&places[i], column) /
                                                  (column->shift == 3 ? WB_MM : 1.0));
        }
    }
}

static void put_state(struct wb_json *object, const struct line *line)
{
    const struct wb_harness_session_state *const state = wb_harness_session_state(line->session);
    wb_harness_output_put_step(object, wb_harness_session_plan(line->session), state->name,
                               &state->result);
    put_items(object, line->session);
    if (line->shapes != NO_SHAPES)
        put_shapes(object, line->session, line->shapes == ALL_COLUMNS);
}

static void put_description(struct wb_json *object, const struct wb_harness_plan *plan)
{
    wb_json_set_text(object, "harness", plan->name);
    struct wb_json *const branches = wb_json_set_array(object, "branches");
    for (int i = 0; i < plan->n_branches; i++) {
        const struct wb_harness_plan_branch *const branch = &plan->branches[i];
        struct wb_json *const own = wb_json_append_object(branches);
        WB_PUT(own, &branch_keys, struct wb_harness_plan_branch, branch);
        wb_json_set_text(own, "wire", plan->wires[branch->wire].name);
        wb_json_set_number(own, "outer_diameter_mm", plan->wires[branch->wire].diameter / WB_MM);
        WB_PUT(own, &branch_keys, struct wb_harness_plan_branch, branch);
    }
    struct wb_json *const items = wb_json_set_array(object, "items");
    for (int i = 0; i < plan->n_items; i++) {
        const struct wb_harness_item *const item = &plan->items[i];
        struct wb_json *const own = wb_json_append_object(items);
        WB_PUT(own, &item_keys, struct wb_harness_item, item);
        if (item->branch >= 0)
            wb_json_set_text(own, "branch", plan->branches[item->branch].name);
        WB_PUT(own, &item_keys, struct wb_harness_item, item);
    }
    struct wb_json *const steps = wb_json_set_array(object, "steps");
    for (int i = 0; i < plan->n_steps; i++)
        wb_json_set_text(wb_json_append_object(steps), "name", plan->steps[i].name);
}

/* --- lines --- */

static enum wb_status run_step(struct line *line, const struct wb_harness_step *step)
{
    struct wb_reason why = {""};
    const char *key = NULL;
    const enum wb_status status =
        wb_harness_session_step(line->session, step, line->watch, line->context, &key, &why);
    return status == WB_OK ? WB_OK
                           : wb_fail_to(&line->why, status, "%s%s%s", key ? key : "",
                                        key ? ": " : "", why.text);
}

/* mount, move, release */
static enum wb_status act(struct line *line, const char *key, const struct wb_config_node *value)
{
    struct wb_harness_step step;
    (void)key, (void)value;
    WB_TRY(wb_harness_file_parse_step(wb_harness_session_plan(line->session), line->map, "shapes",
                                      &step));
    return run_step(line, &step);
}

static enum wb_status check_true(struct line *line, const char *key,
                                 const struct wb_config_node *value)
{
    bool is_true = false;
    const struct wb_config_key row = WB_CONFIG_OPTIONAL_BOOLEAN(key, &is_true);
    WB_TRY(wb_config_value(value, &row));
    return is_true ? WB_OK : wb_config_refuse(line->map, key, "expected true");
}

/* hang, take_off */
static enum wb_status act_as_a_whole(struct line *line, const char *key,
                                     const struct wb_config_node *value)
{
    struct wb_harness_step step = {.kind = strcmp(key, "hang") == 0 ? WB_HARNESS_HANG
                                                                    : WB_HARNESS_TAKE_OFF};
    WB_TRY(check_true(line, key, value));
    snprintf(step.name, sizeof step.name, "%s", key);
    return run_step(line, &step);
}

static enum wb_status take_steps(struct line *line, const char *key,
                                 const struct wb_config_node *value)
{
    const struct wb_harness_plan *const plan = wb_harness_session_plan(line->session);
    const char *const word = wb_config_scalar(value);
    int n = plan->n_steps;
    const struct wb_config_key row = WB_CONFIG_INTEGER(key, &n, 1, plan->n_steps);
    if (!word || strcmp(word, "all") != 0)
        WB_TRY(wb_config_value(value, &row));
    for (int i = 0; i < n; i++) {
        const enum wb_status status = run_step(line, &plan->steps[i]);
        if (status != WB_OK)
            return wb_fail_to(&line->why, status, "%s: step %d, %s: %s", key, i + 1,
                              plan->steps[i].name, line->why.text);
        if (wb_harness_session_state(line->session)->result.end != WB_HARNESS_CONVERGED)
            break;
    }
    return WB_OK;
}

static enum wb_status undo(struct line *line, const char *key, const struct wb_config_node *value)
{
    int n = 0;
    struct wb_reason why = {""};
    const struct wb_config_key row = WB_CONFIG_INTEGER(key, &n, 1, WB_HARNESS_SESSION_UNDO);
    WB_TRY(wb_config_value(value, &row));
    const enum wb_status status = wb_harness_session_undo(line->session, n, &why);
    return status == WB_OK ? WB_OK : wb_fail_to(&line->why, status, "%s: %s", key, why.text);
}

/* snapshot, restore */
static enum wb_status use_snapshot(struct line *line, const char *key,
                                   const struct wb_config_node *value)
{
    char name[WB_HARNESS_NAME];
    struct wb_reason why = {""};
    const struct wb_config_key row = WB_CONFIG_TEXT(key, name);
    WB_TRY(wb_config_value(value, &row));
    const enum wb_status status = strcmp(key, "restore") == 0
                                      ? wb_harness_session_restore(line->session, name, &why)
                                      : wb_harness_session_snapshot(line->session, name, &why);
    return status == WB_OK ? WB_OK : wb_fail_to(&line->why, status, "%s: %s", key, why.text);
}

static enum wb_status describe(struct line *line, const char *key,
                               const struct wb_config_node *value)
{
    line->describes = true;
    return check_true(line, key, value);
}

static enum wb_status quit(struct line *line, const char *key, const struct wb_config_node *value)
{
    WB_TRY(check_true(line, key, value));
    line->quits = true;
    return WB_OK;
}

static const struct command {
    const char *key;
    bool is_step; /* whose reader checks its keys */
    enum wb_status (*run)(struct line *line, const char *key, const struct wb_config_node *value);
} commands[] = {
    {"mount", true, act},
    {"move", true, act},
    {"release", true, act},
    {"hang", false, act_as_a_whole},
    {"take_off", false, act_as_a_whole},
    {"steps", false, take_steps},
    {"undo", false, undo},
    {"snapshot", false, use_snapshot},
    {"restore", false, use_snapshot},
    {"state", false, check_true},
    {"describe", false, describe},
    {"quit", false, quit},
};

static const char known_keys[] =
    "one of the keys mount, move, release, hang, take_off, steps, undo, "
    "snapshot, restore, state, describe and quit";

/* "hang" or "take_off" as a text. */
static enum wb_status run_word(struct line *line, const char *word)
{
    struct wb_harness_step step;
    if (strcmp(word, "hang") != 0 && strcmp(word, "take_off") != 0)
        return wb_config_refuse(line->map, NULL, "'%.60s': expected an object with %s", word,
                                known_keys);
    WB_TRY(
        wb_harness_file_parse_step(wb_harness_session_plan(line->session), line->map, NULL, &step));
    return run_step(line, &step);
}

static enum wb_status run_line(const struct wb_config_node *map, void *into)
{
    struct line *const line = into;
    const struct command *command = NULL;
    const struct wb_config_node *value = NULL;
    line->map = map;
    if (wb_config_scalar(map))
        return run_word(line, wb_config_scalar(map));
    for (size_t i = 0; i < WB_COUNT(commands) && !value; i++) {
        command = &commands[i];
        value = wb_config_find(map, command->key);
    }
    if (!value)
        return wb_config_refuse(map, NULL, "expected an object with %s", known_keys);
    const struct wb_config_node *const shapes = wb_config_find(map, "shapes");
    const struct wb_config_key row =
        WB_CONFIG_OPTIONAL_CHOICE("shapes", &line->shapes, shape_words);
    const struct wb_config_key keys[] = {WB_CONFIG_IGNORED(command->key),
                                         WB_CONFIG_IGNORED("shapes")};
    if (shapes)
        WB_TRY(wb_config_value(shapes, &row));
    if (!command->is_step)
        WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    return command->run(line, command->key, value);
}

/* Without the place that the reader of files puts before a message. */
static const char *message_of(const struct wb_reason *why, const char *origin)
{
    const size_t n = strlen(origin);
    const char *const end = strncmp(why->text, origin, n) == 0 ? strstr(why->text, ": ") : NULL;
    return end ? end + 2 : why->text;
}

bool wb_harness_follow_answer(struct wb_harness_session *session, const char *text,
                              bool (*watch)(void *context, double fraction), void *context,
                              struct wb_text *answer)
{
    static const char origin[] = "line";
    struct line line = {
        .session = session, .watch = watch, .context = context, .shapes = POSITIONS};
    struct wb_json *const object = wb_json_create();
    const bool is_blank = text[strspn(text, " \t\r\n")] == '\0';
    const enum wb_status status =
        is_blank ? wb_fail_to(&line.why, WB_ERR_FORMAT, "the line is empty: expected an object")
                 : wb_config_load(text, origin, &line.why, run_line, &line);
    const bool is_good = status == WB_OK;
    if (!is_good)
        wb_json_set_text(object, "error", message_of(&line.why, origin));
    if (line.quits)
        wb_json_set_boolean(object, "quit", true);
    else
        wb_json_set_integer(object, "state", wb_harness_session_state(session)->number);
    if (is_good && line.describes)
        put_description(object, wb_harness_session_plan(session));
    else if (is_good && !line.quits)
        put_state(object, &line);
    char *const formatted = wb_json_format_line(object);
    wb_text_append(answer, "%s", formatted);
    free(formatted);
    wb_json_destroy(object);
    return !line.quits;
}
