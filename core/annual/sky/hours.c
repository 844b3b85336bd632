#include "annual/sky/hours.h"

#include <stdio.h>
#include <stdlib.h>

#include "annual/sky/bins.h"
#include "light/daylight/daylight.h"

/* Sky of a weather file's row. */
struct row_sky {
    struct orl_daylight daylight;
    double diffuse_w;
    struct orl_daylight_sun sun;
    struct orl_error error; /* code 0 if the row is valid */
};

/* State of reading the weather file's rows. */
struct reader {
    const struct orl_weather *weather;
    const char *name;
    double reflectance;
    struct row_sky *skies; /* by row */
};

/* Returns the sun of a row. If no sunlight was measured, the position is computed, unless the sun
 * is far below the horizon. */
static struct orl_daylight_sun sun_of(const struct reader *r, size_t index)
{
    static const double well_set = -0.02; /* sine of altitude, well below that of half the disc */
    const struct orl_weather_row *row = &r->weather->rows[index];
    const struct orl_daylight *d = &r->skies[index].daylight;
    if (!row->missing && !d->black && d->sun_radiance > 0)
        return (struct orl_daylight_sun){d->sun, d->sun_angle_deg};
    if (!row->missing && d->sun.z < well_set)
        return (struct orl_daylight_sun){.angle_deg = 0};
    return orl_daylight_sun_of_row(r->weather, row);
}

static void read_row(void *arg, size_t index, uint32_t member)
{
    struct reader *r = arg;
    const struct orl_weather_row *row = &r->weather->rows[index];
    struct row_sky *sky = &r->skies[index];
    (void)member;
    if (!row->missing &&
        orl_daylight_from_row(r->weather, row, &sky->daylight, &sky->diffuse_w, &sky->error) < 0)
        orl_error_at(&sky->error, r->name, row->line, NULL);
    else
        sky->sun = sun_of(r, index);
}

static struct orl_annual_step step_of(const struct reader *r, size_t index)
{
    const struct orl_weather_row *row = &r->weather->rows[index];
    const struct orl_daylight *d = &r->skies[index].daylight;
    struct orl_annual_step step = {.month = row->month,
                                   .day = row->day,
                                   .hour = row->hour,
                                   .missing = row->missing,
                                   .column = ORL_ANNUAL_DARK,
                                   .sun_altitude_deg = NAN,
                                   .sun_azimuth_deg = NAN};
    if (row->missing)
        return step;
    step.sun_altitude_deg = atan2(d->sun.z, hypot(d->sun.x, d->sun.y)) / ORL_DEG_TO_RAD;
    step.sun_azimuth_deg = atan2(-d->sun.x, -d->sun.y) / ORL_DEG_TO_RAD;
    if (d->black)
        return step;
    step.direct_normal_lx = ORL_EFFICACY_LM_PER_W * orl_daylight_direct_normal(d);
    step.diffuse_lx = ORL_EFFICACY_LM_PER_W * r->skies[index].diffuse_w;
    step.global_lx = step.diffuse_lx + step.direct_normal_lx * fmax(0, d->sun.z);
    return step;
}

/* Fills the steps, and numbers the lit ones as columns. */
static int make_steps(struct orl_hours *hours, const struct reader *r, struct orl_error *err)
{
    for (size_t i = 0; i < hours->n_steps; i++) {
        struct orl_annual_step *step = &hours->steps[i];
        if (r->skies[i].error.code < 0) {
            *err = r->skies[i].error;
            return err->code;
        }
        *step = step_of(r, i);
        hours->n_missing += step->missing;
        if (!(step->diffuse_lx > 0 || step->direct_normal_lx > 0))
            continue;
        const char *warnings = r->skies[i].daylight.warnings;
        if (warnings[0] && hours->n_warned++ == 0)
            snprintf(hours->warning, sizeof hours->warning, "%s", warnings);
        step->column = (uint32_t)hours->n_columns;
        hours->step_of_column[hours->n_columns++] = (uint32_t)i;
    }
    return 0;
}

/* Lists the suns of all rows, including rows without measured light. */
static void place_suns(struct orl_hours *hours, const struct reader *r, double north_deg)
{
    const struct orl_sky_rotation turn = orl_sky_rotation_by_north(north_deg);
    struct orl_year_suns *suns = &hours->suns;
    for (size_t i = 0; i < hours->n_steps; i++) {
        const struct orl_annual_step *step = &hours->steps[i];
        const bool is_up = r->skies[i].sun.angle_deg > 0;
        if (step->column != ORL_ANNUAL_DARK)
            hours->sun_of_column[step->column] =
                (struct orl_column_sun){(uint32_t)suns->count, is_up ? step->direct_normal_lx : 0};
        if (!is_up)
            continue;
        const struct orl_vec3 sun = orl_normalize(r->skies[i].sun.towards);
        suns->in_sky[suns->count] = sun;
        suns->at[suns->count++] =
            (struct orl_hour_sun){.towards = orl_sky_rotation_to_scene(turn, sun),
                                  .angle_rad = r->skies[i].sun.angle_deg * ORL_DEG_TO_RAD,
                                  .wanted = step->direct_normal_lx > 0};
    }
}

