#include "scene/parse/parse.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "scene/parse/command/commands.h"
#include "scene/parse/luminaire/luminaires.h"
#include "scene/parse/mesh/mesh_import.h"
#include "scene/parse/parser.h"
#include "scene/surfaces.h"

static int refuse_type(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_error *err)
{
    const char *const ending = strrchr(scope->file, '.');
    orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX, "'%.60s' is not a primitive type",
                    parser->primitive.type);
    if (ending && strcmp(ending, ".cal") == 0)
        orl_error_hint(err, "this is a function file: remove it from the scene's files; patterns "
                            "and textures find it by its name");
    else
        orl_error_hint(err, "a primitive is: modifier type identifier, then three counts with "
                            "their arguments; check the counts of the primitive before this one");
    return ORL_ERR_SYNTAX;
}

static bool is_known(const char *type)
{
    return orl_parser_is_surface(type) || orl_parser_is_modifier(type) ||
           orl_parser_is_compiled(type);
}

static int read_primitive(struct orl_parser *parser, const struct orl_scope *scope,
                          struct orl_lexer *lexer, struct orl_error *err)
{
    const struct orl_primitive *primitive = &parser->primitive;
    int code = orl_primitive_read_head(&parser->primitive, lexer, err);
    if (code < 0)
        return code;
    if (strcmp(primitive->type, "alias") == 0) {
        code = orl_primitive_read_reference(&parser->primitive, lexer, err);
        return code < 0 ? code : orl_parser_alias(parser, scope, err);
    }
    if (!is_known(primitive->type))
        return refuse_type(parser, scope, err);
    code = orl_primitive_read_arguments(&parser->primitive, lexer, err);
    if (code < 0)
        return code;
    const struct orl_marker *marker = scope->markers ? orl_marker_find(parser, scope) : NULL;
    if (marker)
        return scope->markers->replace(parser, scope, marker, err);
    if (orl_parser_is_surface(primitive->type))
        return orl_parser_surface(parser, scope, err);
    if (orl_parser_is_compiled(primitive->type))
        return orl_parser_compiled(parser, scope, err);
    return orl_parser_modifier(parser, scope, err);
}

static int read_command(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_lexer *lexer, struct orl_error *err)
{
    const int line = lexer->line;
    char *command = orl_lexer_command(lexer, err);
    if (!command)
        return err->code;
    const int code = orl_parser_command(parser, scope, command, line, err);
    free(command);
    return code;
}

/* Counts an unsupported primitive or command, and continues behind it if possible; modifiers are
 * deferred until they are used. */
static int record_refusal(struct orl_parser *parser, struct orl_lexer *lexer, bool command,
                          struct orl_error *err)
{
    struct orl_error ignored;
    const struct orl_error refused = *err;
    const struct orl_primitive *primitive = &parser->primitive;
    /* For known types the arguments have been read already. */
    const bool read = command || is_known(primitive->type) || strcmp(primitive->type, "alias") == 0;
    /* Reading arguments moves the words of the head. */
    if (!read && orl_primitive_read_arguments(&parser->primitive, lexer, &ignored) < 0) {
        orl_refusals_add(&parser->refusals, &refused);
        parser->cut_short = true;
        return ORL_ERR_UNSUPPORTED;
    }
    if (!command && !orl_parser_is_surface(primitive->type) &&
        !orl_parser_is_compiled(primitive->type))
        return orl_parser_define_refused(parser, primitive->id, &refused, err);
    orl_refusals_add(&parser->refusals, &refused);
    return 0;
}

int orl_parser_read(struct orl_parser *parser, const struct orl_scope *scope, const char *text,
                    size_t size, int line, struct orl_error *err)
{
    struct orl_lexer lexer;
    enum orl_next next;
    int code = orl_parser_count_text(parser, scope, size, err);
    orl_lexer_init(&lexer, scope->file, text, size);
    if (line > 0) {
        lexer.line = line;
        lexer.frozen = true;
    }
    while (code == 0 && (next = orl_lexer_next(&lexer)) != ORL_NEXT_END) {
        const bool command = next == ORL_NEXT_COMMAND;
        code = command ? read_command(parser, scope, &lexer, err)
                       : read_primitive(parser, scope, &lexer, err);
        if (code == ORL_ERR_UNSUPPORTED && !parser->cut_short)
            code = record_refusal(parser, &lexer, command, err);
        if (code == 0)
            code = orl_parser_check_cancel(parser, err);
    }
    return code;
}

