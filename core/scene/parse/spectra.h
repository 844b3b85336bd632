/*
 * Spectra among the patterns: spectrum, specfile, specfunc, specdata, as an eye sees them
 * (material/observer.h). Radiance's renderer does the same unless it is told to keep more than
 * three channels. Internal to this folder.
 *
 * A sample is the mean of its band, which reaches half way to its neighbours, as far beyond the
 * first and the last; nothing is outside. Of a specfile with uneven wavelengths, which Radiance
 * gets wrong, values between are linear. Functions are asked every 5 nm.
 */
#ifndef ORL_SCENE_PARSE_SPECTRA_H
#define ORL_SCENE_PARSE_SPECTRA_H

#include "scene/material/pattern.h"
#include "scene/parse/parser.h"

/* What spectrum or, with a grid, specfile says: the pattern's factor. */
int orl_spectrum_read(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_pattern *pattern, struct orl_error *err);

/* The bands of a pattern whose programs have been compiled: of its data's last axis, or of the
 * primitive's first two numbers. */
int orl_spectrum_bands(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_pattern *pattern, struct orl_error *err);

#endif
