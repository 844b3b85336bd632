/* Builds world, scene and panels of a year, and the interpolation weights of its suns, when each is
 * needed. */
#include "annual/year/year_inputs.h"

#include <stdlib.h>
#include <string.h>

#include "annual/year/scope.h"
#include "scene/swap.h"

/* ---- The world ------------------------------------------------------------------------------- */

static void warn_of_curved(struct orl_year *y)
{
    uint32_t first = 0;
    const size_t n = orl_annual_count_curved(y->world, &first);
    if (n == 0)
        return;
    const struct orl_surface_label label = orl_scene_label_of(y->world->scene, first);
    orl_year_warn(y,
                  "sunlight that %zu curved panes or polished surfaces mirror is left out (first: "
                  "%.100s at %.200s:%d): make them of flat pieces",
                  n, label.name, label.file, label.line);
}

static const char *name_of_part(const struct orl_year_variant *v, size_t part)
{
    return part == v->parts->n_groups ? "windows of no group" : v->swaps->at[part].of;
}

static int check_part(const struct orl_year *y, const size_t *n_ports, size_t part,
                      struct orl_error *err)
{
    const struct orl_year_variant *v = y->variant;
    if (n_ports[part] == 0)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "no surface of '%.100s' is a window to the outside: what light it "
                             "lets in is not told from the rest",
                             name_of_part(v, part));
    return v->sun_only ? 0
                       : orl_part_admit(y->world, (uint32_t)part + 1, name_of_part(v, part), err);
}

/* Returns 0 if light can be separated by the groups that are used. */
static int check_parts(const struct orl_year *y, struct orl_error *err)
{
    const struct orl_year_parts *parts = y->variant->parts;
    if (y->world->open) {
        size_t used = 0;
        while (used < parts->n_groups && !parts->used[used])
            used++;
        orl_error_set(err, ORL_ERR_UNSUPPORTED,
                      "light has other ways into the building than windows: what comes by '%.100s' "
                      "is not told from the rest",
                      name_of_part(y->variant, used));
        orl_error_hint(err, "close the building, or have one window group");
        return ORL_ERR_UNSUPPORTED;
    }
    size_t *n_ports = calloc(parts->n_groups + 1, sizeof *n_ports);
    int code = 0;
    if (!n_ports)
        return orl_year_no_memory(err);
    for (size_t i = 0; i < y->world->n_ports; i++)
        n_ports[orl_part_of_port(y->world, i, parts->n_groups)]++;
    for (size_t part = 0; part < parts->n_groups && code == 0; part++)
        if (parts->used[part])
            code = check_part(y, n_ports, part, err);
    free(n_ports);
    return code;
}

static int make_world(struct orl_year *y, struct orl_error *err)
{
    int code = orl_world_new(y->lights, y->env->run->crew, &y->world, err);
    if (code == 0)
        code = orl_annual_admit(y->world, err);
    if (code < 0 || !y->world)
        return code;
    if (y->variant && y->variant->parts)
        code = check_parts(y, err);
    if (code < 0)
        return code;
    warn_of_curved(y);
    if (y->world->n_emitters > 0)
        orl_year_warn(y, "the scene's lamps are left out: a year of daylight has no lamps on");
    y->world->n_emitters = 0;
    return 0;
}

/* ---- Sunlight on surfaces -------------------------------------------------------------------- */

static int refuse_open(struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_UNSUPPORTED,
                  "precomputed photons come in by windows: the building is open, or has none");
    orl_error_hint(err, "leave \"technique\" out: paths need no windows");
    return ORL_ERR_UNSUPPORTED;
}

static int refuse_large_map(struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_LIMIT,
                  "the map of sunlight indoors is too large: photons came to more than %d squares, "
                  "or left more than %d values there",
                  ORL_SUN_MAP_MOST_SQUARES, ORL_SUN_MAP_MOST_ENTRIES);
    orl_error_hint(err, "ask for fewer \"photons\"");
    return ORL_ERR_LIMIT;
}

