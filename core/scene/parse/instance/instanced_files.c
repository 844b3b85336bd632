#include "scene/parse/instance/instanced_files.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "base/memory/memory.h"
#include "function/function.h"
#include "scene/material/patterns/pattern.h"
#include "scene/material/scatter.h"
#include "scene/parse/parser.h"
#include "scene/surfaces.h"

enum { LEAST_SURFACES = 64, LEAST_PLACES = 4 };

/* ---- While files are read -------------------------------------------------------------------- */

/* Returns true if a file that was read matches the key in that scope. Patterns that depend on
 * normals differ between inverted and other places. */
static bool stands_for(const struct orl_instanced_file *item,
                       const struct orl_instanced_file_key *key, const struct orl_scope *scope)
{
    const struct orl_instanced_file_key *const own = &item->key;
    return own->data == key->data && own->is_mesh == key->is_mesh &&
           own->is_modified == key->is_modified && own->kind == key->kind &&
           own->index == key->index &&
           !(item->has_patterns && item->to_file.inverted != scope->xform.inverted);
}

/* Returns the scope's prefix with its full stop, followed by the name; NULL if out of memory. */
static const char *prefixed(struct orl_parser *parser, const struct orl_scope *scope,
                            const char *name)
{
    const size_t front = scope->prefix ? strlen(scope->prefix) : 0, length = strlen(name);
    char *const text = orl_arena_alloc_chars(parser->out->arena, front + length + 2);
    if (!text)
        return NULL;
    if (front > 0)
        memcpy(text, scope->prefix, front);
    text[front] = '.';
    memcpy(text + front + (scope->prefix ? 1 : 0), name, length + 1);
    return text;
}

struct orl_parser_counts orl_parser_counts_now(const struct orl_parser *parser)
{
    const struct orl_parsed_scene *const d = parser->out;
    return (struct orl_parser_counts){.surfaces = d->n_surfaces,
                                      .distant_sources = d->n_distant_sources,
                                      .skies = d->n_skies,
                                      .refused = parser->refusals.n,
                                      .places = parser->instanced_files.n_places,
                                      .patterns = d->n_patterns};
}

int orl_instanced_files_place(struct orl_parser *parser, const struct orl_instanced_file_key *key,
                              const struct orl_scope *scope, const char *id, struct orl_error *err)
{
    struct orl_instanced_files *const r = &parser->instanced_files;
    size_t at = 0;
    while (at < r->n && !stands_for(&r->items[at], key, scope))
        at++;
    if (at == r->n)
        return 0;
    const struct orl_xform xform = orl_xform_compose(&scope->xform, &r->items[at].to_file);
    if (r->n_places >= ORL_LIMIT_INSTANCES)
        return orl_error_set(err, ORL_ERR_LIMIT, "more than %lu instances and meshes",
                             ORL_LIMIT_INSTANCES);
    const char *const name = key->is_mesh ? prefixed(parser, scope, id) : NULL;
    const char *const prefix = prefixed(parser, scope, "");
    if ((key->is_mesh && !name) || !prefix ||
        !orl_array_reserve(&r->places, &r->places_room, r->n_places, sizeof *r->places))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    r->places[r->n_places++] =
        (struct orl_placement){.prototype = (uint32_t)at,
                               .xform = xform,
                               .name = name,
                               .prefix = prefix,
                               .before = parser->out->n_surfaces,
                               .main_file = parser->out->source.n_first_surfaces - 1};
    r->items[at].n_places++;
    return 1;
}

/* Returns true for plastic or metal without anisotropy axis, and for trans like a leaf, whose
 * transmission is diffuse. */
static bool is_simple(const struct orl_material *m)
{
    if (!orl_material_is_reflector(m))
        return false;
    const struct orl_reflector *const reflector = orl_reflector_of(m);
    const struct orl_vec3 axis = reflector->anisotropy_axis;
    const bool directed =
        m->kind == ORL_MATERIAL_TRANS && reflector->shares.transmitted_specular != 0;
    return !directed && !(orl_dot(axis, axis) > 0) &&
           reflector->diffuse_side == ORL_DIFFUSE_SIDE_BOTH;
}

