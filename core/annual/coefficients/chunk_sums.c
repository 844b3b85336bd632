#include "annual/coefficients/chunk_sums.h"

#include <stdlib.h>

enum { BATCHES = ORL_ANNUAL_BATCHES, PHOTON_BATCHES = ORL_SUN_PHOTON_BATCHES };

void orl_chunk_sums_init(struct orl_chunk_sums *s, struct orl_arrays *arrays)
{
    const size_t batches = s->n_sensors * BATCHES, lights = batches * s->n_window_groups;
    const size_t lit_suns = s->n_sensors * s->n_window_groups;
    s->lit = orl_arrays_new(arrays, lights, sizeof *s->lit);
    s->bins = orl_arrays_new(arrays, lights * ORL_BINS, sizeof *s->bins);
    s->nodes = orl_arrays_new(arrays, lights * s->n_nodes, sizeof *s->nodes);
    s->beams = orl_arrays_new(arrays, batches * s->n_beams, sizeof *s->beams);
    s->photon_batches =
        orl_arrays_new(arrays, batches * PHOTON_BATCHES * s->n_beams, sizeof *s->photon_batches);
    s->sun_lit = orl_arrays_new(arrays, lit_suns, sizeof *s->sun_lit);
    s->suns = orl_arrays_new(arrays, lit_suns * ORL_SUNLIGHT_ROWS * s->n_suns, sizeof *s->suns);
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
    struct orl_span of_lit[MOST_ARRAYS]; /* bytes per window group */
    struct orl_span whole[MOST_ARRAYS];
};

static struct layout layout_of(const struct orl_chunk_sums *s, enum orl_chunk_part part,
                               size_t count)
{
    const size_t batches = count * BATCHES;
    if (part == ORL_CHUNK_SUNS)
        return (struct layout){
            .lit = s->sun_lit,
            .n_lights = count * s->n_window_groups,
            .of_lit = {{s->suns, ORL_SUNLIGHT_ROWS * s->n_suns * sizeof *s->suns}}};
    return (struct layout){.lit = s->lit,
                           .n_lights = batches * s->n_window_groups,
                           .of_lit = {{s->bins, ORL_BINS * sizeof *s->bins},
                                      {s->nodes, s->n_nodes * sizeof *s->nodes}},
                           .whole = {{s->beams, batches * s->n_beams * sizeof *s->beams},
                                     {s->photon_batches, batches * PHOTON_BATCHES * s->n_beams *
                                                             sizeof *s->photon_batches}}};
}

void orl_chunk_sums_clear(struct orl_chunk_sums *s, enum orl_chunk_part part, size_t count)
{
    const struct layout l = layout_of(s, part, count);
    memset(l.lit, 0, l.n_lights);
    for (int k = 0; k < MOST_ARRAYS; k++)
        if (l.whole[k].bytes > 0)
            memset(l.whole[k].at, 0, l.whole[k].bytes);
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
        const struct orl_span *a = &l->of_lit[k];
        for (size_t i = 0; i < l->n_lights && a->bytes > 0; i++) {
            char *value = (char *)a->at + i * a->bytes;
            if (!l->lit[i])
                continue;
            memcpy(out ? at : value, out ? value : at, a->bytes);
            at += a->bytes;
        }
    }
    for (int k = 0; k < MOST_ARRAYS; k++) {
        const struct orl_span *a = &l->whole[k];
        if (a->bytes > 0)
            memcpy(out ? at : a->at, out ? a->at : at, a->bytes);
        at += a->bytes;
    }
}

void *orl_chunk_sums_pack(const struct orl_chunk_sums *sums, enum orl_chunk_part part, size_t count,
                          size_t *ret_size)
{
    const struct layout l = layout_of(sums, part, count);
    *ret_size = size_of(&l, l.lit);
    char *data = calloc(1, *ret_size + 1);
    if (data) {
        memcpy(data, l.lit, l.n_lights);
        copy_values(&l, data, true);
    }
    return data;
}

bool orl_chunk_sums_unpack(struct orl_chunk_sums *sums, enum orl_chunk_part part, size_t count,
                           const void *data, size_t size)
{
    const struct layout l = layout_of(sums, part, count);
    if (!data || size < flag_bytes(&l) || size != size_of(&l, data)) {
        orl_chunk_sums_clear(sums, part, count);
        return false;
    }
    memcpy(l.lit, data, l.n_lights);
    copy_values(&l, (char *)(uintptr_t)data, false);
    return true;
}
