/* Sensor grids of a Honeybee model, with what results need beside their sensors. */
#ifndef ORL_API_RECIPE_MODEL_GRIDS_H
#define ORL_API_RECIPE_MODEL_GRIDS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>

struct orl_model_grid {
    const char *identifier, *display_name, *group; /* borrowed from the model; group: "" if none */
    char full_id[256];   /* GROUP/IDENTIFIER, or the identifier: the grid's name in a project */
    const char *program; /* program type of its room, borrowed; NULL: none */
    double *areas;       /* area of each sensor's mesh face, scene units; owned; NULL: no mesh */
    size_t n_areas;
};
struct orl_model_grids {
    struct orl_model_grid *items; /* owned */
    size_t count;
    double metres; /* length of the model's unit */
};

/* Reads the grids; the model must live as long. Anything unexpected is left out: translating the
 * model to a scene reports it. Returns 0 or ORL_ERR_NOMEM. */
int orl_model_grids_read(const json_t *model, struct orl_model_grids *ret_grids,
                         struct orl_error *err);
void orl_model_grids_done(struct orl_model_grids *grids); /* zeros are fine */

#endif
