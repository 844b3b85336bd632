/*
 * Time of a look-up in a mapped, warm map. Uses the median: some places have fewer photons on their
 * sheet of surface than requested, and these look-ups depend on the maximum radius, not on the
 * number of photons.
 */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "bench/scale.h"
#include "photon/density/density_estimate.h"
#include "photon/map/quantization.h"

enum { NEIGHBOURS = 50, QUERIES = 40000 };

static struct orl_photon_map *open_map(const char *folder)
{
    struct orl_photon_map *map = NULL;
    struct orl_error err = {0};
    DIR *entries = opendir(folder);
    for (struct dirent *e = entries ? readdir(entries) : NULL; e && !map; e = readdir(entries)) {
        char path[2 * BENCH_PATH];
        if (!strstr(e->d_name, ".opm"))
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        if (orl_photon_map_open(path, false, &map, &err) < 0)
            bench_fail("opening a map", &err);
    }
    if (entries)
        closedir(entries);
    if (!map)
        bench_fail("there is no map", NULL);
    return map;
}

static void look_up(const struct orl_photon_map *map, double extent, struct orl_search *search,
                    double seconds[QUERIES])
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    const uint64_t count = orl_photon_map_header(map)->count;
    uint64_t found = 0;
    for (int i = 0; i < QUERIES; i++) {
        const struct orl_photon p =
            orl_photon_map_get(map, (size_t)(orl_random_bits(&random) % count));
        const struct orl_density_query query = {
            .point = orl_v3(p.position[0], p.position[1], p.position[2]),
            .normal = orl_normal_decode(p.normal),
            .k = NEIGHBOURS,
            .max_radius = extent};
        const double started = bench_wall_s(NULL);
        found += orl_density_estimate(map, &query, search).found;
        seconds[i] = bench_wall_s(NULL) - started;
    }
    if (found == 0)
        bench_fail("no look-up found anything", NULL);
}

double scale_search(const char *maps, double extent)
{
    struct orl_search *search = calloc(1, sizeof *search);
    struct orl_photon_map *map = open_map(maps);
    double *seconds = malloc(QUERIES * sizeof *seconds);
    if (!search || !seconds)
        bench_fail("out of memory", NULL);
    look_up(map, extent, search, seconds); /* loads the pages */
    look_up(map, extent, search, seconds);
    const double median = bench_median(seconds, QUERIES);
    orl_photon_map_free(map);
    free(seconds);
    free(search);
    return median;
}
