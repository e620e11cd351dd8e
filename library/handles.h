/* What is behind the handles that more than one file of the library looks into. */
#ifndef WB_LIBRARY_HANDLES_H
#define WB_LIBRARY_HANDLES_H

#include "analysis/calibration/properties/properties.h"
#include "analysis/cards/card_source.h"
#include "analysis/dataset/dataset.h"
#include "analysis/dataset/dataset_columns.h"
#include "library/call.h"

struct wirebench_dataset {
    struct wb_dataset dataset;
    struct wb_properties_dataset origin; /* as a properties file names it */
    struct wirebench_table tables[WB_DATASET_COLUMNS_TABLES];
    char *json; /* owned */
};

struct wirebench_properties {
    struct wb_card_source source; /* a wire's or a properties file's, or as if read from one */
    struct wb_text text;          /* of the file, where it was calibrated; else empty */
};

#endif
