/* The paper's tape on wires, for tests and benchmarks: stiffnesses of the interface, friction 0.4,
 * no damage. */
#ifndef WB_TESTS_FE_SWEPT_ADHESIVE_H
#define WB_TESTS_FE_SWEPT_ADHESIVE_H

#include "fe/swept/swept_tape_contact.h"

static inline void default_cohesion(struct wb_swept_cohesion_settings *settings)
{
    *settings =
        (struct wb_swept_cohesion_settings){.normal_stiffness = 30e9, .shear_stiffness = 10e9};
}

static inline void default_tape_contact(struct wb_swept_tape_contact_settings *settings)
{
    *settings =
        (struct wb_swept_tape_contact_settings){.normal_stiffness = 30e9,
                                                .shear_stiffness = 10e9,
                                                .friction = {.mu_static = 0.4, .mu_kinetic = 0.4}};
}

#endif
