/* Common setup of most tests of the virtual rig: the paper's bench, a specimen, its wire. */
#ifndef WB_TESTS_VIRTUAL_SETUP_H
#define WB_TESTS_VIRTUAL_SETUP_H

#include "base/file.h"
#include "base/units.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/specimen.h"
#include "fe/model/wire.h"
#include "fixtures/virtual/composite.h"
#include "fixtures/virtual/truth.h"
#include "tests/check.h"

struct setup {
    struct wb_rig rig;
    struct wb_specimen specimen;
    struct wb_wire wire;
    struct wb_composite composite;
    struct wb_truth truth;
};

static inline void setup_path(char path[WB_PATH], const char *name)
{
    assert_int_equal(wb_file_find_data(path, name), WB_OK);
}

/* `specimen` such as "type1-L85-1". */
static inline void setup_bench(struct setup *setup, const char *specimen, uint64_t seed)
{
    char path[WB_PATH], name[256];
    setup_path(path, "fixtures/rigs/paper.yaml");
    assert_int_equal(wb_rig_read(path, &setup->rig), WB_OK);
    snprintf(name, sizeof name, "fixtures/specimens/%s.yaml", specimen);
    setup_path(path, name);
    assert_int_equal(wb_specimen_read(path, &setup->specimen), WB_OK);
    snprintf(name, sizeof name, "fixtures/wires/%s.yaml", setup->specimen.wire);
    setup_path(path, name);
    assert_int_equal(wb_wire_read(path, &setup->wire, NULL), WB_OK);
    setup_path(path, "fixtures/virtual/wires.yaml");
    assert_int_equal(wb_composite_read(path, setup->wire.name, &setup->composite), WB_OK);
    wb_truth_draw(&setup->truth, seed, &setup->rig, &setup->specimen);
}

#endif
