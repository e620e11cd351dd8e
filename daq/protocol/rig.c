#include "daq/protocol/rig.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/file.h"
#include "base/text.h"
#include "base/units.h"
#include "daq/protocol/cell_calibration.h"
#include "daq/protocol/cells.h"
#include "daq/protocol/loadcell_preset.h"

#define WB_LOG_DOMAIN "rig"

#define NOISE_TIMES 5.0
#define NOISE_SHARE 0.01

static const char *const load_protocols[] = {"generic", "mt-sics", NULL};
static const char *const mocap_protocols[] = {"natnet", NULL};
static const char *const stage_protocols[] = {"grbl", "tic", NULL};
static const char *const terminators[] = {"any", "cr", "lf", "crlf", "idle", NULL};
static const char *const tares[] = {"unloaded", "counterweight", NULL};
static const char *const ups[] = {"y", "z", NULL};
static const char *const axes[] = {"X", "Y", "Z", NULL};

#define WIRE_SCHEMES "serial: or pty:"
#define NETWORK_SCHEMES "udp:"
#define TEST_SCHEMES "memory: sim:" /* for tests and virtual time: not offered to users */

/* Rejects an address whose scheme the role cannot use; the stream checks the rest. */
static enum wb_status check_address(const struct wb_config_node *map, const char *address,
                                    const char *schemes)
{
    const char *const colon = strchr(address, ':');
    char scheme[16] = "";
    if (colon)
        snprintf(scheme, sizeof scheme, "%.*s", (int)(colon + 1 - address), address);
    if (wb_cells_lists(schemes, scheme) || wb_cells_lists(TEST_SCHEMES, scheme))
        return WB_OK;
    return wb_config_refuse(map, "address", "expected an address that starts with %s, not '%s'",
                            schemes, address);
}

static enum wb_status check_sign(const struct wb_config_node *map, const char *key, int sign)
{
    if (sign != 1 && sign != -1)
        return wb_config_refuse(map, key, "expected +1 or -1, not %d", sign);
    return WB_OK;
}

/* Resolves \r, \n, \t, \\ and \xNN in place. YAML does this only between double quotes. */
static enum wb_status resolve_escapes(const struct wb_config_node *map, const char *key, char *text)
{
    static const char letters[] = "rnt\\", bytes[] = "\r\n\t\\";
    char *out = text;
    for (const char *in = text; *in; in++) {
        if (*in != '\\') {
            *out++ = *in;
            continue;
        }
        in++;
        const char *const letter = *in ? strchr(letters, *in) : NULL;
        long code = letter ? bytes[letter - letters] : 0;
        if (*in == 'x' && isxdigit((unsigned char)in[1]) && isxdigit((unsigned char)in[2])) {
            code = strtol((const char[]){in[1], in[2], '\0'}, NULL, 16);
            in += 2;
        }
        if (code == 0)
            return wb_config_refuse(map, key,
                                    "expected one of \\r \\n \\t \\\\ \\xNN after a backslash");
        *out++ = (char)code;
    }
    *out = '\0';
    return WB_OK;
}

/* Reads a list of short words without changes. */
static enum wb_status read_tokens(const struct wb_config_node *list, const char *key,
                                  char tokens[WB_RIG_TOKENS][16])
{
    if (!list)
        return WB_OK;
    const int n = wb_config_length(list);
    if (n < 0)
        return wb_config_refuse(list, key, "expected a list of words, such as [OL, EC]");
    if (n > WB_RIG_TOKENS)
        return wb_config_refuse(list, key, "%d words given, expected at most %d", n, WB_RIG_TOKENS);
    for (int i = 0; i < n; i++) {
        const char *const word = wb_config_scalar(wb_config_item(list, i));
        if (!word || word[0] == '\0' || strlen(word) >= sizeof tokens[0] || strpbrk(word, " \t"))
            return wb_config_refuse(wb_config_item(list, i), key,
                                    "expected a word of 1 to %zu characters without blanks",
                                    sizeof tokens[0] - 1);
        strcpy(tokens[i], word);
    }
    return WB_OK;
}

/* Keys of the generic line protocol, in the form of the file. */
struct line_keys {
    char delimiter[8];
    int terminator;
    double poll_period, idle_gap, settle; /* s */
    const struct wb_config_node *unstable, *overload;
};

/* Finds the preset that the file names (NULL: none) and writes its settings to `cell`; the file's
 * own keys, which are read later, replace them. */
