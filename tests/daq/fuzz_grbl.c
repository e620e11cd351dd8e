/* Any bytes from a stage are lines or remarks, and how they are cut into reads does not matter. */
#include "tests/daq/fuzz.h"
#include "tests/daq/grbl_jog.h"

#include <math.h>

#include "daq/drivers.h"
#include "daq/grbl.h"

struct total {
    uint64_t n, hash;
};

static void take_stage(void *context, const struct wb_stage_report *report)
{
    struct total *const total = context;
    uint64_t bits;
    FUZZ_REQUIRE(report->state != WB_STAGE_UNKNOWN);
    FUZZ_REQUIRE(isnan(report->position) || isfinite(report->position));
    memcpy(&bits, &report->position, sizeof bits);
    total->hash = (total->hash ^ bits ^ (uint64_t)report->state ^ (uint64_t)report->alarm << 8) *
                      UINT64_C(1099511628211) +
                  1;
    total->n++;
}

static void take_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                        const char *text)
{
    (void)context;
    (void)level;
    (void)t_ns;
    FUZZ_REQUIRE(kind[0] && text[0]);
    for (const char *c = text; *c; c++)
        FUZZ_REQUIRE(*c >= 0x20 && *c < 0x7f);
}

static struct total run(const uint8_t *bytes, size_t n, size_t step)
{
    const struct wb_rig rig = {.stage = {.axis = 'Y', .down = -1}, .time_scale = 1.0};
    struct total total = {0};
    const struct wb_sink sink = {.context = &total, .stage = take_stage, .remark = take_remark};
    void *const state = calloc(1, wb_stage_grbl.state_size);
    FUZZ_REQUIRE(state && wb_stage_grbl.init(state, &rig) == WB_OK);
    for (size_t at = 0; at < n; at += step)
        wb_stage_grbl.receive(state, 7, bytes + at, n - at < step ? n - at : step, &sink);
    free(state);
    return total;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    struct wb_grbl_line line;
    struct wb_grbl_offset offset = {0};
    struct grbl_jog jog;
    char text[256];
    double position;
    wb_grbl_decode((const char *)bytes, n, &line);
    FUZZ_REQUIRE(memchr(line.text, 0, sizeof line.text) != NULL);
    if (line.kind == WB_GRBL_LINE_REPORT) {
        FUZZ_REQUIRE(line.report.state != WB_STAGE_UNKNOWN);
        if (wb_grbl_position(&line.report, &offset, 1, &position))
            FUZZ_REQUIRE(isfinite(position));
        wb_grbl_format_report(text, sizeof text, &line.report);
    }
    if (n < sizeof text) {
        if (n)
            memcpy(text, bytes, n);
        text[n] = '\0';
        if (grbl_jog_parse(text, &jog))
            FUZZ_REQUIRE(jog.axis >= 0 && jog.axis < 3 && jog.feed_mm_min > 0.0 &&
                         isfinite(jog.target_mm));
    }
    const struct total whole = run(bytes, n, n ? n : 1), cut = run(bytes, n, 3);
    FUZZ_REQUIRE(whole.n == cut.n && whole.hash == cut.hash);
    return 0;
}

#ifndef WB_LIBFUZZER

int main(int argc, char **argv)
{
    static const char *const seeds[] = {
        "<Idle|MPos:0.000,-12.500,0.000|FS:0,0|Pn:XYZ|WCO:1.000,2.000,3.000|Ov:100,100,100>",
        ("ok\r\n<Jog|WPos:1.000,2.000,3.000|FS:120,0|WCO:1.000,2.000,3.000>\r\n"
         "<Hold:0|WPos:1.000,2.000,3.000|FS:0,0>\r\nok\r\n"),
        "\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n<Alarm|MPos:0,0,0>\r\n",
        "ALARM:1\r\nerror:9\r\n$110=500.000\r\n<Door:3|MPos:0.1>\r\n",
        "$J=G91 G21 X2.000 F120.000\n",
        "$j=g90g21z-5.5f60",
    };
    const uint8_t *pointers[sizeof seeds / sizeof seeds[0]];
    size_t sizes[sizeof seeds / sizeof seeds[0]];
    const size_t n = sizeof seeds / sizeof seeds[0];
    for (size_t i = 0; i < n; i++) {
        pointers[i] = (const uint8_t *)seeds[i];
        sizes[i] = strlen(seeds[i]);
    }
    return fuzz_main(argc, argv, pointers, sizes, n, 200000);
}

#endif