/* ---- Skies ----------------------------------------------------------------------------------- */

struct sky_context {
    struct orl_hours *hours;
    const struct orl_horizon_blend *rows;
    const struct reader *reader;
};

static void compute_tile(void *arg, size_t index, uint32_t member)
{
    const struct sky_context *p = arg;
    struct orl_hours *hours = p->hours;
    const struct orl_daylight *skies[ORL_HOURS_TILE];
    double diffuse_w[ORL_HOURS_TILE];
    uint32_t n = 0;
    (void)member;
    for (size_t c = index * ORL_HOURS_TILE; c < hours->n_columns && n < ORL_HOURS_TILE; c++, n++) {
        const size_t step = hours->step_of_column[c];
        skies[n] = &p->reader->skies[step].daylight;
        diffuse_w[n] = p->reader->skies[step].diffuse_w;
    }
    orl_sky_tile_compute(p->rows, skies, diffuse_w, n, p->reader->reflectance,
                         hours->fine + index * ORL_BINS * ORL_HOURS_TILE,
                         hours->coarse + index * ORL_BINS_COARSE * ORL_HOURS_TILE);
}

static int compute_skies(struct orl_hours *hours, const struct orl_bins *bins,
                         const struct reader *r, struct orl_thread_pool *pool)
{
    struct orl_horizon_blend rows;
    const struct sky_context sky_context = {hours, &rows, r};
    hours->n_tiles = (hours->n_columns + ORL_HOURS_TILE - 1) / ORL_HOURS_TILE;
    const size_t floats = (hours->n_tiles + 1) * ORL_HOURS_TILE;
    hours->fine = orl_arrays_new(&hours->arrays, floats * ORL_BINS, sizeof *hours->fine);
    hours->coarse = orl_arrays_new(&hours->arrays, floats * ORL_BINS_COARSE, sizeof *hours->coarse);
    if (hours->arrays.failed)
        return ORL_ERR_NOMEM;
    orl_horizon_blend_init(&rows, bins);
    return orl_parallel_try(pool, hours->n_tiles, compute_tile, (void *)(uintptr_t)&sky_context);
}

/* ---- All of it ------------------------------------------------------------------------------- */

static struct orl_vec3 direction_of_sun(const void *suns, uint32_t index)
{
    return ((const struct orl_hour_sun *)suns)[index].towards;
}

static int make_all(struct orl_hours *hours, const struct orl_bins *bins, struct reader *r,
                    double north_deg, struct orl_thread_pool *pool, struct orl_error *err)
{
    const size_t n = hours->n_steps;
    int code = orl_parallel_try(pool, n, read_row, r);
    if (code == 0)
        code = make_steps(hours, r, err);
    if (code < 0)
        return code;
    hours->suns.at = orl_arrays_new(&hours->arrays, n, sizeof *hours->suns.at);
    hours->suns.in_sky = orl_arrays_new(&hours->arrays, n, sizeof *hours->suns.in_sky);
    hours->sun_of_column =
        orl_arrays_new(&hours->arrays, hours->n_columns, sizeof *hours->sun_of_column);
    if (hours->arrays.failed)
        return ORL_ERR_NOMEM;
    place_suns(hours, r, north_deg);
    if (orl_direction_tree_init(&hours->suns.tree, direction_of_sun, hours->suns.at, NULL,
                                hours->suns.count) < 0)
        return ORL_ERR_NOMEM;
    return compute_skies(hours, bins, r, pool);
}

int orl_hours_init(struct orl_hours *hours, const struct orl_bins *bins,
                   const struct orl_weather *weather, const char *weather_name, double north_deg,
                   double ground_reflectance, struct orl_thread_pool *pool, struct orl_error *err)
{
    const size_t n = weather->n_rows;
    struct reader r = {.weather = weather, .name = weather_name, .reflectance = ground_reflectance};
    *hours = (struct orl_hours){.n_steps = n};
    if (n > ORL_HOURS_MOST)
        return orl_error_set(
            err, ORL_ERR_LIMIT,
            "the weather file has %zu rows, but a year has at most %d (10-minute steps)", n,
            ORL_HOURS_MOST);
    int code = ORL_ERR_NOMEM;
    hours->steps = calloc(n + 1, sizeof *hours->steps);
    hours->step_of_column = calloc(n + 1, sizeof *hours->step_of_column);
    r.skies = calloc(n + 1, sizeof *r.skies);
    struct orl_error why = {0};
    if (hours->steps && hours->step_of_column && r.skies)
        code = make_all(hours, bins, &r, north_deg, pool, &why);
    if (code < 0 && why.code == code && err)
        *err = why;
    else if (code < 0)
        orl_error_set(err, code, "%s",
                      code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory for skies");
    free(r.skies);
    return code;
}

void orl_hours_done(struct orl_hours *hours)
{
    free(hours->steps);
    free(hours->step_of_column);
    orl_direction_tree_done(&hours->suns.tree);
    orl_arrays_free(&hours->arrays);
    *hours = (struct orl_hours){.steps = NULL};
}
