#include "runner/estimate/job_estimate.h"

#include <stdio.h>

#include <oriel/annual/annual_phases.h>
#include <oriel/annual/annual_shades.h>

enum { PARTS = 16 };

struct part {
    const char *name; /* plural */
    uint64_t count, bytes;
};

uint64_t orl_job_memory_hours(const struct orl_job_memory *needs)
{
    return needs->year_rows * 6 / 10 * (needs->sensors + needs->file_sensors);
}

uint64_t orl_job_memory_windows(const struct orl_job_memory *needs)
{
    const uint64_t cells = ORL_PHASES_CELLS, patches = ORL_ANNUAL_PATCHES;
    const uint64_t windows = needs->windows < needs->surfaces ? needs->windows : needs->surfaces;
    const uint64_t sensors = needs->sensors + needs->file_sensors;
    return windows * sizeof(float) * (cells * cells + 2 * cells * patches + 2 * cells * sensors);
}

uint64_t orl_job_memory_viewpoints(const struct orl_job_memory *needs)
{
    /* VIEW: bound of the terms, spots and places of one view while it is made. YEAR: the sums of a
     * block of sensors, and the pictures of the hours that threads rate. ROW, ROW_VIEWPOINT: at
     * most six tenths of the rows of weather have light; each then has four floats of a viewpoint,
     * two of a place. */
    enum { VIEW = 64 << 20, YEAR = 64 << 20, ROW_VIEWPOINT = 10, ROW = 640 };
    const uint64_t at_once = ORL_GLARE_VIEWPOINTS_AT_ONCE;
    const uint64_t views = needs->viewpoints < at_once ? needs->viewpoints : at_once;
    return needs->viewpoints == 0
               ? 0
               : YEAR + VIEW * views + needs->year_rows * (ROW + ROW_VIEWPOINT * needs->viewpoints);
}

/* Returns the bytes for window groups: an annual job sums light by group for at least eight sensors
 * at a time. */
static uint64_t window_group_bytes(const struct orl_job_memory *needs)
{
    enum { LEAST = 128 << 20, GROUP = 4 << 20 };
    const uint64_t bytes = GROUP * (needs->window_groups + 1);
    return needs->window_groups == 0 ? 0 : bytes > LEAST ? bytes : LEAST;
}

static void list_parts(const struct orl_job_memory *needs, struct part ret_parts[PARTS])
{
    enum { SURFACE = 400, TRIANGLE = 300, BSDF = 8, PHOTON = 60, SENSOR = 1300, PIXEL = 64 };
    enum { FILE_SENSOR = 900, ROW = 16 << 10, MASK_PIXEL = 24 };
    /* Sums of a block of sensors, and maps of sunlight. Behind windows with BSDFs the peak of an
     * annual job of 570 sensors rose by 42 MB for each set. */
    enum { SUN_NODES = 48 << 20 };
    /* A tenth more: on a busy machine, the process's peak was 2 MB above 19 MB of values. */
    const uint64_t values = needs->array_bytes * (needs->sensors + needs->file_sensors);
    const uint64_t arrays = values + values / 10;
    const uint64_t hours = orl_job_memory_hours(needs);
    ret_parts[0] = (struct part){"surfaces", needs->surfaces, SURFACE * needs->surfaces};
    ret_parts[1] = (struct part){"triangles", needs->triangles, TRIANGLE * needs->triangles};
    ret_parts[2] = (struct part){"bytes of BSDFs", needs->bsdf_bytes, BSDF * needs->bsdf_bytes};
    ret_parts[3] = (struct part){"photons", needs->photons, PHOTON * needs->photons};
    ret_parts[4] = (struct part){"sensors", needs->sensors + needs->file_sensors,
                                 SENSOR * needs->sensors + FILE_SENSOR * needs->file_sensors};
    ret_parts[5] = (struct part){"pixels", needs->pixels, PIXEL * needs->pixels};
    ret_parts[6] = (struct part){"rows of weather", needs->year_rows, ROW * needs->year_rows};
    ret_parts[7] = (struct part){"hours of sensors", hours, needs->hour_bytes * hours};
    ret_parts[8] = (struct part){"bytes of values", needs->bsdf_made_bytes, needs->bsdf_made_bytes};
    ret_parts[9] =
        (struct part){"pixels of masks", needs->mask_pixels, MASK_PIXEL * needs->mask_pixels};
    ret_parts[10] = (struct part){"bytes of sensors' matrices", arrays, arrays};
    ret_parts[11] =
        (struct part){"windows with matrices", needs->windows, orl_job_memory_windows(needs)};
    ret_parts[12] =
        (struct part){"bytes of given matrices", needs->matrix_bytes, needs->matrix_bytes};
    ret_parts[13] =
        (struct part){"glare seats", needs->viewpoints, orl_job_memory_viewpoints(needs)};
    ret_parts[14] = (struct part){"window groups", needs->window_groups, window_group_bytes(needs)};
    ret_parts[15] =
        (struct part){"extra sets of sun nodes", needs->sun_nodes, SUN_NODES * needs->sun_nodes};
}

uint64_t orl_job_memory_estimate(const struct orl_job_memory *needs)
{
    const uint64_t base = 32UL << 20; /* a nearly empty job */
    struct part parts[PARTS];
    uint64_t bytes = base;
    list_parts(needs, parts);
    for (size_t i = 0; i < PARTS; i++)
        bytes += parts[i].bytes;
    return bytes;
}

int orl_job_memory_refuse(const struct orl_job_memory *needs, uint64_t most, struct orl_error *err)
{
    struct part parts[PARTS];
    size_t largest = 0;
    list_parts(needs, parts);
    for (size_t i = 1; i < PARTS; i++)
        if (parts[i].bytes > parts[largest].bytes)
            largest = i;
    orl_error_set(err, ORL_ERR_LIMIT,
                  "the job would take about %llu MiB of memory, %llu MiB of them for %llu %s; jobs "
                  "may take %llu MiB here",
                  (unsigned long long)(orl_job_memory_estimate(needs) >> 20),
                  (unsigned long long)(parts[largest].bytes >> 20),
                  (unsigned long long)parts[largest].count, parts[largest].name,
                  (unsigned long long)(most >> 20));
    orl_error_hint(err,
                   "Ask for fewer %s, or split them among several jobs; --memory sets the limit",
                   parts[largest].name);
    return ORL_ERR_LIMIT;
}