/* Loads the map from the store, or traces photons and stores it. */
static int make_map(struct orl_year *y, struct orl_error *err)
{
    struct orl_keeping it = {.what = ORL_YEARS_MAP,
                             .core_s = orl_annual_scene_map_core_s(y->request, y->nodes.count)};
    void *data = NULL;
    size_t size = 0;
    y->scene.whole_map = y->request->technique == ORL_ANNUAL_PRECOMPUTED;
    const struct orl_sun_map_request request = orl_annual_scene_map_request(&y->scene, y->request);
    if (y->world->open || y->world->n_ports == 0)
        return y->scene.whole_map ? refuse_open(err) : 0;
    if (y->nodes.count == 0)
        return 0;
    int code = orl_keep_ask(&y->keep, &it, err);
    if (code < 0)
        return code;
    if (it.data)
        code = orl_sun_map_load(&request, it.data, &y->scene.map);
    else
        code = orl_sun_map_new(&request, y->env->run->crew, &y->scene.map);
    if (code == 0 && it.owed && orl_sun_map_save(y->scene.map, &data, &size) == 0)
        orl_keep_put(&y->keep, &it, data, size);
    free(data);
    orl_keep_done(&y->keep, &it);
    return code == ORL_ERR_LIMIT ? refuse_large_map(err)
           : code < 0            ? orl_year_failed(y, code, err)
                                 : 0;
}

static int make_scene(struct orl_year *y, struct orl_error *err)
{
    int code = make_world(y, err);
    if (code < 0)
        return code;
    code =
        orl_annual_scene_init(&y->scene, y->world, &y->bins, orl_turn_by(y->request->north_deg),
                              y->node_frames, y->nodes.count, y->nodes.a_circle, y->env->run->crew);
    if (code == 0 && y->variant && y->variant->parts)
        code = orl_annual_scene_split(&y->scene, y->variant->parts->n_groups);
    if (code < 0)
        return orl_year_failed(y, code, err);
    if (y->scene.mirrors.n_left_out > 0)
        orl_year_warn(y,
                      "flat mirrors and panes lie in more planes than a year follows: the sun's "
                      "reflections in %zu of them, the smallest, are left out",
                      y->scene.mirrors.n_left_out);
    return orl_year_is_sun_only(y) ? 0 : make_map(y, err);
}

int orl_year_need_scene(struct orl_year *y, struct orl_error *err)
{
    return y->world ? 0 : make_scene(y, err);
}

