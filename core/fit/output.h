/* Models in the cells of a basis, and their XML. */
#ifndef ORL_FIT_OUTPUT_H
#define ORL_FIT_OUTPUT_H

#include "fit/model.h"

/* By [from the front?][transmitted?]; NULL: no such component. */
struct orl_fit_models {
    struct orl_fit_model *of[2][2];
};

/* Of incident cells, how many places stand for one, in each direction; of wide rings more. */
enum { ORL_FIT_CELL_PLACES = 2 };

/* Of all work: what components begin at; each has its part of the rest. */
static const double orl_fit_begun = 0.4;

/* Set fitted->xml, and its shares of diffuse light. source: who asks, for the XML's remarks. */
int orl_fit_write_trees(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env, struct orl_fit_models *models,
                        struct orl_bsdf_fitted *fitted, struct orl_error *err);
int orl_fit_write_klems(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env, struct orl_fit_models *models,
                        struct orl_bsdf_fitted *fitted, struct orl_error *err);

/* provenance.c: the document with remarks of how it came to be. */
struct orl_document;
struct orl_bsdf_labels;
int orl_fit_write_xml(struct orl_document *document, const struct orl_bsdf_labels *data,
                      const struct orl_bsdf_fit_request *request, struct orl_bsdf_fitted *fitted,
                      struct orl_error *err);

#endif
