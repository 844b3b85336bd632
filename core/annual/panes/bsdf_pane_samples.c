#include "annual/panes/bsdf_pane_samples.h"

#include <string.h>

#include "base/circle.h"
#include "base/reservoir.h"

/* Candidates for each draw, if the sun's disc spans several cells of the BSDF. */
enum { DRAWS = ORL_PANEL_DRAWS, CANDIDATES = 8 };

/* Returns true if the disc spans cells of the BSDF with different transmittances. Then a few points
 * of the disc may send all of the light. */
static bool spans_cells(const struct orl_panel_kind *k, const struct orl_hit *hit,
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
static void find_cell(const struct orl_panel_kind *k, const struct orl_hour_sun *sun,
                      struct orl_panel_draws *draws)
{
    enum { RIM = 32 };
    const struct orl_frame frame = orl_frame_about(sun->towards);
    const double radius = 1.02 * tan(0.5 * sun->angle_rad);
    draws->middle = orl_panel_incidence(k, sun->towards);
    draws->in_one_cell = true;
    for (int i = 0; i < RIM && draws->in_one_cell; i++) {
        const struct orl_circle turn = orl_circle_turn((double)i / RIM);
        const struct orl_bsdf_incidence rim = orl_panel_incidence(
            k, orl_normalize(
                   orl_to_world(&frame, orl_v3(radius * turn.cosine, radius * turn.sine, 1))));
        draws->in_one_cell = orl_bsdf_in_one_cell(k->material->bsdf, &draws->middle, &rim);
    }
}

/* Samples the BSDF once with five uniform numbers. Returns false if the sample carries no light. */
static bool sample_draw(const struct orl_panel_kind *k, const struct orl_hit *hit,
                        const struct orl_sun *disc, const double u[5], struct orl_vec3 *ret_towards,
                        struct orl_panel_draw *ret_draw)
{
    const struct orl_vec3 from = orl_sun_sample(disc, u + 3);
    if (!(orl_dot(from, k->inward) < 0))
        return false;
    const struct orl_scatter s =
        orl_scatter_sample_at(k->material, hit, from, ORL_TRANSPORT_LIGHT, ORL_LOBE_TRANSMITTED, u);
    if (s.event != ORL_EVENT_GLOSSY && s.event != ORL_EVENT_DIFFUSE)
        return false;
    const double leaving = orl_dot(s.direction, k->inward);
    const double density = orl_scatter_pdf(k->material, hit, from, ORL_TRANSPORT_LIGHT,
                                           ORL_LOBE_TRANSMITTED, s.direction);
    if (!(leaving > 1e-6) || !(density > 0))
        return false;
    *ret_towards = s.direction;
    *ret_draw =
        (struct orl_panel_draw){(float)(orl_luma(s.weight) * -orl_dot(from, k->inward) / leaving),
                                (float)density,
                                {(float)u[3], (float)u[4]}};
    return true;
}

void orl_panel_draws_make(const struct orl_panel_kind *k, const struct orl_hour_sun *sun,
                          const struct orl_sobol *sobol, uint64_t seed,
                          struct orl_panel_draws *draws)
{
    const struct orl_sun disc = orl_panel_disc(sun);
    const struct orl_hit hit = orl_hit_anywhere(k->normal, orl_dot(sun->towards, k->normal) > 0);
    memset(draws, 0, sizeof *draws);
    draws->spans_cells = spans_cells(k, &hit, &disc);
    if (k->data_alone)
        find_cell(k, sun, draws);
    const uint32_t candidates = draws->spans_cells ? CANDIDATES : 1;
    for (uint32_t i = 0; i < DRAWS; i++) {
        struct orl_reservoir chosen = orl_reservoir_begin(orl_mix64(seed ^ i));
        for (uint32_t j = 0; j < candidates; j++) {
            struct orl_panel_draw draw;
            struct orl_vec3 towards;
            double u[5];
            orl_sobol_point(sobol, i * candidates + j, (uint32_t)seed, 5, u);
            if (!sample_draw(k, &hit, &disc, u, &towards, &draw) ||
                !orl_reservoir_add(&chosen, (double)draw.light))
                continue;
            draws->towards[0][i] = (float)towards.x;
            draws->towards[1][i] = (float)towards.y;
            draws->towards[2][i] = (float)towards.z;
            draws->at[i] = draw;
        }
        draws->at[i].light = (float)(chosen.weight_sum / candidates);
    }
}
