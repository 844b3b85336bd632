/* BSDF files: each file that loads must evaluate, sample and describe itself soundly. */
#include <string.h>

#include "bsdf_json/bsdf_json.h"
#include "fuzz/fuzz.h"

static void check_color(struct orl_rgb c)
{
    FUZZ_PROMISE(orl_rgb_is_finite(c) && c.r >= 0 && c.g >= 0 && c.b >= 0);
}

/* Checks that a sample has a pdf and that the overall albedo scale bounds its weight. */
static void check_sample(const struct orl_bsdf *bsdf, struct orl_vec3 given,
                         enum orl_bsdf_side sides, const double u[3])
{
    struct orl_vec3 drawn = {0, 0, 0};
    struct orl_rgb weight = {0, 0, 0};
    double pdf = -1;
    if (orl_bsdf_sample(bsdf, given, sides, u, &drawn, &weight, &pdf)) {
        fuzz_check_unit(drawn);
        check_color(weight);
        FUZZ_PROMISE(isfinite(pdf) && pdf > 0);
        const double other = orl_bsdf_pdf(bsdf, given, sides, drawn);
        FUZZ_PROMISE(isfinite(other) && other >= 0);
    }
    if (orl_bsdf_sample_adjoint(bsdf, given, sides, u, &drawn, &weight, &pdf)) {
        fuzz_check_unit(drawn);
        check_color(weight);
        FUZZ_PROMISE(isfinite(pdf) && pdf > 0);
        const double other = orl_bsdf_pdf_adjoint(bsdf, given, sides, drawn);
        FUZZ_PROMISE(isfinite(other) && other >= 0);
    }
}

/* Checks that the straight transmittance and the straight samples are shares of the light. */
static void check_straight(const struct orl_bsdf *bsdf, struct orl_vec3 given, const double u[3])
{
    check_color(orl_bsdf_straight(bsdf, given));
    for (int adjoint = 0; adjoint < 2; adjoint++) {
        struct orl_bsdf_sample_result draw;
        if (!orl_bsdf_sample_split(bsdf, given, adjoint, ORL_BSDF_BOTH, u, &draw))
            continue;
        fuzz_check_unit(draw.direction);
        check_color(draw.weight);
        FUZZ_PROMISE(isfinite(draw.pdf) && (draw.straight || draw.pdf > 0));
        const double part = orl_bsdf_straight_part(bsdf, given, draw.direction);
        FUZZ_PROMISE(part >= 0 && part <= 1);
    }
}

static void check_direction(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                            const struct orl_vec3 *directions, size_t count)
{
    static const double u[3][3] = {{0, 0, 0}, {0.5, 0.25, 0.75}, {0x1.fffffp-1, 0x1.fffffp-1, 0.1}};
    for (size_t i = 0; i < count; i++)
        check_color(orl_bsdf_eval(bsdf, in, directions[i]));
    for (int sides = ORL_BSDF_REFLECT; sides <= ORL_BSDF_BOTH; sides++) {
        check_color(orl_bsdf_albedo(bsdf, in, (enum orl_bsdf_side)sides));
        for (size_t i = 0; i < 3; i++)
            check_sample(bsdf, in, (enum orl_bsdf_side)sides, u[i]);
    }
    for (size_t i = 0; i < 3; i++)
        check_straight(bsdf, in, u[i]);
}

static void check_info(const struct orl_bsdf *bsdf)
{
    struct orl_bsdf_info info;
    orl_bsdf_describe(bsdf, &info);
    FUZZ_PROMISE(memchr(info.name, '\0', sizeof info.name) != NULL);
    FUZZ_PROMISE(memchr(info.kind, '\0', sizeof info.kind) != NULL);
    FUZZ_PROMISE(info.values > 0 && info.resolution > 0);
    FUZZ_PROMISE(isfinite(info.max_albedo[0]) && isfinite(info.max_albedo[1]));
    FUZZ_PROMISE(isfinite(info.thickness_m));
    json_t *json = orl_bsdf_info_to_json(&info);
    FUZZ_PROMISE(json != NULL);
    json_decref(json);
}

/* Runs the check made on upload and writes its report as JSON. */
static void check_check(const struct orl_bsdf *bsdf)
{
    struct orl_bsdf_check check;
    orl_bsdf_examine(bsdf, &check);
    FUZZ_PROMISE(check.n_verdicts <= ORL_BSDF_VERDICTS_MAX);
    for (size_t i = 0; i < check.n_verdicts; i++)
        FUZZ_PROMISE(memchr(check.verdicts[i].text, '\0', ORL_BSDF_VERDICT_TEXT) != NULL);
    json_t *json = orl_bsdf_check_to_json(&check);
    FUZZ_PROMISE(json != NULL);
    json_decref(json);
}

bool fuzz_bsdf(const uint8_t *data, size_t size)
{
    const struct orl_vec3 directions[] = {{0, 0, 1},       {0, 0, -1},         {1, 0, 0},
                                          {0.6, 0, 0.8},   {0, -0.6, -0.8},    {-0.8, 0, 0.6},
                                          {0, 0.28, 0.96}, {-0.48, 0.64, -0.6}};
    const size_t count = sizeof directions / sizeof *directions;
    struct orl_bsdf *bsdf = NULL;
    struct orl_error err = {0};
    const int code = orl_bsdf_load_xml("made.xml", (const char *)data, size, &bsdf, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(bsdf == NULL);
        return false;
    }
    for (size_t i = 0; i < count; i++)
        check_direction(bsdf, directions[i], directions, count);
    for (int front = 0; front < 2; front++)
        for (int through = 0; through < 2; through++)
            check_color(orl_bsdf_diffuse(bsdf, front, through));
    check_info(bsdf);
    check_check(bsdf);
    orl_bsdf_unref(bsdf);
    return true;
}
