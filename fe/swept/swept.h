/* Node fields of swept bodies, and the instruction sets of the kernels that work on them.
 *
 * A swept body is a plane section of nodes, repeated at stations along an axis. Each wire of a
 * bundle and the tape around it is such a body; all have the same stations. A field has three
 * numbers for each node of the body. Component c of section node k at station j is
 *
 *     field[(3 k + c) stride + j],      c = 0, 1, 2 for x (along the axis), y, z,
 *
 * so that neighbours along the axis are neighbours in memory: a kernel loads consecutive stations
 * of one section node into the lanes of a vector. WB_SWEPT_LANES stations are a block, the unit in
 * which work is shared among threads. The stride is a multiple of that and larger than the number
 * of stations; fields are aligned to WB_SWEPT_ALIGNMENT bytes. Entries after the last station are
 * padding: they are finite, and are read without effect on results.
 *
 * Positions and velocities are double; differences of positions are formed in double, then kernels
 * may use float (a displacement of 50 mm in float cannot resolve a strain of 1e-6). Forces are
 * float, or double for models in double precision: they are sums of few terms, recomputed in each
 * step.
 */
#ifndef WB_FE_SWEPT_SWEPT_H
#define WB_FE_SWEPT_SWEPT_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/memory.h"
#include "base/status.h"

enum {
    WB_SWEPT_LANES = 16,
    WB_SWEPT_ALIGNMENT = 64
};

/* Processor instructions used by kernels. */
enum wb_swept_instructions {
    WB_SWEPT_BEST, /* the best that this processor and this build have */
    WB_SWEPT_BASELINE,
    WB_SWEPT_AVX2,
    WB_SWEPT_AVX512
};

struct wb_swept_layout {
    int n_nodes;    /* of the section */
    int n_stations; /* one more than elements along the axis */
    int stride;     /* of stations */
};

/* Stations `first` to `end` - 1, and the elements that begin there: the range over which energies
 * and other sums are taken. A body that is one axial part of a longer one also computes stations
 * that belong to its neighbours, but counts only its own. `end` 0: all. */
struct wb_swept_range {
    int first, end;
};

/* A straight wire of a bundle in the reference state, for contact and cohesion: its section and its
 * surface. The arrays are read only during creation. */
struct wb_swept_wire {
    int n_nodes;             /* of the section */
    int n_surface;           /* at least 3 */
    const int *surface;      /* (n_surface): nodes, in their order around the section */
    const double (*node)[2]; /* (n_nodes): y, z in the section, m */
    double y, z;             /* of the section's origin, m; not used by contact between wires */
    double radius;           /* of contact, m; not used by cohesion */
    double youngs_modulus;   /* Pa; used by contact between wires */
};

/* The layout of a body, and the number of entries of its fields. */
struct wb_swept_layout wb_swept_layout(int n_nodes, int n_stations);
size_t wb_swept_size(const struct wb_swept_layout *layout);

/* True for a finite number above 0. */
static inline bool wb_swept_is_positive(double number)
{
    return number > 0.0 && isfinite(number);
}

/* The intersection of a range with 0 to n - 1. */
struct wb_swept_range wb_swept_range_within(struct wb_swept_range range, int n);

/* Chooses the instructions to use for the wanted ones; the result is never WB_SWEPT_BEST.
 * WB_ERR_UNSUPPORTED if this processor, or this build (option vector_kernels), does not have
 * them. */
WB_MUST_CHECK enum wb_status wb_swept_choose_instructions(enum wb_swept_instructions *chosen,
                                                          enum wb_swept_instructions wanted);

/* "baseline", "avx2", "avx512"; for WB_SWEPT_BEST the name of the best that this processor and this
 * build have. */
const char *wb_swept_instructions_name(enum wb_swept_instructions instructions);

/* Zeroed, aligned memory for `count` values of `size` bytes; free() it. */
void *wb_swept_allocate(size_t count, size_t size);

/* As wb_swept_allocate(), for an array of an object (base/memory.h). */
void *wb_swept_take(struct wb_memory *memory, size_t count, size_t size);

#endif
