#include <oriel/job/floor_plan.h>
#include <oriel/job/run.h>

#include <math.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "light/daylight/weather.h"
#include "render/heat_map/heat_map.h"
#include "run/cache/scene_cache.h"
#include "run/request/job_inputs.h"
#include "scene/built/scene.h"
#include "scene/geometry/instances.h"
#include "scene/parse/parse.h"

static int copy_references(const struct orl_scene *scene, struct orl_scene_summary *summary)
{
    const struct orl_parsed_scene *d = &scene->parsed_scene;
    const size_t n = d->n_files - d->source.n_main;
    summary->referenced = calloc(n + 1, sizeof *summary->referenced);
    if (!summary->referenced)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++) {
        summary->referenced[i] = strdup(d->files[d->source.n_main + i]);
        if (!summary->referenced[i])
            return ORL_ERR_NOMEM;
        summary->n_referenced++;
    }
    return 0;
}

static void summarise(const struct orl_scene *scene, struct orl_scene_summary *summary)
{
    const struct orl_parsed_scene *d = &scene->parsed_scene;
    const struct orl_geometry *g = scene->geometry;
    const struct orl_vec3 low = orl_add(g->low, g->center), high = orl_add(g->high, g->center);
    summary->placed_surfaces = orl_parsed_scene_count_surfaces(d);
    summary->surfaces = d->n_surfaces;
    summary->materials = d->n_materials;
    summary->sources = d->n_distant_sources;
    summary->triangles = orl_geometry_count_triangles(g);
    for (size_t i = 0; i < g->n_prototypes; i++) {
        summary->surfaces += g->prototypes[i]->n_facets;
        summary->triangles += orl_geometry_count_triangles(g->prototypes[i]);
    }
    for (size_t i = 0; i < d->n_materials; i++)
        summary->bsdfs += d->materials[i].kind == ORL_MATERIAL_BSDF;
    summary->bounds_min[0] = low.x;
    summary->bounds_min[1] = low.y;
    summary->bounds_min[2] = low.z;
    summary->bounds_max[0] = high.x;
    summary->bounds_max[1] = high.y;
    summary->bounds_max[2] = high.z;
    sodium_bin2hex(summary->digest, sizeof summary->digest, d->digest, sizeof d->digest);
}

int orl_prepare_thread(struct orl_error *err)
{
    return orl_geometry_prepare_thread(err);
}

/* Reads a scene; the caller owns *ret_scene, which may be NULL. material_overrides: materials that
 * shades give windows, or NULL. */
static int read_overridden(const char *const *main_files, size_t n_files,
                           const struct orl_files *files,
                           const struct orl_material_overrides *material_overrides,
                           const atomic_bool *cancel, struct orl_scene **ret_scene,
                           struct orl_error *err)
{
    const struct orl_bsdf_loader loader = {.cancel = cancel};
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_sources sources;
    *ret_scene = NULL;
    orl_sources_init(&sources, files, &loader, orl_arena_new());
    int code = orl_scene_parse_opened(main_files, n_files, &sources, material_overrides != NULL,
                                      &parsed_scene, err);
    parsed_scene.cancel = cancel;
    if (code == 0 && material_overrides) {
        code = orl_material_overrides_apply(material_overrides, n_files, &parsed_scene, err);
        if (code < 0)
            orl_parsed_scene_done(&parsed_scene);
    }
    return code ? code : orl_scene_new(&parsed_scene, ret_scene, err);
}

static int read_scene(const char *const *main_files, size_t n_files, const struct orl_files *files,
                      const atomic_bool *cancel, struct orl_scene **ret_scene,
                      struct orl_error *err)
{
    return read_overridden(main_files, n_files, files, NULL, cancel, ret_scene, err);
}

int orl_run_measure_overridden(const char *const *main_files, size_t n_files,
                               const struct orl_files *files,
                               const struct orl_material_overrides *material_overrides,
                               struct orl_scene_summary *ret_summary, struct orl_error *err)
{
    struct orl_scene_summary summary = {0};
    struct orl_scene *scene = NULL;
    const int code =
        read_overridden(main_files, n_files, files, material_overrides, NULL, &scene, err);
    if (code == 0)
        summarise(scene, &summary);
    orl_scene_release(scene);
    if (code == 0)
        *ret_summary = summary;
    return code;
}

