/* Values in independent batches: their mean, and its standard error. */
#ifndef ORL_BSDF_MAKE_BATCH_MEAN_H
#define ORL_BSDF_MAKE_BATCH_MEAN_H

#include <math.h>

#include <oriel/bsdf/bsdf_make.h>

enum { ORL_GONIO_BATCHES = ORL_BSDF_MAKE_BATCHES };

static inline struct orl_bsdf_share orl_gonio_batch_mean(const double values[ORL_GONIO_BATCHES])
{
    double sum = 0, squares = 0;
    for (int k = 0; k < ORL_GONIO_BATCHES; k++)
        sum += values[k];
    const double mean = sum / ORL_GONIO_BATCHES;
    for (int k = 0; k < ORL_GONIO_BATCHES; k++)
        squares += (values[k] - mean) * (values[k] - mean);
    return (struct orl_bsdf_share){mean,
                                   sqrt(squares / (ORL_GONIO_BATCHES * (ORL_GONIO_BATCHES - 1.0)))};
}

#endif
