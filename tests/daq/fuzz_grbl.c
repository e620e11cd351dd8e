/* Any bytes from a stage give lines or remarks, independent of the division into reads. */
#include "tests/daq/fuzz_driver.h"
#include "tests/daq/grbl_jog.h"

#include <math.h>

#include "daq/protocol/grbl.h"

static void take_stage(void *context, const struct wb_stage_report *report)
{
    FUZZ_REQUIRE(report->state != WB_STAGE_UNKNOWN);
    FUZZ_REQUIRE(isnan(report->position) || isfinite(report->position));
    fuzz_count(context, report->position, (uint64_t)report->state ^ (uint64_t)report->alarm << 8);
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
    const struct wb_rig rig = {.stage = {.axis = 'Y', .down = -1}, .time_scale = 1.0};
    fuzz_cuts(&wb_stage_grbl, &rig, (struct wb_sink){.stage = take_stage}, bytes, n);
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
    return fuzz_main_text(argc, argv, seeds, sizeof seeds / sizeof seeds[0], 200000);
}

#endif
