#include "scene/keep/scene_bytes.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "scene/keep/keep_parts.h"
#include "scene/material/pattern.h"

static const struct orl_sealed_kind kind = {
    .magic = "ORIELSC",
    .version = 1,
    .shape =
        (((((uint64_t)sizeof(struct orl_description) * 1000 + sizeof(struct orl_material)) * 1000 +
           sizeof(struct orl_pattern)) *
              1000 +
          sizeof(struct orl_placement)) *
             100 +
         sizeof(struct orl_sky)),
    .what = "scene"};

/* ---- Source files ---------------------------------------------------------------------------- */

/* Fails with ORL_ERR_VERSION if the caller's file of that name is missing or has changed. */
static void check_read_file(struct orl_scene_keeping *k, const char *name,
                            const struct orl_file_read *read)
{
    size_t index = 0;
    int code = orl_sources_open(&k->sources, name, read->library, &index, NULL);
    if (code == ORL_ERR_NOT_FOUND)
        code = ORL_ERR_VERSION;
    if (code == 0 &&
        memcmp(k->sources.items[index].content, read->content, sizeof read->content) != 0)
        code = ORL_ERR_VERSION;
    if (code < 0)
        orl_stream_fail(&k->stream, code);
}

static void check_missed(struct orl_scene_keeping *k, const struct orl_file_missed *missed)
{
    size_t index = 0;
    const int code = orl_sources_open(&k->sources, missed->name, missed->library, &index, NULL);
    if (code != ORL_ERR_NOT_FOUND)
        orl_stream_fail(&k->stream, code == 0 ? ORL_ERR_VERSION : code);
}

/* Allocates the arrays of file names and digests when reading. */
static bool make_room(struct orl_scene_keeping *k)
{
    struct orl_description *const d = k->d;
    if (!orl_stream_reads(&k->stream))
        return true;
    d->files = calloc(d->n_files + 1, sizeof *d->files);
    d->read = orl_arena_take(d->arena, (d->n_files + 1) * sizeof *d->read);
    d->missed = orl_arena_take(d->arena, (d->n_missed + 1) * sizeof *d->missed);
    if (!d->files || !d->read || !d->missed)
        orl_stream_fail(&k->stream, ORL_ERR_NOMEM);
    return k->stream.code == 0;
}

static void pass_files(struct orl_scene_keeping *k)
{
    struct orl_stream *const stream = &k->stream;
    struct orl_description *const d = k->d;
    orl_stream_value(stream, &d->n_files);
    orl_stream_value(stream, &d->n_main);
    orl_stream_value(stream, &d->n_missed);
    if (d->n_files > ORL_LIMIT_SCENE_FILES || d->n_missed > ORL_SOURCES_MISSED)
        orl_stream_fail(stream, ORL_ERR_CORRUPT);
    if (stream->code < 0 || !make_room(k))
        return;
    for (size_t i = 0; i < d->n_files && stream->code == 0; i++) {
        orl_stream_text(stream, d->arena, (const char **)&d->files[i]);
        orl_stream_value(stream, &d->read[i]);
        if (orl_stream_reads(stream) && stream->code == 0)
            check_read_file(k, d->files[i], &d->read[i]);
    }
    for (size_t i = 0; i < d->n_missed && stream->code == 0; i++) {
        orl_stream_text(stream, d->arena, &d->missed[i].name);
        orl_stream_value(stream, &d->missed[i].library);
        if (orl_stream_reads(stream) && stream->code == 0)
            check_missed(k, &d->missed[i]);
    }
}

/* ---- Other contents -------------------------------------------------------------------------- */

static void pass_prototypes(struct orl_scene_keeping *k)
{
    struct orl_description *const d = k->d;
    size_t n = d->n_prototypes;
    orl_stream_value(&k->stream, &n);
    orl_stream_room(&k->stream, &d->prototypes, n, sizeof *d->prototypes);
    for (size_t i = 0; i < n && k->stream.code == 0; i++) {
        struct orl_prototype *const p = &d->prototypes[i];
        d->n_prototypes = i + 1;
        orl_keep_surfaces(k, &p->surfaces, &p->n_surfaces);
        orl_keep_opposed(k, &p->opposed, &p->n_opposed);
        orl_stream_value(&k->stream, &p->prefix_bytes);
    }
}

/* Writes the struct without pointers, then the strings they point to. */
static void pass_placement(struct orl_scene_keeping *k, struct orl_placement *p)
{
    struct orl_placement image = *p;
    image.name = image.prefix = NULL;
    orl_stream_value(&k->stream, &image);
    if (orl_stream_reads(&k->stream))
        *p = image;
    orl_stream_text(&k->stream, k->d->arena, &p->name);
    orl_stream_text(&k->stream, k->d->arena, &p->prefix);
    if (p->prototype >= k->d->n_prototypes)
        orl_stream_fail(&k->stream, ORL_ERR_CORRUPT);
}

