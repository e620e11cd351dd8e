#include "analysis/report/kinds/kinds.h"

#include "analysis/report/bench/recordings_kind.h"
#include "analysis/report/bundles/bundles_kind.h"
#include "analysis/report/harnesses/harnesses_kind.h"
#include "analysis/report/machines/machines_kind.h"
#include "analysis/report/predictions/predictions_kind.h"
#include "analysis/report/wires/wires_kind.h"

const struct wb_kind *const wb_kinds[WB_KINDS] = {
    &wb_recordings_kind, &wb_wires_kind,       &wb_bundles_kind,
    &wb_machines_kind,   &wb_predictions_kind, &wb_harnesses_kind,
};
