/* Converts a BSDF to another basis: measures the file in place of a panel. A cull may be found by
 * trials. */
#include <math.h>

#include <oriel/bsdf/bsdf_convert.h>

#include "bsdf/make/make_bsdf.h"
#include "bsdf/make/panel/panel.h"

static int check_request(const struct orl_bsdf_make_request *to, struct orl_error *err)
{
    if (to->accuracy > 0 || to->paths > 0)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "paths and accuracy do not apply when a BSDF is converted");
    return orl_bsdf_make_validate(to, err);
}

int orl_bsdf_convert(const struct orl_bsdf *bsdf, const char *source,
                     const struct orl_bsdf_make_request *to, const struct orl_bsdf_make_env *env,
                     struct orl_bsdf_make_result *ret_result, struct orl_error *err)
{
    struct orl_bsdf_info info;
    struct orl_bsdf_make_request request = *to;
    int code = check_request(to, err);
    if (code < 0)
        return code;
    orl_bsdf_describe(bsdf, &info);
    if (!request.name)
        request.name = info.name;
    const struct orl_gonio_sample sample = {
        .file = bsdf, .source = source, .depth = {0, info.thickness_m}};
    code = orl_gonio_measure(&request, env, &sample, ret_result, err);
    if (code == 0)
        ret_result->paths = 0;
    return code;
}

/* ---- Cull by trials: by light that changes direction, not by a share of each cell's value ---- */

/* Number of trials, and the largest cull tried, as a share of the incident light that a cell may
 * redirect. */
enum { TRIALS = 12 };
static const double max_cull_fraction = 0.1;

/* Parameters of one conversion in the search. */
struct trial {
    const struct orl_bsdf *bsdf;
    const char *source;
    const struct orl_bsdf_make_request *to;
    const struct orl_bsdf_make_env *env;
};

static double worst_of(const struct orl_bsdf_comparison *c, bool color)
{
    double worst = 0;
    for (int i = 0; i < 4; i++) {
        const struct orl_bsdf_difference *d = &c->of[i / 2][i % 2];
        worst = fmax(worst, fmax(fabs(d->albedo_worst), fabs(d->cone_worst)));
        if (color)
            worst = fmax(worst, fmax(fabs(d->color.albedo_worst), fabs(d->color.cone_worst)));
    }
    return worst;
}

static int try_cull(const struct trial *trial, double cull_fraction,
                    struct orl_bsdf_make_result *ret_result, struct orl_bsdf_comparison *ret_lost,
                    struct orl_error *err)
{
    struct orl_bsdf_make_request to = *trial->to;
    struct orl_bsdf *after = NULL;
    to.cull = 0;
    to.cull_fraction = cull_fraction;
    int code = orl_bsdf_convert(trial->bsdf, trial->source, &to, trial->env, ret_result, err);
    if (code < 0)
        return code;
    code = orl_bsdf_load_xml("culled.xml", ret_result->xml, ret_result->xml_size, &after, err);
    if (code == 0)
        code = orl_bsdf_compare(trial->bsdf, after, trial->env->pool, trial->env->cancel, ret_lost,
                                err);
    orl_bsdf_unref(after);
    if (code < 0)
        orl_bsdf_make_result_done(ret_result);
    return code;
}

/* Makes this trial the best so far. */
static void take_trial(struct orl_bsdf_make_result *result, const struct orl_bsdf_comparison *lost,
                       struct orl_bsdf_make_result *ret_result,
                       struct orl_bsdf_comparison *ret_lost)
{
    orl_bsdf_make_result_done(ret_result);
    *ret_result = *result;
    *ret_lost = *lost;
}

/* Finds the largest cull that is allowed, by bisection. best and ret_lost: in: result and
 * differences of the least cull; out: of the cull found. */
static int search_cull(const struct trial *trial, double within, double *ret_cull_fraction,
                       struct orl_bsdf_make_result *best, struct orl_bsdf_comparison *ret_lost,
                       struct orl_error *err)
{
    double low = ORL_BSDF_CULL_FRACTION, high = max_cull_fraction, middle = high;
    for (int i = 0; i < TRIALS && low < high; i++) {
        struct orl_bsdf_make_result result = {0};
        struct orl_bsdf_comparison lost;
        const int code = try_cull(trial, middle, &result, &lost, err);
        if (code < 0)
            return code;
        if (worst_of(&lost, trial->to->color) <= within) {
            take_trial(&result, &lost, best, ret_lost);
            *ret_cull_fraction = low = middle;
        } else {
            orl_bsdf_make_result_done(&result);
            high = middle;
        }
        middle = sqrt(low * high);
    }
    return 0;
}

/* Checks that the resolution alone does not lose more. */
static int check_resolution(const struct orl_bsdf_comparison *lost, bool color, double within,
                            struct orl_error *err)
{
    const double worst = worst_of(lost, color);
    if (worst <= within)
        return 0;
    orl_error_set(err, ORL_ERR_RANGE,
                  "even without a cull, the resolution loses or misplaces %.2g %% of the light; "
                  "the limit is %.2g %%",
                  100 * worst, 100 * within);
    orl_error_hint(err, "Ask for a finer resolution, or allow a larger loss");
    return ORL_ERR_RANGE;
}

int orl_bsdf_convert_within(const struct orl_bsdf *bsdf, const char *source,
                            const struct orl_bsdf_make_request *to, double within,
                            const struct orl_bsdf_make_env *env, double *ret_cull_fraction,
                            struct orl_bsdf_make_result *ret_result,
                            struct orl_bsdf_comparison *ret_lost, struct orl_error *err)
{
    const struct trial trial = {bsdf, source, to, env};
    struct orl_bsdf_make_result best = {0};
    if (!orl_bsdf_basis_is_tree(to->basis) || !(within > 0 && within < 1))
        return orl_error_set(
            err, ORL_ERR_INVALID,
            "a limit on the lost light must be above 0 and below 1, and needs a tensor tree");
    *ret_cull_fraction = ORL_BSDF_CULL_FRACTION;
    int code = try_cull(&trial, ORL_BSDF_CULL_FRACTION, &best, ret_lost, err);
    if (code < 0)
        return code;
    code = check_resolution(ret_lost, to->color, within, err);
    if (code == 0)
        code = search_cull(&trial, within, ret_cull_fraction, &best, ret_lost, err);
    if (code == 0)
        *ret_result = best;
    else
        orl_bsdf_make_result_done(&best);
    return code;
}
