#include "render/image/image.h"

#include <stdlib.h>

#include "render/gather/icache.h"
#include "render/image/adaptive_tile.h"

enum { LAMP_RAYS = 4 };
/* Rays into a pane's lobes; fewer if the rest is not gathered and the picture has larger other
 * errors. */
enum { PANE_SAMPLES = 28, FEWER_PANE_SAMPLES = 12, GLOSS_SAMPLES = 4 };
static const double least_weight =
    0.004; /* branches below this share of the pixel are not followed */
/* Weight in the pixel below which a lobe is faint. */
static const double faint_lobe = 0.1;
enum { COARSEST_STEP = 16, RECORDS_A_ROUND = 256, HOLDS = 2 };

/*
 * Rows of a record's hemisphere, by the step that requests it: late records serve fewer pixels.
 * Along the lines where surfaces meet, late records have few neighbours, and their noise shows as
 * stitches. The cause is windows that few rays find. Hemispheres send more rays to these by
 * themselves, so that few rows suffice.
 */
enum { ROWS = 12, ROWS_OF_STEP_4 = 8, LEAST_ROWS = 6 };
/* Lower limit for pictures with fewer rays than usual. */
enum { FEWEST_ROWS = 4 };

/* Steps down to which all places are tested: if the rest is read, and if it is gathered. */
enum { ALL_READ_OF_STEP = 8, ALL_OF_STEP = 2 };

/* Pixels of a picture for which these rows hold. In smaller pictures each of the fewer records
 * covers a larger part, so that it gets more rows, up to this factor. */
static const double large_picture = 1 << 17, most_finer = 1.5;

/* Places of one lattice row that need a record. */
struct row {
    struct orl_irradiance_record *places; /* with the least radius that pixels allow */
    size_t count, capacity;
    size_t looks, lobes; /* rays through the row's places, and those of them that met lobes */
    bool out_of_memory;
};

struct painter {
    const struct orl_gather *gather;
    const struct orl_painting *painting;
    struct orl_shader shader;
    struct orl_icache cache;
    bool outside;
    struct orl_pixel_footprint footprint;
    /* A round of records: places are found row by row, then records are computed. */
    uint32_t step;
    double before, share; /* progress of the view: by earlier rounds, and the share of this one */
    double records;       /* share of the progress by all rounds and by fitting records */
    uint64_t *seen;       /* for every second pixel: what its lattice ray saw */
    struct row *rows;
    struct orl_irradiance_record *wanted;
    size_t n_wanted, first_record;
};

static bool cancelled(const struct painter *p)
{
    return orl_paint_cancelled(p->painting->env);
}

/* Returns the random seed of this view. */
static uint64_t seed_of(const struct painter *p)
{
    return p->gather->seed + p->painting->env->index;
}

/* ---- Records --------------------------------------------------------------------------------- */

/* Returns the last step. If only the outside is gathered, a round at step 1 would find next to
 * nothing. */
static uint32_t finest_step(const struct painter *p)
{
    return p->gather->indirect->gathered || p->outside ? 1 : 2;
}

/* Returns the factor of rays over the usual number. */
static double rays_of(const struct painter *p)
{
    return p->painting->rays > 0 ? p->painting->rays : 1;
}

/* Returns the rows of a record. Inside, where the rest is read, even few rays are more accurate
 * than what they replace. */
static uint32_t rows_of(const struct painter *p, const struct orl_shading_point *place)
{
    const struct orl_film *film = p->painting->film;
    const double finer = cbrt(sqrt(large_picture / ((double)film->width * film->height)));
    const bool coarse = p->step > 2 && orl_lighting_gathers(p->gather, place);
    const uint32_t rows = !coarse ? LEAST_ROWS : p->step > 4 ? ROWS : ROWS_OF_STEP_4;
    const double all = rows * fmin(fmax(finer, 1), most_finer) * sqrt(rays_of(p));
    return (uint32_t)lrint(fmin(fmax(all, FEWEST_ROWS), ORL_HEMISPHERE_ROWS));
}

