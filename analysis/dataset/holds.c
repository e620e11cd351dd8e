#include "analysis/dataset/holds.h"

#include <string.h>

int wb_holds_of_bent_wire(const struct wb_dataset *dataset, double *seconds)
{
    const struct wb_json *const holds =
        wb_json_get(wb_json_get(dataset->document, "checks"), "holds");
    int n = 0;
    *seconds = 0.0;
    for (size_t i = 0; i < wb_json_length(holds); i++) {
        const struct wb_json *const hold = wb_json_item(holds, i);
        const char *phase = "";
        double lasted = 0.0;
        if (!wb_json_get_text(hold, "phase", &phase) || strcmp(phase, "rest") == 0)
            continue;
        (void)wb_json_get_number(hold, "lasted_s", &lasted);
        *seconds += lasted;
        n++;
    }
    return n;
}
