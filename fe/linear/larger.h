/* The larger of two numbers, where a NaN is not lost. */
#ifndef WB_FE_LINEAR_LARGER_H
#define WB_FE_LINEAR_LARGER_H

/* As fmax(), but returns NaN if either argument is NaN. */
static inline double wb_larger(double a, double b)
{
    return b > a || b != b ? b : a;
}

#endif
