/* Builds lit scene, scene data and BSDF panes of a year, and the interpolation weights of its suns,
 * when each is needed. */
#include "annual/year/annual_year.h"

#include <stdlib.h>
#include <string.h>

#include "annual/year/annual_scene.h"
#include "scene/surfaces.h"

/* ---- The lit scene --------------------------------------------------------------------------- */

static void warn_of_curved(struct orl_year *y)
{
    uint32_t first = 0;
    const size_t n = orl_annual_count_curved(y->lit_scene, &first);
    if (n == 0)
        return;
    const struct orl_surface_label label = orl_scene_label_of(y->lit_scene->scene, first);
    orl_year_warn(y,
                  "sunlight mirrored by %zu curved panes or polished surfaces is left out (first: "
                  "%.100s at %.200s:%d): build them of flat pieces",
                  n, label.name, label.file, label.line);
}

static const char *name_of_window_group(const struct orl_year_overrides *v, size_t window_group)
{
    return window_group == v->window_groups->n_groups ? "windows without a group"
                                                      : v->material_overrides->at[window_group].of;
}

static int check_window_group(const struct orl_year *y, const size_t *n_ports, size_t window_group,
                              struct orl_error *err)
{
    const struct orl_year_overrides *v = y->overrides;
    if (n_ports[window_group] == 0)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "no surface of '%.100s' is a window to the outside, so its light "
                             "cannot be separated from the rest",
                             name_of_window_group(v, window_group));
    return v->sun_only ? 0
                       : orl_window_group_check_near(y->lit_scene, (uint32_t)window_group + 1,
                                                     name_of_window_group(v, window_group), err);
}

/* Returns 0 if light can be separated by the groups that are used. */
static int check_window_groups(const struct orl_year *y, struct orl_error *err)
{
    const struct orl_year_window_groups *window_groups = y->overrides->window_groups;
    if (y->lit_scene->open) {
        size_t used = 0;
        while (used < window_groups->n_groups && !window_groups->used[used])
            used++;
        orl_error_set(err, ORL_ERR_UNSUPPORTED,
                      "light enters the building other than through windows, so the light of "
                      "'%.100s' cannot be separated",
                      name_of_window_group(y->overrides, used));
        orl_error_hint(err, "close the building, or use one window group");
        return ORL_ERR_UNSUPPORTED;
    }
    size_t *n_ports = calloc(window_groups->n_groups + 1, sizeof *n_ports);
    int code = 0;
    if (!n_ports)
        return orl_year_no_memory(err);
    for (size_t i = 0; i < y->lit_scene->n_ports; i++)
        n_ports[orl_window_group_of_port(y->lit_scene, i, window_groups->n_groups)]++;
    for (size_t window_group = 0; window_group < window_groups->n_groups && code == 0;
         window_group++)
        if (window_groups->used[window_group])
            code = check_window_group(y, n_ports, window_group, err);
    free(n_ports);
    return code;
}

static int make_lit_scene(struct orl_year *y, struct orl_error *err)
{
    int code = orl_lit_scene_new(y->lights, y->env->run->pool, &y->lit_scene, err);
    if (code == 0)
        code = orl_annual_check_supported(y->lit_scene, err);
    if (code < 0 || !y->lit_scene)
        return code;
    if (y->overrides->window_groups)
        code = check_window_groups(y, err);
    if (code < 0)
        return code;
    warn_of_curved(y);
    if (y->lit_scene->n_emitters > 0)
        orl_year_warn(y, "the scene's lamps are left out: annual jobs simulate daylight only");
    y->lit_scene->n_emitters = 0;
    return 0;
}

/* ---- Sunlight on surfaces -------------------------------------------------------------------- */

static int refuse_open(struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_UNSUPPORTED,
                  "precomputed photons need windows: the building is open, or has none");
    orl_error_hint(err, "leave \"technique\" out: paths need no windows");
    return ORL_ERR_UNSUPPORTED;
}

static int refuse_large_map(struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_LIMIT,
                  "the map of sunlight indoors is too large: it has more than %d texels, or more "
                  "than %d values",
                  ORL_SUN_MAP_MOST_TEXELS, ORL_SUN_MAP_MOST_ENTRIES);
    orl_error_hint(err, "ask for fewer \"photons\"");
    return ORL_ERR_LIMIT;
}

