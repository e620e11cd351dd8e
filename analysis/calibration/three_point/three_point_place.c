#include "analysis/calibration/three_point/three_point_place.h"

#include <math.h>

enum {
    CONTACT_SECTIONS = 48, /* golden-section steps for a contact's range, */
    BOW_SECTIONS = 16      /* and for a bow's, each of which computes the curve */
};

static const double golden = 0.6180339887498949;
/* Range of the search, in standard deviations of a prior. */
static const double reach = 3.0;

void wb_three_point_place_bow(const struct wb_test_info *info,
                              const struct wb_three_point_fit_settings *settings, double *middle,
                              double *deviation)
{
    const struct wb_band *const given = &info->piece.natural_bow;
    *middle = given->known ? given->value : 0.0;
    *deviation =
        given->known ? 0.25 * (given->most - given->least) : settings->bow_prior * info->length;
}

double wb_three_point_place_error(const struct wb_three_point_data *data,
                                  const struct wb_three_point_fit_settings *settings)
{
    return fmax(data->noise, settings->force_share * data->max_force);
}

/* Input and state of the search. */
struct search {
    struct wb_three_point_model *model;
    const struct wb_law *law;
    const struct wb_three_point_data *data;
    const struct wb_three_point_fit_settings *settings;
    double deepest, bow, bow_deviation;
    double first_contact; /* the last one found */
    struct wb_three_point_run run;
    enum wb_status status;
};

/* Golden-section search of a minimum, without derivatives. */
static double find_valley(struct search *s, double (*height)(struct search *s, double x),
                          double low, double high, int sections)
{
    double a = high - golden * (high - low), b = low + golden * (high - low);
    double at_a = height(s, a), at_b = height(s, b);
    for (int i = 0; i < sections; i++) {
        if (at_a < at_b) {
            high = b;
            b = a;
            at_b = at_a;
            a = high - golden * (high - low);
            at_a = height(s, a);
        } else {
            low = a;
            a = b;
            at_a = at_b;
            b = low + golden * (high - low);
            at_b = height(s, b);
        }
    }
    return 0.5 * (low + high);
}

/* Sum of squares of a wire whose stiffness relative to the law is fitted. */
static double misfit_of_contact(struct search *s, double contact)
{
    const struct wb_three_point_data *const data = s->data;
    const double error = wb_three_point_place_error(data, s->settings);
    const double off =
        (contact - data->first_contact) / (s->settings->contact_prior * data->info.length);
    double mm = 0.0, mf = 0.0, ff = 0.0;
    for (int i = 0; i < wb_three_point_data_count_loading(data); i++) {
        const struct wb_three_point_point *const point = &data->points[i];
        const double force = wb_three_point_model_force(s->model, point->travel - contact, false);
        mm += point->force * point->force;
        mf += point->force * force;
        ff += force * force;
    }
    return (mm - (ff > 0.0 ? mf * mf / ff : 0.0)) / (error * error) + off * off;
}

/* The same of a bow, with its best contact. It has a single minimum, because curves are shifted
 * along a rise. */
static double misfit_of_bow(struct search *s, double bow)
{
    const double around = reach * s->settings->contact_prior * s->data->info.length;
    const double from = s->data->first_contact;
    if (s->status != WB_OK)
        return HUGE_VAL;
    s->status = wb_three_point_model_run(s->model, s->law,
                                         wb_three_point_model_curvature(&s->data->info, bow),
                                         s->deepest, false, &s->run);
    if (s->status != WB_OK || !s->run.reached)
        return HUGE_VAL;
    s->first_contact =
        find_valley(s, misfit_of_contact, from - around, from + around, CONTACT_SECTIONS);
    const double off = s->bow_deviation > 0.0 ? (bow - s->bow) / s->bow_deviation : 0.0;
    return misfit_of_contact(s, s->first_contact) + off * off;
}

enum wb_status wb_three_point_place_find(struct wb_three_point_place *place,
                                         struct wb_three_point_model *model,
                                         const struct wb_law *law,
                                         const struct wb_three_point_data *data, double deepest,
                                         const struct wb_three_point_fit_settings *settings,
                                         struct wb_three_point_run *run)
{
    struct search s = {.model = model,
                       .law = law,
                       .data = data,
                       .settings = settings,
                       .deepest = deepest,
                       .status = WB_OK};
    wb_three_point_place_bow(&data->info, settings, &s.bow, &s.bow_deviation);
    place->bow = s.bow;
    if (s.bow_deviation > 0.0)
        place->bow = find_valley(&s, misfit_of_bow, s.bow - reach * s.bow_deviation,
                                 s.bow + reach * s.bow_deviation, BOW_SECTIONS);
    (void)misfit_of_bow(&s, place->bow);
    place->first_contact = s.first_contact;
    *run = s.run;
    return s.status;
}
