/*
 * Direct sunlight at a sensor by sun (hours.h), and by the part of the windows through which it
 * comes in (annual_scene.h): irradiance for a sun with a normal irradiance of 1.
 */
#ifndef ORL_ANNUAL_SUN_SUN_ROWS_H
#define ORL_ANNUAL_SUN_SUN_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Rows: sunlight straight and through BSDF panes (oriel/annual.h); sunlight by mirrors; and the
 * square of the standard error of both together. */
enum orl_sun_row { ORL_SUN_DIRECT, ORL_SUN_MIRRORED, ORL_SUN_SQUARES, ORL_SUN_ROWS };

/* Returns the number of samples of a disc for the given paths per sensor, such that both errors
 * fall together. */
enum { ORL_DISC_LEAST_POINTS = 128, ORL_DISC_MOST_POINTS = 2048, ORL_PATHS_A_DISC_POINT = 32 };
static inline uint32_t orl_disc_points(uint32_t samples)
{
    const uint32_t points = samples / ORL_PATHS_A_DISC_POINT;
    return points < ORL_DISC_LEAST_POINTS  ? ORL_DISC_LEAST_POINTS
           : points > ORL_DISC_MOST_POINTS ? ORL_DISC_MOST_POINTS
                                           : points;
}

struct orl_sun_rows {
    float *at; /* [part][ORL_SUN_ROWS][sun] */
    size_t n_suns;
    unsigned char *lit;   /* by part: 1 if its rows are set; rows of other parts are undefined */
    uint32_t disc_points; /* samples of a sun's disc that an edge crosses; at least 4 */
    bool direct_only;     /* true if light by mirrors is not computed */
    /* [part][sun]: nonzero if the caller needs that sun for that part; NULL: all are needed. BSDF
     * panes are sampled for these suns only. */
    const unsigned char *wanted;
};

static inline float *orl_sun_row_of(const struct orl_sun_rows *rows, uint32_t part,
                                    enum orl_sun_row row)
{
    return rows->at + ((size_t)part * ORL_SUN_ROWS + row) * rows->n_suns;
}

/* Sets the rows of a part to 0 at their first use. */
static inline void orl_sun_rows_need(const struct orl_sun_rows *rows, uint32_t part)
{
    if (rows->lit[part])
        return;
    rows->lit[part] = 1;
    memset(orl_sun_row_of(rows, part, ORL_SUN_DIRECT), 0,
           ORL_SUN_ROWS * rows->n_suns * sizeof *rows->at);
}

static inline void orl_sun_rows_add(const struct orl_sun_rows *rows, uint32_t part,
                                    enum orl_sun_row row, size_t sun, double light)
{
    orl_sun_rows_need(rows, part);
    orl_sun_row_of(rows, part, row)[sun] += (float)light;
}

#endif
