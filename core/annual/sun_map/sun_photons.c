#include "annual/sun_map/sun_beams.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory/memory.h"
#include "light/direct.h"
#include "light/path.h"

enum { MOST_BOUNCES = 64 };
/* Share of a photon's first flux below which Russian roulette applies. */
static const double dimmest = 0.05;

/* Distribution of a beam's photons over its ports. */
struct port_distribution {
    double *shares; /* by port: cumulative flux */
    double flux;    /* flux of all ports */
};

static void record_deposit(struct orl_sun_photon_task *s, const struct orl_hit *hit, uint32_t batch,
                           struct orl_rgb flux)
{
    if (!orl_rgb_is_finite(flux))
        return;
    if (!orl_array_reserve(&s->deposits, &s->room, s->n_deposits, sizeof *s->deposits)) {
        s->code = ORL_ERR_NOMEM;
        return;
    }
    s->deposits[s->n_deposits++] =
        (struct orl_sun_deposit){.facet = hit->facet,
                                 .batch = batch,
                                 .front = hit->front,
                                 .point = hit->point,
                                 .normal = hit->normal,
                                 .flux = {(float)flux.r, (float)flux.g, (float)flux.b}};
}

/* Traces a photon from the inner side of a port until it is absorbed, leaves, or no permitted lobe
 * scatters it. */
static void trace_photon(struct orl_sun_photon_task *s, struct orl_path path, uint32_t batch,
                         struct orl_random *random)
{
    const struct orl_lit_scene *lit_scene = s->beams->lit_scene;
    const double first = orl_rgb_max(path.weight);
    const enum orl_lobes lobes = s->interreflection
                                     ? ORL_LOBE_ALL
                                     : (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);
    bool outside = false;
    for (int bounce = 0; bounce < MOST_BOUNCES; bounce++) {
        struct orl_hit hit;
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return;
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        orl_path_attenuate(&path, m, &hit);
        if (!outside && orl_rgb_max(orl_material_diffuse(m, &hit)) > 0)
            record_deposit(s, &hit, batch, path.weight);
        if (!s->interreflection && orl_material_is_matt(m))
            return;
        const struct orl_surface_sample sample =
            orl_material_sample(m, &hit, orl_path_back(&path), ORL_TRANSPORT_LIGHT, lobes, random);
        if (sample.event == ORL_EVENT_ABSORBED)
            return;
        path.weight = orl_rgb_mul(path.weight, sample.weight);
        const double chance = fmin(orl_rgb_max(path.weight) / (first * dimmest), 1);
        if (!(chance > 0) || (chance < 1 && !orl_path_roulette(&path, chance, random)))
            return;
        outside = orl_lit_scene_outside_after(lit_scene, &hit, sample.transmitted, outside);
        orl_path_spawn_ray(&path, lit_scene, &hit, &sample);
    }
}

