/* Loads a BSDF file and identifies its source. */
#ifndef ORL_CLIENT_COMMANDS_BSDF_FILE_H
#define ORL_CLIENT_COMMANDS_BSDF_FILE_H

#include <oriel/bsdf/bsdf.h>

/* Loads the file at path. *ret_bsdf: to be released by orl_bsdf_unref. */
int orl_bsdf_file_load(const char *path, struct orl_bsdf **ret_bsdf, struct orl_error *err);
/* Formats the source of a BSDF: "panel.xml, SHA-256 0123..." */
int orl_bsdf_file_source(const char *path, char ret_source[512], struct orl_error *err);

#endif
