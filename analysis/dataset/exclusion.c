#include "analysis/dataset/exclusion.h"

#include "daq/recording/index.h"

#define WB_LOG_DOMAIN "dataset"

enum wb_status wb_exclusion_check(const struct wb_dataset *dataset, const char *name)
{
    const struct wb_json *const recordings = wb_json_get(dataset->document, "recordings");
    for (size_t i = 0; i < wb_json_length(recordings); i++) {
        struct wb_index_exclusion excluded;
        char text[WB_INDEX_EXCLUSION_TEXT];
        if (!wb_index_exclusion_get_json(&excluded, wb_json_item(recordings, i)))
            continue;
        wb_index_exclusion_describe(&excluded, text);
        return wb_fail(WB_ERR_DATA,
                       "'%s': the test was excluded %s. Leave the dataset out; to use it, take "
                       "`excluded` out of index.yaml beside its recording, and align it again",
                       name, text);
    }
    return WB_OK;
}
