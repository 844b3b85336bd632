/* Turns figures (check_bsdf.c) into sentences (verdict.c). For core/bsdf only. */
#ifndef ORL_BSDF_CHECK_CHECK_BSDF_H
#define ORL_BSDF_CHECK_CHECK_BSDF_H

#include <oriel/bsdf/bsdf.h>

/* Fills verdicts and worst of a check from its other fields. */
void orl_bsdf_set_verdicts(struct orl_bsdf_check *check);

#endif
