/*
 * Surfaces and distant sources. Transforms leave a surface's front where Radiance's xform puts it:
 * polygons of a mirrored scene are listed backwards, all surfaces of an inverted one are flipped.
 * References: xform(1) and "The RADIANCE Synthetic Imaging System", section 2.1.1.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "base/memory/memory.h"
#include "scene/parse/parser.h"
#include "scene/surfaces.h"

struct surface_type {
    const char *name;
    enum orl_surface_kind kind;
    size_t n_reals;
};

static const struct surface_type surface_types[] = {
    {"polygon", ORL_SURFACE_POLYGON, 0}, {"sphere", ORL_SURFACE_SPHERE, 4},
    {"bubble", ORL_SURFACE_BUBBLE, 4},   {"cylinder", ORL_SURFACE_CYLINDER, 7},
    {"tube", ORL_SURFACE_TUBE, 7},       {"cone", ORL_SURFACE_CONE, 8},
    {"cup", ORL_SURFACE_CUP, 8},         {"ring", ORL_SURFACE_RING, 8},
};

static const struct surface_type *find_type(const char *name)
{
    for (size_t i = 0; i < sizeof surface_types / sizeof *surface_types; i++)
        if (strcmp(surface_types[i].name, name) == 0)
            return surface_types + i;
    return NULL;
}

bool orl_parser_is_surface(const char *type)
{
    return find_type(type) || strcmp(type, "source") == 0;
}

static int out_of_memory(struct orl_parser *parser, const struct orl_scope *scope,
                         struct orl_error *err)
{
    return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
}

/* Returns the modifier of the current primitive, or the one that the scope sets. */
static const char *modifier_of(const struct orl_parser *parser, const struct orl_scope *scope)
{
    return scope->modifier ? scope->modifier : parser->primitive.modifier;
}

/* Finds the material of the current primitive, with the scope's override; *ret_order: order of its
 * modifier's definition, unchanged for void. */
static int find_material(struct orl_parser *parser, const struct orl_scope *scope,
                         uint32_t *ret_index, uint32_t *ret_order, struct orl_error *err)
{
    const char *name = modifier_of(parser, scope);
    const struct orl_symbol *symbol = orl_symbols_find(&parser->symbols, name);
    if (symbol && symbol->kind == ORL_SYMBOL_REFUSED) {
        const int code = orl_deferred_use(&parser->deferred, symbol->index, &parser->refusals, err);
        if (code < 0)
            return code;
    }
    if (strcmp(name, "void") == 0 || (symbol && symbol->kind == ORL_SYMBOL_REFUSED))
        return orl_parser_void(parser, ret_index) < 0 ? out_of_memory(parser, scope, err) : 0;
    if (!symbol)
        return orl_parser_refuse(parser, scope, err, ORL_ERR_NOT_FOUND,
                                 "a material must be defined before the surfaces that use it; is a "
                                 "materials file missing, or listed too late?",
                                 "its modifier '%.200s' is not defined", name);
    if (symbol->kind != ORL_SYMBOL_MATERIAL)
        return orl_parser_refuse(parser, scope, err, ORL_ERR_UNSUPPORTED,
                                 "apply the pattern to a glow or light, and that to the surface",
                                 "its modifier '%.200s' is a pattern, not a material", name);
    *ret_index = symbol->index;
    *ret_order = symbol->order;
    if (parser->normals && orl_parser_smooth(parser, symbol->index, ret_index) < 0)
        return out_of_memory(parser, scope, err);
    return 0;
}

/* Makes the name with the scope's prefix, in that arena. A prefix is written once and repeated in
 * every copy, so the total is limited. */
static int make_name(struct orl_parser *parser, const struct orl_scope *scope,
                     struct orl_arena *arena, char **ret_name, struct orl_error *err)
{
    const char *id = parser->primitive.id;
    const size_t length = strlen(id), front = scope->prefix ? strlen(scope->prefix) + 1 : 0;
    parser->name_bytes += front + length + 1;
    if (parser->name_bytes > ORL_LIMIT_NAME_BYTES)
        return orl_parser_refuse(
            parser, scope, err, ORL_ERR_LIMIT, "use shorter names, or fewer copies by xform -a",
            "the names of the scene's surfaces, including prefixes by xform -n, take "
            "more than %lu MiB",
            ORL_LIMIT_NAME_BYTES >> 20);
    char *name = orl_arena_alloc_chars(arena, front + length + 1);
    if (!name)
        return out_of_memory(parser, scope, err);
    if (front > 0) {
        memcpy(name, scope->prefix, front - 1);
        name[front - 1] = '.';
    }
    memcpy(name + front, id, length + 1);
    *ret_name = name;
    return 0;
}