/* Loads the map from the store, or traces photons and stores it. */
static int make_map(struct orl_year *y, struct orl_error *err)
{
    struct orl_annual_cache_entry entry = {
        .data_kind = ORL_ANNUAL_CACHE_SUN_MAP,
        .core_s = orl_annual_scene_map_core_s(y->request, y->nodes.count)};
    y->scene.map_interreflection = y->request->technique == ORL_ANNUAL_PRECOMPUTED;
    const struct orl_sun_map_request request = orl_annual_scene_map_request(&y->scene, y->request);
    if (y->lit_scene->open || y->lit_scene->n_ports == 0)
        return y->scene.map_interreflection ? refuse_open(err) : 0;
    if (y->nodes.count == 0)
        return 0;
    int code = orl_annual_cache_get(&y->cache, &entry, err);
    if (code < 0)
        return code;
    if (entry.data)
        code = orl_sun_map_load(&request, entry.data, entry.size, &y->scene.map);
    else
        code = orl_sun_map_new(&request, y->env->run->pool, &y->scene.map);
    if (code == 0 && entry.must_commit) {
        size_t size = 0;
        void *data = orl_sun_map_save(y->scene.map, &size);
        orl_annual_cache_put(&y->cache, &entry, data, size);
    }
    orl_annual_cache_release(&y->cache, &entry);
    return code == ORL_ERR_LIMIT ? refuse_large_map(err)
           : code < 0            ? orl_year_failed(y, code, err)
                                 : 0;
}

static int make_scene(struct orl_year *y, struct orl_error *err)
{
    int code = make_lit_scene(y, err);
    if (code < 0)
        return code;
    y->scene = (struct orl_annual_scene){.lit_scene = y->lit_scene,
                                         .bins = &y->bins,
                                         .north = orl_sky_rotation_by_north(y->request->north_deg),
                                         .nodes = y->node_frames,
                                         .n_nodes = y->nodes.count,
                                         .nodes_per_circle = y->nodes.nodes_per_circle,
                                         .n_window_groups = y->n_window_groups};
    code = orl_annual_scene_init(&y->scene, y->env->run->pool);
    if (code < 0)
        return orl_year_failed(y, code, err);
    if (y->scene.mirrors.n_left_out > 0)
        orl_year_warn(y,
                      "flat mirrors and panes lie in too many planes: the sun's reflections in the "
                      "%zu smallest are left out",
                      y->scene.mirrors.n_left_out);
    return y->overrides->sun_only ? 0 : make_map(y, err);
}

int orl_year_ensure_scene(struct orl_year *y, struct orl_error *err)
{
    return y->lit_scene ? 0 : make_scene(y, err);
}

