#include "scene/cache/scene_cache_file.h"
#include "scene/grid/grid.h"
#include "scene/material/patterns/pattern.h"

static void pass_grid_data(struct orl_serializer *serializer, struct orl_grid *grid)
{
    struct orl_grid image = *grid;
    bool uneven[ORL_GRID_AXES];
    image.values = NULL;
    for (int i = 0; i < ORL_GRID_AXES; i++) {
        uneven[i] = image.axes[i].places != NULL;
        image.axes[i].places = NULL;
    }
    orl_serialize_value(serializer, &image);
    orl_serialize_value(serializer, &uneven);
    if (orl_serializer_reads(serializer))
        *grid = image;
    for (int i = 0; i < ORL_GRID_AXES; i++)
        if (uneven[i])
            orl_serialize_array(serializer, &grid->axes[i].places, grid->axes[i].n,
                                sizeof *grid->axes[i].places);
    orl_serialize_array(serializer, &grid->values, grid->n_values, sizeof *grid->values);
}

void orl_cache_grids(struct orl_scene_cache_stream *k)
{
    struct orl_parsed_scene *const d = k->d;
    struct orl_serializer *const serializer = &k->serializer;
    size_t n = d->n_grids;
    orl_serialize_value(serializer, &n);
    orl_serializer_alloc(serializer, &d->grids, n, sizeof(struct orl_grid *));
    for (size_t i = 0; i < n && serializer->code == 0; i++) {
        orl_serializer_alloc(serializer, &d->grids[i], 1, sizeof *d->grids[i]);
        d->n_grids = i + 1;
        if (d->grids[i])
            pass_grid_data(serializer, d->grids[i]);
    }
}

/* Stores a pattern as its index + 1; 0: none. */
void orl_cache_pattern(struct orl_scene_cache_stream *k, struct orl_pattern **slot)
{
    const bool reads = orl_serializer_reads(&k->serializer);
    uint32_t number = !reads && *slot ? (*slot)->index + 1 : 0;
    orl_serialize_value(&k->serializer, &number);
    if (number > k->d->n_patterns)
        orl_serializer_fail(&k->serializer, ORL_ERR_CORRUPT);
    else if (reads)
        *slot = number > 0 ? k->d->patterns[number - 1] : NULL;
}

/* orl_cache_pattern for a pointer to const. */
static void pass_other(struct orl_scene_cache_stream *k, const struct orl_pattern **slot)
{
    struct orl_pattern *pattern = (struct orl_pattern *)(uintptr_t)*slot;
    orl_cache_pattern(k, &pattern);
    *slot = pattern;
}

static void pass_grid(struct orl_scene_cache_stream *k, const struct orl_grid **slot)
{
    const struct orl_parsed_scene *const d = k->d;
    uint32_t number = 0;
    while (!orl_serializer_reads(&k->serializer) && number < d->n_grids &&
           d->grids[number] != *slot)
        number++;
    orl_serialize_value(&k->serializer, &number);
    if (number >= d->n_grids)
        orl_serializer_fail(&k->serializer, ORL_ERR_CORRUPT);
    else
        *slot = d->grids[number];
}

/* ---- Texts ----------------------------------------------------------------------------------- */

static void pass_glyph(struct orl_scene_cache_stream *k, struct orl_glyph *glyph)
{
    const unsigned char *corners = glyph->corners;
    glyph->corners = NULL;
    orl_serialize_value(&k->serializer, glyph);
    if (glyph->n < 0)
        orl_serializer_fail(&k->serializer, ORL_ERR_CORRUPT);
    else
        orl_serialize_arena_array(&k->serializer, k->d->arena, &corners, (size_t)glyph->n, 2);
    glyph->corners = corners;
}

static void pass_letter(struct orl_scene_cache_stream *k, struct orl_placed_letter *letter)
{
    struct orl_glyph image = {.n = 0};
    struct orl_glyph *own = NULL;
    if (!orl_serializer_reads(&k->serializer))
        image = *letter->glyph;
    orl_serialize_value(&k->serializer, &letter->at);
    pass_glyph(k, &image);
    if (!orl_serializer_reads(&k->serializer))
        return;
    own = orl_arena_alloc(k->d->arena, sizeof *own);
    if (!own) {
        orl_serializer_fail(&k->serializer, ORL_ERR_NOMEM);
        return;
    }
    *own = image;
    letter->glyph = own;
}

/* Returns an array in the arena when reading, else the existing array. */
static void *array_for(struct orl_scene_cache_stream *k, const void *there, size_t n, size_t item)
{
    if (!orl_serializer_reads(&k->serializer))
        return (void *)(uintptr_t)there;
    if (n > (size_t)(k->serializer.end - k->serializer.at)) /* each item takes at least one byte */
        orl_serializer_fail(&k->serializer, ORL_ERR_CORRUPT);
    void *const made =
        k->serializer.code == 0 ? orl_arena_alloc(k->d->arena, (n + 1) * item) : NULL;
    if (!made)
        orl_serializer_fail(&k->serializer, ORL_ERR_NOMEM);
    return made;
}