static struct orl_vec3 real3(const struct orl_parser *parser, size_t i)
{
    const double *r = parser->primitive.reals + i;
    return orl_v3(r[0], r[1], r[2]);
}

/* Limit of coordinates: rays are traced in single precision, which holds squares and products up to
 * here. */
static const double farthest = 1e12;

static bool in_reach(struct orl_vec3 v)
{
    return fabs(v.x) < farthest && fabs(v.y) < farthest && fabs(v.z) < farthest;
}

static int too_far(struct orl_parser *parser, const struct orl_scope *scope, struct orl_error *err)
{
    return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                           "its transformed coordinates are too large");
}

/* Drops a surface without extent with a warning, as Radiance's programs do. */
static int drop_surface(struct orl_parser *parser, const struct orl_scope *scope, bool *ret_keep)
{
    orl_parser_tally(parser, scope, &parser->degenerate);
    *ret_keep = false;
    return 0;
}

/* ---- Polygons -------------------------------------------------------------------------------- */

/* Transforms the vertices, in reverse order if the front would change sides. */
static int copy_vertices(struct orl_parser *parser, const struct orl_scope *scope,
                         struct orl_surface *surface, struct orl_error *err)
{
    const bool backwards = scope->xform.mirrored != scope->xform.inverted;
    size_t n = parser->primitive.n_reals / 3;
    const struct orl_vec3 first = real3(parser, 0), last = real3(parser, 3 * (n - 1));
    if (n > 3 && first.x == last.x && first.y == last.y && first.z == last.z)
        n--; /* drops a repeated first corner */
    parser->vertices += n;
    if (parser->vertices > 8 * (uint64_t)ORL_LIMIT_SURFACES)
        return orl_parser_fail(parser, scope, err, ORL_ERR_LIMIT, "the scene has too many corners");
    const size_t uv_bytes = parser->uv ? 2 * sizeof *parser->uv : 0;
    const size_t normal_bytes = parser->normals ? sizeof *parser->normals : 0;
    surface->vertices = orl_arena_alloc(parser->out->outlines,
                                        n * (sizeof *surface->vertices + uv_bytes + normal_bytes));
    if (!surface->vertices)
        return out_of_memory(parser, scope, err);
    surface->n_vertices = (uint32_t)n;
    surface->has_uv = parser->uv != NULL;
    surface->has_normals = parser->normals != NULL;
    double *const uv = (double *)(surface->vertices + n);
    char *const normals = (char *)uv + n * uv_bytes;
    for (size_t i = 0; i < n; i++) {
        const size_t from = backwards ? n - 1 - i : i;
        const struct orl_vec3 p = orl_xform_point(&scope->xform, real3(parser, 3 * from));
        surface->vertices[i] = p;
        if (parser->uv)
            memcpy(uv + 2 * i, parser->uv + 2 * from, uv_bytes);
        if (parser->normals) {
            const struct orl_vec3 turned =
                orl_normalize(orl_xform_vector(&scope->xform, parser->normals[from]));
            const struct orl_vec3 normal = scope->xform.inverted ? orl_neg(turned) : turned;
            memcpy(normals + i * normal_bytes, &normal, normal_bytes);
        }
        if (!in_reach(p))
            return too_far(parser, scope, err);
    }
    return 0;
}

/* Twice the area times the normal, by Newell's method about the first corner. */
static struct orl_vec3 newell(const struct orl_surface *surface)
{
    const struct orl_vec3 origin = surface->vertices[0];
    struct orl_vec3 sum = {0, 0, 0}, before = {0, 0, 0};
    for (uint32_t i = 1; i < surface->n_vertices; i++) {
        const struct orl_vec3 now = orl_sub(surface->vertices[i], origin);
        sum = orl_add(sum, orl_cross(before, now));
        before = now;
    }
    return sum;
}

