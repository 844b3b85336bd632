/*
 * One path of light through the panel: from beside it, by what its materials draw, until it leaves,
 * is absorbed, or is given up.
 */
#ifndef ORL_GONIOMETER_FOLLOW_H
#define ORL_GONIOMETER_FOLLOW_H

#include "base/sobol.h"
#include "goniometer/sample.h"

/*
 * A path's random numbers: of the first scatterings the points of an even sequence each, which is
 * padded from the others by its seed (Burley 2020); then chance alone.
 */
struct orl_gonio_numbers {
    const struct orl_sobol *sobol;
    uint32_t index, seed;
    struct orl_random random;
};

enum orl_gonio_end { ORL_GONIO_LEFT, ORL_GONIO_GIVEN_UP };

struct orl_gonio_exit {
    enum orl_gonio_end end;
    bool front;                /* it left towards z > 0 */
    struct orl_vec3 direction; /* as it travels */
    struct orl_rgb weight;     /* of a path that set out with 1 */
};

/*
 * path: at a place beside the panel, on its way in. Tells of every end that is not absorption:
 * where clear surfaces mirror some of the light and let some through, both are followed as long as
 * they are worth it, so that such panels leave nothing to chance but where light comes in.
 */
typedef void orl_gonio_sink(void *ctx, const struct orl_gonio_exit *exit);
void orl_gonio_follow(const struct orl_gonio_sample *sample, struct orl_path path,
                      struct orl_gonio_numbers *numbers, orl_gonio_sink *sink, void *ctx);

#endif
