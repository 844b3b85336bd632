/* What requests for BSDFs have in common, made of geometry or of measurements. */
#ifndef ORL_GONIOMETER_REQUEST_H
#define ORL_GONIOMETER_REQUEST_H

#include <stdint.h>

#include <oriel/error.h>

/* With the member at fault as its place. Returns code. */
int orl_gonio_refuse(struct orl_error *err, int code, const char *member, const char *message);

/* Of tensor trees. ORL_ERR_RANGE. */
int orl_gonio_check_tree(uint32_t resolution, double cull, struct orl_error *err);

/* Frees names, their list, and a name. */
void orl_gonio_free_names(char **files, size_t n_files, char *name);

/* Seconds of one core that a path is thought to take: of panels of some surfaces. */
#define ORL_GONIO_PATH_S 4e-6

#endif
