/* The gathered part at a place: a stratified hemisphere of one ray a stratum, and three or fifteen
 * more in strata whose neighbours differ. */
#include "render/gather/gather.h"
#include "scene/built/scene.h"

enum { AHEAD = 16 };

/*
 * Strata get CLOSER or CLOSEST rays across and down if their neighbours differ by more than
 * `contrast` or `much_contrast` times the mean of all strata. The noise of a stratum's only ray is
 * up to half of its neighbours' difference. If ten of some hundred strata differ by 20, one ray
 * each gives the mean to a third. Sixteen rays each leave only the edge of a window to chance, and
 * give the mean to some hundredths.
 */
enum { CLOSER = 2, CLOSEST = 4 };
static const double contrast = 5, much_contrast = 20;

/* A stratum: the radiance and the distance that its rays have found. */
struct strand {
    struct orl_rgb radiance;
    double distance;     /* harmonic mean */
    double variance;     /* variance of its luma over several rays; negative if there was one ray */
    double down, across; /* position of the first ray in the stratum */
    uint32_t side;       /* number of rays across, and down */
};

static double channel(struct orl_rgb c, uint32_t i)
{
    return i == 0 ? c.r : i == 1 ? c.g : c.b;
}

/* A column's directions in the plane: along its middle, normal to that, and normal to its first
 * edge. */
struct spoke {
    struct orl_vec3 out, turn, around;
};

static struct spoke spoke_of(const struct orl_frame *frame, uint32_t column, uint32_t columns)
{
    const double phi = 2 * ORL_PI * (column + 0.5) / columns, edge = 2 * ORL_PI * column / columns;
    return (struct spoke){
        .out = orl_add(orl_scale(frame->u, cos(phi)), orl_scale(frame->v, sin(phi))),
        .turn = orl_add(orl_scale(frame->u, -sin(phi)), orl_scale(frame->v, cos(phi))),
        .around = orl_add(orl_scale(frame->u, -sin(edge)), orl_scale(frame->v, cos(edge)))};
}

static double nearer_distance(const struct strand *a, const struct strand *b)
{
    return a->distance < b->distance ? a->distance : b->distance;
}

/* Adds one row's share of the gradients: differences to the strata below and beside. */
static void add_row(struct orl_hemisphere *h, const struct spoke *spokes,
                    const struct strand *strands, uint32_t rows, uint32_t columns, uint32_t row,
                    uint32_t channels)
{
    const double sine_low = sqrt((double)row / rows), sine_high = sqrt((row + 1.0) / rows);
    const double middle = sqrt((row + 0.5) / rows);
    const double turning = -middle / sqrt(1 - middle * middle) * ORL_PI / ((double)rows * columns);
    const double outwards = 2 * ORL_PI / columns * sine_low * (1 - sine_low * sine_low);
    for (uint32_t column = 0; column < columns; column++) {
        const struct strand *here = &strands[row * columns + column];
        const struct strand *beside = &strands[row * columns + (column + columns - 1) % columns];
        const struct strand *below = row > 0 ? here - columns : NULL;
        const double by_below = below ? outwards / nearer_distance(here, below) : 0;
        const double by_beside = (sine_high - sine_low) / nearer_distance(here, beside);
        for (uint32_t c = 0; c < channels; c++) {
            const double value = channel(here->radiance, c);
            struct orl_vec3 *shift = &h->translation_gradient[c];
            h->rotation_gradient[c] =
                orl_madd(h->rotation_gradient[c], spokes[column].turn, turning * value);
            if (below)
                *shift = orl_madd(*shift, spokes[column].out,
                                  by_below * (value - channel(below->radiance, c)));
            *shift = orl_madd(*shift, spokes[column].around,
                              by_beside * (value - channel(beside->radiance, c)));
        }
    }
}

static void add_gradients(struct orl_hemisphere *h, const struct orl_frame *frame,
                          const struct strand *strands, uint32_t rows, uint32_t columns,
                          uint32_t channels)
{
    struct spoke spokes[ORL_HEMISPHERE_COLUMNS];
    for (uint32_t column = 0; column < columns; column++)
        spokes[column] = spoke_of(frame, column, columns);
    for (uint32_t row = 0; row < rows; row++)
        add_row(h, spokes, strands, rows, columns, row, channels);
    for (uint32_t c = channels; c < 3; c++) {
        h->rotation_gradient[c] = h->rotation_gradient[0];
        h->translation_gradient[c] = h->translation_gradient[0];
    }
}

/* Returns the variance of the mean. For strata with one ray it takes half the squared difference to
 * the next stratum. */
