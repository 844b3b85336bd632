/*
 * Splits a multipart/form-data body into parts: files go to tmp/ and are hashed as they are read,
 * other fields stay in memory. Pool threads; the connection must be suspended meanwhile (its
 * headers are read for the boundary).
 */
#ifndef ORL_SERVER_UPLOADS_MULTIPART_H
#define ORL_SERVER_UPLOADS_MULTIPART_H

#include <microhttpd.h>

#include "store/files/scene_bundle.h"

struct orl_multipart {
    struct orl_bundle files; /* in the order sent; temporary */
    struct orl_bundle zips;  /* likewise: zips to be unpacked */
    char *bsdfs;             /* the field "bsdfs", NUL-terminated, or NULL */
    char *mains;             /* the fields "main", one per line, or NULL */
};

/*
 * Splits the body. A part with a file name is a file: a resource if its field is "resource" or its
 * name ends in .xml, otherwise a main file. It is a zip if its type or name says so. Honeybee
 * models are not recognised here. Fields other than "bsdfs" and "main" are refused.
 */
int orl_multipart_split(struct MHD_Connection *connection, const struct orl_file *body,
                        const struct orl_folders *folders, struct orl_multipart *ret_parts,
                        struct orl_error *err);
void orl_multipart_done(struct orl_multipart *parts);

/* Returns true if the name ends in .xml, in any case. */
bool orl_is_xml_name(const char *name);

#endif
