/*
 * Shares in percent. All of the whole is 100 exactly, and 7 of 25 is 28, whatever rounding does to
 * quotients.
 */
#ifndef ORL_BASE_PERCENT_H
#define ORL_BASE_PERCENT_H

/* part of whole, 0 ... 100; of nothing 0. */
static inline double orl_percent(double part, double whole)
{
    if (!(whole > 0))
        return 0;
    return part < whole ? 100 * part / whole : 100;
}

#endif
