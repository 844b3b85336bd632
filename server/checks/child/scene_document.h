/*
 * A scene as one JSON document: {"files": [{"name", "text" | "base64", "resource"}], "bsdfs":
 * {"name": "id"}}; or a Honeybee model, {"type": "Model", ...} (honeybee/hbjson.h).
 */
#ifndef ORL_SERVER_CHECKS_CHILD_SCENE_DOCUMENT_H
#define ORL_SERVER_CHECKS_CHILD_SCENE_DOCUMENT_H

#include <jansson.h>

#include "uploads/incoming.h"

/* Sends the document's files to the sink, in their order. *ret_rest is {"resources": [true, ...],
 * "bsdfs": ...}: one resource flag for each file, and the document's "bsdfs" if it has them. For a
 * model it is {"model": true}. */
int orl_scene_document_read(const struct orl_file *document, const struct orl_incoming_sink *sink,
                            json_t **ret_rest, struct orl_error *err);

#endif