/* The largest distance of a corner from the first, squared. */
static double extent2(const struct orl_surface *surface)
{
    double largest = 0;
    for (uint32_t i = 1; i < surface->n_vertices; i++) {
        const struct orl_vec3 d = orl_sub(surface->vertices[i], surface->vertices[0]);
        largest = fmax(largest, orl_dot(d, d));
    }
    return largest;
}

/* Returns the distance along the normal between the corners that are farthest apart. */
static double bend_of(const struct orl_surface *surface)
{
    double low = 0, high = 0;
    for (uint32_t i = 1; i < surface->n_vertices; i++) {
        const double d =
            orl_dot(surface->normal, orl_sub(surface->vertices[i], surface->vertices[0]));
        low = fmin(low, d);
        high = fmax(high, d);
    }
    return high - low;
}

/* Counts polygons whose corners are off the mean plane by more than a thousandth of the size. */
static void count_nonplanar(struct orl_parser *parser, const struct orl_scope *scope,
                            const struct orl_surface *surface, double size)
{
    const double bend = surface->n_vertices > 3 ? bend_of(surface) : 0;
    if (!(bend > 1e-3 * size))
        return;
    parser->largest_bend = fmax(parser->largest_bend, bend);
    orl_parser_tally(parser, scope, &parser->nonplanar);
}

/* Sets the polygon's vertices and normal; *ret_keep is false if it has no area. */
static int read_polygon(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_surface *surface, bool *ret_keep, struct orl_error *err)
{
    const size_t n_reals = parser->primitive.n_reals;
    if (parser->primitive.n_strings != 0 || n_reals < 9 || n_reals % 3 != 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "a polygon needs three numbers per corner and at least three "
                               "corners, but has %zu numbers",
                               n_reals);
    if (n_reals / 3 > ORL_LIMIT_POLYGON_VERTICES)
        return orl_parser_fail(parser, scope, err, ORL_ERR_LIMIT,
                               "the polygon has %zu corners, more than %u", n_reals / 3,
                               ORL_LIMIT_POLYGON_VERTICES);
    const int code = copy_vertices(parser, scope, surface, err);
    if (code < 0)
        return code;
    const struct orl_vec3 area = newell(surface);
    const double size2 = extent2(surface);
    /* Rounding alone gives a line an "area" of some 1e-16 of its length squared. */
    *ret_keep = isnormal(orl_dot(area, area)) && orl_length(area) > 1e-13 * size2;
    if (!*ret_keep)
        return drop_surface(parser, scope, ret_keep);
    surface->normal = orl_normalize(area);
    count_nonplanar(parser, scope, surface, sqrt(size2));
    return 0;
}

/* ---- Quadrics and rings ---------------------------------------------------------------------- */

static int check_radius(struct orl_parser *parser, const struct orl_scope *scope, double radius,
                        bool *ret_keep, struct orl_error *err)
{
    if (radius > 0)
        return 0;
    if (radius == 0)
        return drop_surface(parser, scope, ret_keep);
    return orl_parser_refuse(parser, scope, err, ORL_ERR_RANGE,
                             "for a surface that faces inwards use bubble, tube or cup",
                             "its radius %g is not positive", radius);
}

static int read_sphere(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_quadric *quadric, bool *ret_keep, struct orl_error *err)
{
    quadric->center[0] = orl_xform_point(&scope->xform, real3(parser, 0));
    quadric->radius[0] = parser->primitive.reals[3] * scope->xform.scale;
    return check_radius(parser, scope, parser->primitive.reals[3], ret_keep, err);
}

/* Reads cylinder, tube (one radius), cone and cup (two, one of which may be 0). */
static int read_cone(struct orl_parser *parser, const struct orl_scope *scope,
                     struct orl_quadric *quadric, bool *ret_keep, struct orl_error *err)
{
    const double *r = parser->primitive.reals;
    const bool straight = parser->primitive.n_reals == 7;
    const struct orl_vec3 axis = orl_sub(real3(parser, 3), real3(parser, 0));
    if (!straight && (r[6] < 0 || r[7] < 0))
        return check_radius(parser, scope, fmin(r[6], r[7]), ret_keep, err);
    for (size_t i = 0; i < 2; i++) {
        quadric->center[i] = orl_xform_point(&scope->xform, real3(parser, 3 * i));
        quadric->radius[i] = (straight ? r[6] : r[6 + i]) * scope->xform.scale;
    }
    if (!(orl_length(axis) > 0))
        return drop_surface(parser, scope, ret_keep);
    return check_radius(parser, scope, straight ? r[6] : fmax(r[6], r[7]), ret_keep, err);
}