/* Reads an IES file through the text that ies2rad would write. */
static int read_luminaire(struct orl_parser *parser, const struct orl_scope *scope,
                          const struct orl_file *file, struct orl_error *err)
{
    struct orl_text text = {0};
    int code = orl_luminaire_write(parser, scope, file, &text, err);
    if (code == 0 && text.warnings[0])
        orl_parser_warn(parser, "%s: %s", scope->file, text.warnings);
    if (code == 0)
        code = orl_parser_read(parser, scope, text.data, text.size, 1, err);
    orl_text_done(&text);
    return code;
}

int orl_parser_file(struct orl_parser *parser, const struct orl_scope *scope,
                    const struct orl_file *file, struct orl_error *err)
{
    const enum orl_import_kind kind = orl_import_kind_of(scope->file, file);
    if (kind == ORL_IMPORT_IES)
        return read_luminaire(parser, scope, file, err);
    return kind != ORL_IMPORT_NONE ? orl_parser_import_mesh(parser, scope, file, kind, err)
                                   : orl_parser_read(parser, scope, file->data, file->size, 0, err);
}

/* Opens the main files first, so that they come first in files and digest; ret_index: their
 * indices. */
static int open_main(struct orl_parser *parser, const char *const *names, size_t count,
                     size_t *ret_index, struct orl_error *err)
{
    struct orl_sources *sources = &parser->sources;
    struct orl_error empty = {0};
    bool filled = false;
    for (size_t i = 0; i < count; i++) {
        const size_t before = sources->count;
        if (orl_sources_is_resource(names[i]))
            continue;
        const int code = orl_sources_find(sources, "", names[i], ret_index + i, err);
        if (code < 0) {
            orl_error_at(err, names[i], 0, NULL);
            return code;
        }
        if (sources->count == before)
            orl_sources_count_again(sources, ret_index[i]);
        if (sources->items[ret_index[i]].file.size == 0) {
            orl_error_set(&empty, ORL_ERR_SYNTAX, "the file is empty");
            orl_error_at(&empty, names[i], 0, NULL);
            orl_parser_warn(parser, "%.200s: the file is empty", names[i]);
        } else {
            filled = true;
        }
    }
    if (filled || empty.code == 0)
        return 0;
    *err = empty;
    return empty.code;
}

static int read_main(struct orl_parser *parser, const char *const *names, size_t count,
                     const size_t *index, struct orl_error *err)
{
    int code = 0;
    for (size_t i = 0; i < count && code == 0; i++) {
        parser->out->source.first_surfaces[i] = parser->out->n_surfaces;
        parser->out->source.n_first_surfaces = i + 1;
        if (orl_sources_is_resource(names[i]))
            continue;
        const struct orl_source *const source = parser->sources.items + index[i];
        const struct orl_scope scope = {
            .file = source->name, .folder = source->folder, .xform = orl_xform_identity};
        code = orl_parser_file(parser, &scope, &source->file, err);
    }
    return code;
}

/* Lists the files that were read, and the names that were not found. */
static bool list_files(const struct orl_sources *sources, struct orl_parsed_scene *out)
{
    const size_t n_missing = sources->n_missing > ORL_MISSING_FILES_MAX ? 0 : sources->n_missing;
    out->source.read = orl_arena_alloc(out->arena, (sources->count + 1) * sizeof *out->source.read);
    out->source.missing =
        orl_arena_alloc(out->arena, (n_missing + 1) * sizeof *out->source.missing);
    if (!out->source.read || !out->source.missing)
        return false;
    for (size_t i = 0; i < sources->count; i++) {
        const struct orl_source *const item = &sources->items[i];
        out->files[i] = item->name;
        out->source.read[i].library = item->library;
        memcpy(out->source.read[i].content, item->content, sizeof out->source.read[i].content);
    }
    out->n_files = sources->count;
    if (n_missing > 0)
        memcpy(out->source.missing, sources->missing, n_missing * sizeof *out->source.missing);
    out->source.n_missing = sources->n_missing > n_missing ? SIZE_MAX : n_missing;
    return true;
}

