#include "scene/cache/scene_cache_file.h"

#include <link.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "scene/material/patterns/pattern.h"

/* State of the search through the notes of the main program, which is the first object. */
struct search {
    struct orl_sha256 *hash;
    bool found;
};

static size_t align_to_4(size_t size)
{
    return (size + 3) / 4 * 4;
}

static void find_build_id(struct search *search, const char *at, size_t size)
{
    static const char owner[] = "GNU";
    ElfW(Nhdr) note;
    while (!search->found && size >= sizeof note) {
        memcpy(&note, at, sizeof note);
        const size_t name = align_to_4(note.n_namesz),
                     all = sizeof note + name + align_to_4(note.n_descsz);
        if (all > size)
            return;
        if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == sizeof owner &&
            memcmp(at + sizeof note, owner, sizeof owner) == 0) {
            orl_sha256_add(search->hash, at + sizeof note + name, note.n_descsz);
            search->found = true;
        }
        at += all;
        size -= all;
    }
}

static int visit_object(struct dl_phdr_info *info, size_t size, void *ctx)
{
    (void)size;
    for (int i = 0; i < info->dlpi_phnum; i++)
        if (info->dlpi_phdr[i].p_type == PT_NOTE)
            find_build_id(ctx, (const char *)(info->dlpi_addr + info->dlpi_phdr[i].p_vaddr),
                          info->dlpi_phdr[i].p_memsz);
    return 1; /* stop after the first object */
}

bool orl_program_id_add(struct orl_sha256 *hash)
{
    struct search search = {hash, false};
    dl_iterate_phdr(visit_object, &search);
    return search.found;
}

static const struct orl_checked_file_kind kind = {
    .magic = "ORIELSC",
    .version = 2,
    .shape =
        (((((uint64_t)sizeof(struct orl_parsed_scene) * 1000 + sizeof(struct orl_material)) * 1000 +
           sizeof(struct orl_pattern)) *
              1000 +
          sizeof(struct orl_placement)) *
             100 +
         sizeof(struct orl_sky)),
    .what = "scene"};

/* ---- Source files ---------------------------------------------------------------------------- */

/* Fails with ORL_ERR_VERSION if the caller's file of that name is missing or has changed. */
static void check_read_file(struct orl_scene_cache_stream *k, const char *name,
                            const struct orl_file_record *read)
{
    size_t index = 0;
    int code = orl_sources_open(&k->sources, name, read->library, &index, NULL);
    if (code == ORL_ERR_NOT_FOUND)
        code = ORL_ERR_VERSION;
    if (code == 0 &&
        memcmp(k->sources.items[index].content, read->content, sizeof read->content) != 0)
        code = ORL_ERR_VERSION;
    if (code < 0)
        orl_serializer_fail(&k->serializer, code);
}

static void check_missing(struct orl_scene_cache_stream *k, const struct orl_missing_file *missing)
{
    size_t index = 0;
    const int code = orl_sources_open(&k->sources, missing->name, missing->library, &index, NULL);
    if (code != ORL_ERR_NOT_FOUND)
        orl_serializer_fail(&k->serializer, code == 0 ? ORL_ERR_VERSION : code);
}

/* Allocates the arrays of file names and digests when reading. */
static bool make_room(struct orl_scene_cache_stream *k)
{
    struct orl_parsed_scene *const d = k->d;
    if (!orl_serializer_reads(&k->serializer))
        return true;
    d->files = calloc(d->n_files + 1, sizeof *d->files);
    d->source.read = orl_arena_alloc(d->arena, (d->n_files + 1) * sizeof *d->source.read);
    d->source.missing =
        orl_arena_alloc(d->arena, (d->source.n_missing + 1) * sizeof *d->source.missing);
    if (!d->files || !d->source.read || !d->source.missing)
        orl_serializer_fail(&k->serializer, ORL_ERR_NOMEM);
    return k->serializer.code == 0;
}

