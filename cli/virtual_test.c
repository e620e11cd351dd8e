#include "cli/virtual_test.h"

#include "fixtures/virtual/virtual_time.h"

enum wb_status wb_virtual_test_begin(struct wb_virtual_test *test,
                                     struct wb_bend_test_request *request)
{
    test->bench = NULL;
    test->rig = (struct wb_text){0};
    test->settings.rig = request->rig_path;
    test->settings.specimen = request->specimen_path;
    test->settings.specimen_text = request->specimen_text;
    wb_virtual_time_begin(test->start);
    enum wb_status status = wb_bench_open(&test->bench, &test->settings);
    if (status == WB_OK)
        status = wb_bench_format_rig(test->bench, &test->rig);
    if (status != WB_OK) {
        wb_virtual_test_end(test, request);
        return status;
    }
    request->rig_text = wb_text_string(&test->rig);
    return WB_OK;
}

void wb_virtual_test_end(struct wb_virtual_test *test, struct wb_bend_test_request *request)
{
    request->rig_text = NULL;
    wb_bench_close(test->bench);
    test->bench = NULL;
    wb_text_release(&test->rig);
    wb_virtual_time_end();
}
