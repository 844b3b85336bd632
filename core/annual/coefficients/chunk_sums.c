#include "annual/coefficients/chunk_sums.h"

#include <stdlib.h>

#include <oriel/base/error.h>

enum { BATCHES = ORL_ANNUAL_BATCHES, PHOTON_BATCHES = ORL_SUN_PHOTON_BATCHES };

int orl_chunk_sums_init(struct orl_chunk_sums *s)
{
    const size_t batches = s->n_sensors * BATCHES, lights = batches * s->n_window_groups;
    const size_t lit_suns = s->n_sensors * s->n_window_groups;
    s->lit = calloc(lights + 1, sizeof *s->lit);
    s->bins = malloc((lights * ORL_BINS + 1) * sizeof *s->bins);
    s->nodes = malloc((lights * s->n_nodes + 1) * sizeof *s->nodes);
    s->beams = malloc((batches * s->n_beams + 1) * sizeof *s->beams);
    s->photon_batches =
        malloc((batches * PHOTON_BATCHES * s->n_beams + 1) * sizeof *s->photon_batches);
    s->sun_lit = calloc(lit_suns + 1, sizeof *s->sun_lit);
    s->suns = malloc((lit_suns * ORL_SUNLIGHT_ROWS * s->n_suns + 1) * sizeof *s->suns);
    return s->lit && s->bins && s->nodes && s->beams && s->photon_batches && s->sun_lit && s->suns
               ? 0
               : ORL_ERR_NOMEM;
}

void orl_chunk_sums_done(struct orl_chunk_sums *s)
{
    free(s->lit);
    free(s->bins);
    free(s->nodes);
    free(s->beams);
    free(s->photon_batches);
    free(s->sun_lit);
    free(s->suns);
    *s = (struct orl_chunk_sums){.lit = NULL};
}

void orl_chunk_sums_clear_paths(struct orl_chunk_sums *s, size_t count)
{
    const size_t batches = count * BATCHES;
    memset(s->lit, 0, batches * s->n_window_groups);
    memset(s->beams, 0, batches * s->n_beams * sizeof *s->beams);
    memset(s->photon_batches, 0, batches * PHOTON_BATCHES * s->n_beams * sizeof *s->photon_batches);
}

void orl_chunk_sums_clear_suns(struct orl_chunk_sums *s, size_t count)
{
    memset(s->sun_lit, 0, count * s->n_window_groups);
}

struct orl_path_sums orl_chunk_sums_of(const struct orl_chunk_sums *s, size_t sensor,
                                       uint32_t batch)
{
    const size_t at = sensor * BATCHES + batch, light = at * s->n_window_groups;
    return (struct orl_path_sums){.lit = s->lit + light,
                                  .bins = s->bins + light * ORL_BINS,
                                  .nodes = s->nodes + light * s->n_nodes,
                                  .n_nodes = s->n_nodes,
                                  .beams = s->beams + at * s->n_beams,
                                  .photon_batches =
                                      s->photon_batches + at * PHOTON_BATCHES * s->n_beams};
}

struct orl_sensor_sunlight orl_chunk_suns_of(const struct orl_chunk_sums *s, size_t sensor)
{
    const size_t light = sensor * s->n_window_groups;
    return (struct orl_sensor_sunlight){.at = s->suns + light * ORL_SUNLIGHT_ROWS * s->n_suns,
                                        .n_suns = s->n_suns,
                                        .lit = s->sun_lit + light};
}

/* ---- Packing --------------------------------------------------------------------------------- */

/* Layout of packed data: flags of the lit window groups, padded; the values of these, in order; and
 * arrays stored as a whole. */
enum { MOST_ARRAYS = 2 };
struct layout {
    unsigned char *lit;
    size_t n_lights;
    struct array {
        void *at;
        size_t bytes; /* per window group in of_lit, in total in whole */
    } of_lit[MOST_ARRAYS], whole[MOST_ARRAYS];
};

