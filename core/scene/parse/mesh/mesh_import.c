#include "scene/parse/mesh/mesh_import.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory/memory.h"
#include "scene/grid/ies.h"
#include "scene/parse/gltf/gltf.h"
#include "scene/parse/mesh/mesh_formats.h"

/* A file being read, with its options. */
struct object {
    struct orl_parser *parser;
    const struct orl_scope *scope;
    const struct orl_material_rules *rules; /* may be NULL */
    const char *name;                       /* for unnamed faces; may be NULL */
    bool flat;                              /* -f: ignores normals without a warning */
    int line;          /* line that messages name for every face; 0: the face's own */
    uint64_t unturned; /* faces whose corner normals are ignored */
    double *reals;     /* three per corner */
    size_t *next;      /* index of the next remaining corner */
    size_t reals_room, next_room;
};

enum { ID_BYTES = ORL_WAVEFRONT_GROUPS * ORL_WAVEFRONT_NAME + 32 };

static int add_polygon(struct object *object, const char *modifier, const char *id, int line,
                       size_t n, struct orl_error *err)
{
    struct orl_parser *parser = object->parser;
    const char *const head[3] = {modifier, "polygon", id};
    if (!orl_primitive_set(&parser->primitive, head, object->reals, 3 * n))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    parser->primitive.line = object->line > 0 ? object->line : line;
    const int code = orl_parser_surface(parser, object->scope, err);
    return code ? code : orl_parser_check_cancel(parser, err);
}

static void put_corner(struct object *object, size_t at, const struct orl_vec3 *corner)
{
    object->reals[3 * at] = corner->x;
    object->reals[3 * at + 1] = corner->y;
    object->reals[3 * at + 2] = corner->z;
}

/* ---- OBJ ------------------------------------------------------------------------------------- */

