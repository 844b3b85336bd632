#include "bsdf_json/bsdf_json.h"

/* Returns "zero", "copy" or json null. */
static json_t *dummy_to_json(enum orl_bsdf_placeholder kind)
{
    if (kind == ORL_BSDF_NO_PLACEHOLDER)
        return json_null();
    return json_string(kind == ORL_BSDF_PLACEHOLDER_ZERO ? "zero" : "copy");
}

json_t *orl_bsdf_info_to_json(const struct orl_bsdf_info *info)
{
    json_t *components = json_pack("{s:b, s:b, s:b, s:b}", "reflection_front", (int)info->has[1][0],
                                   "reflection_back", (int)info->has[0][0], "transmission_front",
                                   (int)info->has[1][1], "transmission_back", (int)info->has[0][1]);
    /* Names that are not UTF-8 become null, so that the rest is still returned. */
    json_t *name = json_string(info->name);
    return json_pack(
        "{s:o, s:s, s:i, s:I, s:I, s:o, s:{s:o, s:o}, s:{s:f, s:f}, s:f, s:b, s:b, s:I, s:I}",
        "name", name ? name : json_null(), "kind", info->kind, "resolution", info->resolution,
        "values", (json_int_t)info->values, "bytes", (json_int_t)info->bytes, "components",
        components, "dummy", "transmission_front", dummy_to_json(info->dummy[1]),
        "transmission_back", dummy_to_json(info->dummy[0]), "max_albedo", "front",
        info->max_albedo[1], "back", info->max_albedo[0], "thickness_m", info->thickness_m,
        "colored", (int)info->colored, "color_left_out", (int)info->color_left_out, "out_of_gamut",
        (json_int_t)info->out_of_gamut, "clamped", (json_int_t)info->clamped);
}

/* ---- The check ------------------------------------------------------------------------------- */

/* Returns {"front": front, "back": back}; takes both references. */
static json_t *both_sides_to_json(json_t *front, json_t *back)
{
    return json_pack("{s:o, s:o}", "front", front, "back", back);
}

static json_t *directions_to_json(const struct orl_bsdf_hemispherical *h)
{
    json_t *list = json_array();
    for (int i = 0; i < ORL_BSDF_CHECK_DIRECTIONS; i++)
        json_array_append_new(list, json_pack("{s:f, s:f, s:f, s:f}", "theta_deg", h[i].theta_deg,
                                              "phi_deg", h[i].phi_deg, "reflected", h[i].reflected,
                                              "transmitted", h[i].transmitted));
    return list;
}

static json_t *extremes_to_json(const struct orl_bsdf_extremes *x)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f}", "least", x->least, "mean", x->mean, "most",
                     x->most, "most_theta_deg", x->most_theta_deg, "most_phi_deg", x->most_phi_deg);
}

/* Extremes of one component, which has a coarse maximum besides. */
static json_t *component_extremes_to_json(const struct orl_bsdf_extremes *x)
{
    json_t *json = extremes_to_json(x);
    if (json) {
        json_object_set_new(json, "most_coarse", json_real(x->most_coarse));
        json_object_set_new(json, "even", json_real(x->even));
    }
    return json;
}

static json_t *side_extremes_to_json(const struct orl_bsdf_check *check, int front)
{
    return json_pack("{s:o, s:o, s:o}", "reflected",
                     component_extremes_to_json(&check->extremes[front][0]), "transmitted",
                     component_extremes_to_json(&check->extremes[front][1]), "total",
                     extremes_to_json(&check->total[front]));
}

/* Returns json null if there was nothing to compare (value < 0). */
static json_t *share_to_json(double value)
{
    return value < 0 ? json_null() : json_real(value);
}

static json_t *peak_to_json(const struct orl_bsdf_peak *p)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "theta_deg", p->theta_deg, "phi_deg",
                     p->phi_deg, "cell_sr", p->cell_sr, "smear", p->smear, "share", p->share,
                     "straight", p->straight, "dgp_loss_max", p->dgp_loss);
}

static json_t *redirection_to_json(const struct orl_bsdf_redirection by_origin[2])
{
    return json_pack("{s:{s:f, s:f}, s:{s:f, s:f}}", "from_above", "transmitted",
                     by_origin[1].transmitted, "upward", by_origin[1].upward, "from_below",
                     "transmitted", by_origin[0].transmitted, "upward", by_origin[0].upward);
}

static json_t *verdicts_to_json(const struct orl_bsdf_check *check)
{
    json_t *list = json_array();
    for (size_t i = 0; i < check->n_verdicts; i++)
        json_array_append_new(list, json_pack("{s:s, s:s}", "level",
                                              orl_bsdf_level_name(check->verdicts[i].level), "text",
                                              check->verdicts[i].text));
    return list;
}

json_t *orl_bsdf_check_to_json(const struct orl_bsdf_check *c)
{
    json_t *check = json_pack(
        "{s:s, s:o, s:o, s:o, s:{s:o, s:o, s:o}, s:{s:o, s:o}, s:o}", "verdict",
        orl_bsdf_level_name(c->worst), "verdicts", verdicts_to_json(c), "hemispherical",
        both_sides_to_json(directions_to_json(c->directions[1]),
                           directions_to_json(c->directions[0])),
        "extremes", both_sides_to_json(side_extremes_to_json(c, 1), side_extremes_to_json(c, 0)),
        "irreciprocal", "reflection_front", share_to_json(c->irreciprocal_reflection[1]),
        "reflection_back", share_to_json(c->irreciprocal_reflection[0]), "transmission",
        share_to_json(c->irreciprocal_transmission), "straight_through", "normal",
        peak_to_json(&c->normal), "strongest", peak_to_json(&c->strongest), "redirection",
        both_sides_to_json(redirection_to_json(c->redirection[1]),
                           redirection_to_json(c->redirection[0])));
    json_t *json = orl_bsdf_info_to_json(&c->info);
    if (json_object_set_new(json, "check", check) == 0)
        return json;
    json_decref(json);
    return NULL;
}

/* ---- Distribution of light from one direction ------------------------------------------------ */

static json_t *hemisphere_to_json(const double values[ORL_POLAR_THETAS][ORL_POLAR_PHIS])
{
    json_t *rows = json_array();
    int rc = rows ? 0 : -1;
    for (int i = 0; i < ORL_POLAR_THETAS && rc == 0; i++) {
        json_t *row = json_array();
        for (int k = 0; k < ORL_POLAR_PHIS && rc == 0; k++)
            rc = json_array_append_new(row, json_real(values[i][k]));
        if (json_array_append_new(rows, row))
            rc = -1;
    }
    if (rc == 0)
        return rows;
    json_decref(rows);
    return NULL;
}

json_t *orl_bsdf_polar_to_json(const struct orl_bsdf_polar *polar, bool front, double theta_deg,
                               double phi_deg)
{
    return json_pack("{s:s, s:f, s:f, s:f, s:f, s:f, s:o, s:o}", "from", front ? "front" : "back",
                     "theta_deg", theta_deg, "phi_deg", phi_deg, "reflected", polar->reflected,
                     "transmitted", polar->transmitted, "straight", polar->straight, "reflection",
                     hemisphere_to_json(polar->values[0]), "transmission",
                     hemisphere_to_json(polar->values[1]));
}

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