static uint32_t pane_samples_of(const struct painter *p)
{
    const bool gathered = p->gather->indirect->gathered;
    return (uint32_t)ceil((gathered ? PANE_SAMPLES : FEWER_PANE_SAMPLES) * rays_of(p));
}

/* Computes a record; its random stream is named by the record's index. */
static void compute_record(void *arg, size_t index, uint32_t member)
{
    const struct painter *p = arg;
    struct orl_irradiance_record *record = &p->wanted[p->first_record + index];
    struct orl_random random =
        orl_random_stream(seed_of(p), ORL_PURPOSE_RECORD, p->cache.count + p->first_record + index);
    if (cancelled(p))
        return;
    *record = orl_irradiance_record_make(p->gather, &record->place, record->least,
                                         rows_of(p, &record->place), &p->cache, &random,
                                         &p->painting->env->searches[member]);
}

static void request_record(struct row *row, const struct orl_vertex *v,
                           const struct orl_pixel_footprint *footprint)
{
    if (row->count == row->capacity) {
        const size_t capacity = row->capacity ? 2 * row->capacity : 16;
        struct orl_irradiance_record *grown = realloc(row->places, capacity * sizeof *grown);
        if (!grown) {
            row->out_of_memory = true;
            return;
        }
        row->places = grown;
        row->capacity = capacity;
    }
    row->places[row->count++] = (struct orl_irradiance_record){
        .place = v->place, .least = orl_pixel_footprint_radius(footprint, v->distance)};
}

/* Returns true if a place needs no record; in the last round it suffices that a record can be
 * read. */
static bool is_served(const struct painter *p, const struct orl_shading_point *place)
{
    return p->step > finest_step(p) ? orl_icache_covers(&p->cache, place)
                                    : orl_icache_has_record_for(&p->cache, place);
}

/* Returns true if the value read at a place is in doubt. */
static bool is_doubted(const struct painter *p, const struct orl_vertex *v,
                       struct orl_search *search)
{
    struct orl_surface_point surface_point;
    if (!p->gather->indirect->knows_spread ||
        !orl_gather_find_surface(p->gather, v->on_surface, v->place.normal, &surface_point))
        return false;
    const struct orl_density read = orl_gather_indirect(p->gather, &surface_point, search);
    return orl_lighting_gathered_share(&read) > 0;
}

/*
 * The result of a lattice ray: its path signature, or SEEN_GATHERED if the rest is read and
 * something there is gathered in spite of that. If the rest is read few places need a record, and
 * finer rounds test only the places about those and where the signature changes. The last round of
 * a gathered picture does likewise: places between equal signatures are served.
 */
enum { SEEN_GATHERED };

static uint64_t *seen_at(const struct painter *p, uint32_t x, uint32_t y)
{
    return &p->seen[(size_t)(y / 2) * ((p->painting->film->width + 1) / 2) + x / 2];
}

/* The previous lattice's results about a point. */
struct told {
    bool all;      /* all points about it have the same result, with nothing gathered */
    bool gathered; /* at one of them something is gathered */
    uint64_t seen;
};

static struct told previous_results(const struct painter *p, uint32_t x, uint32_t y)
{
    const uint32_t coarse = 2 * p->step, x0 = x - x % coarse, y0 = y - y % coarse;
    const uint32_t x1 = x == x0 ? x : x0 + coarse, y1 = y == y0 ? y : y0 + coarse;
    const bool beyond_x = x1 >= p->painting->film->width;
    const bool beyond_y = y1 >= p->painting->film->height;
    const uint64_t seen[4] = {*seen_at(p, x0, y0), *seen_at(p, beyond_x ? x0 : x1, y0),
                              *seen_at(p, x0, beyond_y ? y0 : y1),
                              *seen_at(p, beyond_x ? x0 : x1, beyond_y ? y0 : y1)};
    struct told told = {.all = !beyond_x && !beyond_y, .seen = seen[0]};
    for (int i = 0; i < 4; i++) {
        told.gathered = told.gathered || seen[i] == SEEN_GATHERED;
        told.all = told.all && seen[i] == seen[0];
    }
    told.all = told.all && !told.gathered;
    return told;
}

