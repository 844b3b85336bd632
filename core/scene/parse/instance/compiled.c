/*
 * The primitives instance and mesh: scenes that oconv has compiled into an octree, and triangles
 * that obj2mesh has compiled. Their octrees are skipped; for an octree that is not frozen, the
 * files it names are read.
 *
 * Names inside are separate: a file sees no modifiers from outside, and its own are not visible
 * there. A modifier of the primitive itself, other than void, replaces all modifiers inside.
 *
 * Normals and (u, v) of a mesh's corners are read (material_table.c). Files that occur several
 * times may be stored once (instanced_files.h).
 */
#include "scene/parse/parser.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/parse/instance/binary_reader.h"

/* The first integer of a file is one of these plus the size in bytes of its primitive numbers. */
enum { OCTREE_MAGIC = 283, MESH_MAGIC = 319, NUMBER_BYTES_MAX = 8 };

/* A compiled file that is being read. */
struct inside {
    struct orl_parser *parser;
    struct orl_scope scope;
    const char *id; /* identifier of the primitive that names it */
    struct orl_binary_reader reader;
    unsigned bytes; /* size of its primitive numbers */
    struct orl_binary_names names;
};

bool orl_parser_is_compiled(const char *type)
{
    return strcmp(type, "instance") == 0 || strcmp(type, "mesh") == 0;
}

/* ---- Common parts ---------------------------------------------------------------------------- */

static int read_text(void *ctx, const char *text, size_t size, struct orl_error *err)
{
    struct inside *inside = ctx;
    return orl_parser_read(inside->parser, &inside->scope, text, size, 1, err);
}

static int read_primitives(struct inside *inside, struct orl_error *err)
{
    return orl_binary_primitives(&inside->reader, inside->bytes, &inside->names, read_text, inside,
                                 err);
}

/* Reads the header, the kind, and the bounding cube. */
static int open_file(struct inside *inside, const struct orl_file *file, const char *format,
                     int magic, double ret_cube[4], struct orl_error *err)
{
    int code = orl_binary_open(file->data, file->size, format, &inside->reader, err);
    if (code < 0)
        return code;
    const int64_t bytes = orl_binary_int(&inside->reader, 2) - magic;
    if (bytes < 1 || bytes > NUMBER_BYTES_MAX)
        return orl_binary_fail(&inside->reader, "the version of its format is unknown", err);
    inside->bytes = (unsigned)bytes;
    for (int i = 0; i < 4; i++)
        ret_cube[i] = strtod(orl_binary_string(&inside->reader), NULL);
    return 0;
}

/* ---- instance -------------------------------------------------------------------------------- */

/* Reads the files that the octree was made of. */
static int read_named(struct inside *inside, size_t *ret_count, struct orl_error *err)
{
    const char *name;
    int code = 0;
    *ret_count = 0;
    while (code == 0 && *(name = orl_binary_string(&inside->reader))) {
        if (name[0] == '!')
            return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                                 "its octree was made from a command's output ('%.60s')", name);
        code = orl_parser_include(inside->parser, &inside->scope, name, err);
        ++*ret_count;
    }
    if (code == ORL_ERR_NOT_FOUND && err->hint[0] == '\0')
        orl_error_hint(err, "the octree only names the files that it was made from: upload them "
                            "too, or freeze it (oconv -f)");
    return code == 0 && inside->reader.ended ? orl_binary_fail(&inside->reader, "", err) : code;
}

static int read_octree(struct inside *inside, const struct orl_file *file, struct orl_error *err)
{
    double cube[4];
    size_t n_files = 0;
    int code = open_file(inside, file, "Radiance_octree", OCTREE_MAGIC, cube, err);
    if (code == 0)
        code = read_named(inside, &n_files, err);
    if (code < 0 || n_files > 0)
        return code;
    orl_binary_int(&inside->reader, inside->bytes); /* number of primitives */
    code = orl_binary_skip_octree(&inside->reader, inside->bytes, err);
    return code < 0 ? code : read_primitives(inside, err);
}

/* ---- mesh ------------------------------------------------------------------------------------ */

