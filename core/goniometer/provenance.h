/* A panel's XML, with what it says of its making. */
#ifndef ORL_GONIOMETER_PROVENANCE_H
#define ORL_GONIOMETER_PROVENANCE_H

#include "bsdf/write.h"
#include "goniometer/sample.h"

/* The file's part for light from the back (which it calls Front), or the front; reflected,
 * transmitted. */
extern const enum orl_bsdf_part orl_gonio_part_of[2][2];

/* Sets made->xml; all else of it is told already. write_part: of trees (bsdf/write.h). 0 or
 * ORL_ERR_NOMEM. */
int orl_gonio_write(struct orl_document *document, orl_bsdf_write_part *write_part, void *ctx,
                    const struct orl_gonio_sample *sample,
                    const struct orl_bsdf_make_request *request, struct orl_bsdf_made *made);
/* The same for made->errors_xml, of a document of errors. */
int orl_gonio_write_errors(struct orl_document *document, orl_bsdf_write_part *write_part,
                           void *ctx, const struct orl_gonio_sample *sample,
                           const struct orl_bsdf_make_request *request, struct orl_bsdf_made *made);

#endif