/* Traces a ray through the centre of a pixel to find places without a record; with `doubt`, also
 * places where the value read is in doubt. Returns what the ray has seen. */
static uint64_t look_for_places(const struct painter *p, uint32_t x, uint32_t y, bool doubt,
                                struct row *row, struct orl_search *search)
{
    struct orl_vec3 origin, direction;
    struct orl_shaded_ray shaded;
    struct orl_random random = {0};
    bool gathered = false;
    if (!orl_paint_ray(p->painting, x + 0.5, y + 0.5, &origin, &direction))
        return SEEN_GATHERED + 1;
    orl_shade_ray(&p->shader, origin, direction, p->outside, false, &random, search, &shaded);
    row->looks++;
    row->lobes += shaded.has_lobes;
    for (uint32_t i = 0; i < shaded.n_vertices; i++) {
        const struct orl_vertex *v = &shaded.vertices[i];
        const bool is_read = !orl_lighting_gathers(p->gather, &v->place);
        const bool served = (!is_read || doubt) && is_served(p, &v->place);
        const bool wants = !served && (!is_read || (doubt && is_doubted(p, v, search)));
        if (wants)
            request_record(row, v, &p->footprint);
        gathered = gathered || served || wants;
    }
    return gathered && !p->gather->indirect->gathered ? SEEN_GATHERED : shaded.path_signature | 1;
}

/* Finds the places along one lattice row. */
static void look_along_row(void *arg, size_t index, uint32_t member)
{
    const struct painter *p = arg;
    struct orl_search *search = &p->painting->env->searches[member];
    const uint32_t step = p->step, y = (uint32_t)index * step;
    const bool all =
        step >= (uint32_t)(p->gather->indirect->gathered ? ALL_OF_STEP : ALL_READ_OF_STEP);
    for (uint32_t x = 0; x < p->painting->film->width && !cancelled(p); x += step) {
        if (!all && x % (2 * step) == 0 && y % (2 * step) == 0)
            continue; /* the previous lattice contains this point */
        const struct told told = all ? (struct told){.gathered = true} : previous_results(p, x, y);
        const uint64_t seen =
            told.all ? told.seen : look_for_places(p, x, y, told.gathered, &p->rows[index], search);
        if (step > 1)
            *seen_at(p, x, y) = seen;
    }
}

/* Joins the rows' places into one array, in order, and thins them out. Empties the rows. */
static int join_rows(struct painter *p, size_t rows)
{
    size_t total = 0;
    bool short_of_memory = false;
    for (size_t i = 0; i < rows; i++) {
        total += p->rows[i].count;
        short_of_memory = short_of_memory || p->rows[i].out_of_memory;
    }
    struct orl_irradiance_record *wanted = realloc(p->wanted, (total + 1) * sizeof *wanted);
    if (wanted)
        p->wanted = wanted;
    p->n_wanted = 0;
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = 0; wanted && k < p->rows[i].count; k++)
            wanted[p->n_wanted++] = p->rows[i].places[k];
        free(p->rows[i].places);
    }
    return wanted && !short_of_memory ? orl_irradiance_records_thin(p->wanted, &p->n_wanted)
                                      : ORL_ERR_NOMEM;
}

/* Returns the number of rays through the lattice's points, or of those that met lobes. */
static size_t count_looks(const struct painter *p, size_t rows, bool lobes)
{
    size_t sum = 0;
    for (size_t i = 0; i < rows; i++)
        sum += lobes ? p->rows[i].lobes : p->rows[i].looks;
    return sum;
}

static void report_records(const struct painter *p)
{
    const size_t end = p->first_record + RECORDS_A_ROUND;
    const double part = end < p->n_wanted ? (double)end / (double)p->n_wanted : 1;
    p->painting->env->progress(p->painting->env->ctx, p->before + p->share * part);
}

