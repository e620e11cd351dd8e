/* Stored curves of taped bundles from a static model: references for the explicit and the section
 * model that share no code with either.
 *
 * The model: implicit equilibrium, wires as planar Simo-Reissner beams of fibres, line contact with
 * friction along the wires, the tape as a membrane in plane stress on elastic bonds; see "Static
 * references" in docs/theory.md. Its code is in the history: tests/twin/bundle_static.c of revision
 * 44a8e6085fc5. These numbers were made with that revision, with 80 elements along a wire, 3 lines
 * of tape nodes on an arc, 20 fibres, contact stiffness 0.25 E, tangential 0.5 of it, open contact
 * pulling with 1e-4 of it, increments of at most 1/200 of the length, relative residual 1e-7.
 *
 * Loading: a vertical force at the tip, no weight, constant friction; bundles of fixtures/bundles.
 */
#ifndef WB_TESTS_FE_BUNDLE_STATIC_REFERENCE_H
#define WB_TESTS_FE_BUNDLE_STATIC_REFERENCE_H

struct static_point {
    double deflection_mm, force, tip_x_mm; /* of the tip; mm, N, mm */
};

/* 7-type3, mu = 0.1, from 2 to 53 mm. */
static const struct static_point static_7_every_mm[] = {
    {2, 0.13672, 113.98},    {3, 0.20505, 113.954},   {4, 0.270004, 113.919},
    {5, 0.328208, 113.874},  {6, 0.380078, 113.82},   {7, 0.427102, 113.756},
    {8, 0.470622, 113.681},  {9, 0.511456, 113.597},  {10, 0.55042, 113.503},
    {11, 0.587955, 113.398}, {12, 0.624393, 113.283}, {13, 0.659992, 113.158},
    {14, 0.694977, 113.023}, {15, 0.729496, 112.877}, {16, 0.763676, 112.721},
    {17, 0.797627, 112.554}, {18, 0.83143, 112.377},  {19, 0.865152, 112.189},
    {20, 0.898854, 111.991}, {21, 0.932587, 111.781}, {22, 0.966396, 111.561},
    {23, 1.00032, 111.33},   {24, 1.0344, 111.088},   {25, 1.06867, 110.835},
    {26, 1.10316, 110.571},  {27, 1.13791, 110.295},  {28, 1.17294, 110.008},
    {29, 1.20829, 109.71},   {30, 1.24399, 109.4},    {31, 1.28008, 109.078},
    {32, 1.31657, 108.745},  {33, 1.3535, 108.399},   {34, 1.39091, 108.042},
    {35, 1.42882, 107.673},  {36, 1.46727, 107.291},  {37, 1.50629, 106.897},
    {38, 1.54587, 106.491},  {39, 1.58606, 106.071},  {40, 1.62688, 105.64},
    {41, 1.66835, 105.195},  {42, 1.71038, 104.737},  {43, 1.75291, 104.267},
    {44, 1.79549, 103.783},  {45, 1.83799, 103.285},  {46, 1.88083, 102.774},
    {47, 1.9242, 102.249},   {48, 1.96821, 101.71},   {49, 2.01293, 101.157},
    {50, 2.05845, 100.589},  {51, 2.10472, 100.007},  {52, 2.15178, 99.4101},
    {53, 2.19976, 98.7981},
};

/* 7-type3, mu = 0.4. */
static const struct static_point static_7[] = {
    {2, 0.137087, 113.98},  {10, 0.553217, 113.501}, {20, 0.906453, 111.977},
    {30, 1.25983, 109.353}, {40, 1.65664, 105.521},  {50, 2.12653, 100.316},
    {53, 2.28658, 98.4486},
};

/* 7-type3, mu = 0. */
static const struct static_point static_7_frictionless[] = {
    {2, 0.136597, 113.98},  {10, 0.549493, 113.503}, {20, 0.896369, 111.995},
    {30, 1.23893, 109.414}, {40, 1.61734, 105.676},  {50, 2.03334, 100.687},
    {53, 2.16869, 98.9222},
};

/* 7-type3 without tape, with wires that do not touch. */
static const struct static_point static_7_apart[] = {
    {2, 0.0242125, 113.979}, {10, 0.117715, 113.476}, {20, 0.191061, 111.937},
    {30, 0.252471, 109.319}, {40, 0.317698, 105.515}, {50, 0.395432, 100.367},
    {53, 0.4227, 98.5271},
};

/* 7-type3 without tape, with wires that neither separate nor slip. */
static const struct static_point static_7_glued[] = {
    {2, 0.189881, 113.979}, {10, 0.637348, 113.491}, {20, 1.00722, 111.94},  {30, 1.3824, 109.28},
    {40, 1.80527, 105.415}, {50, 2.31983, 100.187},  {53, 2.50159, 98.3184},
};

/* 12-type3, mu = 0.4. */
static const struct static_point static_12[] = {
    {2, 0.284601, 113.98}, {10, 1.09429, 113.498}, {20, 1.83447, 111.976}, {30, 2.56604, 109.355},
    {40, 3.3095, 105.529}, {50, 4.16236, 100.35},  {53, 4.45671, 98.5003},
};

#endif
