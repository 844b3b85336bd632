/* Models in the cells of a basis, and their XML. */
#ifndef ORL_BSDF_FIT_FIT_OUTPUT_H
#define ORL_BSDF_FIT_FIT_OUTPUT_H

#include "bsdf/fit/fit_model.h"

/* Indexed by [from the front][transmitted]; NULL: no such component. */
struct orl_fit_models {
    struct orl_fit_model *of[2][2];
};

/* Sample directions per incident cell along each axis; wide rings have more. */
enum { ORL_FIT_CELL_SAMPLES = 2 };

/* Share of all work after which components begin; they divide the rest among them. */
static const double orl_fit_prepared_share = 0.4;

/* Write the models in a basis: set fitted->xml and fitted->diffuse. Return 0 or a negative enum
 * orl_err. */
int orl_fit_write_trees(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env, struct orl_fit_models *models,
                        struct orl_bsdf_fit_result *result, struct orl_error *err);
int orl_fit_write_klems(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env, struct orl_fit_models *models,
                        struct orl_bsdf_fit_result *result, struct orl_error *err);

/* Writes the document with comments on how it was made (fit_provenance.c). */
struct orl_document;
struct orl_bsdf_labels;
int orl_fit_write_xml(struct orl_document *document, const struct orl_bsdf_labels *data,
                      const struct orl_bsdf_fit_request *request,
                      struct orl_bsdf_fit_result *result, struct orl_error *err);

#endif
