/* Shares in percent, without rounding artefacts: the whole is exactly 100, and 7 of 25 is 28. */
#ifndef ORL_BASE_STATISTICS_PERCENT_H
#define ORL_BASE_STATISTICS_PERCENT_H

/* Returns part of whole, 0 ... 100; 0 if whole is 0. */
static inline double orl_percent(double part, double whole)
{
    if (!(whole > 0))
        return 0;
    return part < whole ? 100 * part / whole : 100;
}

#endif