static double variance_of_mean(const struct strand *strands, uint32_t rows, uint32_t columns)
{
    double sum = 0;
    for (uint32_t i = 0; i < rows * columns; i++) {
        const uint32_t row = i / columns, beside = row * columns + (i + 1) % columns;
        const double difference =
            orl_luma(strands[i].radiance) - orl_luma(strands[beside].radiance);
        sum += strands[i].variance < 0 ? difference * difference / 2 : strands[i].variance;
    }
    return sum / ((double)rows * columns * rows * columns);
}

/* State while a hemisphere is gathered. */
struct making {
    const struct orl_gather *gather;
    const struct orl_shading_point *place;
    const struct orl_icache *icache;
    struct orl_frame frame;
    uint32_t rows, columns;
    struct orl_random *random;
    struct orl_search *search;
    uint32_t sequence, rays; /* rays sent so far */
    struct strand strands[ORL_HEMISPHERE_ROWS * ORL_HEMISPHERE_COLUMNS];
    struct orl_tally tally;
    double least_distance;
};

/* A ray that may still have to read a texel. */
struct under_way {
    struct orl_gather_ray ray;
    struct orl_sobol_slice slice;
    struct orl_texel_fetch fetch;
    struct orl_rgb radiance;
    double distance;
    uint32_t stratum;
};

/* Sends a ray through a position in a stratum. On a surface that a BSDF stands for, the ray sees
 * the scene as views do. */
static void send_ray(struct making *m, uint32_t stratum, double down, double across,
                     struct orl_tally *tally, struct under_way *w)
{
    const uint32_t row = stratum / m->columns, column = stratum % m->columns;
    const double sine = sqrt((row + down) / m->rows),
                 phi = 2 * ORL_PI * (column + across) / m->columns;
    *w = (struct under_way){.stratum = stratum,
                            .slice = {.index = m->rays++, .sequence = m->sequence},
                            .distance = INFINITY};
    w->ray = (struct orl_gather_ray){
        .origin = m->place->point,
        .direction = orl_to_world(
            &m->frame, orl_v3(sine * cos(phi), sine * sin(phi), sqrt(fmax(0, 1 - sine * sine)))),
        .outside = m->place->outside,
        .stratified = true,
        .slice = &w->slice,
        .reads_texels = true,
        .reads_records = m->icache != NULL,
        .icache = m->icache,
        .tally = tally,
        .share = ORL_PI / ((double)m->rows * m->columns),
        .ret_distance = &w->distance,
        .ret_fetch = &w->fetch};
    w->radiance = m->place->proxied
                      ? orl_health_filter(&m->search->health,
                                          orl_exterior_radiance(
                                              orl_lit_scene_seen(m->gather->lit_scene),
                                              w->ray.origin, w->ray.direction, orl_mis_pdf_zero(),
                                              m->random, &m->search->health, NULL))
                      : orl_gather_radiance(m->gather, &w->ray, m->random, m->search);
    w->distance = fmax(w->distance, 1e-9 * m->gather->lit_scene->geometry->radius);
    m->least_distance = fmin(m->least_distance, w->distance);
}

/* Returns the radiance of a ray after its texel, if any, has arrived. */
static struct orl_rgb arrived_radiance(const struct under_way *w)
{
    return w->fetch.texel ? orl_rgb_add(w->radiance, orl_gather_read_texel(&w->ray, &w->fetch))
                          : w->radiance;
}

/* Sends one ray a stratum. A texel is read some rays later, when memory has delivered it. */
static void send_first_rays(struct making *m)
{
    struct under_way under_way[AHEAD];
    const uint32_t strata = m->rows * m->columns;
    for (uint32_t i = 0; i < strata + AHEAD; i++) {
        struct under_way *w = &under_way[i % AHEAD];
        if (i >= AHEAD && i - AHEAD < strata) {
            struct strand *strand = &m->strands[w->stratum];
            strand->radiance = arrived_radiance(w);
            strand->distance = w->distance;
        }
        if (i >= strata)
            continue;
        const double down = orl_random_uniform(m->random), across = orl_random_uniform(m->random);
        m->strands[i] = (struct strand){.variance = -1, .down = down, .across = across};
        send_ray(m, i, down, across, &m->tally, w);
    }
}

/*
 * Returns the range of luma over the up to eight strata about one. The next strata in the row and
 * column do not suffice: the edges of a bright patch no wider than a stratum also lie in the
 * diagonal ones.
 */