static bool is_varied(const struct orl_material *m)
{
    return m->pattern || m->texture || orl_material_roughness_pattern(m);
}

static uint64_t inputs_of(const struct orl_pattern *p,
                          uint64_t (*inputs)(const struct orl_function *function))
{
    return (p->program.function ? inputs(p->program.function) : 0) |
           (p->program.values ? inputs(p->program.values) : 0);
}

/* Returns true if a pattern, with those under it and those it mixes, gives in each place the values
 * of the first place. */
static bool moves_along(const struct orl_pattern *pattern, size_t first_within)
{
    const uint64_t mesh = UINT64_C(1) << ORL_RAY_LU | UINT64_C(1) << ORL_RAY_LV;
    const uint64_t data = ~UINT64_C(0) << ORL_RAY_DATA;
    bool moves = true;
    for (const struct orl_pattern *p = pattern; p && moves; p = p->under) {
        const bool within = p->index >= first_within;
        moves = p->source == ORL_PATTERN_MESH_NORMALS || p->source == ORL_PATTERN_CONSTANT ||
                (within ? inputs_of(p, orl_function_fixed_inputs) == 0
                        : p->source != ORL_PATTERN_TEXT &&
                              !(inputs_of(p, orl_function_inputs) & ~mesh & ~data));
        for (int i = 0; p->role == ORL_PATTERN_BLEND && i < 2 && moves; i++)
            moves = moves_along(orl_blend_of(p)->mixed[i].pattern, first_within);
    }
    return moves;
}

static bool is_plain(const struct orl_parser *parser, const struct orl_material *m,
                     size_t first_within)
{
    if (!is_simple(m) || (is_varied(m) && parser->instanced_files.plain))
        return false;
    return moves_along(m->pattern, first_within) && moves_along(m->texture, first_within) &&
           moves_along(orl_material_roughness_pattern(m), first_within);
}

static bool is_fit(const struct orl_parser *parser, const struct orl_parser_counts *before,
                   bool *ret_varied)
{
    *ret_varied = false;
    const struct orl_parsed_scene *const d = parser->out;
    const struct orl_parser_counts now = orl_parser_counts_now(parser);
    if (now.surfaces < before->surfaces + LEAST_SURFACES ||
        now.distant_sources > before->distant_sources || now.skies > before->skies ||
        now.refused > before->refused || now.places > before->places)
        return false;
    for (size_t i = before->surfaces; i < now.surfaces; i++) {
        const struct orl_material *const m = &d->materials[d->surfaces[i].material];
        if (!is_plain(parser, m, before->patterns))
            return false;
        *ret_varied = *ret_varied || is_varied(m);
    }
    return true;
}

int orl_instanced_files_add(struct orl_parser *parser, const struct orl_instanced_file_key *key,
                            const struct orl_parser_counts *before, const struct orl_scope *scope,
                            struct orl_error *err)
{
    struct orl_instanced_files *const r = &parser->instanced_files;
    bool has_patterns;
    if (!is_fit(parser, before, &has_patterns))
        return 0;
    const char *const prefix = prefixed(parser, scope, "");
    /* Files read within this one belong to it, and are not instanced in other places yet. */
    while (r->n > 0 && r->items[r->n - 1].first >= before->surfaces)
        r->n--;
    if (!prefix || !orl_array_reserve(&r->items, &r->room, r->n, sizeof *r->items))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    r->items[r->n++] =
        (struct orl_instanced_file){.key = *key,
                                    .first = before->surfaces,
                                    .end = parser->out->n_surfaces,
                                    .main_file = parser->out->source.n_first_surfaces - 1,
                                    .prefix = prefix,
                                    .has_patterns = has_patterns,
                                    .to_file = orl_xform_inverse(&scope->xform)};
    return 0;
}

/* ---- After reading --------------------------------------------------------------------------- */

/* Orders all placements as in the files; the place where a file was read comes behind those named
 * there before. */
