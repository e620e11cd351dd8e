/* Private to fe/swept_contact*.c. */
#ifndef WB_FE_SWEPT_SWEPT_CONTACT_PRIVATE_H
#define WB_FE_SWEPT_SWEPT_CONTACT_PRIVATE_H

#include "fe/swept/swept_contact.h"
#include "fe/swept/swept_contact_kernel.h"

struct wb_swept_contact {
    struct wb_swept_contact_settings settings;
    const struct wb_swept_contact_kernel *kernel;
    struct wb_swept_contact_model model;
    int most_pairs;
    double spacing, smallest_radius;
    double *radius, *youngs_modulus; /* (n_wires) */
    double *searched;                /* (n_wires x 3 x n_stations): centres at the last search */
    long long step;                  /* steps done */

    double *centre_memory, *fixed_memory, *rows_memory; /* of all wires, of all pairs */
    void *turn_memory, *inverse_memory, *load_memory;   /* in the kernel's type */
    unsigned char *active_memory;
    struct wb_swept_contact_window *window_memory;
    int *node_memory, *side_memory;
    double (*weight_memory)[3];
    void *narrow_weight_memory;
};

/* Neighbours, shifts, lengths and windows at the frames present. */
WB_MUST_CHECK enum wb_status wb_swept_contact_search(struct wb_swept_contact *contact);

/* What a pair of two wires has from the start. */
void wb_swept_contact_search_pair(const struct wb_swept_contact *contact,
                                  struct wb_swept_contact_pair_rows *pair, int a, int b);

/* Which pairs each wire has. */
void wb_swept_contact_search_sides(struct wb_swept_contact *contact);

/* Which whole offsets occur, from a pair's rows. */
void wb_swept_contact_search_windows(const struct wb_swept_contact *contact,
                                     struct wb_swept_contact_pair_rows *pair);

/* k of two wires. */
static inline double wb_swept_contact_stiffness(const struct wb_swept_contact *contact, int a,
                                                int b)
{
    const double *E = contact->youngs_modulus;
    return contact->settings.stiffness * 2.0 * E[a] * E[b] / (E[a] + E[b]);
}

static inline size_t wb_swept_contact_real_size(const struct wb_swept_contact *contact)
{
    return contact->settings.double_precision ? sizeof(double) : sizeof(float);
}

/* Element i of an array of the kernel's type. */
static inline void wb_swept_contact_set(const struct wb_swept_contact *contact, void *array,
                                        ptrdiff_t i, double value)
{
    if (contact->settings.double_precision)
        ((double *)array)[i] = value;
    else
        ((float *)array)[i] = (float)value;
}

static inline double wb_swept_contact_get(const struct wb_swept_contact *contact, const void *array,
                                          ptrdiff_t i)
{
    return contact->settings.double_precision ? ((const double *)array)[i]
                                              : (double)((const float *)array)[i];
}

static inline void *wb_swept_contact_at(const struct wb_swept_contact *contact, void *array,
                                        ptrdiff_t i)
{
    return (unsigned char *)array + i * (ptrdiff_t)wb_swept_contact_real_size(contact);
}

/* Row `i` of a pair, and of a wire's centres and fixed rows. */
static inline double *wb_swept_contact_pair_row(const struct wb_swept_contact *contact,
                                                const struct wb_swept_contact_pair_rows *pair,
                                                int i)
{
    return pair->rows + (ptrdiff_t)i * contact->model.stride;
}

static inline double *wb_swept_contact_centre_row(const struct wb_swept_contact *contact, int wire,
                                                  int i)
{
    return contact->model.wire[wire].centre + (ptrdiff_t)i * contact->model.row;
}

static inline double *wb_swept_contact_fixed_row(const struct wb_swept_contact *contact, int wire,
                                                 int i)
{
    return contact->model.wire[wire].fixed + (ptrdiff_t)i * contact->model.stride;
}

/* A row's value at a place between stations. */
static inline double wb_swept_contact_between(const struct wb_swept_contact *contact,
                                              const double *row, double place)
{
    const int last = contact->model.n_stations - 2;
    const int j = place >= last ? last : (int)place;
    const double f = place - j;
    return (1.0 - f) * row[j] + f * row[j + 1];
}

#endif