/* Fills the remaining fields after all files have been read. */
static int fill_description(struct orl_parser *parser, struct orl_error *err)
{
    struct orl_parsed_scene *out = parser->out;
    const struct orl_sources *sources = &parser->sources;
    struct orl_sha256 digest = sources->digest;
    out->files = calloc(sources->count ? sources->count : 1, sizeof *out->files);
    if (!out->files || !list_files(sources, out))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_sha256_finish(&digest, out->digest);
    out->n_degenerate = parser->degenerate.count;
    orl_parser_report(parser);
    return orl_instanced_files_finish(&parser->instanced_files, out, err);
}

/* Main files that are already open count from the place where they are named. */
static int parse_files(struct orl_parser *parser, const char *const *names, size_t count,
                       size_t *index, struct orl_error *err)
{
    struct orl_parsed_scene *const out = parser->out;
    out->outlines = orl_arena_new();
    out->source.first_surfaces =
        out->arena ? orl_arena_alloc(out->arena, (count + 1) * sizeof *out->source.first_surfaces)
                   : NULL;
    if (!out->outlines || !out->source.first_surfaces)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_sha256_init(&parser->sources.digest);
    int code = open_main(parser, names, count, index, err);
    if (code < 0)
        return code;
    out->source.n_main = parser->sources.count;
    code = read_main(parser, names, count, index, err);
    /* Later errors may be caused by content that was left out, so refusals are reported first. */
    if (parser->refusals.n > 0 && code != ORL_ERR_NOMEM && code != ORL_ERR_CANCELLED &&
        code != ORL_ERR_LIMIT)
        code = orl_refusals_report(&parser->refusals, err);
    return code == 0 ? fill_description(parser, err) : code;
}

/* Returns true if instances with patterns must be expanded. */
static bool must_expand(const struct orl_parsed_scene *d)
{
    bool has_patterns = false;
    for (size_t i = 0; i < d->n_prototypes; i++)
        has_patterns = has_patterns || d->prototypes[i].has_patterns;
    return has_patterns && orl_parsed_scene_must_split(d);
}

static int parse_whole(const char *const *names, size_t count, struct orl_sources *sources,
                       bool plain, struct orl_parsed_scene *ret_parsed_scene, struct orl_error *err)
{
    struct orl_error local = {0};
    struct orl_parsed_scene out = {.arena = sources->arena};
    struct orl_parser parser = {
        .out = &out, .sources = *sources, .void_material = -1, .instanced_files = {.plain = plain}};
    size_t *index = calloc(count ? count : 1, sizeof *index);
    err = err ? err : &local;
    memset(sources, 0, sizeof *sources);
    const int code = index ? parse_files(&parser, names, count, index, err)
                           : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (code == 0) {
        *ret_parsed_scene = out;
        memset(&out, 0, sizeof out);
    }
    orl_sources_done(&parser.sources);
    orl_symbols_done(&parser.symbols);
    orl_deferred_done(&parser.deferred);
    orl_instanced_files_done(&parser.instanced_files);
    orl_functions_free(parser.functions);
    free(parser.smooth);
    orl_primitive_done(&parser.primitive);
    orl_parsed_scene_done(&out);
    free(index);
    return code;
}

int orl_scene_parse_opened(const char *const *names, size_t count, struct orl_sources *sources,
                           bool apart, struct orl_parsed_scene *ret_parsed_scene,
                           struct orl_error *err)
{
    const struct orl_files *const files = sources->files;
    const struct orl_bsdf_loader *const loader = sources->loader;
    int code = parse_whole(names, count, sources, apart, ret_parsed_scene, err);
    if (code == 0 && must_expand(ret_parsed_scene)) {
        orl_parsed_scene_done(ret_parsed_scene);
        orl_sources_init(sources, files, loader, orl_arena_new());
        code = parse_whole(names, count, sources, true, ret_parsed_scene, err);
    }
    return code;
}

int orl_scene_parse(const char *const *names, size_t count, const struct orl_files *files,
                    struct orl_parsed_scene *ret_parsed_scene, struct orl_error *err)
{
    return orl_scene_parse_with(names, count, files, NULL, ret_parsed_scene, err);
}

int orl_scene_parse_with(const char *const *names, size_t count, const struct orl_files *files,
                         const struct orl_bsdf_loader *loader,
                         struct orl_parsed_scene *ret_parsed_scene, struct orl_error *err)
{
    struct orl_sources sources;
    orl_sources_init(&sources, files, loader, orl_arena_new());
    return orl_scene_parse_opened(names, count, &sources, false, ret_parsed_scene, err);
}