int orl_year_need_panels(struct orl_year *y, struct orl_error *err)
{
    int code = orl_year_need_scene(y, err);
    if (code < 0 || y->has_panels)
        return code;
    y->has_panels = true;
    code = orl_panels_init(&y->panels, &y->scene, &y->hours.suns, y->request->n_sensors,
                           y->request->seed, y->env->run->crew);
    if (code == ORL_ERR_LIMIT)
        return orl_error_set(err, code,
                             "more than %d kinds of BSDF panes, by material and "
                             "direction, are too many for a year",
                             ORL_PANEL_MOST_KINDS);
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

/* ---- Suns ------------------------------------------------------------------------------------ */

/* Header of stored suns. The arrays of the terms follow, then warnings, each with a terminating
 * zero. */
struct kept_suns {
    uint64_t n_beams, n_firsts, n_terms, n_warnings, text_bytes;
};

static size_t bytes_of(const struct kept_suns *k)
{
    return sizeof *k + k->n_firsts * sizeof(uint32_t) +
           k->n_terms * (sizeof(uint32_t) + 2 * sizeof(float)) + k->text_bytes;
}

static void *put_bytes(void *to, const void *from, size_t bytes)
{
    memcpy(to, from, bytes);
    return (char *)to + bytes;
}

static const void *get_bytes(void *to, const void *from, size_t bytes)
{
    memcpy(to, from, bytes);
    return (const char *)from + bytes;
}

/* first_warning: index in the result of the first warning about the light. */
static void store_suns(struct orl_year *y, struct orl_keeping *it, size_t first_warning)
{
    const struct orl_annual_result *r = y->result;
    const struct orl_sun_terms *terms = &y->terms;
    struct kept_suns k = {.n_beams = y->n_beams,
                          .n_firsts = y->hours.suns.count * (1 + terms->n_parts) + 1,
                          .n_warnings = r->n_warnings - first_warning};
    k.n_terms = terms->first[k.n_firsts - 1];
    for (size_t i = first_warning; i < r->n_warnings; i++)
        k.text_bytes += strlen(r->warnings[i]) + 1;
    k.text_bytes += (4 - k.text_bytes % 4) % 4;
    void *data = calloc(1, bytes_of(&k));
    if (!data)
        return;
    void *at = put_bytes(data, &k, sizeof k);
    at = put_bytes(at, terms->first, k.n_firsts * sizeof *terms->first);
    at = put_bytes(at, terms->which, k.n_terms * sizeof *terms->which);
    at = put_bytes(at, terms->weights, k.n_terms * sizeof *terms->weights);
    at = put_bytes(at, terms->apart, k.n_terms * sizeof *terms->apart);
    for (size_t i = first_warning; i < r->n_warnings; i++)
        at = put_bytes(at, r->warnings[i], strlen(r->warnings[i]) + 1);
    orl_keep_put(&y->keep, it, data, bytes_of(&k));
    free(data);
}

/* Reads stored suns. The file has passed its checks, so the data is as written. */
static int load_suns(struct orl_year *y, const void *data)
{
    struct orl_sun_terms *terms = &y->terms;
    struct kept_suns k;
    const void *at = get_bytes(&k, data, sizeof k);
    y->n_beams = k.n_beams;
    terms->n_parts = y->n_parts;
    terms->first = malloc((k.n_firsts + 1) * sizeof *terms->first);
    terms->which = malloc((k.n_terms + 1) * sizeof *terms->which);
    terms->weights = malloc((k.n_terms + 1) * sizeof *terms->weights);
    terms->apart = malloc((k.n_terms + 1) * sizeof *terms->apart);
    if (!terms->first || !terms->which || !terms->weights || !terms->apart)
        return ORL_ERR_NOMEM;
    at = get_bytes(terms->first, at, k.n_firsts * sizeof *terms->first);
    at = get_bytes(terms->which, at, k.n_terms * sizeof *terms->which);
    at = get_bytes(terms->weights, at, k.n_terms * sizeof *terms->weights);
    at = get_bytes(terms->apart, at, k.n_terms * sizeof *terms->apart);
    const char *text = at;
    for (size_t i = 0; i < k.n_warnings; i++, text += strlen(text) + 1)
        orl_year_warn(y, "%s", text);
    y->hushed = true;
    return 0;
}

static int make_suns(struct orl_year *y, struct orl_keeping *it, struct orl_error *err)
{
    const size_t first_warning = y->result->n_warnings;
    int code = orl_year_need_panels(y, err);
    if (code < 0)
        return code;
    y->n_beams = y->scene.map ? orl_sun_map_beams(y->scene.map)->count : 0;
    code = orl_sun_terms_init(&y->terms, &y->hours.suns, &y->nodes, y->node_frames, y->scene.map,
                              &y->scene.sobol, y->n_parts, y->env->run->crew);
    if (code < 0)
        return orl_year_failed(y, code, err);
    if (y->terms.n_lost > 0)
        orl_year_warn(y,
                      "sunlight of %zu of %zu positions of the sun is left out: it reaches windows "
                      "past what stands outside, and from no position that is followed indoors%s",
                      y->terms.n_lost, y->hours.suns.count,
                      y->request->sun_halvings < ORL_ANNUAL_MOST_HALVINGS
                          ? "; \"sun_halvings\" follows more"
                          : "");
    if (it->owed)
        store_suns(y, it, first_warning);
    return 0;
}

/* Time of a sun through a panel, in seconds of one core. */
static const double sun_s = 1e-4;

int orl_year_find_suns(struct orl_year *y, struct orl_error *err)
{
    struct orl_keeping it = {.what = ORL_YEARS_SUNS, /* their computation includes the map */
                             .core_s = orl_annual_scene_map_core_s(y->request, y->nodes.count) +
                                       sun_s * (double)y->hours.suns.count};
    if (orl_year_is_sun_only(y))
        return 0;
    int code = orl_keep_ask(&y->keep, &it, err);
    if (code == 0 && it.data)
        code = load_suns(y, it.data) < 0 ? orl_year_no_memory(err) : 0;
    else if (code == 0)
        code = make_suns(y, &it, err);
    orl_keep_done(&y->keep, &it);
    return code;
}

void orl_year_light_done(struct orl_year *y)
{
    orl_panels_done(&y->panels);
    orl_annual_scene_done(&y->scene);
    orl_world_free(y->world);
    orl_sun_terms_done(&y->terms);
}