static void pass_files(struct orl_scene_cache_stream *k)
{
    struct orl_serializer *const serializer = &k->serializer;
    struct orl_parsed_scene *const d = k->d;
    orl_serialize_value(serializer, &d->n_files);
    orl_serialize_value(serializer, &d->source.n_main);
    orl_serialize_value(serializer, &d->source.n_missing);
    if (d->n_files > ORL_LIMIT_SCENE_FILES || d->source.n_missing > ORL_MISSING_FILES_MAX)
        orl_serializer_fail(serializer, ORL_ERR_CORRUPT);
    if (serializer->code < 0 || !make_room(k))
        return;
    for (size_t i = 0; i < d->n_files && serializer->code == 0; i++) {
        orl_serialize_text(serializer, d->arena, (const char **)&d->files[i]);
        orl_serialize_value(serializer, &d->source.read[i]);
        if (orl_serializer_reads(serializer) && serializer->code == 0)
            check_read_file(k, d->files[i], &d->source.read[i]);
    }
    for (size_t i = 0; i < d->source.n_missing && serializer->code == 0; i++) {
        orl_serialize_text(serializer, d->arena, &d->source.missing[i].name);
        orl_serialize_value(serializer, &d->source.missing[i].library);
        if (orl_serializer_reads(serializer) && serializer->code == 0)
            check_missing(k, &d->source.missing[i]);
    }
}

/* ---- Other contents -------------------------------------------------------------------------- */

static void pass_prototypes(struct orl_scene_cache_stream *k)
{
    struct orl_parsed_scene *const d = k->d;
    size_t n = d->n_prototypes;
    orl_serialize_value(&k->serializer, &n);
    orl_serializer_alloc(&k->serializer, &d->prototypes, n, sizeof *d->prototypes);
    for (size_t i = 0; i < n && k->serializer.code == 0; i++) {
        struct orl_prototype *const p = &d->prototypes[i];
        d->n_prototypes = i + 1;
        orl_cache_surfaces(k, &p->surfaces, &p->n_surfaces);
        orl_cache_opposed(k, &p->opposed, &p->n_opposed);
        orl_serialize_value(&k->serializer, &p->prefix_bytes);
    }
}

/* Writes the struct without pointers, then the strings they point to. */
static void pass_placement(struct orl_scene_cache_stream *k, struct orl_placement *p)
{
    struct orl_placement image = *p;
    image.name = image.prefix = NULL;
    orl_serialize_value(&k->serializer, &image);
    if (orl_serializer_reads(&k->serializer))
        *p = image;
    orl_serialize_text(&k->serializer, k->d->arena, &p->name);
    orl_serialize_text(&k->serializer, k->d->arena, &p->prefix);
    if (p->prototype >= k->d->n_prototypes)
        orl_serializer_fail(&k->serializer, ORL_ERR_CORRUPT);
}

static void pass_distant(struct orl_scene_cache_stream *k, struct orl_distant_source *distant)
{
    struct orl_distant_source image = *distant;
    image.name = NULL;
    orl_serialize_value(&k->serializer, &image);
    if (orl_serializer_reads(&k->serializer))
        *distant = image;
    orl_serialize_text(&k->serializer, k->d->arena, (const char **)&distant->name);
}

static void pass_placements(struct orl_scene_cache_stream *k)
{
    struct orl_parsed_scene *const d = k->d;
    orl_serialize_value(&k->serializer, &d->n_placements);
    orl_serializer_alloc(&k->serializer, &d->placements, d->n_placements, sizeof *d->placements);
    for (size_t i = 0; i < d->n_placements && k->serializer.code == 0; i++)
        pass_placement(k, &d->placements[i]);
}

static void pass_sky(struct orl_scene_cache_stream *k)
{
    struct orl_parsed_scene *const d = k->d;
    orl_serialize_value(&k->serializer, &d->n_distant_sources);
    orl_serializer_alloc(&k->serializer, &d->distant_sources, d->n_distant_sources,
                         sizeof *d->distant_sources);
    for (size_t i = 0; i < d->n_distant_sources && k->serializer.code == 0; i++)
        pass_distant(k, &d->distant_sources[i]);
    orl_serialize_value(&k->serializer, &d->n_skies);
    orl_serialize_array(&k->serializer, &d->skies, d->n_skies, sizeof *d->skies);
}

