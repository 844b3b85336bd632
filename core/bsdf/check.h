/*
 * Inside core/bsdf: from figures (check.c) to sentences (verdict.c). Not for anyone else.
 */
#ifndef ORL_BSDF_CHECK_H
#define ORL_BSDF_CHECK_H

#include <oriel/bsdf.h>

/* Fills check's verdicts and worst from everything else in it. */
void orl_bsdf_judge(struct orl_bsdf_check *check);

#endif
