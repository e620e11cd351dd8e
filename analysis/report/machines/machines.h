/* A campaign of tests that testing machines made: groups of specimens, each tested alike, from the
 * machines' own files. The files need not be shipped: their folder may stand in an environment
 * variable.
 *
 *     kind: machine
 *     title: A cable and its layers
 *     data_environment: WIREBENCH_REAL_DATA   # optional; else relative to the campaign file
 *     calibrate: true              # optional: a law of each wire, which takes minutes
 *     groups:
 *       - name: "1"
 *         label: insulated wire
 *         wire: 30 AWG               # optional, else the name: groups of one wire are calibrated
 *                                    # together
 *         machine: ../machines/two-rollers.yaml
 *         outer_diameter_mm: 0.8
 *         zero_force_mN: 10          # the test begins where the force first exceeds this
 *         usable_travel_mm: 4        # or a band
 *         tests: [bending/group-1-test-1.txt, bending/group-1-test-2.txt]
 *     cable:                         # optional: groups that are layers of one cable
 *       wires: ["1", "1b"]           # groups of the wire alone, each a series
 *       core: "2b"
 *       layers: ["4", "5b"]          # wires laid round the core, and what is put round those
 *       wire_count: 6
 *       wire_circle_radius_mm: 0.85  # on which the wires' centres are
 *       conductor: copper-22awg      # a material
 *       conductor_area_mm2: 0.0509
 */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_H

#include "analysis/calibration/constituents/cable.h"
#include "analysis/dataset/machine.h"
#include "analysis/dataset/test_piece.h"
#include "analysis/report/campaign.h"

struct wb_machines_group {
    char name[64], label[160];
    struct wb_machine machine;  /* three-point */
    struct wb_test_piece piece; /* of all tests; `sample` counts them */
    double zero_force;          /* N */
    int n_tests;
    char (*tests)[300]; /* (n_tests) paths from the data's folder; owned */
};

enum {
    WB_MACHINES_WIRES = 4, /* at most */
    WB_MACHINES_LAYERS = 8
};

/* Groups by their index. */
struct wb_machines_cable {
    int n_wires, wires[WB_MACHINES_WIRES];
    int core;
    int n_layers, layers[WB_MACHINES_LAYERS]; /* 0: the campaign has no cable */
    char conductor[300];
    struct wb_cable_ring ring;
};

struct wb_machines {
    struct wb_campaign head;
    char environment[64]; /* "": none */
    bool calibrates;
    int n_groups;
    struct wb_machines_group *groups; /* (n_groups), owned */
    struct wb_machines_cable cable;
};

/* As wb_kind_keys and wb_kind_release. */
enum wb_status wb_machines_keys(void *campaign, const struct wb_config_node *root);
void wb_machines_release(void *campaign);

#endif