static size_t port_at(const struct orl_lit_scene *lit_scene,
                      const struct port_distribution *port_distribution, double share)
{
    size_t low = 0, high = lit_scene->n_ports - 1;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (share < port_distribution->shares[middle])
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Traces one photon from the sun's disc to a port and through it. u: its Sobol point. */
static void emit_photon(struct orl_sun_photon_task *s,
                        const struct port_distribution *port_distribution, uint32_t index,
                        uint32_t batch, const double u[ORL_SOBOL_DIMENSIONS])
{
    const struct orl_lit_scene *lit_scene = s->beams->lit_scene;
    const struct orl_frame *sun = &s->nodes[s->beams->at[s->beam].node];
    const uint64_t name = (uint64_t)s->beam * ORL_SUN_PHOTON_BATCHES + batch;
    struct orl_random random =
        orl_random_stream(s->seed, ORL_PURPOSE_SUN_MAP, (name << 32) + index);
    const struct orl_port *port =
        &lit_scene->ports[port_at(lit_scene, port_distribution, u[2] * port_distribution->flux)];
    const double disc = 0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD;
    const struct orl_sun there = {.frame = *sun, .cos_half_angle = cos(disc)};
    const double on_disc[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
    const struct orl_vec3 towards = orl_sun_sample(&there, on_disc);
    struct orl_hit hit = {.facet = port->facet};
    orl_facet_sample(lit_scene->geometry, port->facet, u, &hit.point, &hit.normal);
    hit.front = orl_dot(towards, hit.normal) > 0;
    if (!(orl_dot(towards, port->outward) > 0) ||
        !orl_port_owns(lit_scene->geometry, port, hit.point))
        return;
    const struct orl_rgb share =
        orl_transmittance(lit_scene, orl_hit_ray_origin(lit_scene->geometry, &hit, towards),
                          towards, INFINITY, false);
    if (!(orl_rgb_max(share) > 0))
        return;
    const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
    const struct orl_surface_sample sample =
        orl_material_sample_at(m, &hit, towards, ORL_TRANSPORT_LIGHT, ORL_LOBE_TRANSMITTED, u + 3);
    if (sample.event == ORL_EVENT_ABSORBED)
        return;
    struct orl_path path = orl_path_from(hit.point, sample.direction);
    path.weight =
        orl_rgb_scale(orl_rgb_mul(share, sample.weight), port_distribution->flux / s->photons);
    orl_path_spawn_ray(&path, lit_scene, &hit, &sample);
    trace_photon(s, path, batch, &random);
}

/* Traces the photons of one index, from batch `first` to before batch `end`. */
static void emit_batches(struct orl_sun_photon_task *s,
                         const struct port_distribution *port_distribution,
                         const uint32_t seeds[ORL_SOBOL_BLOCK], uint32_t index, uint32_t first,
                         uint32_t end)
{
    struct orl_sobol_block block;
    orl_sobol_block(s->sobol, index, seeds, &block);
    for (uint32_t batch = first; batch < end && s->code == 0; batch++) {
        double u[ORL_SOBOL_DIMENSIONS];
        for (int d = 0; d < ORL_SOBOL_DIMENSIONS; d++)
            u[d] = block.at[d][batch];
        emit_photon(s, port_distribution, index, batch, u);
    }
}

/* Photons are distributed by the flux of unobstructed ports; obstacles attenuate each photon. */
void orl_sun_photon_task_trace(struct orl_sun_photon_task *s)
{
    const struct orl_lit_scene *lit_scene = s->beams->lit_scene;
    const struct orl_sun_beam *beam = &s->beams->at[s->beam];
    const struct orl_vec3 sun = s->nodes[beam->node].n;
    struct port_distribution port_distribution = {
        .shares = malloc(lit_scene->n_ports * sizeof *port_distribution.shares)};
    if (!port_distribution.shares) {
        s->code = ORL_ERR_NOMEM;
        return;
    }
    for (size_t i = 0; i < lit_scene->n_ports; i++) {
        if (s->beams->kind_of_port[i] == beam->kind)
            port_distribution.flux +=
                lit_scene->ports[i].area * fmax(orl_dot(sun, lit_scene->ports[i].outward), 0);
        port_distribution.shares[i] = port_distribution.flux;
    }
    uint32_t seeds[ORL_SOBOL_BLOCK] = {0};
    static_assert((int)ORL_SUN_PHOTON_BATCHES <= (int)ORL_SOBOL_BLOCK, "one block for all batches");
    for (uint32_t batch = 0; batch < ORL_SUN_PHOTON_BATCHES; batch++)
        seeds[batch] = (uint32_t)orl_mix64(
            s->seed + orl_mix64((uint64_t)s->beam * ORL_SUN_PHOTON_BATCHES + batch + 1));
    for (uint32_t i = s->first, next; port_distribution.flux > 0 && i < s->end; i = next) {
        const uint32_t index = i / ORL_SUN_PHOTON_BATCHES;
        next = (index + 1) * ORL_SUN_PHOTON_BATCHES;
        next = next < s->end ? next : s->end;
        emit_batches(s, &port_distribution, seeds, index, i % ORL_SUN_PHOTON_BATCHES,
                     next - index * ORL_SUN_PHOTON_BATCHES);
    }
    free(port_distribution.shares);
}

void orl_sun_photon_task_done(struct orl_sun_photon_task *s)
{
    free(s->deposits);
    s->deposits = NULL;
}