static void pass_warnings(struct orl_scene_cache_stream *k)
{
    struct orl_parsed_scene *const d = k->d;
    size_t n = d->n_warnings;
    orl_serialize_value(&k->serializer, &n);
    for (size_t i = 0; i < n && k->serializer.code == 0; i++) {
        const char *text = orl_serializer_reads(&k->serializer) ? NULL : d->warnings[i];
        orl_serialize_text(&k->serializer, d->arena, &text);
        if (orl_serializer_reads(&k->serializer) && text)
            orl_parsed_scene_warn(d, "%s", text);
    }
}

static void pass_counts(struct orl_scene_cache_stream *k)
{
    struct orl_parsed_scene *const d = k->d;
    orl_serialize_value(&k->serializer, &d->digest);
    orl_serialize_value(&k->serializer, &d->n_read);
    orl_serialize_value(&k->serializer, &d->n_degenerate);
    orl_serialize_value(&k->serializer, &d->n_undefined);
    orl_serialize_value(&k->serializer, &d->source.n_first_surfaces);
    orl_serialize_arena_array(&k->serializer, d->arena, &d->source.first_surfaces,
                              d->source.n_first_surfaces, sizeof *d->source.first_surfaces);
}

static void pass_all(struct orl_scene_cache_stream *k)
{
    pass_files(k);
    pass_counts(k);
    orl_cache_grids(k);
    orl_cache_patterns(k);
    orl_cache_materials(k);
    orl_cache_surfaces(k, &k->d->surfaces, &k->d->n_surfaces);
    orl_cache_opposed(k, &k->d->opposed, &k->d->n_opposed);
    pass_prototypes(k);
    pass_placements(k);
    pass_sky(k);
    pass_warnings(k);
}

/* ---- Entry points ---------------------------------------------------------------------------- */

bool orl_parsed_scene_is_cacheable(const struct orl_parsed_scene *parsed_scene)
{
    return parsed_scene->source.n_missing <= ORL_MISSING_FILES_MAX;
}

int orl_parsed_scene_save(const struct orl_parsed_scene *parsed_scene,
                          const unsigned char content[ORL_CHECKED_FILE_CONTENT], const char *path,
                          uint64_t *ret_bytes, struct orl_error *err)
{
    struct orl_checked_writer *const out = malloc(sizeof *out);
    struct orl_scene_cache_stream k = {.d = (struct orl_parsed_scene *)(uintptr_t)parsed_scene};
    if (!out)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory writing a scene");
    k.serializer = orl_serializer_to(out);
    int code = orl_checked_writer_begin(out, &kind, path, err);
    if (code == 0) {
        pass_all(&k);
        code = orl_checked_writer_end(out, content, ret_bytes, err);
    }
    free(out);
    return code;
}

/* Reports the error of a failed stream; an error that loading a BSDF has set takes precedence. */
static int report_failure(const struct orl_scene_cache_stream *k, const char *path,
                          struct orl_error *err)
{
    const int code = k->serializer.code;
    if (code < 0 && (!k->err || k->err->code != code))
        orl_error_set(err, code,
                      code == ORL_ERR_VERSION ? "'%s' was made from files that have changed"
                      : code == ORL_ERR_NOMEM ? "out of memory for the scene '%s'"
                                              : "the cached scene '%s' is damaged",
                      path);
    return code;
}

int orl_parsed_scene_load(const char *path, const unsigned char content[ORL_CHECKED_FILE_CONTENT],
                          struct orl_sources *sources, struct orl_parsed_scene *ret_parsed_scene,
                          struct orl_error *err)
{
    struct orl_parsed_scene d = {.arena = sources->arena, .coincidences_resolved = true};
    struct orl_scene_cache_stream k = {.d = &d, .sources = *sources, .err = err};
    memset(sources, 0, sizeof *sources);
    int code = d.arena ? orl_checked_file_open(&kind, path, content, &d.file, err)
                       : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the scene");
    if (code == 0) {
        k.serializer = orl_serializer_from(&d.file);
        pass_all(&k);
        code = report_failure(&k, path, err);
    }
    orl_sources_done(&k.sources);
    if (code == 0)
        *ret_parsed_scene = d;
    else
        orl_parsed_scene_done(&d);
    return code;
}