static int read_ring(struct orl_parser *parser, const struct orl_scope *scope,
                     struct orl_surface *surface, struct orl_quadric *quadric, bool *ret_keep,
                     struct orl_error *err)
{
    const double *r = parser->primitive.reals;
    const double inner = fmin(r[6], r[7]), outer = fmax(r[6], r[7]);
    struct orl_vec3 normal = orl_normalize(orl_xform_vector(&scope->xform, real3(parser, 3)));
    if (inner < 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its radii %g and %g are not both positive", r[6], r[7]);
    if (!(fabs(orl_length(normal) - 1.0) < 1e-6) || !(outer > inner))
        return drop_surface(parser, scope, ret_keep);
    quadric->center[0] = orl_xform_point(&scope->xform, real3(parser, 0));
    surface->normal = scope->xform.inverted ? orl_neg(normal) : normal;
    quadric->radius[0] = inner * scope->xform.scale;
    quadric->radius[1] = outer * scope->xform.scale;
    return 0;
}

/* *ret_keep becomes false if the surface has no extent. */
static int read_quadric(struct orl_parser *parser, const struct orl_scope *scope,
                        const struct surface_type *type, struct orl_surface *surface,
                        bool *ret_keep, struct orl_error *err)
{
    struct orl_quadric *const quadric = orl_arena_alloc(parser->out->outlines, sizeof *quadric);
    int code = orl_parser_expect(parser, scope, 0, type->n_reals, err);
    if (code < 0)
        return code;
    if (!quadric)
        return out_of_memory(parser, scope, err);
    *quadric = orl_quadric_none;
    if (type->kind == ORL_SURFACE_RING)
        code = read_ring(parser, scope, surface, quadric, ret_keep, err);
    else if (type->n_reals == 4)
        code = read_sphere(parser, scope, quadric, ret_keep, err);
    else
        code = read_cone(parser, scope, quadric, ret_keep, err);
    if (code == 0 && (!in_reach(quadric->center[0]) || !in_reach(quadric->center[1]) ||
                      !(quadric->radius[0] < farthest) || !(quadric->radius[1] < farthest)))
        code = too_far(parser, scope, err);
    surface->quadric = quadric;
    return code;
}

/* ---- All surfaces ---------------------------------------------------------------------------- */

/* A BSDF's up vector must not be parallel to the normal: its azimuth would be undefined. */
static int check_up(struct orl_parser *parser, const struct orl_scope *scope,
                    const struct orl_surface *surface, struct orl_error *err)
{
    const struct orl_material *material = parser->out->materials + surface->material;
    if (!orl_bsdf_up_is_undefined(material, surface))
        return 0;
    const struct orl_vec3 up = orl_bsdf_surface_of(material)->up;
    return orl_parser_refuse(
        parser, scope, err, ORL_ERR_RANGE,
        "tilt it a little, for example 0.01 0.01 1, or give the direction that is up in the pane",
        "the up vector (%g %g %g) of BSDF '%.100s' is parallel to the surface's normal", up.x, up.y,
        up.z, material->name);
}

static int keep_surface(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_surface *surface, struct orl_error *err)
{
    struct orl_parsed_scene *out = parser->out;
    int code = check_up(parser, scope, surface, err);
    if (code < 0)
        return code;
    if (out->n_surfaces >= ORL_LIMIT_SURFACES)
        return orl_parser_fail(parser, scope, err, ORL_ERR_LIMIT,
                               "the scene has more than %lu surfaces", ORL_LIMIT_SURFACES);
    code = make_name(parser, scope, out->outlines, &surface->name, err);
    if (code < 0)
        return code;
    if (out->materials[surface->material].kind == ORL_MATERIAL_VOID) {
        orl_parser_tally(parser, scope, &parser->unmodified);
        return 0;
    }
    if (!orl_array_reserve(&out->surfaces, &parser->surfaces_room, out->n_surfaces,
                           sizeof *out->surfaces))
        return out_of_memory(parser, scope, err);
    out->surfaces[out->n_surfaces++] = *surface;
    return 0;
}

static int fail_source(struct orl_parser *parser, const struct orl_scope *scope,
                       enum orl_material_kind kind, struct orl_error *err)
{
    orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                    "a source needs a light or glow as its modifier");
    orl_error_hint(err, "a sun is 'void light solar 0 0 3 R G B' and 'solar source sun 0 0 4 X Y Z "
                        "0.533'; a sky is a glow over 180 degrees");
    if (kind == ORL_MATERIAL_SPOTLIGHT)
        orl_error_hint(err,
                       "a spotlight must be a surface; a sun limited to one spot is not simulated");
    return ORL_ERR_UNSUPPORTED;
}

