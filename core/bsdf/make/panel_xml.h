/* XML of a panel, with a comment on how it was made. */
#ifndef ORL_BSDF_MAKE_PANEL_XML_H
#define ORL_BSDF_MAKE_PANEL_XML_H

#include "bsdf/make/panel/panel_sample.h"
#include "bsdf/xml/write_xml.h"

/* Component of the file by [light from the front][transmitted]. Light from the back is Front in the
 * file. */
extern const enum orl_component_kind orl_gonio_component_of[2][2];

/* Sets made->xml; its other fields must be set. write_part: writes trees (bsdf/xml/write_xml.h).
 * Returns 0 or ORL_ERR_NOMEM. */
int orl_gonio_write(struct orl_document *document, orl_bsdf_write_part *write_part, void *ctx,
                    const struct orl_gonio_sample *sample,
                    const struct orl_bsdf_make_request *request,
                    struct orl_bsdf_make_result *result);
/* Sets made->errors_xml in the same way, from a document of errors. */
int orl_gonio_write_errors(struct orl_document *document, orl_bsdf_write_part *write_part,
                           void *ctx, const struct orl_gonio_sample *sample,
                           const struct orl_bsdf_make_request *request,
                           struct orl_bsdf_make_result *result);

#endif
