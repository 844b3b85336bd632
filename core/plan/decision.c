#include <stdarg.h>
#include <stdio.h>

#include "plan/decide.h"

bool orl_decision_fill(struct orl_decision *decision, const struct orl_finding *finding,
                       const char *format, ...)
{
    va_list args;
    int at = 0;
    decision->simulated = decision->override == ORL_OVERRIDE_FORCE ||
                          (decision->override == ORL_OVERRIDE_AUTO && finding->needed);
    decision->unit = finding->unit;
    decision->bound = finding->bound;
    decision->saved_s = decision->simulated ? 0 : finding->saved_s;
    decision->cost_s = decision->simulated ? finding->saved_s : 0;
    if (decision->override != ORL_OVERRIDE_AUTO)
        at = snprintf(decision->why, sizeof decision->why, "as asked; ");
    va_start(args, format);
    vsnprintf(decision->why + at, sizeof decision->why - (size_t)at, format, args);
    va_end(args);
    return decision->simulated;
}