static enum wb_status read_preset(const struct wb_config_node *map,
                                  const struct wb_loadcell_preset **preset,
                                  struct wb_rig_load_cell *cell)
{
    const struct wb_config_node *const node = wb_config_find(map, "preset");
    const char *const name = node ? wb_config_scalar(node) : NULL;
    *preset = name ? wb_loadcell_preset_find(name) : NULL;
    if (*preset)
        wb_loadcell_preset_apply(*preset, cell);
    if (*preset || !node)
        return WB_OK;
    struct wb_text known = {0};
    for (size_t i = 0; wb_loadcell_preset_at(i); i++)
        wb_text_append(&known, "%s%s", i ? ", " : "", wb_loadcell_preset_at(i)->name);
    const enum wb_status status =
        wb_config_refuse(map, "preset",
                         "expected one of %s, not '%s'; for another instrument, replace the preset "
                         "by its line settings",
                         wb_text_string(&known), name ? name : "");
    wb_text_release(&known);
    return status;
}

/* Initialises the keys from the preset's settings, the defaults of keys that the file does not
 * give. */
static void begin_line_keys(const struct wb_rig_load_cell *cell, struct line_keys *keys)
{
    keys->delimiter[0] = cell->delimiter;
    for (int i = 0; terminators[i]; i++)
        if (strcmp(terminators[i], cell->terminator) == 0)
            keys->terminator = i;
    keys->poll_period = wb_seconds_from_ns(cell->poll_period_ns);
    keys->settle = wb_seconds_from_ns(cell->settle_ns);
    keys->idle_gap = 0.02;
}

static enum wb_status read_delimiter(const struct wb_config_node *map, const char *text,
                                     char *delimiter)
{
    if (strcmp(text, "tab") == 0)
        *delimiter = '\t';
    else if (strlen(text) == 1 && !isalnum((unsigned char)text[0]) && !strchr("+-.", text[0]))
        *delimiter = text[0];
    else if (text[0] != '\0')
        return wb_config_refuse(
            map, "delimiter", "expected one character such as ',' or ';', or tab, not '%s'", text);
    return WB_OK;
}

/* Checks keys that require or exclude each other. */
static enum wb_status check_line_keys(const struct wb_config_node *map,
                                      const struct wb_rig_load_cell *cell)
{
    static const char *const generic_only[] = {
        "preset",          "delimiter",     "column",       "unit",
        "scale",           "offset",        "terminator",   "poll_command",
        "start_command",   "stop_command",  "tare_command", "unstable_tokens",
        "overload_tokens", "decimal_comma", "settle_ms",    NULL,
    };
    if (strcmp(cell->protocol, "generic") != 0)
        return wb_config_refuse_keys(map, generic_only,
                                     "only the generic line protocol has this key: remove it or "
                                     "write protocol: generic");
    if ((cell->column > 0) != (cell->delimiter != 0))
        return wb_config_refuse(
            map, cell->column > 0 ? "column" : "delimiter",
            "delimiter and column belong together, and the other one is missing");
    if (cell->decimal_comma && cell->delimiter == ',')
        return wb_config_refuse(map, "decimal_comma",
                                "a comma cannot be both the delimiter and the decimal sign");
    if ((cell->poll_command[0] != '\0') != (cell->poll_period_ns > 0))
        return wb_config_refuse(map, cell->poll_command[0] ? "poll_period_ms" : "poll_command",
                                "poll_command and poll_period_ms belong together, and this one is "
                                "missing");
    if (cell->scale == 0.0)
        return wb_config_refuse(map, "scale", "expected a number other than 0");
    double newtons;
    if (cell->unit[0] && !wb_line_unit_factor(cell->unit, WB_STANDARD_GRAVITY, &newtons))
        return wb_config_refuse(map, "unit", "expected a unit such as g, kg, mN, N or lb, not '%s'",
                                cell->unit);
    return WB_OK;
}

/* Streaming and polling exclude each other: the file's choice has precedence over the preset's. */
static void choose_commands(const struct wb_config_node *map,
                            const struct wb_loadcell_preset *preset, struct line_keys *keys,
                            struct wb_rig_load_cell *cell)
{
    const bool has_poll_period = wb_config_find(map, "poll_period_ms");
    const bool has_start = wb_config_find(map, "start_command");
    if (has_poll_period && !cell->poll_command[0] && !has_start)
        wb_loadcell_preset_ask(preset, cell);
    if (has_start && !has_poll_period) {
        cell->poll_command[0] = '\0';
        keys->poll_period = 0.0;
    }
}

