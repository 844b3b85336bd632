/* Caustic photons' share of the light where they land (orl_photon_pilot_contrast). */
#include "photon/shooting/photon_pilot.h"

#include <stdlib.h>
#include <string.h>

#include "base/sampling/random.h"
#include "photon/map/normal_code.h"

/* Levels of cubes, from the scene's own to 1/16384 of its width; minimum number of photons in a
 * cube. */
enum { LEVELS = 15, LEAST_IN_CUBE = 8 };
/* Hash table of cubes: more slots than photons. */
enum { MOST_PHOTONS = 1 << 15, SLOTS = 1 << 17 };
_Static_assert((int)SLOTS >= 4 * (int)MOST_PHOTONS, "no long searches");

struct cube {
    uint64_t key; /* hash of a cube and a bin of normals; 0: free */
    uint32_t caustic, rest;
    double caustic_w, rest_w;
};

/* Every step-th photon of an array. */
struct photon_subset {
    const struct orl_photon *photons;
    size_t count, step;
    double scale;
};

static struct photon_subset select_photons(const struct orl_photon *photons, size_t count,
                                           double scale)
{
    const size_t step = (count + MOST_PHOTONS / 2 - 1) / (MOST_PHOTONS / 2);
    return (struct photon_subset){photons, count, step > 0 ? step : 1,
                                  scale * (double)(step > 0 ? step : 1)};
}

static uint64_t key_of(const struct orl_photon *p, const struct orl_geometry *g, int level)
{
    const double cubes = ldexp(1, level), width = 2 * g->radius * (1 + 1e-6);
    uint64_t key = orl_normal_bin(p->normal) + 1;
    for (int i = 0; i < 3; i++) {
        const double at = cubes * (0.5 + p->position[i] / width);
        key = orl_mix64(key) + (uint64_t)fmin(fmax(at, 0), cubes);
    }
    return orl_mix64(key) | 1;
}

static struct cube *find_cube(struct cube *cubes, uint64_t key)
{
    size_t at = key >> 17 & (SLOTS - 1);
    while (cubes[at].key != 0 && cubes[at].key != key)
        at = (at + 1) & (SLOTS - 1);
    cubes[at].key = key;
    return &cubes[at];
}

static double luma_of(const struct orl_photon *p)
{
    return orl_luma((struct orl_rgb){p->flux[0], p->flux[1], p->flux[2]});
}

static void fill_cubes(struct cube *cubes, const struct photon_subset *caustic,
                       const struct photon_subset *rest, const struct orl_geometry *g, int level)
{
    memset(cubes, 0, SLOTS * sizeof *cubes);
    for (size_t i = 0; i < caustic->count; i += caustic->step) {
        struct cube *c = find_cube(cubes, key_of(&caustic->photons[i], g, level));
        c->caustic++;
        c->caustic_w += caustic->scale * luma_of(&caustic->photons[i]);
    }
    for (size_t i = 0; i < rest->count; i += rest->step) {
        const struct orl_photon *p = &rest->photons[i];
        if (p->tag == ORL_PHOTON_CAUSTIC)
            continue;
        struct cube *c = find_cube(cubes, key_of(p, g, level));
        c->rest++;
        c->rest_w += rest->scale * luma_of(p);
    }
}

/* Flux over area, of both kinds, around each caustic photon. */
struct local_flux {
    double caustic, rest;
};

int orl_photon_pilot_contrast(const struct orl_photon *caustic, size_t n_caustic,
                              double caustic_scale, const struct orl_photon *rest, size_t n_rest,
                              double rest_scale, const struct orl_geometry *geometry,
                              double *ret_contrast)
{
    const struct photon_subset c = select_photons(caustic, n_caustic, caustic_scale),
                               r = select_photons(rest, n_rest, rest_scale);
    struct cube *cubes = malloc(SLOTS * sizeof *cubes);
    struct local_flux *local_flux = calloc(n_caustic + 1, sizeof *local_flux);
    double sum = 0, all = 0;
    for (int level = 0; level < LEVELS && cubes && local_flux; level++) {
        const double per_area = ldexp(1, 2 * level);
        fill_cubes(cubes, &c, &r, geometry, level);
        for (size_t i = 0; i < n_caustic; i += c.step) {
            const struct cube *cube = find_cube(cubes, key_of(&caustic[i], geometry, level));
            if (level == 0 || cube->caustic >= LEAST_IN_CUBE)
                local_flux[i].caustic = per_area * cube->caustic_w;
            if (level == 0 || cube->rest >= LEAST_IN_CUBE)
                local_flux[i].rest = per_area * cube->rest_w;
        }
    }
    for (size_t i = 0; i < n_caustic && cubes && local_flux; i += c.step) {
        const double flux = luma_of(&caustic[i]), both = local_flux[i].caustic + local_flux[i].rest;
        sum += both > 0 ? flux * local_flux[i].caustic / both : 0;
        all += flux;
    }
    const bool failed = !cubes || !local_flux;
    free(cubes);
    free(local_flux);
    if (failed)
        return ORL_ERR_NOMEM;
    *ret_contrast = all > 0 ? sum / all : 1;
    return 0;
}
