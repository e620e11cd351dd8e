/* What scatter between specimens alone makes of a validation's error; see validate.h. */
#ifndef WB_ANALYSIS_VALIDATION_EXPECTED_H
#define WB_ANALYSIS_VALIDATION_EXPECTED_H

/* Specimens (or series of them) here or of the calibration. */
struct wb_expected_group {
    int n;            /* 0 not known */
    double deviation; /* of ln k between them; NaN not known */
};

struct wb_expected {
    double deviation; /* s, pooled; the rest is NaN, too, where it is not known */
    int degrees;      /* v; 0 not known */
    double rms;       /* root mean square over many validations of a perfect model, */
    double rms_95;    /* and the value that one of twenty exceeds */
    double share;     /* of the mean square error of `found` that such scatter makes, at most 1 */
};

/* `sensitivity` is G; `found` the error of the validation. */
struct wb_expected wb_expected_find(const struct wb_expected_group *here,
                                    const struct wb_expected_group *calibration, double sensitivity,
                                    double found);

#endif