/* Returns true for "skyfunc source sky" instead of "skyglow source sky", a mistake that Radiance
 * reads as a dark source. */
static bool is_patterned_alone(const struct orl_parser *parser, const struct orl_scope *scope)
{
    const char *name = modifier_of(parser, scope);
    const struct orl_symbol *symbol = orl_symbols_find(&parser->symbols, name);
    return strcmp(name, "void") != 0 && symbol && symbol->kind == ORL_SYMBOL_SKY;
}

static void warn_of_dark(struct orl_parser *parser, const struct orl_scope *scope)
{
    const char *name = modifier_of(parser, scope);
    orl_parser_warn(parser,
                    "%.200s:%d: source %.100s emits no light, as in Radiance: its modifier "
                    "'%.100s' is a pattern; apply that pattern to a glow, for example \"%.100s "
                    "glow %.100s_glow 0 0 4 1 1 1 0\", and use the glow for the source",
                    scope->file, parser->primitive.line, parser->primitive.id, name, name,
                    parser->primitive.id);
}

static int read_source(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_error *err)
{
    struct orl_parsed_scene *out = parser->out;
    struct orl_distant_source distant = {0};
    uint32_t order = 0;
    int code = orl_parser_expect(parser, scope, 0, 4, err);
    if (code == 0 && is_patterned_alone(parser, scope)) {
        warn_of_dark(parser, scope);
        return 0;
    }
    if (code == 0)
        code = find_material(parser, scope, &distant.material, &order, err);
    if (code < 0)
        return code;
    const double *const r = parser->primitive.reals;
    const enum orl_material_kind kind = out->materials[distant.material].kind;
    if (parser->refusals.n > 0 && kind == ORL_MATERIAL_VOID)
        return 0;
    if (kind != ORL_MATERIAL_LIGHT && kind != ORL_MATERIAL_GLOW)
        return fail_source(parser, scope, kind, err);
    distant.direction = orl_normalize(orl_xform_vector(&scope->xform, real3(parser, 0)));
    distant.angle_deg = r[3];
    if (!(fabs(orl_length(distant.direction) - 1.0) < 1e-6))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its direction (%g %g %g) has no length", r[0], r[1], r[2]);
    if (!(r[3] > 0 && r[3] <= 360))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its angle %g is not between 0 and 360 degrees", r[3]);
    code = make_name(parser, scope, out->arena, &distant.name, err);
    if (code < 0)
        return code;
    if (!orl_array_reserve(&out->distant_sources, &parser->distant_sources_room,
                           out->n_distant_sources, sizeof *out->distant_sources))
        return out_of_memory(parser, scope, err);
    out->distant_sources[out->n_distant_sources++] = distant;
    return 0;
}

int orl_parser_surface(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_error *err)
{
    const struct surface_type *type = find_type(parser->primitive.type);
    struct orl_surface surface = {.file = scope->file, .line = parser->primitive.line};
    bool keep = true;
    if (!type)
        return read_source(parser, scope, err);
    int code = find_material(parser, scope, &surface.material, &surface.modifier_order, err);
    if (code < 0)
        return code;
    surface.kind = orl_xform_kind(&scope->xform, type->kind);
    if (type->kind == ORL_SURFACE_POLYGON)
        code = read_polygon(parser, scope, &surface, &keep, err);
    else
        code = read_quadric(parser, scope, type, &surface, &keep, err);
    return code == 0 && keep ? keep_surface(parser, scope, &surface, err) : code;
}
