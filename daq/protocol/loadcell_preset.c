#include "daq/protocol/loadcell_preset.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/config.h"
#include "base/units.h"

#define MS WB_NS_PER_MS

/* Common to the instruments of Loadstar. */
#define LOADSTAR                                                                                   \
    .line = "9600,8n1", .unit_rule = WB_UNIT_OF_RIG_FILE, .unit = "lb", .start = "O0W0\r",         \
    .stop = "\r", .request = "O0W1\r", .tare = "CT0\r", .answers = {{"A", NULL}}

/* Sources: the manufacturers' manuals, and the sketches of the named libraries. Commands that wait
 * for a stable load (`S` of most balances) are not used: during bending the load is never stable.
 */
static const struct wb_loadcell_preset presets[] = {
    {
        /* Loadstar DI-100, DI-1000: decimal pounds */
        .name = "loadstar",
        LOADSTAR,
    },
    {
        /* Loadstar iLoad, DQ-1000: thousandths of a pound */
        .name = "loadstar-iload",
        .scale = 1e-3,
        LOADSTAR,
    },
    {
        /* Mark-10 force gauges; tension is negative */
        .name = "mark-10",
        .line = "115200,8n1",
        .sign = -1,
        .request = "?C\r",
        .period_ns = 50 * MS,
        .tare = "Z\r",
        .answers =
            {
                {"*10", "unknown command (*10): Series 3 and 4 support only "
                        "load_cell.poll_command: \"?\\r\""},
                {"*11", "the command cannot be executed now (*11)"},
                {"*12", "invalid command specifier (*12)"},
                {"*22", "a value in the command is too large (*22)"},
            },
    },
    {
        /* KERN balances, print format of 14 or 15 characters */
        .name = "kern",
        .line = "1200,8n2",
        .start = "O1\r\n",
        .stop = "O0\r\n",
        .request = "O8\r\n",
        .tare = "T \r\n",
        .answers = {{"A00", NULL}, {"E01", "the balance rejected a command (E01)"}},
    },
    {
        /* KERN balances (PCB, FKB and others) polled with the letter w */
        .name = "kern-asked",
        .line = "9600,8n1",
        .unit_rule = WB_UNIT_IF_STABLE,
        .request = "w",
        .period_ns = 200 * MS,
        .tare = "t",
        .overloads = {"Error"},
    },
    {
        /* Arduino with HX711, sketches of the library HX711_ADC */
        .name = "hx711-adc",
        .line = "57600,8n1",
        .unit_rule = WB_UNIT_OF_RIG_FILE,
        .tare = "t",
        .settle_ns = 2500 * MS,
    },
    {
        /* Arduino with HX711, sketches of bogde's library HX711 */
        .name = "hx711-bogde",
        .line = "38400,8n1",
        .unit_rule = WB_UNIT_OF_RIG_FILE,
        .delimiter = '|',
        .column = 1,
        .settle_ns = 2500 * MS,
    },
    {
        /* Arduino with HX711, sketches of SparkFun */
        .name = "hx711-sparkfun",
        .line = "9600,8n1",
        .settle_ns = 2500 * MS,
    },
    {
        /* A&D balances, A&D standard format */
        .name = "a-and-d",
        .line = "2400,7e1",
        .terminator = "crlf",
        .start = "SIR\r\n",
        .stop = "C\r\n",
        .request = "Q\r\n",
        .tare = "R\r\n",
        .answers =
            {
                {"\x06", NULL},
                {"EC,E00", "communication error (EC,E00): check baud rate and parity in "
                           "load_cell.address"},
                {"EC,E01", "unknown command (EC,E01)"},
                {"EC,E02", "the balance is not ready for the command (EC,E02)"},
                {"EC,E04", "the balance received too many characters (EC,E04)"},
                {"EC,E06", "the balance received a malformed command (EC,E06)"},
            },
    },
    {
        /* Ohaus balances, Ohaus commands */
        .name = "ohaus",
        .line = "9600,8n1",
        .start = "CP\r\n",
        .stop = "0P\r\n",
        .request = "IP\r\n",
        .tare = "T\r\n",
        .answers =
            {
                {"ES", "unknown command (ES)"},
                {"OK!", NULL},
                {"Err 8.3", NULL, true},
                {"Err 8.4", NULL, true},
            },
    },
    {
        /* Ohaus Scout Pro and Traveler */
        .name = "ohaus-scout",
        .line = "2400,8n1",
        .start = "CA\r\n",
        .stop = "0A\r\n",
        .request = "P\r\n",
        .tare = "T\r\n",
        .answers = {{"Err 8.3", NULL, true}, {"Err 8.4", NULL, true}},
    },
    {
        /* Sartorius balances, SBI format of 16 or 22 characters */
        .name = "sartorius",
        .line = "9600,8o1",
        .terminator = "crlf",
        .unit_rule = WB_UNIT_IF_STABLE,
        .request = "\x1bP\r\n",
        .period_ns = 100 * MS,
        .tare = "\x1bT\r\n",
        .overloads = {"H", "L", "High", "Low"},
        .answers =
            {
                {"C", "the balance adjusts itself (C)"},
                {"Stat       C", "the balance adjusts itself (C)"},
            },
    },
    {
        /* Radwag balances and indicators */
        .name = "radwag",
        .line = "9600,8n1",
        .terminator = "crlf",
        .start = "C1\r\n",
        .stop = "C0\r\n",
        .request = "SI\r\n",
        .tare = "T\r\n",
        .answers =
            {
                {"C1 A", NULL},
                {"C0 A", NULL},
                {"C1 I", "the balance cannot stream now (C1 I)"},
                {"SI I", "the balance cannot weigh now (SI I)"},
                {"ES", "unknown command (ES)"},
            },
    },
    {
        /* weighing indicators that print `ST,GS,+  4.876kg` by themselves */
        .name = "indicator",
        .line = "9600,8n1",
    },
    {
        /* Dini Argeo indicators, polled */
        .name = "dini-argeo",
        .line = "9600,8n1",
        .terminator = "crlf",
        .request = "READ\r\n",
        .period_ns = 100 * MS,
        .tare = "TARE\r\n",
        .overloads = {"UL"},
        .answers =
            {
                {"OK", NULL},
                {"ERR01", "error in the command (ERR01)"},
                {"ERR02", "invalid value in the command (ERR02)"},
                {"ERR03", "the command cannot be executed now (ERR03)"},
                {"ERR04", "unknown command (ERR04)"},
            },
    },
    {
        /* Mantracourt DSC and DCell, ASCII, station 1, polled */
        .name = "mantracourt",
        .terminator = "cr",
        .unit_rule = WB_UNIT_OF_RIG_FILE,
        .request = "!001:SYS?\r",
        .period_ns = 50 * MS,
        .answers = {{"?", "the amplifier rejected the request (?)"}},
    },
};