/* A triangle's line in messages is its number. */
static int add_triangle(struct inside *inside, const struct orl_patches *patches, size_t number,
                        struct orl_error *err)
{
    const struct orl_patch_triangle *triangle = &patches->triangles[number];
    struct orl_vec3 v[3];
    struct orl_vec3 normals[3];
    double uv[6];
    bool has_uv, has_normals;
    const size_t material = (size_t)triangle->material;
    const bool bare = triangle->material < 0;
    if (!orl_patches_corners(patches, triangle, v, uv, &has_uv, normals, &has_normals) ||
        (!bare && material >= inside->names.count))
        return orl_binary_fail(&inside->reader, "one of its triangles is damaged", err);
    const char *const head[3] = {bare ? "void" : inside->names.at[material], "polygon", inside->id};
    const double reals[9] = {v[0].x, v[0].y, v[0].z, v[1].x, v[1].y,
                             v[1].z, v[2].x, v[2].y, v[2].z};
    if (!orl_primitive_set(&inside->parser->primitive, head, reals, 9))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    inside->parser->primitive.line = (int)number + 1;
    inside->parser->uv = has_uv ? uv : NULL;
    inside->parser->normals = has_normals ? normals : NULL;
    const int code = orl_parser_surface(inside->parser, &inside->scope, err);
    inside->parser->uv = NULL;
    inside->parser->normals = NULL;
    return code;
}

static int add_triangles(struct inside *inside, const struct orl_patches *patches,
                         struct orl_error *err)
{
    int code = 0;
    for (size_t i = 0; i < patches->n_triangles && code == 0; i++)
        code = add_triangle(inside, patches, i, err);
    return code;
}

static int read_mesh(struct inside *inside, const struct orl_file *file, struct orl_error *err)
{
    struct orl_patch_frame frame;
    struct orl_patches patches = {.n_patches = 0};
    double cube[4];
    int code = open_file(inside, file, "Radiance_tmesh", MESH_MAGIC, cube, err);
    if (code < 0)
        return code;
    frame.corner = orl_v3(cube[0], cube[1], cube[2]);
    frame.size = cube[3];
    for (int k = 0; k < 2; k++) {
        frame.low[k] = orl_binary_number(&inside->reader);
        frame.high[k] = orl_binary_number(&inside->reader);
    }
    code = orl_binary_skip_octree(&inside->reader, inside->bytes, err);
    if (code == 0)
        code = read_primitives(inside, err);
    if (code == 0)
        code = orl_patches_read(&inside->reader, &frame, &patches, err);
    if (code == 0)
        code = add_triangles(inside, &patches, err);
    orl_patches_done(&patches);
    return code;
}

/* ---- The primitive --------------------------------------------------------------------------- */

/* Defines the primitive's modifier inside the file, under a name that the file does not use. */
static int carry_modifier(struct orl_parser *parser, const struct orl_scope *scope,
                          const struct orl_symbols *outer, const char *modifier,
                          const char **ret_name, struct orl_error *err)
{
    static const char mark[] = " of outside";
    const struct orl_symbol *symbol = orl_symbols_find(outer, modifier);
    const size_t length = strlen(modifier);
    if (!symbol)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOT_FOUND,
                               "its modifier '%.200s' is not defined", modifier);
    struct orl_symbol carried = *symbol;
    char *name = orl_arena_alloc(parser->out->arena, length + sizeof mark);
    if (!name)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    memcpy(name, modifier, length);
    memcpy(name + length, mark, sizeof mark);
    carried.name = *ret_name = name;
    return orl_symbols_set(&parser->symbols, carried) < 0
               ? orl_error_set(err, ORL_ERR_NOMEM, "out of memory")
               : 0;
}