static void pass_distant(struct orl_scene_keeping *k, struct orl_distant *distant)
{
    struct orl_distant image = *distant;
    image.name = NULL;
    orl_stream_value(&k->stream, &image);
    if (orl_stream_reads(&k->stream))
        *distant = image;
    orl_stream_text(&k->stream, k->d->arena, (const char **)&distant->name);
}

static void pass_placements(struct orl_scene_keeping *k)
{
    struct orl_description *const d = k->d;
    orl_stream_value(&k->stream, &d->n_placements);
    orl_stream_room(&k->stream, &d->placements, d->n_placements, sizeof *d->placements);
    for (size_t i = 0; i < d->n_placements && k->stream.code == 0; i++)
        pass_placement(k, &d->placements[i]);
}

static void pass_sky(struct orl_scene_keeping *k)
{
    struct orl_description *const d = k->d;
    orl_stream_value(&k->stream, &d->n_distants);
    orl_stream_room(&k->stream, &d->distants, d->n_distants, sizeof *d->distants);
    for (size_t i = 0; i < d->n_distants && k->stream.code == 0; i++)
        pass_distant(k, &d->distants[i]);
    orl_stream_value(&k->stream, &d->n_skies);
    orl_stream_array(&k->stream, &d->skies, d->n_skies, sizeof *d->skies);
}

static void pass_warnings(struct orl_scene_keeping *k)
{
    struct orl_description *const d = k->d;
    size_t n = d->n_warnings;
    orl_stream_value(&k->stream, &n);
    for (size_t i = 0; i < n && k->stream.code == 0; i++) {
        const char *text = orl_stream_reads(&k->stream) ? NULL : d->warnings[i];
        orl_stream_text(&k->stream, d->arena, &text);
        if (orl_stream_reads(&k->stream) && text)
            orl_description_warn(d, text);
    }
}

static void pass_counts(struct orl_scene_keeping *k)
{
    struct orl_description *const d = k->d;
    orl_stream_value(&k->stream, &d->digest);
    orl_stream_value(&k->stream, &d->n_read);
    orl_stream_value(&k->stream, &d->n_degenerate);
    orl_stream_value(&k->stream, &d->n_undefined);
    orl_stream_value(&k->stream, &d->n_first_surfaces);
    orl_stream_kept(&k->stream, d->arena, &d->first_surfaces, d->n_first_surfaces,
                    sizeof *d->first_surfaces);
}

static void pass_all(struct orl_scene_keeping *k)
{
    pass_files(k);
    pass_counts(k);
    orl_keep_grids(k);
    orl_keep_patterns(k);
    orl_keep_materials(k);
    orl_keep_surfaces(k, &k->d->surfaces, &k->d->n_surfaces);
    orl_keep_opposed(k, &k->d->opposed, &k->d->n_opposed);
    pass_prototypes(k);
    pass_placements(k);
    pass_sky(k);
    pass_warnings(k);
}

/* ---- Entry points ---------------------------------------------------------------------------- */

bool orl_description_can_be_kept(const struct orl_description *description)
{
    return description->n_missed <= ORL_SOURCES_MISSED;
}

int orl_description_keep(const struct orl_description *description,
                         const unsigned char content[ORL_SEALED_CONTENT], const char *path,
                         uint64_t *ret_bytes, struct orl_error *err)
{
    struct orl_sealed_writer *const out = malloc(sizeof *out);
    struct orl_scene_keeping k = {.d = (struct orl_description *)(uintptr_t)description};
    if (!out)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory writing a scene");
    k.stream = orl_stream_to(out);
    int code = orl_sealed_begin(out, &kind, path, err);
    if (code == 0) {
        pass_all(&k);
        code = orl_sealed_end(out, content, ret_bytes, err);
    }
    free(out);
    return code;
}

/* Reports the error of a failed stream; keeps an error that loading a BSDF has already set. */
static int report_failure(const struct orl_scene_keeping *k, const char *path,
                          struct orl_error *err)
{
    const int code = k->stream.code;
    if (code < 0 && (!k->err || k->err->code != code))
        orl_error_set(err, code,
                      code == ORL_ERR_VERSION ? "'%s' is of files that have changed"
                      : code == ORL_ERR_NOMEM ? "out of memory for the scene '%s'"
                                              : "the kept scene '%s' is damaged",
                      path);
    return code;
}

int orl_description_open(const char *path, const unsigned char content[ORL_SEALED_CONTENT],
                         struct orl_sources *sources, struct orl_description *ret_description,
                         struct orl_error *err)
{
    struct orl_description d = {.arena = sources->arena, .settled = true};
    struct orl_scene_keeping k = {.d = &d, .sources = *sources, .err = err};
    memset(sources, 0, sizeof *sources);
    int code = d.arena ? orl_sealed_open(&kind, path, content, &d.file, err)
                       : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the scene");
    if (code == 0) {
        k.stream = orl_stream_from(&d.file);
        pass_all(&k);
        code = report_failure(&k, path, err);
    }
    orl_sources_done(&k.sources);
    if (code == 0)
        *ret_description = d;
    else
        orl_description_done(&d);
    return code;
}