const struct wb_loadcell_preset *wb_loadcell_preset_at(size_t index)
{
    return index < WB_COUNT(presets) ? &presets[index] : NULL;
}

const struct wb_loadcell_preset *wb_loadcell_preset_find(const char *name)
{
    for (size_t i = 0; i < WB_COUNT(presets); i++)
        if (strcmp(presets[i].name, name) == 0)
            return &presets[i];
    return NULL;
}

static void set_text(char *target, size_t size, const char *text)
{
    snprintf(target, size, "%s", text ? text : "");
}

void wb_loadcell_preset_apply(const struct wb_loadcell_preset *preset,
                              struct wb_rig_load_cell *cell)
{
    set_text(cell->preset, sizeof cell->preset, preset->name);
    set_text(cell->terminator, sizeof cell->terminator,
             preset->terminator ? preset->terminator : "any");
    set_text(cell->unit, sizeof cell->unit, preset->unit);
    cell->scale = preset->scale != 0.0 ? preset->scale : 1.0;
    cell->sign = preset->sign != 0 ? preset->sign : 1;
    cell->delimiter = preset->delimiter;
    cell->column = preset->column;
    cell->settle_ns = preset->settle_ns;
    set_text(cell->start_command, sizeof cell->start_command, preset->start);
    set_text(cell->stop_command, sizeof cell->stop_command, preset->stop);
    set_text(cell->tare_command, sizeof cell->tare_command, preset->tare);
    memset(cell->overload_tokens, 0, sizeof cell->overload_tokens);
    for (size_t i = 0; preset->overloads[i]; i++)
        set_text(cell->overload_tokens[i], sizeof cell->overload_tokens[i], preset->overloads[i]);
    if (preset->period_ns > 0) {
        wb_loadcell_preset_ask(preset, cell);
        cell->poll_period_ns = preset->period_ns;
    }
}

void wb_loadcell_preset_ask(const struct wb_loadcell_preset *preset, struct wb_rig_load_cell *cell)
{
    set_text(cell->poll_command, sizeof cell->poll_command, preset->request);
    cell->start_command[0] = cell->stop_command[0] = '\0';
}

bool wb_loadcell_preset_complete_address(const struct wb_loadcell_preset *preset, char *address,
                                         size_t size)
{
    bool has_baud = false, has_frame = false;
    if (!preset->line || strncmp(address, "serial:", 7) != 0)
        return true;
    for (const char *at = strchr(address, ','); at; at = strchr(at, ',')) {
        const size_t n = strcspn(++at, ","), digits = strspn(at, "0123456789");
        has_baud = has_baud || (n > 0 && digits == n);
        has_frame = has_frame || (n == 3 && digits == 1 && isdigit((unsigned char)at[2]));
    }
    const size_t baud = strcspn(preset->line, ",");
    size_t used = strlen(address);
    if (!has_baud && used < size)
        used += (size_t)snprintf(address + used, size - used, ",%.*s", (int)baud, preset->line);
    if (!has_frame && used < size)
        used += (size_t)snprintf(address + used, size - used, "%s", preset->line + baud);
    return used < size;
}

/* The reply of the preset that equals the line; NULL: none. */
static const struct wb_loadcell_answer *find_answer(const struct wb_loadcell_preset *preset,
                                                    const char *bytes, size_t length)
{
    while (length > 0 && isspace((unsigned char)bytes[length - 1]))
        length--;
    for (; length > 0 && isspace((unsigned char)*bytes); length--)
        bytes++;
    for (const struct wb_loadcell_answer *at = preset->answers; at->text; at++)
        if (strlen(at->text) == length && memcmp(at->text, bytes, length) == 0)
            return at;
    return NULL;
}

void wb_loadcell_preset_decode(const struct wb_loadcell_preset *preset, const char *bytes,
                               size_t length, const struct wb_rig_load_cell *cell,
                               struct wb_line_reading *reading)
{
    const struct wb_loadcell_answer *const answer = find_answer(preset, bytes, length);
    wb_line_decode(bytes, length, cell, reading);
    if (answer) {
        reading->kind = answer->overload  ? WB_LINE_OVERLOAD
                        : answer->meaning ? WB_LINE_REFUSED
                                          : WB_LINE_EMPTY;
        reading->reason = answer->meaning;
    }
    if (preset->unit_rule == WB_UNIT_IF_STABLE && reading->kind == WB_LINE_VALUE &&
        reading->unit[0] == '\0')
        reading->unstable = true;
}
