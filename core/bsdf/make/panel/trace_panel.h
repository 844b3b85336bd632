/*
 * Traces one path of light through the panel. It starts beside the panel, samples its materials,
 * and ends when it leaves, is absorbed, or is given up.
 */
#ifndef ORL_BSDF_MAKE_PANEL_TRACE_PANEL_H
#define ORL_BSDF_MAKE_PANEL_TRACE_PANEL_H

#include "base/sampling/sobol.h"
#include "bsdf/make/panel/panel_sample.h"

/*
 * Random numbers of a path. The first scatterings use points of a Sobol sequence each, padded by
 * the path's seed (Burley 2020). Later ones use independent random numbers.
 */
struct orl_gonio_sampler {
    const struct orl_sobol *sobol;
    uint32_t index, seed;
    struct orl_random random;
};

enum orl_gonio_path_end { ORL_GONIO_PATH_LEFT, ORL_GONIO_PATH_CUT };

struct orl_gonio_exit {
    enum orl_gonio_path_end end;
    bool front;                /* true if it left towards z > 0 */
    struct orl_vec3 direction; /* direction of travel */
    struct orl_rgb weight;     /* weight of a path that started with 1 */
};

/*
 * Traces a path that starts beside the panel and enters it. Calls the sink for every end that is
 * not absorption. Where clear surfaces reflect and transmit, both parts are traced while they are
 * strong enough. In clear panels only the place of entry is then random.
 */
typedef void orl_gonio_on_exit(void *ctx, const struct orl_gonio_exit *exit);
void orl_gonio_trace(const struct orl_gonio_sample *sample, struct orl_path path,
                     struct orl_gonio_sampler *sampler, orl_gonio_on_exit *on_exit, void *ctx);

#endif