static int compute_wanted(struct painter *p)
{
    for (p->first_record = 0; p->first_record < p->n_wanted; p->first_record += RECORDS_A_ROUND) {
        const size_t left = p->n_wanted - p->first_record;
        orl_parallel_for(p->painting->env->pool, left < RECORDS_A_ROUND ? left : RECORDS_A_ROUND,
                         compute_record, p);
        if (cancelled(p))
            return ORL_ERR_CANCELLED;
        report_records(p);
    }
    /* p->wanted is freed in orl_image_render, which the analyzer cannot see from here. */
    /* NOLINTNEXTLINE(clang-analyzer-unix.Malloc) */
    int code = orl_icache_add(&p->cache, p->wanted, p->n_wanted);
    if (code == 0)
        code = orl_icache_index(&p->cache);
    /* After the last round no further records could serve the places that are no longer reached. */
    for (int i = 0; i < HOLDS && code == 0 && p->step > finest_step(p); i++)
        code = orl_icache_clamp_neighbours(&p->cache, p->painting->env->pool);
    return code;
}

/*
 * Rough shares of a view's time: one for each round of records, from the coarsest on, and one for
 * fitting them. Pixels take the remainder. They hold for a view without lobes; times_of_lobes is
 * the factor for a pixel with lobes.
 */
enum { STEPS = 5 };
static const double shares_gathered[STEPS + 1] = {0.13, 0.105, 0.13, 0.185, 0.07, 0.01};
static const double shares_read[STEPS + 1] = {0.02, 0.045, 0.06, 0.095, 0, 0};
/* It traces as many gather rays; reading maps instead is negligible. */
static const double times_of_lobes = 40;

static double sum_of(const double shares[STEPS + 1])
{
    double sum = 0;
    for (int round = 0; round <= STEPS; round++)
        sum += shares[round];
    return sum;
}

/* Estimates the pixels' share of the time from the coarsest lattice's rays. */
static void foresee_pixels(struct painter *p, size_t looks, size_t lobes)
{
    const bool gathered = p->gather->indirect->gathered;
    const double records = sum_of(gathered ? shares_gathered : shares_read), rays = rays_of(p);
    const double met = gathered && looks > 0 ? (double)lobes / (double)looks : 0;
    const double pixels = (1 - records) * (1 + times_of_lobes * met * rays);
    p->records = records * rays / (records * rays + pixels);
    p->painting->env->phase(p->painting->env->ctx, 0, p->records);
}

static double share_of_round(const struct painter *p, int round)
{
    const double *shares = p->gather->indirect->gathered ? shares_gathered : shares_read;
    return p->records * shares[round] / sum_of(shares);
}

/* Makes records in rounds, from a coarse lattice to every pixel. */
static int place_records(struct painter *p)
{
    const struct orl_film *film = p->painting->film;
    int code = 0, round = 0;
    const size_t across = (film->width + 1) / 2, down = (film->height + 1) / 2;
    p->seen = calloc(across * down, sizeof *p->seen);
    if (!p->seen)
        return ORL_ERR_NOMEM;
    for (p->step = COARSEST_STEP; p->step >= finest_step(p) && code == 0; p->step /= 2) {
        const size_t rows = (film->height + p->step - 1) / p->step;
        p->rows = calloc(rows, sizeof *p->rows);
        if (!p->rows)
            return ORL_ERR_NOMEM;
        orl_parallel_for(p->painting->env->pool, rows, look_along_row, p);
        code = join_rows(p, rows);
        if (round == 0)
            foresee_pixels(p, count_looks(p, rows, false), count_looks(p, rows, true));
        p->share = share_of_round(p, round++);
        free(p->rows);
        if (code == 0)
            code = compute_wanted(p);
        p->before += p->share;
        p->painting->env->progress(p->painting->env->ctx, p->before);
    }
    if (code == 0)
        code = orl_icache_fit(&p->cache, p->gather->lit_scene->geometry, p->painting->env->pool);
    p->before += share_of_round(p, STEPS);
    return code;
}