static void pass_line(struct orl_scene_cache_stream *k, struct orl_lettering_line *line)
{
    orl_serialize_value(&k->serializer, &line->n);
    orl_serialize_value(&k->serializer, &line->width);
    struct orl_placed_letter *const letters = array_for(k, line->letters, line->n, sizeof *letters);
    for (size_t i = 0; letters && i < line->n && k->serializer.code == 0; i++)
        pass_letter(k, &letters[i]);
    line->letters = letters;
}

static void pass_text(struct orl_scene_cache_stream *k, const struct orl_lettering **slot)
{
    struct orl_lettering *const text = array_for(k, *slot, 1, sizeof *text);
    if (!text)
        return;
    struct orl_lettering image = *text;
    image.lines = NULL;
    orl_serialize_value(&k->serializer, &image);
    struct orl_lettering_line *const lines =
        array_for(k, text->lines, image.n_lines, sizeof *lines);
    for (size_t i = 0; lines && i < image.n_lines && k->serializer.code == 0; i++)
        pass_line(k, &lines[i]);
    if (!orl_serializer_reads(&k->serializer))
        return;
    image.lines = lines;
    *text = image;
    *slot = text;
}

/* ---- Patterns -------------------------------------------------------------------------------- */

/* Writes or reads the struct without its pointers and without the values computed once geometry is
 * built. */
static void pass_image(struct orl_serializer *serializer, struct orl_pattern *p)
{
    struct orl_pattern image = *p;
    image.name = image.file = NULL;
    image.key = NULL;
    image.program.function = image.program.values = NULL;
    image.under = image.other = NULL;
    image.geometry = NULL;
    image.parsed_scene = NULL;
    for (size_t i = 0; i < ORL_GRID_CHANNELS; i++)
        image.program.grids[i] = NULL;
    if (image.source == ORL_PATTERN_TEXT)
        image.as_source.text.lettering = NULL;
    if (image.source == ORL_PATTERN_SPECTRUM)
        image.as_source.spectrum.bands = NULL;
    for (int i = 0; image.role == ORL_PATTERN_BLEND && i < 2; i++)
        image.as_role.blend.mixed[i].pattern = NULL;
    if (image.role == ORL_PATTERN_LOBES) {
        image.as_role.lobes.tables = NULL;
        image.as_role.lobes.n_tables = 0;
    }
    orl_serialize_value(serializer, &image);
    if (orl_serializer_reads(serializer))
        *p = image;
}

static void pass_pattern(struct orl_scene_cache_stream *k, struct orl_pattern *p)
{
    struct orl_serializer *const serializer = &k->serializer;
    struct orl_arena *const arena = k->d->arena;
    pass_image(serializer, p);
    orl_serialize_text(serializer, arena, &p->name);
    orl_serialize_text(serializer, arena, &p->file);
    orl_serialize_arena_array(serializer, arena, &p->key, p->key_size, 1);
    orl_function_serialize(&p->program.function, serializer);
    orl_function_serialize(&p->program.values, serializer);
    pass_other(k, &p->under);
    pass_other(k, &p->other);
    for (int i = 0; p->role == ORL_PATTERN_BLEND && i < 2; i++)
        pass_other(k, &p->as_role.blend.mixed[i].pattern);
    for (uint32_t i = 0; i < p->program.n_grids && i < ORL_GRID_CHANNELS; i++)
        pass_grid(k, &p->program.grids[i]);
    if (p->source == ORL_PATTERN_SPECTRUM) {
        struct orl_pattern_spectrum *const spectrum = &p->as_source.spectrum;
        orl_serialize_arena_array(serializer, arena, &spectrum->bands, spectrum->n_bands,
                                  sizeof *spectrum->bands);
    }
    if (p->source == ORL_PATTERN_TEXT)
        pass_text(k, &p->as_source.text.lettering);
}

static void make_room(struct orl_scene_cache_stream *k, size_t n)
{
    struct orl_parsed_scene *const d = k->d;
    orl_serializer_alloc(&k->serializer, &d->patterns, n, sizeof(struct orl_pattern *));
    for (size_t i = 0; i < n && k->serializer.code == 0; i++) {
        orl_serializer_alloc(&k->serializer, &d->patterns[i], 1, sizeof *d->patterns[i]);
        d->n_patterns = i + 1;
    }
}

/* Patterns refer to each other, so all are allocated before any is filled. */
void orl_cache_patterns(struct orl_scene_cache_stream *k)
{
    size_t n = k->d->n_patterns;
    orl_serialize_value(&k->serializer, &n);
    if (orl_serializer_reads(&k->serializer))
        make_room(k, n);
    for (size_t i = 0; i < n && k->serializer.code == 0; i++)
        pass_pattern(k, k->d->patterns[i]);
}
