/* Validation error expected from scatter between specimens alone; equations in validate.h. */
#ifndef WB_ANALYSIS_VALIDATION_EXPECTED_H
#define WB_ANALYSIS_VALIDATION_EXPECTED_H

/* Specimens (or series of them) of the validation or of the calibration. */
struct wb_expected_group {
    int n;            /* 0 unknown */
    double deviation; /* of ln k between them; NaN unknown */
};

struct wb_expected {
    double deviation; /* s, pooled; NaN unknown, and then rms, rms_95 and share are NaN too */
    int degrees;      /* v; 0 unknown */
    double rms;       /* root mean square over many validations of a perfect model, */
    double rms_95;    /* and the value that one of twenty exceeds */
    double share; /* of the mean square error of `found` that this scatter explains, at most 1 */
};

/* `sensitivity` is G; `found` is the RMS error of the validation. */
struct wb_expected wb_expected_find(const struct wb_expected_group *here,
                                    const struct wb_expected_group *calibration, double sensitivity,
                                    double found);

#endif