/* ---- The view -------------------------------------------------------------------------------- */

/*
 * Returns the radiance along a lobe's ray. A near surface is lit again by a single ray, which
 * sometimes hits a window: a speck. That is acceptable for a strong lobe, which would show how
 * coarse the maps are. A faint lobe reads texels and records instead.
 */
static struct orl_rgb lobe_radiance(const void *ctx, const struct orl_lobe_ray *lobe,
                                    struct orl_random *random, struct orl_search *search)
{
    const struct painter *p = ctx;
    const bool faint = lobe->weight < faint_lobe;
    const struct orl_gather_ray ray = {.origin = lobe->origin,
                                       .direction = lobe->direction,
                                       .outside = lobe->outside,
                                       .finds_caustics = true,
                                       .lobe_mis_pdf = lobe->mis_pdf,
                                       .reads_texels = faint,
                                       .reads_records = faint,
                                       .icache = &p->cache};
    return orl_gather_radiance(p->gather, &ray, random, search);
}

static int paint_pixels(const struct painter *p)
{
    const uint32_t lamps = (uint32_t)(p->gather->lit_scene->n_emitters > 0);
    atomic_bool failed = false;
    struct orl_tile_painter tile_painter = {
        .lighting = {p->gather, &p->cache, p->footprint, lamps ? LAMP_RAYS : 1},
        .shader = p->shader,
        .painting = p->painting,
        .seed = seed_of(p),
        .outside = p->outside,
        .failed = &failed};
    const int code = orl_paint_tiles(p->painting, orl_tile_painter_paint, &tile_painter, p->before);
    return code == 0 && atomic_load(&failed) ? ORL_ERR_NOMEM : code;
}

int orl_image_render(const struct orl_gather *gather, const struct orl_painting *painting,
                     struct orl_error *err)
{
    struct painter painter = {.gather = gather,
                              .painting = painting,
                              .shader = {.lit_scene = gather->lit_scene,
                                         .backs_unseen = painting->view->backs_unseen,
                                         .irradiance = painting->irradiance,
                                         .sobol = &gather->sobol,
                                         .gloss_samples = GLOSS_SAMPLES,
                                         .least_weight = least_weight,
                                         .radiance = lobe_radiance,
                                         .ctx = &painter}};
    const struct orl_view *view = painting->view;
    const struct orl_vec3 eye = orl_sub(view->point, gather->lit_scene->geometry->center);
    const double degrees = fmax(view->horizontal, view->vertical);
    const double side = fmax(painting->film->width, painting->film->height);
    struct orl_small_lights small_lights;
    painter.shader.pane_samples = pane_samples_of(&painter);
    painter.outside = orl_lit_scene_is_outside(gather->lit_scene, eye);
    painter.footprint =
        view->type == 'l'
            ? (struct orl_pixel_footprint){.width = view->horizontal / painting->film->width}
            : (struct orl_pixel_footprint){
                  .angle = fmax(degrees * ORL_DEG_TO_RAD, 0.05) / side,
                  .start = view->fore,
                  .nearest = orl_geometry_resolution(gather->lit_scene->geometry)};
    orl_icache_init(&painter.cache, gather->lit_scene->omit.channels);
    painter.cache.geometry = gather->lit_scene->geometry;
    int code = orl_small_lights_init(&small_lights, gather->lit_scene, painting);
    painter.shader.suns = small_lights.suns;
    painter.shader.excluded_lamps = small_lights.lamps;
    if (code == 0)
        code = place_records(&painter);
    if (code == 0)
        code = paint_pixels(&painter);
    if (code == 0)
        orl_small_lights_paint(&small_lights, &painter.shader, painting, painter.outside);
    orl_small_lights_done(&small_lights);
    orl_icache_done(&painter.cache);
    free(painter.wanted);
    free(painter.seen);
    if (code == ORL_ERR_CANCELLED)
        return orl_error_set(err, code, "cancelled while rendering a view");
    if (code < 0)
        return orl_error_set(err, code, "out of memory rendering a view");
    return 0;
}
