/*
 * Spectra among the patterns: spectrum, specfile, specfunc, specdata, converted by the standard
 * observer (material/patterns/observer.h). Radiance's renderer does the same unless it is set to
 * more than three channels. Internal to this folder.
 *
 * A sample is the mean of its band, which reaches half way to its neighbours, and as far beyond the
 * first and the last; outside the spectrum is 0. For a specfile with uneven wavelengths, which
 * Radiance reads wrongly, values between are linear. Functions are sampled every 5 nm.
 */
#ifndef ORL_SCENE_PARSE_PATTERN_SPECTRA_H
#define ORL_SCENE_PARSE_PATTERN_SPECTRA_H

#include "scene/material/patterns/pattern.h"
#include "scene/parse/parser.h"

/* Reads a spectrum or, with a grid, a specfile: sets the pattern's factor. */
int orl_spectrum_read(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_pattern *pattern, struct orl_error *err);

/* Sets the bands of a pattern whose programs are compiled: from its data's last axis, or from the
 * primitive's first two numbers. */
int orl_spectrum_bands(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_pattern *pattern, struct orl_error *err);

#endif