static double range_about(const double *lumas, uint32_t rows, uint32_t columns, uint32_t stratum)
{
    const uint32_t row = stratum / columns, column = stratum % columns;
    const uint32_t beside[3] = {(column + columns - 1) % columns, (column + 1) % columns, column};
    const uint32_t last = row + 1 < rows ? row + 1 : row;
    double least = INFINITY, most = 0;
    for (uint32_t y = row > 0 ? row - 1 : 0; y <= last; y++) {
        for (int i = 0; i < (y == row ? 2 : 3); i++) {
            const double luma = lumas[y * columns + beside[i]];
            least = luma < least ? luma : least;
            most = luma > most ? luma : most;
        }
    }
    return most - least;
}

/* Chooses the rays of each stratum: more where bright things such as windows begin and end. A
 * stratum's own ray does not decide, because its noise would then bias the mean. */
static void choose_rays(struct making *m)
{
    double lumas[ORL_HEMISPHERE_ROWS * ORL_HEMISPHERE_COLUMNS], sum = 0;
    const uint32_t strata = m->rows * m->columns;
    for (uint32_t i = 0; i < strata; i++) {
        lumas[i] = orl_luma(m->strands[i].radiance);
        sum += lumas[i];
    }
    for (uint32_t i = 0; i < strata; i++) {
        const double mean = (sum - lumas[i]) / (strata - 1);
        const double range = range_about(lumas, m->rows, m->columns, i);
        m->strands[i].side = range > much_contrast * mean ? CLOSEST
                             : range > contrast * mean    ? CLOSER
                                                          : 1;
    }
}

/* Sends the other rays of a stratum, one through each of its parts. The first ray stands for the
 * photons' noise. */
static void refine_stratum(struct making *m, uint32_t stratum)
{
    struct strand *strand = &m->strands[stratum];
    struct under_way w[CLOSEST * CLOSEST - 1];
    const uint32_t side = strand->side, parts = side * side;
    const uint32_t first =
        side * (uint32_t)(side * strand->down) + (uint32_t)(side * strand->across);
    uint32_t n = 0;
    for (uint32_t part = 0; part < parts; part++) {
        if (part == first)
            continue;
        const uint32_t row = part / side;
        const double down = (row + orl_random_uniform(m->random)) / side;
        send_ray(m, stratum, down, (part % side + orl_random_uniform(m->random)) / side, NULL,
                 &w[n++]);
    }
    double luma = orl_luma(strand->radiance), squares = luma * luma,
           nearness = 1 / strand->distance;
    struct orl_rgb sum = strand->radiance;
    for (uint32_t i = 0; i < n; i++) {
        const struct orl_rgb seen = arrived_radiance(&w[i]);
        sum = orl_rgb_add(sum, seen);
        squares += orl_luma(seen) * orl_luma(seen);
        nearness += 1 / w[i].distance;
    }
    strand->radiance = orl_rgb_scale(sum, 1.0 / parts);
    strand->distance = parts / nearness;
    luma = orl_luma(strand->radiance);
    strand->variance = fmax(squares / parts - luma * luma, 0) / (parts - 1);
}

struct orl_hemisphere orl_gather_hemisphere(const struct orl_gather *gather,
                                            const struct orl_shading_point *place, uint32_t rows,
                                            uint32_t columns, const struct orl_icache *icache,
                                            struct orl_random *random, struct orl_search *search)
{
    struct orl_hemisphere h = {.irradiance = {0, 0, 0}};
    struct making m; /* its strands stay uninitialised, because they are many */
    m.gather = gather;
    m.place = place;
    m.icache = icache;
    m.frame = orl_frame_about(place->normal);
    m.rows = rows;
    m.columns = columns;
    m.random = random;
    m.search = search;
    m.sequence = (uint32_t)orl_random_bits(random);
    m.rays = 0;
    m.tally = (struct orl_tally){.record_error = 0};
    m.least_distance = INFINITY;
    send_first_rays(&m);
    choose_rays(&m);
    double nearness = 0;
    for (uint32_t i = 0; i < rows * columns; i++) {
        if (m.strands[i].side > 1)
            refine_stratum(&m, i);
        h.irradiance = orl_rgb_add(h.irradiance, m.strands[i].radiance);
        nearness += 1 / m.strands[i].distance;
    }
    h.irradiance = orl_rgb_scale(h.irradiance, ORL_PI / ((double)rows * columns));
    h.mean_distance = nearness > 0 ? (double)rows * columns / nearness : INFINITY;
    h.least_distance = m.least_distance;
    add_gradients(&h, &m.frame, m.strands, rows, columns, gather->lit_scene->omit.channels);
    h.photon_error = sqrt(orl_tally_variance(&m.tally));
    h.ray_error = ORL_PI * sqrt(variance_of_mean(m.strands, rows, columns));
    return h;
}
