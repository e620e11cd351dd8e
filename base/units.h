/* Unit conversions at the interfaces. Every double without a unit in its name is SI; these factors
 * convert units of files, instruments and axes to SI (multiply) and back (divide). */
#ifndef WB_BASE_UNITS_H
#define WB_BASE_UNITS_H

#include <stdint.h>

#define WB_MM 1e-3                     /* m */
#define WB_G 1e-3                      /* kg: one gram */
#define WB_MG 1e-6                     /* kg: one milligram */
#define WB_MPA 1e6                     /* Pa */
#define WB_G_PER_CM3 1e3               /* kg/m3 */
#define WB_DAY 86400.0                 /* s */
#define WB_NMM 1e-3                    /* N m: one newton millimetre */
#define WB_NMM2 1e-6                   /* N m2: one newton square millimetre */
#define WB_N_PER_MM 1e3                /* J/m2: fracture energy of 1 N/mm */
#define WB_N_PER_MM3 1e9               /* Pa/m: stiffness of an interface of 1 N/mm3 */
#define WB_S_PER_MM 1e3                /* s/m */
#define WB_MN 1e-3                     /* N: one millinewton */
#define WB_MJ 1e-3                     /* J: one millijoule */
#define WB_PERCENT 1e-2                /* 1 */
#define WB_PPM 1e-6                    /* 1 */
#define WB_DEGREE 0.017453292519943295 /* rad */
#define WB_POUND 0.45359237            /* kg: the international pound, exact */
#define WB_OUNCE 0.028349523125        /* kg: the international ounce, exact */
#define WB_POUND_FORCE 4.4482216152605 /* N, exact */
#define WB_STANDARD_GRAVITY 9.80665    /* m/s2, exact by definition */

#define WB_NS_PER_S INT64_C(1000000000)
#define WB_NS_PER_MS INT64_C(1000000)

/* Nanoseconds for a time in seconds, rounded to nearest. |seconds| must be below 9.2e9. */
static inline int64_t wb_ns_from_seconds(double seconds)
{
    return (int64_t)(seconds * 1e9 + (seconds < 0.0 ? -0.5 : 0.5));
}

/* Seconds for a time in nanoseconds; exact to 1 ns up to 100 days. */
static inline double wb_seconds_from_ns(int64_t t_ns)
{
    return (double)t_ns * 1e-9;
}

#endif
