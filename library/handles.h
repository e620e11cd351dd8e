/* The handles that more than one file of the library accesses. */
#ifndef WB_LIBRARY_HANDLES_H
#define WB_LIBRARY_HANDLES_H

#include "analysis/calibration/properties/properties.h"
#include "analysis/cards/card_source.h"
#include "analysis/dataset/dataset.h"
#include "analysis/dataset/dataset_columns.h"
#include "library/call.h"

struct wirebench_dataset {
    struct wb_dataset dataset;
    struct wb_properties_dataset origin; /* its name in a properties file */
    struct wirebench_table tables[WB_DATASET_COLUMNS_TABLES];
    char *json; /* owned */
};

struct wirebench_properties {
    struct wb_card_source source; /* from a wire or properties file, or equivalent */
    struct wb_text text;          /* of the file, if calibrated; else empty */
};

#endif