int orl_year_ensure_bsdf_panes(struct orl_year *y, struct orl_error *err)
{
    int code = orl_year_ensure_scene(y, err);
    if (code < 0 || y->has_bsdf_panes)
        return code;
    y->has_bsdf_panes = true;
    code = orl_bsdf_panes_init(&y->bsdf_panes, &y->scene, &y->hours.suns, y->request->n_sensors,
                               y->request->seed, y->env->run->pool);
    if (code == ORL_ERR_LIMIT)
        return orl_error_set(err, code,
                             "more than %d kinds of BSDF panes (material and direction) are too "
                             "many for an annual job",
                             ORL_BSDF_PANE_MOST_KINDS);
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

/* ---- Suns ------------------------------------------------------------------------------------ */

/* Header of stored suns. The arrays of the weights follow, then warnings, each with a terminating
 * zero. */
struct stored_weights {
    uint64_t n_beams, n_firsts, n_weights, n_warnings, text_bytes;
};

/* Lists the parts of stored suns. text: the warnings; NULL: there are none to copy. */
enum { STORED_PARTS = 6 };
static void list_parts(struct stored_weights *k, const struct orl_sun_weights *w, char *text,
                       struct orl_span ret_parts[STORED_PARTS])
{
    ret_parts[0] = (struct orl_span){k, sizeof *k};
    ret_parts[1] = (struct orl_span){w->first, k->n_firsts * sizeof *w->first};
    ret_parts[2] = (struct orl_span){w->which, k->n_weights * sizeof *w->which};
    ret_parts[3] = (struct orl_span){w->weights, k->n_weights * sizeof *w->weights};
    ret_parts[4] = (struct orl_span){w->difference, k->n_weights * sizeof *w->difference};
    ret_parts[5] = (struct orl_span){text, k->text_bytes};
}

/* first_warning: index in the result of the first warning about the light. */
static void store_sun_weights(struct orl_year *y, struct orl_annual_cache_entry *entry,
                              size_t first_warning)
{
    const struct orl_annual_result *r = y->result;
    struct stored_weights k = {.n_beams = y->n_beams,
                               .n_firsts =
                                   y->hours.suns.count * (1 + y->sun_weights.n_window_groups) + 1,
                               .n_warnings = r->n_warnings - first_warning};
    struct orl_span parts[STORED_PARTS];
    size_t size = 0;
    k.n_weights = y->sun_weights.first[k.n_firsts - 1];
    for (size_t i = first_warning; i < r->n_warnings; i++)
        k.text_bytes += strlen(r->warnings[i]) + 1;
    k.text_bytes += (4 - k.text_bytes % 4) % 4;
    char *text = calloc(1, k.text_bytes + 1), *at = text;
    for (size_t i = first_warning; text && i < r->n_warnings; i++)
        at = stpcpy(at, r->warnings[i]) + 1;
    list_parts(&k, &y->sun_weights, text, parts);
    void *data = text ? orl_spans_join(parts, STORED_PARTS, &size) : NULL;
    orl_annual_cache_put(&y->cache, entry, data, size);
    free(text);
}

/* Reads stored suns. The file has passed its checks, so the data is as written. */
static int load_sun_weights(struct orl_year *y, const struct orl_annual_cache_entry *entry)
{
    struct orl_span parts[STORED_PARTS];
    struct stored_weights k;
    memcpy(&k, entry->data, sizeof k);
    char *texts = malloc(k.text_bytes + 1);
    y->n_beams = k.n_beams;
    y->sun_weights.n_window_groups = y->n_window_groups;
    orl_sun_weights_allocate(&y->sun_weights, k.n_firsts, k.n_weights);
    list_parts(&k, &y->sun_weights, texts, parts);
    const bool room = texts && !y->sun_weights.arrays.failed;
    if (room)
        orl_spans_fill(parts, STORED_PARTS, entry->data, entry->size);
    const char *text = texts;
    for (size_t i = 0; room && i < k.n_warnings; i++, text += strlen(text) + 1)
        orl_year_warn(y, "%s", text);
    free(texts);
    y->warnings_emitted = true;
    return room ? 0 : ORL_ERR_NOMEM;
}

static int compute_sun_weights(struct orl_year *y, struct orl_annual_cache_entry *entry,
                               struct orl_error *err)
{
    const size_t first_warning = y->result->n_warnings;
    int code = orl_year_ensure_bsdf_panes(y, err);
    if (code < 0)
        return code;
    y->n_beams = y->scene.map ? orl_sun_map_beams(y->scene.map)->count : 0;
    code =
        orl_sun_weights_init(&y->sun_weights, &y->hours.suns, &y->nodes, y->node_frames,
                             y->scene.map, &y->scene.sobol, y->n_window_groups, y->env->run->pool);
    if (code < 0)
        return orl_year_failed(y, code, err);
    if (y->sun_weights.n_lost > 0)
        orl_year_warn(y,
                      "sunlight of %zu of %zu sun positions is left out: it reaches windows that "
                      "obstructions block for all simulated positions%s",
                      y->sun_weights.n_lost, y->hours.suns.count,
                      y->request->sun_halvings < ORL_ANNUAL_MOST_HALVINGS
                          ? "; raise \"sun_halvings\" to simulate more positions"
                          : "");
    if (entry->must_commit)
        store_sun_weights(y, entry, first_warning);
    return 0;
}

/* Time of a sun through a BSDF pane, in seconds of one core. */
static const double sun_s = 1e-4;

int orl_year_find_sun_weights(struct orl_year *y, struct orl_error *err)
{
    struct orl_annual_cache_entry entry = {
        .data_kind = ORL_ANNUAL_CACHE_SUN_WEIGHTS, /* their computation includes the map */
        .core_s = orl_annual_scene_map_core_s(y->request, y->nodes.count) +
                  sun_s * (double)y->hours.suns.count};
    if (y->overrides->sun_only)
        return 0;
    int code = orl_annual_cache_get(&y->cache, &entry, err);
    if (code == 0 && entry.data)
        code = load_sun_weights(y, &entry) < 0 ? orl_year_no_memory(err) : 0;
    else if (code == 0)
        code = compute_sun_weights(y, &entry, err);
    orl_annual_cache_release(&y->cache, &entry);
    return code;
}

void orl_year_inputs_done(struct orl_year *y)
{
    orl_bsdf_panes_done(&y->bsdf_panes);
    orl_annual_scene_done(&y->scene);
    orl_lit_scene_free(y->lit_scene);
    orl_sun_weights_done(&y->sun_weights);
}
