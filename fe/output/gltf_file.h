/* Binary glTF 2.0 (.glb, https://www.khronos.org/gltf): a JSON object that describes a scene, and
 * arrays of numbers, little-endian on any machine. analysis/harness/harness_gltf.c defines the
 * contents of a scene.
 *
 *     struct wb_gltf_file file;
 *     wb_gltf_file_init(&file);
 *     const int positions = wb_gltf_file_add(&file, WB_GLTF_FILE_POSITIONS, n, values);
 *     ... members of file.root: scenes, nodes, meshes, with the index `positions` of an accessor
 *     status = wb_gltf_file_write(&file, path);
 *     wb_gltf_file_release(&file);
 */
#ifndef WB_FE_OUTPUT_GLTF_FILE_H
#define WB_FE_OUTPUT_GLTF_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/json.h"
#include "base/status.h"
#include "base/text.h"

/* Uses of arrays. Arrays of one use lie one after the other, in one view of the buffer. */
enum wb_gltf_file_use {
    WB_GLTF_FILE_POSITIONS,      /* (n, 3), of vertices, with their range */
    WB_GLTF_FILE_NORMALS,        /* (n, 3), of vertices, and changes of normals */
    WB_GLTF_FILE_COLOURS,        /* (n, 4), of vertices, 0 to 1, in steps of 1/255; linear light */
    WB_GLTF_FILE_COLOUR_CHANGES, /* (n, 4), -1 to 1, in steps of 1/127 */
    WB_GLTF_FILE_INDICES,        /* (n), of vertices */
    WB_GLTF_FILE_TIMES,          /* (n), of an animation, with their range */
    WB_GLTF_FILE_TRANSLATIONS,   /* (n, 3), of an animation */
    WB_GLTF_FILE_ROTATIONS,      /* (n, 4), of an animation: x, y, z, scalar */
    WB_GLTF_FILE_WEIGHTS,        /* (n), of an animation */
    WB_GLTF_FILE_USES            /* number of uses */
};

struct wb_gltf_file {
    struct wb_json *root;      /* the document; has `asset`; the caller adds the scene */
    struct wb_json *accessors; /* of the document */
    int n_accessors;
    struct wb_text bytes[WB_GLTF_FILE_USES];
    int view[WB_GLTF_FILE_USES], n_views; /* index of the view of a use that has bytes */
    bool is_finite;                       /* all numbers so far */
};

void wb_gltf_file_init(struct wb_gltf_file *file);
void wb_gltf_file_release(struct wb_gltf_file *file);

/* Adds an array of `n` items; returns the index of its accessor. */
int wb_gltf_file_add(struct wb_gltf_file *file, enum wb_gltf_file_use use, size_t n,
                     const double *values);

/* Writes the file completely or not at all; to be called once. WB_ERR_DATA if a number is not
 * finite, or if the file would exceed the format's 4 GiB. */
WB_MUST_CHECK enum wb_status wb_gltf_file_write(struct wb_gltf_file *file, const char *path);

#endif