/* Checks that the file gives what the preset requires, and completes the address. */
static enum wb_status finish_preset(const struct wb_config_node *map,
                                    const struct wb_loadcell_preset *preset,
                                    struct wb_rig_load_cell *cell)
{
    if (preset->unit_rule == WB_UNIT_OF_RIG_FILE && cell->unit[0] == '\0')
        return wb_config_refuse(map, "unit",
                                "an instrument of the preset %s prints no unit: give the one that "
                                "it is calibrated in, such as unit: g",
                                preset->name);
    if (!preset->line && strncmp(cell->address, "serial:", 7) == 0 && !strchr(cell->address, ','))
        return wb_config_refuse(map, "address",
                                "the preset %s has no default baud rate: give the instrument's "
                                "own, such as %s,115200,8n1",
                                preset->name, cell->address);
    if (!wb_loadcell_preset_complete_address(preset, cell->address, sizeof cell->address))
        return wb_config_refuse(map, "address", "expected an address of %d characters at most",
                                WB_RIG_TEXT - 20);
    return WB_OK;
}

static enum wb_status finish_line_keys(const struct wb_config_node *map, struct line_keys *keys,
                                       struct wb_rig_load_cell *cell)
{
    strcpy(cell->terminator, terminators[keys->terminator]);
    cell->poll_period_ns = wb_ns_from_seconds(keys->poll_period);
    cell->idle_gap_ns = wb_ns_from_seconds(keys->idle_gap);
    cell->settle_ns = wb_ns_from_seconds(keys->settle);
    WB_TRY(read_delimiter(map, keys->delimiter, &cell->delimiter));
    WB_TRY(resolve_escapes(map, "poll_command", cell->poll_command));
    WB_TRY(resolve_escapes(map, "start_command", cell->start_command));
    WB_TRY(resolve_escapes(map, "stop_command", cell->stop_command));
    WB_TRY(resolve_escapes(map, "tare_command", cell->tare_command));
    WB_TRY(read_tokens(keys->unstable, "unstable_tokens", cell->unstable_tokens));
    WB_TRY(read_tokens(keys->overload, "overload_tokens", cell->overload_tokens));
    return check_line_keys(map, cell);
}

/* Reads the masses of a calibration series. */
static enum wb_status read_check_masses(const struct wb_config_node *list,
                                        struct wb_rig_load_cell *cell)
{
    const struct wb_config_key mass = WB_CONFIG_NUMBER("check_masses_g", NULL, WB_G, 0.0, 1e6);
    char problem[160];
    if (!list)
        return WB_OK;
    WB_TRY(wb_config_numbers(list, &mass, 3, WB_RIG_MASSES, cell->check_masses,
                             &cell->n_check_masses));
    if (!wb_cell_calibration_check(cell->check_masses, cell->n_check_masses, problem,
                                   sizeof problem))
        return wb_config_refuse(list, "check_masses_g", "%s", problem);
    return WB_OK;
}