static void order_places(const struct orl_instanced_files *r, struct orl_parsed_scene *d)
{
    size_t next = 0;
    for (size_t i = 0; i < r->n; i++) {
        const struct orl_instanced_file *const item = &r->items[i];
        if (item->n_places == 0)
            continue;
        while (next < r->n_places && r->places[next].before <= item->first)
            d->placements[d->n_placements++] = r->places[next++];
        d->placements[d->n_placements++] = (struct orl_placement){.prototype = (uint32_t)i,
                                                                  .xform = orl_xform_identity,
                                                                  .prefix = item->prefix,
                                                                  .before = item->first,
                                                                  .main_file = item->main_file};
    }
    while (next < r->n_places)
        d->placements[d->n_placements++] = r->places[next++];
}

/* Makes a prototype of the surfaces of an instanced file. */
static bool make_prototype(const struct orl_instanced_file *item, struct orl_parsed_scene *d)
{
    struct orl_prototype *const prototype = &d->prototypes[d->n_prototypes];
    const size_t n = item->end - item->first;
    prototype->surfaces = malloc(n * sizeof *prototype->surfaces);
    if (!prototype->surfaces)
        return false;
    memcpy(prototype->surfaces, d->surfaces + item->first, n * sizeof *prototype->surfaces);
    prototype->n_surfaces = n;
    prototype->prefix_bytes = strlen(item->prefix);
    prototype->has_patterns = item->has_patterns;
    d->n_prototypes++;
    return true;
}

/* Returns the number of surfaces taken out before index; *next: the first instanced file not yet
 * passed. */
static size_t count_before(const struct orl_instanced_files *r, size_t index, size_t *next,
                           size_t *gone)
{
    for (; *next < r->n && r->items[*next].end <= index; ++*next)
        if (r->items[*next].n_places > 0)
            *gone += r->items[*next].end - r->items[*next].first;
    return *gone;
}

/* Closes the gaps in the surfaces, and adjusts indices of surfaces. */
static void close_gaps(const struct orl_instanced_files *r, struct orl_parsed_scene *d)
{
    size_t kept = 0, from = 0, next = 0, gone = 0;
    for (size_t i = 0; i < d->n_placements; i++)
        d->placements[i].before -= count_before(r, d->placements[i].before, &next, &gone);
    next = gone = 0;
    for (size_t i = 0; i < d->source.n_first_surfaces; i++)
        d->source.first_surfaces[i] -= count_before(r, d->source.first_surfaces[i], &next, &gone);
    for (size_t i = 0; i <= r->n; i++) {
        const bool last = i == r->n;
        const size_t to = last ? d->n_surfaces : r->items[i].first;
        if (!last && r->items[i].n_places == 0)
            continue;
        memmove(d->surfaces + kept, d->surfaces + from, (to - from) * sizeof *d->surfaces);
        kept += to - from;
        from = last ? to : r->items[i].end;
    }
    d->n_surfaces = kept;
}

int orl_instanced_files_finish(struct orl_instanced_files *r, struct orl_parsed_scene *d,
                               struct orl_error *err)
{
    uint32_t *const numbers = malloc((r->n + 1) * sizeof *numbers);
    int code = numbers ? 0 : ORL_ERR_NOMEM;
    if (code < 0 || r->n_places == 0)
        goto done;
    code = ORL_ERR_NOMEM;
    d->prototypes = calloc(r->n, sizeof *d->prototypes);
    d->placements = malloc((r->n_places + r->n) * sizeof *d->placements);
    if (!d->prototypes || !d->placements)
        goto done;
    for (size_t i = 0; i < r->n; i++) {
        numbers[i] = (uint32_t)d->n_prototypes;
        if (r->items[i].n_places > 0 && !make_prototype(&r->items[i], d))
            goto done;
    }
    order_places(r, d);
    close_gaps(r, d);
    for (size_t i = 0; i < d->n_placements; i++)
        d->placements[i].prototype = numbers[d->placements[i].prototype];
    code = orl_placements_expand(d, LEAST_PLACES, err);
done:
    free(numbers);
    return code == ORL_ERR_NOMEM ? orl_error_set(err, code, "out of memory") : code;
}

void orl_instanced_files_done(struct orl_instanced_files *instanced_files)
{
    free(instanced_files->items);
    free(instanced_files->places);
    *instanced_files = (struct orl_instanced_files){.n = 0};
}
