#include "bsdf_json.h"

json_t *orl_bsdf_info_to_json(const struct orl_bsdf_info *info)
{
    json_t *components = json_pack("{s:b, s:b, s:b, s:b}", "reflection_front", (int)info->has[1][0],
                                   "reflection_back", (int)info->has[0][0], "transmission_front",
                                   (int)info->has[1][1], "transmission_back", (int)info->has[0][1]);
    /* A name that is not UTF-8 is left out rather than failing the whole. */
    json_t *name = json_string(info->name);
    return json_pack("{s:o, s:s, s:i, s:I, s:I, s:o, s:{s:f, s:f}, s:f, s:I}", "name",
                     name ? name : json_null(), "kind", info->kind, "resolution", info->resolution,
                     "values", (json_int_t)info->values, "bytes", (json_int_t)info->bytes,
                     "components", components, "max_albedo", "front", info->max_albedo[1], "back",
                     info->max_albedo[0], "thickness_m", info->thickness_m, "clamped",
                     (json_int_t)info->clamped);
}