static enum wb_status read_load_cell(const struct wb_config_node *map, double gravity,
                                     struct wb_rig_load_cell *cell)
{
    int protocol = 0;
    double capacity_mass = 0.0, overload_fraction = 1.0, noise_mass = 0.0;
    const struct wb_loadcell_preset *preset;
    const struct wb_config_node *masses;
    struct line_keys keys = {0};
    cell->scale = 1.0;
    cell->sign = 1;
    WB_TRY(read_preset(map, &preset, cell));
    begin_line_keys(cell, &keys);
    cell->check_tolerance = 0.01;
    const struct wb_config_key table[] = {
        WB_CONFIG_TEXT("address", cell->address),
        WB_CONFIG_CHOICE("protocol", &protocol, load_protocols),
        WB_CONFIG_OPTIONAL_NUMBER("capacity_g", &capacity_mass, WB_G, 0.1, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("capacity_N", &cell->capacity, 1.0, 1e-3, 1e4),
        WB_CONFIG_OPTIONAL_NUMBER("overload_percent", &overload_fraction, WB_PERCENT, 100.0,
                                  1000.0),
        WB_CONFIG_OPTIONAL_TEXT("serial_number", cell->serial_number),
        WB_CONFIG_OPTIONAL_TEXT("calibration_date", cell->calibration_date),
        WB_CONFIG_NUMBER("filter_delay_ms", &cell->filter_delay, 1e-3, 0.0, 5000.0),
        WB_CONFIG_NUMBER("filter_delay_uncertainty_ms", &cell->filter_delay_uncertainty, 1e-3, 0.0,
                         5000.0),
        WB_CONFIG_OPTIONAL_NUMBER("u_gain_percent", &cell->gain_uncertainty, WB_PERCENT, 1e-4,
                                  50.0),
        WB_CONFIG_OPTIONAL_NUMBER("noise_mg", &noise_mass, WB_MG, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("check_mass_g", &cell->check_mass, WB_G, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("check_tolerance_percent", &cell->check_tolerance, WB_PERCENT,
                                  0.001, 50.0),
        WB_CONFIG_OPTIONAL_NODE("check_masses_g", &masses),
        WB_CONFIG_OPTIONAL_NUMBER("check_due_days", &cell->check_due, WB_DAY, 0.01, 3660.0),
        WB_CONFIG_OPTIONAL_CHOICE("tare", &cell->tare, tares),
        WB_CONFIG_OPTIONAL_INTEGER("sign", &cell->sign, -1000, 1000),
        WB_CONFIG_OPTIONAL_NUMBER("poll_period_ms", &keys.poll_period, 1e-3, 1.0, 10000.0),
        WB_CONFIG_IGNORED("preset"),
        WB_CONFIG_OPTIONAL_TEXT("delimiter", keys.delimiter),
        WB_CONFIG_OPTIONAL_INTEGER("column", &cell->column, 1, 64),
        WB_CONFIG_OPTIONAL_TEXT("unit", cell->unit),
        WB_CONFIG_OPTIONAL_NUMBER("scale", &cell->scale, 1.0, -1e12, 1e12),
        WB_CONFIG_OPTIONAL_NUMBER("offset", &cell->offset, 1.0, -1e12, 1e12),
        WB_CONFIG_OPTIONAL_CHOICE("terminator", &keys.terminator, terminators),
        WB_CONFIG_OPTIONAL_NUMBER("idle_gap_ms", &keys.idle_gap, 1e-3, 1.0, 10000.0),
        WB_CONFIG_OPTIONAL_TEXT("poll_command", cell->poll_command),
        WB_CONFIG_OPTIONAL_TEXT("start_command", cell->start_command),
        WB_CONFIG_OPTIONAL_TEXT("stop_command", cell->stop_command),
        WB_CONFIG_OPTIONAL_TEXT("tare_command", cell->tare_command),
        WB_CONFIG_OPTIONAL_NODE("unstable_tokens", &keys.unstable),
        WB_CONFIG_OPTIONAL_NODE("overload_tokens", &keys.overload),
        WB_CONFIG_OPTIONAL_BOOLEAN("decimal_comma", &cell->decimal_comma),
        WB_CONFIG_OPTIONAL_NUMBER("settle_ms", &keys.settle, 1e-3, 0.0, 60000.0),
    };
    WB_TRY(wb_config_map(map, table, WB_COUNT(table)));
    const bool has_grams = capacity_mass > 0.0;
    if (has_grams == (cell->capacity > 0.0))
        return wb_config_refuse(map, has_grams ? "capacity_N" : "capacity_g",
                                "expected exactly one of capacity_g and capacity_N");
    if (has_grams)
        cell->capacity = capacity_mass * gravity;
    cell->overload = cell->capacity * overload_fraction;
    cell->noise = noise_mass * gravity;
    strcpy(cell->protocol, load_protocols[protocol]);
    WB_TRY(check_address(map, cell->address, WIRE_SCHEMES));
    WB_TRY(wb_config_check_date(map, "calibration_date", cell->calibration_date));
    WB_TRY(read_check_masses(masses, cell));
    WB_TRY(check_sign(map, "sign", cell->sign));
    if (preset && strcmp(cell->protocol, "generic") == 0)
        choose_commands(map, preset, &keys, cell);
    WB_TRY(finish_line_keys(map, &keys, cell));
    return preset ? finish_preset(map, preset, cell) : WB_OK;
}

static enum wb_status read_mocap(const struct wb_config_node *map, struct wb_rig_mocap *mocap)
{
    int protocol = 0, up = 0;
    const struct wb_config_key table[] = {
        WB_CONFIG_TEXT("address", mocap->address),
        WB_CONFIG_CHOICE("protocol", &protocol, mocap_protocols),
        WB_CONFIG_CHOICE("up", &up, ups),
        WB_CONFIG_OPTIONAL_NUMBER("marker_noise_mm", &mocap->marker_noise, WB_MM, 0.0, 100.0),
        WB_CONFIG_OPTIONAL_NUMBER("frame_rate_hz", &mocap->frame_rate, 1.0, 1.0, 10000.0),
        WB_CONFIG_OPTIONAL_BOOLEAN("record_take", &mocap->record_take),
    };
    WB_TRY(wb_config_map(map, table, WB_COUNT(table)));
    strcpy(mocap->protocol, mocap_protocols[protocol]);
    mocap->up = ups[up][0];
    return check_address(map, mocap->address, NETWORK_SCHEMES);
}

static enum wb_status read_stage(const struct wb_config_node *map, struct wb_rig_stage *stage)
{
    int protocol = 0, axis = 0;
    const struct wb_config_key table[] = {
        WB_CONFIG_TEXT("address", stage->address),
        WB_CONFIG_CHOICE("protocol", &protocol, stage_protocols),
        WB_CONFIG_OPTIONAL_CHOICE("axis", &axis, axes),
        WB_CONFIG_INTEGER("down", &stage->down, -1000, 1000),
        WB_CONFIG_NUMBER("travel_mm", &stage->travel, WB_MM, 0.1, 5000.0),
        WB_CONFIG_NUMBER("speed_mm_s", &stage->speed, WB_MM, 0.001, 1000.0),
        WB_CONFIG_OPTIONAL_NUMBER("steps_per_mm", &stage->steps, 1.0 / WB_MM, 0.1, 1e6),
    };
    WB_TRY(wb_config_map(map, table, WB_COUNT(table)));
    strcpy(stage->protocol, stage_protocols[protocol]);
    stage->axis = axes[axis][0];
    const bool is_tic = strcmp(stage->protocol, "tic") == 0;
    if ((wb_config_find(map, "axis") != NULL) == is_tic)
        return wb_config_refuse(map, "axis",
                                is_tic ? "a Tic has one axis: remove this key"
                                       : "this key is missing: expected X, Y or Z");
    if (is_tic && !(stage->steps > 0.0))
        return wb_config_refuse(map, "steps_per_mm",
                                "this key is missing: a Tic counts microsteps, and only you know "
                                "how many make a millimetre");
    WB_TRY(check_sign(map, "down", stage->down));
    return check_address(map, stage->address, WIRE_SCHEMES);
}

static enum wb_status read_strand(const struct wb_config_node *map, struct wb_rig_strand *strand)
{
    if (!map)
        return WB_OK;
    const struct wb_config_key table[] = {
        WB_CONFIG_NUMBER("length_mm", &strand->length, WB_MM, 1.0, 100000.0),
        WB_CONFIG_NUMBER("counterweight_g", &strand->counterweight, WB_G, 0.0, 100000.0),
        WB_CONFIG_OPTIONAL_NUMBER("u_counterweight_g", &strand->counterweight_uncertainty, WB_G,
                                  1e-6, 1000.0),
    };
    return wb_config_map(map, table, WB_COUNT(table));
}

static enum wb_status read_limits(const struct wb_config_node *map, struct wb_rig *rig)
{
    struct wb_rig_limits *const limits = &rig->limits;
    limits->stream_lost = 1.0;
    limits->force_drop = 0.1;
    if (!map)
        return WB_OK;
    const struct wb_config_key table[] = {
        WB_CONFIG_OPTIONAL_NUMBER("force_mN", &limits->force, WB_MN, 0.001, 1e7),
        WB_CONFIG_OPTIONAL_NUMBER("travel_mm", &limits->travel, WB_MM, 0.1, 5000.0),
        WB_CONFIG_OPTIONAL_NUMBER("stream_lost_s", &limits->stream_lost, 1.0, 0.05, 60.0),
        WB_CONFIG_OPTIONAL_NUMBER("force_drop_percent", &limits->force_drop, WB_PERCENT, 0.0,
                                  100.0),
    };
    WB_TRY(wb_config_map(map, table, WB_COUNT(table)));
    /* A limit beyond the instrument's range would never trigger. */
    if (limits->force > rig->load_cell.overload * (1.0 + 1e-9))
        return wb_config_refuse(map, "force_mN",
                                "%g mN is more than the load cell reads (capacity times "
                                "overload_percent is %g mN)",
                                limits->force / WB_MN, rig->load_cell.overload / WB_MN);
    if (limits->travel > rig->stage.travel * (1.0 + 1e-9))
        return wb_config_refuse(map, "travel_mm", "%g mm is more than the stage's travel of %g mm",
                                limits->travel / WB_MM, rig->stage.travel / WB_MM);
    return WB_OK;
}

static enum wb_status read_root(const struct wb_config_node *root, void *into)
{
    struct wb_rig read = {.name = ""}, *const rig = &read;
    const struct wb_config_node *load_cell, *mocap, *stage, *strand, *limits;
    rig->gravity = WB_STANDARD_GRAVITY;
    rig->time_scale = 1.0;
    const struct wb_config_key table[] = {
        WB_CONFIG_TEXT("name", rig->name),
        WB_CONFIG_OPTIONAL_NUMBER("gravity_m_s2", &rig->gravity, 1.0, 9.7, 9.9),
        WB_CONFIG_NODE("load_cell", &load_cell),
        WB_CONFIG_NODE("mocap", &mocap),
        WB_CONFIG_NODE("stage", &stage),
        WB_CONFIG_OPTIONAL_NODE("strand", &strand),
        WB_CONFIG_OPTIONAL_NODE("limits", &limits),
        WB_CONFIG_OPTIONAL_BOOLEAN("virtual", &rig->is_virtual),
        WB_CONFIG_OPTIONAL_NUMBER("time_scale", &rig->time_scale, 1.0, 0.01, 1000.0),
        WB_CONFIG_IGNORED("truth"),
    };
    WB_TRY(wb_config_map(root, table, WB_COUNT(table)));
    if (!rig->is_virtual && rig->time_scale != 1.0)
        return wb_config_refuse(root, "time_scale",
                                "only a virtual rig's clocks can run faster: remove this key");
    WB_TRY(read_load_cell(load_cell, rig->gravity, &rig->load_cell));
    WB_TRY(read_mocap(mocap, &rig->mocap));
    WB_TRY(read_stage(stage, &rig->stage));
    WB_TRY(read_strand(strand, &rig->strand));
    if (rig->load_cell.tare == WB_RIG_TARE_COUNTERWEIGHT && !(rig->strand.counterweight > 0.0))
        return wb_config_refuse(load_cell, "tare",
                                "the strand has no counterweight: give strand.counterweight_g, or "
                                "take the tare unloaded");
    WB_TRY(read_limits(limits, rig));
    *(struct wb_rig *)into = read;
    return WB_OK;
}

double wb_rig_tare_load(const struct wb_rig *rig)
{
    if (rig->load_cell.tare == WB_RIG_TARE_COUNTERWEIGHT)
        return rig->strand.counterweight * rig->gravity;
    return 0.0;
}

double wb_rig_noise_allowed(const struct wb_rig_load_cell *cell)
{
    return cell->noise > 0.0 ? NOISE_TIMES * cell->noise : NOISE_SHARE * cell->capacity;
}

/* A virtual rig that was killed leaves its file behind, but its ports no longer exist. */
static enum wb_status check_virtual_ports(const char *path, const struct wb_rig *rig)
{
    const char *const addresses[] = {rig->load_cell.address, rig->stage.address};
    for (size_t i = 0; rig->is_virtual && i < WB_COUNT(addresses); i++) {
        char port[WB_RIG_TEXT];
        if (strncmp(addresses[i], "pty:", 4) != 0)
            continue;
        snprintf(port, sizeof port, "%.*s", (int)strcspn(addresses[i] + 4, ",?"), addresses[i] + 4);
        if (!wb_file_exists(port))
            return wb_fail(WB_ERR_NOT_FOUND,
                           "%s: there is no port '%s': the virtual rig that wrote this file no "
                           "longer runs; start it again",
                           path, port);
    }
    return WB_OK;
}

enum wb_status wb_rig_read(const char *path, struct wb_rig *rig)
{
    struct wb_rig read;
    /* The virtual rig writes a file of this name and removes it when it stops. */
    if (strcmp(wb_file_name(path), "rig.yaml") == 0 && !wb_file_exists(path))
        return wb_fail(WB_ERR_NOT_FOUND,
                       "no rig file '%s'; is `wirebench rig` running, and has it said ready?",
                       path);
    WB_TRY(wb_config_load(NULL, path, NULL, read_root, &read));
    WB_TRY(check_virtual_ports(path, &read));
    *rig = read;
    return WB_OK;
}

enum wb_status wb_rig_parse(const char *text, const char *origin, struct wb_rig *rig,
                            struct wb_reason *why)
{
    return wb_config_load(text, origin, why, read_root, rig);
}
