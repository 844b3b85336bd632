/* Functions shared by requests for BSDFs from geometry and from measurements. */
#ifndef ORL_BSDF_MAKE_PANEL_REQUEST_H
#define ORL_BSDF_MAKE_PANEL_REQUEST_H

#include <stdint.h>

#include <oriel/base/error.h>

/* Sets an error at the given member; returns code. */
int orl_gonio_refuse(struct orl_error *err, int code, const char *member, const char *message);

/* Checks the parameters of tensor trees. Returns 0 or ORL_ERR_RANGE. */
int orl_gonio_check_tree(uint32_t resolution, double cull, struct orl_error *err);

/* Frees the files' names with their list, and the name. */
void orl_gonio_free_names(char **files, size_t n_files, char *name);

/* Estimated seconds of one core per path, for panels with a few surfaces. */
#define ORL_GONIO_PATH_S 4e-6

#endif