/* Reads the file with its own table of modifiers. */
static int read_inside(struct inside *inside, const struct orl_scope *outer, const char *modifier,
                       bool is_mesh, const struct orl_file *file, struct orl_error *err)
{
    struct orl_parser *parser = inside->parser;
    struct orl_symbols outside = parser->symbols;
    int code = 0;
    parser->symbols = (struct orl_symbols){.n_set = outside.n_set};
    if (modifier)
        code = carry_modifier(parser, outer, &outside, modifier, &inside->scope.modifier, err);
    if (code == 0)
        code = is_mesh ? read_mesh(inside, file, err) : read_octree(inside, file, err);
    outside.n_set = parser->symbols.n_set;
    orl_symbols_done(&parser->symbols);
    parser->symbols = outside;
    return code;
}

/* Copies what is needed of the current primitive, which reading the file overwrites. */
static int begin_file(struct orl_parser *parser, const struct orl_scope *scope,
                      struct inside *inside, const char **ret_modifier, struct orl_error *err)
{
    const struct orl_primitive *primitive = &parser->primitive;
    struct orl_arena *arena = parser->out->arena;
    const char *modifier = scope->modifier ? scope->modifier : primitive->modifier;
    if (primitive->n_strings < 1 || primitive->n_reals != 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "it takes a file and a transform, but no numbers");
    *inside = (struct inside){.parser = parser, .scope = *scope};
    inside->scope.outer = scope;
    inside->scope.modifier = NULL;
    inside->scope.markers = NULL;
    inside->id = orl_arena_copy_text(arena, primitive->id, strlen(primitive->id));
    if (strcmp(modifier, "void") != 0)
        *ret_modifier = orl_arena_copy_text(arena, modifier, strlen(modifier));
    if (!inside->id || (strcmp(modifier, "void") != 0 && !*ret_modifier))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return orl_parser_string_xform(parser, scope, 1, &inside->scope.xform, err);
}

/* Adds an instance if the file has been read before and can be instanced; reads it otherwise. */
static int read_or_place(struct inside *inside, const struct orl_scope *outer, const char *modifier,
                         bool is_mesh, const struct orl_file *file, struct orl_error *err)
{
    struct orl_parser *const parser = inside->parser;
    const struct orl_symbol *const symbol =
        modifier ? orl_symbols_find(&parser->symbols, modifier) : NULL;
    struct orl_instanced_file_key key = {
        .data = file->data, .is_mesh = is_mesh, .is_modified = symbol != NULL};
    if (symbol) {
        key.kind = symbol->kind;
        key.index = symbol->index;
    }
    const bool known = !modifier || symbol;
    int code = known ? orl_instanced_files_place(parser, &key, &inside->scope, inside->id, err) : 0;
    if (code != 0)
        return code < 0 ? code : 0;
    const struct orl_parser_counts before = orl_parser_counts_now(parser);
    code = orl_parser_count_text(parser, &inside->scope, file->size, err);
    if (code == 0)
        code = read_inside(inside, outer, modifier, is_mesh, file, err);
    return code == 0 && known ? orl_instanced_files_add(parser, &key, &before, &inside->scope, err)
                              : code;
}

int orl_parser_compiled(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_error *err)
{
    const bool is_mesh = strcmp(parser->primitive.type, "mesh") == 0;
    struct inside inside = {.parser = parser};
    struct orl_file file;
    char name[ORL_ERROR_NAME_MAX];
    const char *modifier = NULL;
    int code = begin_file(parser, scope, &inside, &modifier, err);
    if (code == 0)
        code = orl_parser_enter(parser, &inside.scope, orl_primitive_string(&parser->primitive, 0),
                                &file, err);
    if (code == ORL_ERR_NOT_FOUND) {
        const struct orl_error missing = *err;
        orl_parser_fail(parser, scope, err, code, "its file is missing: %.*s", (int)sizeof name - 1,
                        missing.message);
        orl_error_hint(err, "%s", missing.hint);
        return code;
    }
    if (code == 0)
        code = read_or_place(&inside, scope, modifier, is_mesh, &file, err);
    free(inside.names.at);
    if (code < 0 && err->file[0] == '\0') {
        snprintf(name, sizeof name, "%s %.180s", is_mesh ? "mesh" : "instance", inside.id);
        orl_error_at(err, inside.scope.file, 0, name);
    }
    return code;
}