static int make_room(struct object *object, size_t n, struct orl_error *err)
{
    return orl_array_reserve_more(&object->reals, &object->reals_room, 0, 3 * n,
                                  sizeof *object->reals) &&
                   orl_array_reserve_more(&object->next, &object->next_room, 0, n,
                                          sizeof *object->next)
               ? 0
               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

/* Returns the unit normal by Newell's method; 0 if there is no area. */
static struct orl_vec3 normal_of(const struct orl_wavefront_face *face)
{
    const struct orl_vec3 *v = face->corners;
    struct orl_vec3 sum = orl_v3(0, 0, 0);
    for (size_t i = 1; i + 1 < face->n_corners; i++)
        sum = orl_add(sum, orl_cross(orl_sub(v[i], v[0]), orl_sub(v[i + 1], v[0])));
    return orl_normalize(sum);
}

/* Returns true if the face deviates from its mean plane by at most a thousandth of its size. */
static bool is_planar(const struct orl_wavefront_face *face, struct orl_vec3 normal)
{
    double low = 0, high = 0, size = 0;
    for (size_t i = 1; i < face->n_corners; i++) {
        const struct orl_vec3 d = orl_sub(face->corners[i], face->corners[0]);
        low = fmin(low, orl_dot(normal, d));
        high = fmax(high, orl_dot(normal, d));
        size = fmax(size, orl_length(d));
    }
    return high - low <= 1e-3 * size;
}

static bool is_convex(const struct orl_wavefront_face *face, struct orl_vec3 normal)
{
    const struct orl_vec3 *v = face->corners;
    const size_t n = face->n_corners;
    for (size_t i = 0; i < n; i++) {
        const struct orl_vec3 a = orl_sub(v[(i + 1) % n], v[i]),
                              b = orl_sub(v[(i + 2) % n], v[(i + 1) % n]);
        if (orl_dot(orl_cross(a, b), normal) < 0)
            return false;
    }
    return true;
}

/* Compares corner normals with the face's: equal, different, or on the wrong side. */
enum turning { FLAT, TURNED, ODD };
static enum turning turning_of(const struct orl_wavefront_face *face, struct orl_vec3 normal)
{
    enum turning turning = FLAT;
    for (size_t i = 0; face->normals && i < face->n_corners; i++) {
        const double cosine = orl_dot(face->normals[i], normal) / orl_length(face->normals[i]);
        if (!(cosine > 0)) /* also for normals of length 0 */
            return ODD;
        if (cosine < 1 - 1e-6)
            turning = TURNED;
    }
    return turning;
}

/* Cuts off every other corner, round by round, until one triangle remains. */
static int add_triangles(struct object *object, const struct orl_wavefront_face *face, bool turned,
                         const char *modifier, const char *id, struct orl_error *err)
{
    struct orl_vec3 normals[3];
    size_t *const next = object->next;
    size_t first = 0;
    int code = 0;
    for (size_t i = 0; i < face->n_corners; i++)
        next[i] = (i + 1) % face->n_corners;
    for (size_t left = face->n_corners; left >= 3 && code == 0; left--) {
        const size_t second = next[first], corners[3] = {first, second, next[second]};
        for (size_t k = 0; k < 3; k++) {
            put_corner(object, k, &face->corners[corners[k]]);
            if (turned)
                normals[k] = orl_normalize(face->normals[corners[k]]);
        }
        object->parser->normals = turned ? normals : NULL;
        code = add_polygon(object, modifier, id, face->line, 3, err);
        object->parser->normals = NULL;
        next[first] = corners[2];
        first = corners[2];
    }
    return code;
}

static void name_face(const struct object *object, const struct orl_wavefront_face *face,
                      char id[ID_BYTES])
{
    size_t at = 0;
    if (face->object[0] || object->name || face->n_groups == 0)
        at = (size_t)snprintf(id, ID_BYTES, "%.200s",
                              face->object[0] ? face->object
                              : object->name  ? object->name
                                              : "unnamed");
    else
        for (size_t i = 0; i < face->n_groups; i++)
            at +=
                (size_t)snprintf(id + at, ID_BYTES - at, "%s%s", i > 0 ? "." : "", face->groups[i]);
    snprintf(id + at, ID_BYTES - at, ".%llu", (unsigned long long)face->number);
}

static int add_face(void *ctx, const struct orl_wavefront_face *face, struct orl_error *err)
{
    struct object *object = ctx;
    char id[ID_BYTES];
    const char *modifier = object->rules        ? orl_material_rules_choose(object->rules, face)
                           : face->material[0]  ? face->material
                           : face->n_groups > 0 ? face->groups[0]
                                                : "white";
    if (!modifier)
        return 0;
    name_face(object, face, id);
    const int code = make_room(object, face->n_corners, err);
    if (code)
        return code;
    const struct orl_vec3 normal = normal_of(face);
    const enum turning turning = object->flat ? FLAT : turning_of(face, normal);
    const bool turned = turning == TURNED && is_convex(face, normal);
    object->unturned += turning != FLAT && !turned;
    if (turned || (face->n_corners > 3 && !is_planar(face, normal)))
        return add_triangles(object, face, turned, modifier, id, err);
    for (size_t k = 0; k < face->n_corners; k++)
        put_corner(object, k, &face->corners[k]);
    return add_polygon(object, modifier, id, face->line, face->n_corners, err);
}

static void warn_of_normals(const struct object *object)
{
    if (object->unturned > 0)
        orl_parser_warn(object->parser,
                        "%.200s: %llu faces are shaded flat: their vertex normals point away from "
                        "the face, or the face is not convex",
                        object->scope->file, (unsigned long long)object->unturned);
}

static int read_obj(struct object *object, const struct orl_file *file, struct orl_error *err)
{
    const struct orl_wavefront_sink sink = {add_face, object};
    struct orl_wavefront_ignored ignored;
    int code = orl_parser_count_text(object->parser, object->scope, file->size, err);
    if (code == 0)
        code =
            orl_wavefront_read(object->scope->file, file->data, file->size, &sink, &ignored, err);
    if (code == 0)
        warn_of_normals(object);
    if (code == 0 && ignored.curved > 0)
        orl_parser_warn(
            object->parser,
            "%.200s: %llu curves and curved surfaces are ignored: export them as polygons",
            object->scope->file, (unsigned long long)ignored.curved);
    free(object->reals);
    free(object->next);
    return code;
}

/* ---- STL ------------------------------------------------------------------------------------- */

static int add_facet(void *ctx, const struct orl_vec3 corners[3], int line, struct orl_error *err)
{
    struct object *object = ctx;
    for (size_t k = 0; k < 3; k++)
        put_corner(object, k, &corners[k]);
    return add_polygon(object, object->name, object->name, line, 3, err);
}

/* Makes a name from the file's, without folder and extension; blanks become underscores. */
static void name_of_file(const char *file, char ret_name[ORL_WAVEFRONT_NAME])
{
    const char *const start = basename(file), *const dot = strrchr(start, '.');
    snprintf(ret_name, ORL_WAVEFRONT_NAME, "%.*s", dot ? (int)(dot - start) : (int)strlen(start),
             start);
    for (char *c = ret_name; *c; c++)
        *c = *c == ' ' ? '_' : *c;
}

static int read_stl(struct orl_parser *parser, const struct orl_scope *scope,
                    const struct orl_file *file, struct orl_error *err)
{
    double reals[9];
    char name[ORL_WAVEFRONT_NAME];
    struct object object = {.parser = parser, .scope = scope, .name = name, .reals = reals};
    const struct orl_stl_sink sink = {add_facet, &object};
    name_of_file(scope->file, name);
    const int code = orl_parser_count_text(parser, scope, file->size, err);
    return code ? code : orl_stl_read(scope->file, file->data, file->size, &sink, err);
}

/* ---- glTF ------------------------------------------------------------------------------------ */

/* Opens a .gltf's buffer file next to it. */
static int open_buffer(void *ctx, const char *name, struct orl_file *ret_file,
                       struct orl_error *err)
{
    const struct object *object = ctx;
    struct orl_scope inner = *object->scope;
    const int code = orl_parser_enter(object->parser, &inner, name, ret_file, err);
    return code ? code : orl_parser_count_text(object->parser, &inner, ret_file->size, err);
}

static void warn_of_ignored(const struct object *object, const struct orl_gltf_ignored *ignored)
{
    const char *file = object->scope->file;
    warn_of_normals(object);
    if (ignored->empty)
        orl_parser_warn(object->parser, "%.200s has no triangles in its scene", file);
    if (ignored->skinned > 0)
        orl_parser_warn(object->parser,
                        "%.200s: %llu meshes with a skeleton are used in their rest pose", file,
                        (unsigned long long)ignored->skinned);
    if (ignored->blended > 0)
        orl_parser_warn(object->parser,
                        "%.200s: %llu meshes with morph targets are used in their base shape", file,
                        (unsigned long long)ignored->blended);
}

static int read_gltf(struct object *object, const struct orl_file *file, struct orl_error *err)
{
    const struct orl_wavefront_sink sink = {add_face, object};
    const struct orl_gltf_buffers buffers = {open_buffer, object};
    struct orl_gltf_ignored ignored;
    int code = orl_parser_count_text(object->parser, object->scope, file->size, err);
    if (code == 0)
        code = orl_gltf_read(object->scope->file, file->data, file->size, &buffers, &sink, &ignored,
                             err);
    if (code == 0)
        warn_of_ignored(object, &ignored);
    free(object->reals);
    free(object->next);
    return code;
}

/* ---- Files ----------------------------------------------------------------------------------- */

static bool ends_with(const char *name, const char *ending)
{
    const size_t length = strlen(name), last = strlen(ending);
    return length > last && strcasecmp(name + length - last, ending) == 0;
}

enum orl_import_kind orl_import_kind_of(const char *name, const struct orl_file *file)
{
    if (ends_with(name, ".obj") && orl_wavefront_detect(file->data, file->size))
        return ORL_IMPORT_OBJ;
    if (ends_with(name, ".stl") && orl_stl_detect(file->data, file->size))
        return ORL_IMPORT_STL;
    if ((ends_with(name, ".glb") || ends_with(name, ".gltf")) &&
        orl_gltf_detect(file->data, file->size))
        return ORL_IMPORT_GLTF;
    if (ends_with(name, ".ies") && orl_ies_detect(file->data, file->size))
        return ORL_IMPORT_IES;
    return ORL_IMPORT_NONE;
}

int orl_parser_import_mesh(struct orl_parser *parser, const struct orl_scope *scope,
                           const struct orl_file *file, enum orl_import_kind kind,
                           struct orl_error *err)
{
    struct object object = {.parser = parser, .scope = scope};
    return kind == ORL_IMPORT_STL    ? read_stl(parser, scope, file, err)
           : kind == ORL_IMPORT_GLTF ? read_gltf(&object, file, err)
                                     : read_obj(&object, file, err);
}

/* ---- obj2rad --------------------------------------------------------------------------------- */

struct options {
    const char *rules, *name, *file;
    bool flat;
};

static int read_options(const char *const *words, size_t count, bool piped, struct options *ret,
                        struct orl_error *err)
{
    *ret = (struct options){.rules = NULL};
    for (size_t i = 1; i < count; i++) {
        const char **value = strcmp(words[i], "-m") == 0   ? &ret->rules
                             : strcmp(words[i], "-o") == 0 ? &ret->name
                                                           : NULL;
        if (strcmp(words[i], "-f") == 0)
            ret->flat = true;
        else if (value && i + 1 < count)
            *value = words[++i];
        else if (words[i][0] == '-')
            return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                                 "obj2rad: '%.40s' is not supported, or its argument is missing",
                                 words[i]);
        else if (ret->file)
            return orl_error_set(err, ORL_ERR_SYNTAX, "obj2rad reads one file");
        else
            ret->file = words[i];
    }
    if (piped && ret->file)
        return orl_error_set(err, ORL_ERR_SYNTAX, "obj2rad after '|' takes no file");
    return ret->file || piped ? 0
                              : orl_error_set(err, ORL_ERR_SYNTAX, "obj2rad needs a file to read");
}

static int read_rules(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                      struct orl_material_rules **ret_rules, struct orl_error *err)
{
    struct orl_scope inner = *scope;
    struct orl_file file;
    int code = orl_parser_enter(parser, &inner, name, &file, err);
    if (code == 0)
        code = orl_parser_count_text(parser, &inner, file.size, err);
    return code ? code : orl_material_rules_read(inner.file, file.data, file.size, ret_rules, err);
}

int orl_parser_obj2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, const struct orl_file *piped,
                       int line, struct orl_error *err)
{
    struct orl_scope inner = *scope;
    struct orl_material_rules *rules = NULL;
    struct options options;
    struct orl_file file;
    int code = read_options(words, count, piped != NULL, &options, err);
    if (code == 0 && options.rules)
        code = read_rules(parser, scope, options.rules, &rules, err);
    if (code == 0 && !piped)
        code = orl_parser_enter(parser, &inner, options.file, &file, err);
    if (code == 0) {
        struct object object = {.parser = parser,
                                .scope = &inner,
                                .rules = rules,
                                .name = options.name,
                                .flat = options.flat,
                                .line = line};
        code = read_obj(&object, piped ? piped : &file, err);
    }
    orl_material_rules_free(rules);
    return code;
}
