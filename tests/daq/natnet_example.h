/* A NatNet frame with something in every section, for tests, fuzzing and benchmarks. */
#ifndef WB_TESTS_DAQ_NATNET_EXAMPLE_H
#define WB_TESTS_DAQ_NATNET_EXAMPLE_H

#include <string.h>

#include "daq/protocol/natnet_encode.h"

static inline void natnet_example(struct wb_natnet_frame *frame, int n_markers)
{
    memset(frame, 0, sizeof *frame);
    frame->mocap.frame_number = 162734;
    frame->n_labelled = frame->mocap.n_markers = n_markers;
    for (int i = 0; i < n_markers; i++) {
        struct wb_marker *const marker = &frame->mocap.markers[i];
        *marker = (struct wb_marker){.id = 50007 + i, .size = 0.021F, .residual = 2.07e-4F};
        marker->position[0] = 0.014F * (float)i;
        marker->position[1] = 1.5F - 0.001F * (float)(i * i);
        marker->position[2] = -0.8858F;
        marker->params = WB_MARKER_POINT_CLOUD_SOLVED | WB_MARKER_UNLABELED;
    }
    strcpy(frame->sets[0].name, "wire");
    strcpy(frame->sets[1].name, "all");
    frame->n_sets = 2;
    frame->sets[0].n_points = frame->sets[0].n_kept = 3;
    frame->sets[1].n_points = frame->sets[1].n_kept = 5;
    frame->sets[1].first_point = 3;
    frame->n_points = 8;
    for (int i = 0; i < frame->n_points; i++)
        for (int k = 0; k < 3; k++)
            frame->points[i][k] = 0.1F * (float)(3 * i + k);
    frame->n_others = 2;
    memcpy(frame->others[0], frame->mocap.markers[0].position, sizeof frame->others[0]);
    memcpy(frame->others[1], frame->mocap.markers[1].position, sizeof frame->others[1]);
    for (int i = 0; i < 5; i++) {
        struct wb_natnet_body *const body = &frame->bodies[i];
        *body = (struct wb_natnet_body){.id = 100 + i, .error = 1e-4F, .params = 1};
        body->rotation[3] = 1.0F;
        body->position[1] = 0.5F + (float)i;
        body->n_markers = i;
    }
    frame->n_bodies_kept = 5;
    frame->n_bodies = 2;
    frame->n_skeletons = 1;
    frame->skeletons[0] = (struct wb_natnet_group){.id = 4, .n_bodies = 2, .first_body = 2};
    frame->skeletons[0].n_kept = 2;
    frame->n_assets = 1;
    frame->assets[0] =
        (struct wb_natnet_group){.id = 7, .n_bodies = 1, .first_body = 4, .n_markers = 3};
    frame->assets[0].n_kept = 1;
    frame->n_force_plates = 1;
    frame->force_plates[0] = (struct wb_natnet_analog){.id = 1, .n_channels = 3, .n_values = 10};
    frame->n_devices = 2;
    frame->devices[0] = (struct wb_natnet_analog){.id = 2, .n_channels = 1, .n_values = 4};
    frame->devices[1] = (struct wb_natnet_analog){.id = 3};
    frame->latency = 775.3009F;
    frame->timecode = 11;
    frame->timecode_sub = 12;
    frame->timestamp = 1356.125; /* exact in float32 too */
    frame->has_precision = true;
    frame->precision_seconds = 1700000000;
    frame->precision_fraction = 99;
    frame->mocap.camera_data_received = UINT64_C(1417339207940);
    frame->mocap.transmit = UINT64_C(1417339217940);
    frame->mocap.params = 4;
}

#endif
