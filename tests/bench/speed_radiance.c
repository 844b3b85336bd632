/* Radiance does the work of these rows, measured as Oriel is (tests/README.md). */
#include <stdio.h>
#include <stdlib.h>

#include "bench/speed.h"

static const char sensors_options[] = "-ab 4 -aa .1 -ar 128 -ad 4096 -as 2048 -lw 1e-4";
static const char image_options[] = "-ab 1 -aa .15 -ar 64 -ad 512 -as 256";

/* The row of each mkpmap run. */
static const enum speed_row_id rows_of_maps[RADIANCE_MAPS] = {[RADIANCE_GLOBAL] = SPEED_GLOBAL,
                                                              [RADIANCE_CAUSTIC] = SPEED_CAUSTIC,
                                                              [RADIANCE_PRECOMPUTED] =
                                                                  SPEED_PRECOMPUTED};

/* The maps that images read. */
static const struct {
    enum speed_row_id row;
    bool uses[RADIANCE_MAPS];
} images[] = {{SPEED_IMAGE_PRECOMPUTED, {false, true, true}},
              {SPEED_IMAGE_GATHER, {true, true, false}}};
enum { IMAGES = sizeof images / sizeof *images };

static bool wants(const struct speed *s, enum speed_row_id row)
{
    return speed_wants(s->rows[row].key);
}

static bool needs_map(const struct speed *s, enum radiance_map map)
{
    bool needs = wants(s, rows_of_maps[map]);
    for (int i = 0; i < IMAGES; i++)
        needs = needs || (wants(s, images[i].row) && images[i].uses[map]);
    return needs;
}

static void book(struct speed *s, enum speed_row_id row, double rate, double seconds, double error)
{
    s->rows[row].radiance = (struct speed_figure){seconds, rate, seconds * rate};
    s->rows[row].radiance_error = error;
}

static double rate_now(struct speed *s, enum speed_row_id row)
{
    fprintf(stderr, "  Radiance: %s\n", s->rows[row].name);
    return office_rate(&s->office, s->pool, 1);
}

static void make_maps(struct speed *s, const struct radiance *radiance)
{
    for (int map = 0; map < RADIANCE_MAPS; map++) {
        if (!needs_map(s, (enum radiance_map)map))
            continue;
        const enum speed_row_id row = rows_of_maps[map];
        const double rate = rate_now(s, row);
        book(s, row, rate, radiance_make_map(radiance, (enum radiance_map)map, s->photons).cpu_s,
             0);
    }
}

static void render_images(struct speed *s, const struct radiance *radiance)
{
    for (int i = 0; i < IMAGES; i++) {
        char use[256], options[512];
        double *luminances;
        if (!wants(s, images[i].row))
            continue;
        const double rate = rate_now(s, images[i].row);
        radiance_use_maps(images[i].uses, use);
        snprintf(options, sizeof options, "%s%s", image_options, use);
        const struct bench_use taken =
            radiance_image(radiance, options, s->reference.width, s->reference.height, &luminances);
        book(s, images[i].row, rate, taken.cpu_s,
             bench_compare(&s->reference.image, luminances, OFFICE_DARKEST).rms);
        free(luminances);
    }
}

void speed_add_radiance(struct speed *s)
{
    const char *missing = radiance_missing();
    struct radiance radiance;
    if (!s->radiance)
        return;
    if (missing) {
        printf("  (no %s on PATH: Radiance's figures are left out)\n", missing);
        return;
    }
    s->pool = orl_thread_pool_start(1);
    if (!s->pool)
        bench_fail("out of memory", NULL);
    radiance_open(&radiance, &s->office, "radiance");
    make_maps(s, &radiance);
    render_images(s, &radiance);
    if (wants(s, SPEED_SENSORS_5)) {
        double lx[OFFICE_SENSORS];
        const double rate = rate_now(s, SPEED_SENSORS_5);
        const struct bench_use taken = radiance_sensors(&radiance, sensors_options, lx);
        book(s, SPEED_SENSORS_5, rate, taken.cpu_s,
             bench_compare(&s->reference.sensors, lx, 0).rms);
    }
    orl_thread_pool_stop(s->pool);
    s->pool = NULL;
}
