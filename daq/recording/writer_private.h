/* Functions of daq/recording/writer.h that only tests call. */
#ifndef WB_DAQ_RECORDING_WRITER_PRIVATE_H
#define WB_DAQ_RECORDING_WRITER_PRIVATE_H

#include "daq/recording/writer.h"

void wb_writer_default_settings(struct wb_writer_settings *settings);

void wb_writer_counts(const struct wb_writer *writer, struct wb_writer_counts *counts);

#endif