int orl_views_check(const struct orl_job *job, const struct orl_files *files, struct orl_error *err)
{
    struct orl_view_request *views;
    const int code = orl_run_resolve_views(job, files, &views, err);
    if (views != job->views)
        orl_run_views_done(job, views);
    return code;
}

int orl_scene_check(const char *const *main_files, size_t n_files, const struct orl_files *files,
                    const atomic_bool *cancel, struct orl_scene_summary *ret_summary,
                    struct orl_error *err)
{
    struct orl_scene_summary summary = {0};
    struct orl_scene *scene = NULL;
    int code = read_scene(main_files, n_files, files, cancel, &scene, err);
    if (code == 0) {
        summarise(scene, &summary);
        code = copy_references(scene, &summary);
        if (code < 0)
            orl_error_set(err, code, "out of memory");
    }
    orl_scene_release(scene);
    if (code < 0)
        orl_scene_summary_done(&summary);
    else
        *ret_summary = summary;
    return code;
}

/* ---- The floor plan -------------------------------------------------------------------------- */

struct section_lines {
    double (*lines)[4];
    size_t count, room;
    bool no_memory;
};

static void add_section_line(void *ctx, const double from[2], const double to[2])
{
    struct section_lines *p = ctx;
    if (p->count == p->room) {
        const size_t room = p->room ? 2 * p->room : 256;
        void *lines = reallocarray(p->lines, room, sizeof *p->lines);
        p->no_memory = p->no_memory || !lines;
        if (!lines)
            return;
        p->lines = lines;
        p->room = room;
    }
    double *line = p->lines[p->count++];
    memcpy(line, from, 2 * sizeof *line);
    memcpy(line + 2, to, 2 * sizeof *line);
}

static int longest_first(const void *a, const void *b)
{
    const double *p = a, *q = b;
    const double one = hypot(p[2] - p[0], p[3] - p[1]), other = hypot(q[2] - q[0], q[3] - q[1]);
    return (one < other) - (one > other);
}

static int cut_scene(const struct orl_geometry *g, struct orl_floor_plan *plan,
                     struct orl_error *err)
{
    const struct orl_sensor_plane plane = {
        .normal = {0, 0, 1}, .u = {1, 0, 0}, .v = {0, 1, 0}, .offset = plan->height};
    struct section_lines section_lines = {0};
    orl_section_cut(g, &plane, add_section_line, &section_lines);
    if (section_lines.no_memory) {
        free(section_lines.lines);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    plan->more = section_lines.count > ORL_FLOOR_PLAN_LINES;
    if (plan->more)
        qsort(section_lines.lines, section_lines.count, sizeof *section_lines.lines, longest_first);
    plan->lines = section_lines.lines;
    plan->count = plan->more ? ORL_FLOOR_PLAN_LINES : section_lines.count;
    return 0;
}

int orl_scene_floor_plan(const char *const *main_files, size_t n_files,
                         const struct orl_files *files, double height,
                         struct orl_floor_plan *ret_plan, struct orl_error *err)
{
    struct orl_scene *scene = NULL;
    *ret_plan = (struct orl_floor_plan){.height = height};
    int code = read_scene(main_files, n_files, files, NULL, &scene, err);
    if (code == 0) {
        const struct orl_geometry *g = scene->geometry;
        const struct orl_vec3 low = orl_add(g->low, g->center), high = orl_add(g->high, g->center);
        memcpy(ret_plan->low, (double[]){low.x, low.y, low.z}, sizeof ret_plan->low);
        memcpy(ret_plan->high, (double[]){high.x, high.y, high.z}, sizeof ret_plan->high);
        if (isnan(height))
            ret_plan->height = 0.5 * (low.z + high.z);
        code = cut_scene(g, ret_plan, err);
    }
    orl_scene_release(scene);
    return code;
}

void orl_floor_plan_done(struct orl_floor_plan *plan)
{
    free(plan->lines);
    *plan = (struct orl_floor_plan){0};
}

/* ---- Other files ----------------------------------------------------------------------------- */

int orl_weather_check(const char *name, const char *text, size_t size, int year,
                      struct orl_error *err)
{
    struct orl_weather weather = {0};
    const int code = orl_weather_parse(name, text, size, year, &weather, err);
    if (code == 0)
        orl_weather_done(&weather);
    return code;
}

void orl_scene_summary_done(struct orl_scene_summary *summary)
{
    if (!summary)
        return;
    orl_texts_free(summary->referenced, summary->n_referenced);
    memset(summary, 0, sizeof *summary);
}
