#include "bsdf_json/bsdf_compare_json.h"

static json_t *place_to_json(const struct orl_bsdf_angles *place)
{
    return json_pack("{s:f, s:f}", "theta_deg", place->theta_deg, "phi_deg", place->phi_deg);
}

static json_t *color_to_json(const struct orl_bsdf_color_difference *d)
{
    return json_pack("{s:{s:f, s:o}, s:{s:f, s:o, s:o}}", "albedo", "worst", d->albedo_worst,
                     "from", place_to_json(&d->albedo_from), "cone_2deg", "worst", d->cone_worst,
                     "from", place_to_json(&d->cone_from), "to", place_to_json(&d->cone_to));
}

static json_t *part_to_json(const struct orl_bsdf_difference *d)
{
    return json_pack("{s:{s:f, s:f, s:o}, s:{s:f, s:o, s:o}, s:{s:f, s:f, s:o}, s:o}", "albedo",
                     "rms", d->albedo_rms, "worst", d->albedo_worst, "from",
                     place_to_json(&d->albedo_from), "cone_2deg", "worst", d->cone_worst, "from",
                     place_to_json(&d->cone_from), "to", place_to_json(&d->cone_to), "moved",
                     "mean", d->moved_mean, "worst", d->moved_worst, "from",
                     place_to_json(&d->moved_from), "any_color", color_to_json(&d->color));
}

static json_t *side_to_json(const struct orl_bsdf_difference of[2])
{
    return json_pack("{s:o, s:o}", "reflected", part_to_json(&of[0]), "transmitted",
                     part_to_json(&of[1]));
}

json_t *orl_bsdf_comparison_to_json(const struct orl_bsdf_comparison *comparison)
{
    return json_pack("{s:o, s:o}", "front", side_to_json(comparison->of[1]), "back",
                     side_to_json(comparison->of[0]));
}
