#include "annual/panes/bsdf_panes.h"

#include <string.h>

#include "base/sampling/sampling.h"

/* Candidates for each sample, if the sun's disc spans several cells of the BSDF. */
enum { SAMPLES = ORL_BSDF_PANE_SAMPLES, CANDIDATES = 8 };

/* Returns true if the disc spans cells of the BSDF with different transmittances. Then a few points
 * of the disc may send all of the light. */
static bool spans_cells(const struct orl_bsdf_pane_kind *k, const struct orl_hit *hit,
                        const struct orl_sun *disc)
{
    enum { RIM = 8 };
    static const double alike = 0.05;
    double least = INFINITY, most = 0;
    for (int i = 0; i <= RIM; i++) {
        const double u[2] = {i < RIM ? 0.999 : 0, (i + 0.5) / RIM};
        const double share = orl_luma(
            orl_material_albedo(k->material, hit, orl_sun_sample(disc, u), ORL_LOBE_TRANSMITTED));
        least = fmin(least, share);
        most = fmax(most, share);
    }
    return most - least > alike * most;
}

/* Finds the cell of the disc's centre, and tests whether the whole disc lies in it. The test points
 * lie on a circle that is wider than the disc by more than the sagitta between them. */
static void find_cell(const struct orl_bsdf_pane_kind *k, const struct orl_hour_sun *sun,
                      struct orl_bsdf_pane_samples *samples)
{
    enum { RIM = 32 };
    const struct orl_frame frame = orl_frame_about(sun->towards);
    const double radius = 1.02 * tan(0.5 * sun->angle_rad);
    samples->middle = orl_bsdf_pane_incidence(k, sun->towards);
    samples->in_one_cell = true;
    for (int i = 0; i < RIM && samples->in_one_cell; i++) {
        const struct orl_sincos turn = orl_sincos_turn((double)i / RIM);
        const struct orl_bsdf_incidence rim = orl_bsdf_pane_incidence(
            k, orl_normalize(
                   orl_to_world(&frame, orl_v3(radius * turn.cosine, radius * turn.sine, 1))));
        samples->in_one_cell =
            orl_bsdf_in_one_cell(orl_material_bsdf(k->material), &samples->middle, &rim);
    }
}

/* Samples the BSDF once with five uniform numbers. Returns false if the sample carries no light. */
static bool draw_sample(const struct orl_bsdf_pane_kind *k, const struct orl_hit *hit,
                        const struct orl_sun *disc, const double u[5], struct orl_vec3 *ret_towards,
                        struct orl_bsdf_pane_sample *ret_sample)
{
    const struct orl_vec3 from = orl_sun_sample(disc, u + 3);
    if (!(orl_dot(from, k->inward) < 0))
        return false;
    const struct orl_surface_sample s = orl_material_sample_at(
        k->material, hit, from, ORL_TRANSPORT_LIGHT, ORL_LOBE_TRANSMITTED, u);
    if (s.event != ORL_EVENT_GLOSSY && s.event != ORL_EVENT_DIFFUSE)
        return false;
    const double leaving = orl_dot(s.direction, k->inward);
    const double density = orl_material_pdf(k->material, hit, from, ORL_TRANSPORT_LIGHT,
                                            ORL_LOBE_TRANSMITTED, s.direction);
    if (!(leaving > 1e-6) || !(density > 0))
        return false;
    *ret_towards = s.direction;
    *ret_sample = (struct orl_bsdf_pane_sample){
        (float)(orl_luma(s.weight) * -orl_dot(from, k->inward) / leaving),
        (float)density,
        {(float)u[3], (float)u[4]}};
    return true;
}

void orl_bsdf_pane_samples_make(const struct orl_bsdf_pane_kind *k, const struct orl_hour_sun *sun,
                                const struct orl_sobol *sobol, uint64_t seed,
                                struct orl_bsdf_pane_samples *samples)
{
    const struct orl_sun disc = orl_bsdf_pane_sun_disc(sun);
    const struct orl_hit hit =
        orl_hit_surface_mean(k->normal, orl_dot(sun->towards, k->normal) > 0);
    memset(samples, 0, sizeof *samples);
    samples->spans_cells = spans_cells(k, &hit, &disc);
    if (k->data_alone)
        find_cell(k, sun, samples);
    const uint32_t candidates = samples->spans_cells ? CANDIDATES : 1;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        struct orl_reservoir chosen = orl_reservoir_begin(orl_mix64(seed ^ i));
        for (uint32_t j = 0; j < candidates; j++) {
            struct orl_bsdf_pane_sample sample;
            struct orl_vec3 towards;
            double u[5];
            orl_sobol_point(sobol, i * candidates + j, (uint32_t)seed, 5, u);
            if (!draw_sample(k, &hit, &disc, u, &towards, &sample) ||
                !orl_reservoir_add(&chosen, (double)sample.light))
                continue;
            samples->towards[0][i] = (float)towards.x;
            samples->towards[1][i] = (float)towards.y;
            samples->towards[2][i] = (float)towards.z;
            samples->at[i] = sample;
        }
        samples->at[i].light = (float)(chosen.weight_sum / candidates);
    }
}
