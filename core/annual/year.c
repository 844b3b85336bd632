#include "annual/year.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/stages.h"

void orl_year_warn(struct orl_year *y, const char *format, ...)
{
    struct orl_annual_result *r = y->result;
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (y->env->run->warned)
        y->env->run->warned(y->env->run->ctx, text);
    char **grown = realloc(r->warnings, (r->n_warnings + 1) * sizeof *grown);
    if (!grown)
        return;
    r->warnings = grown;
    grown[r->n_warnings] = strdup(text);
    r->n_warnings += grown[r->n_warnings] != NULL;
}

double orl_year_now(const struct orl_year *y)
{
    return y->env->run->now_s(y->env->run->ctx);
}

void orl_year_book(struct orl_year *y, enum orl_annual_stage stage, double *since)
{
    const double t = orl_year_now(y);
    y->result->timings_s[stage] += t - *since;
    *since = t;
}

/* Of the sensors to be computed the share w took from blocks_s to now: the rest takes as long, by
 * sensor. */
static double share_of_time(const struct orl_year *y, double sensors)
{
    const double now = orl_year_now(y), before = y->blocks_s - y->started_s;
    const double n = (double)(y->request->n_sensors - y->kept);
    const double w = n > 0 ? (sensors - (double)y->kept) / n : 1;
    const double whole = w > 0 ? before + (now - y->blocks_s) / w : 0;
    return whole > 0 ? fmin((now - y->started_s) / whole, 1) : 0;
}

void orl_year_tell(struct orl_year *y, enum orl_stage stage, double sensors)
{
    if (!y->env->run->progress)
        return; /* and the clock is not looked at */
    if (stage == ORL_STAGE_RENDER)
        y->told = fmax(y->told, share_of_time(y, sensors));
    orl_run_report(y->env->run, stage, sensors / (double)y->request->n_sensors, y->told);
}

int orl_year_no_memory(struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a year");
}

int orl_year_cancelled(struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
}