static struct layout paths_of(const struct orl_chunk_sums *s, size_t count)
{
    const size_t batches = count * BATCHES;
    return (struct layout){.lit = s->lit,
                           .n_lights = batches * s->n_window_groups,
                           .of_lit = {{s->bins, ORL_BINS * sizeof *s->bins},
                                      {s->nodes, s->n_nodes * sizeof *s->nodes}},
                           .whole = {{s->beams, batches * s->n_beams * sizeof *s->beams},
                                     {s->photon_batches, batches * PHOTON_BATCHES * s->n_beams *
                                                             sizeof *s->photon_batches}}};
}

static struct layout suns_of(const struct orl_chunk_sums *s, size_t count)
{
    return (struct layout){.lit = s->sun_lit,
                           .n_lights = count * s->n_window_groups,
                           .of_lit = {{s->suns, ORL_SUNLIGHT_ROWS * s->n_suns * sizeof *s->suns}}};
}

static size_t flag_bytes(const struct layout *l)
{
    return (l->n_lights + 7) / 8 * 8;
}

static size_t size_of(const struct layout *l, const unsigned char *lit)
{
    size_t size = flag_bytes(l), n = 0;
    for (size_t i = 0; i < l->n_lights; i++)
        n += lit[i] != 0;
    for (int k = 0; k < MOST_ARRAYS; k++)
        size += n * l->of_lit[k].bytes + l->whole[k].bytes;
    return size;
}

/* Copies values to (out) or from data, behind the flags at its start. */
static void copy_values(const struct layout *l, char *data, bool out)
{
    char *at = data + flag_bytes(l);
    for (int k = 0; k < MOST_ARRAYS; k++) {
        const struct array *a = &l->of_lit[k];
        for (size_t i = 0; i < l->n_lights && a->bytes > 0; i++) {
            char *value = (char *)a->at + i * a->bytes;
            if (!l->lit[i])
                continue;
            memcpy(out ? at : value, out ? value : at, a->bytes);
            at += a->bytes;
        }
    }
    for (int k = 0; k < MOST_ARRAYS; k++) {
        const struct array *a = &l->whole[k];
        if (a->bytes > 0)
            memcpy(out ? at : a->at, out ? a->at : at, a->bytes);
        at += a->bytes;
    }
}

static int pack_layout(const struct layout *l, void **ret_data, size_t *ret_size)
{
    const size_t size = size_of(l, l->lit);
    char *data = *ret_data = calloc(1, size + 1);
    if (!data)
        return ORL_ERR_NOMEM;
    memcpy(data, l->lit, l->n_lights);
    copy_values(l, data, true);
    *ret_size = size;
    return 0;
}

static bool unpack_layout(const struct layout *l, const void *data, size_t size)
{
    if (!data || size < flag_bytes(l) || size != size_of(l, data))
        return false;
    memcpy(l->lit, data, l->n_lights);
    copy_values(l, (char *)(uintptr_t)data, false);
    return true;
}

int orl_chunk_sums_pack_paths(const struct orl_chunk_sums *sums, size_t count, void **ret_data,
                              size_t *ret_size)
{
    const struct layout l = paths_of(sums, count);
    return pack_layout(&l, ret_data, ret_size);
}

int orl_chunk_sums_pack_suns(const struct orl_chunk_sums *sums, size_t count, void **ret_data,
                             size_t *ret_size)
{
    const struct layout l = suns_of(sums, count);
    return pack_layout(&l, ret_data, ret_size);
}

bool orl_chunk_sums_unpack_paths(struct orl_chunk_sums *sums, size_t count, const void *data,
                                 size_t size)
{
    const struct layout l = paths_of(sums, count);
    if (unpack_layout(&l, data, size))
        return true;
    orl_chunk_sums_clear_paths(sums, count);
    return false;
}

bool orl_chunk_sums_unpack_suns(struct orl_chunk_sums *sums, size_t count, const void *data,
                                size_t size)
{
    const struct layout l = suns_of(sums, count);
    if (unpack_layout(&l, data, size))
        return true;
    orl_chunk_sums_clear_suns(sums, count);
    return false;
}
