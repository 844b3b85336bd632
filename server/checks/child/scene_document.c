#include "checks/child/child_checks.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "honeybee/hbjson.h"
#include "schemas.h"
#include "uploads/uploads.h"
#include "json/decode.h"

/* Decodes the content of one file object; the caller owns *ret_data. */
static int decode_content(const json_t *file, const char *where, unsigned char **ret_data,
                          size_t *ret_size, struct orl_error *err)
{
    const json_t *text = json_object_get(file, "text");
    const json_t *base64 = json_object_get(file, "base64");
    const json_t *source = text ? text : base64;
    if (!json_is_string(source) || (text && base64))
        return orl_json_fail(err, ORL_ERR_INVALID, where,
                             "give either \"text\" or \"base64\", as a string");
    const size_t length = json_string_length(source);
    unsigned char *data = malloc(length + 1);
    size_t size = length;
    if (!data)
        return orl_error_no_memory(err);
    memcpy(data, json_string_value(source), length);
    if (!text && sodium_base642bin(data, length + 1, json_string_value(source), length, " \r\n",
                                   &size, NULL, sodium_base64_VARIANT_ORIGINAL) != 0) {
        free(data);
        return orl_json_fail(err, ORL_ERR_INVALID, where, "this is not valid base64");
    }
    *ret_data = data;
    *ret_size = size;
    return 0;
}

static int send_to_sink(const char *name, const unsigned char *data, size_t size,
                        const struct orl_incoming_sink *sink, struct orl_error *err)
{
    if (size > ORL_LIMIT_FILE_BYTES)
        return orl_error_set(err, ORL_ERR_LIMIT, "'%s' is larger than %lu MiB", name,
                             ORL_LIMIT_FILE_BYTES >> 20);
    const int rc = sink->file(sink->ctx, name, err);
    return rc ? rc : sink->data(sink->ctx, (const char *)data, size, err);
}

static int read_file(const json_t *file, size_t index, const struct orl_incoming_sink *sink,
                     json_t *resources, struct orl_error *err)
{
    char where[ORL_JSON_PATH_MAX];
    char *name = NULL;
    unsigned char *data = NULL;
    size_t size = 0;
    bool resource = false;
    const struct orl_json_member members[] = {{"name", .text = &name},
                                              {.name = "text"},
                                              {.name = "base64"},
                                              {"resource", .flag = &resource},
                                              {0}};
    snprintf(where, sizeof where, "files[%zu]", index);
    int rc = orl_json_members(file, where, &orl_schema_upload_file, members, err);
    if (rc == 0 && !json_object_get(file, "resource"))
        resource = orl_is_xml_name(name);
    if (rc == 0)
        rc = decode_content(file, where, &data, &size, err);
    if (rc == 0)
        rc = send_to_sink(name, data, size, sink, err);
    if (rc == 0 && json_array_append_new(resources, json_boolean(resource)))
        rc = orl_error_no_memory(err);
    free(data);
    free(name);
    return rc;
}

static int read_model(const json_t *model, const struct orl_incoming_sink *sink, json_t **ret_rest,
                      struct orl_error *err)
{
    struct orl_text_files files = {0};
    int rc = orl_hbjson_translate(model, &files, err);
    for (size_t i = 0; i < files.count && rc == 0; i++)
        rc = send_to_sink(files.items[i].name, (const unsigned char *)files.items[i].text,
                          files.items[i].size, sink, err);
    orl_text_files_done(&files);
    *ret_rest = rc ? NULL : json_pack("{s:b}", "model", 1);
    return rc == 0 && !*ret_rest ? orl_error_no_memory(err) : rc;
}

static int read_files(const json_t *doc, const struct orl_incoming_sink *sink, json_t **ret_rest,
                      struct orl_error *err)
{
    static const struct orl_json_member members[] = {{.name = "files"}, {.name = "bsdfs"}, {0}};
    const json_t *files = json_object_get(doc, "files");
    json_t *bsdfs = json_object_get(doc, "bsdfs"), *resources = json_array();
    int rc = orl_json_members(doc, "", &orl_schema_scene_files, members, err);
    if (rc == 0)
        rc = orl_json_array_of(files, "files", &orl_schema_scene_files_files, err);
    for (size_t i = 0; rc == 0 && i < json_array_size(files); i++)
        rc = read_file(json_array_get(files, i), i, sink, resources, err);
    if (rc == 0 && bsdfs && json_object_size(bsdfs) > ORL_LIMIT_SCENE_FILES)
        rc = orl_json_fail(err, ORL_ERR_LIMIT, "bsdfs", "there are more than %u BSDFs",
                           ORL_LIMIT_SCENE_FILES);
    json_t *rest = rc ? NULL : json_pack("{s:O}", "resources", resources);
    if (rest && bsdfs)
        json_object_set(rest, "bsdfs", bsdfs);
    if (rc == 0 && !rest)
        rc = orl_error_no_memory(err);
    json_decref(resources);
    if (rc == 0)
        *ret_rest = rest;
    return rc;
}

/* Reads a model and the files that come with it, such as weather. */
static int read_model_and_files(const json_t *doc, const struct orl_incoming_sink *sink,
                                json_t **ret_rest, struct orl_error *err)
{
    static const struct orl_json_member members[] = {{.name = "model"}, {.name = "files"}, {0}};
    const json_t *model = json_object_get(doc, "model"), *files = json_object_get(doc, "files");
    json_t *resources = json_array(), *rest = NULL;
    int rc = orl_json_members(doc, "", &orl_schema_model_with_files, members, err);
    if (rc == 0 && !orl_hbjson_is_model(model))
        rc = orl_json_fail(err, ORL_ERR_INVALID, "model",
                           "this is not a Honeybee model: an object with \"type\": \"Model\"");
    if (rc == 0 && files)
        rc = orl_json_array_of(files, "files", &orl_schema_model_with_files_files, err);
    if (rc == 0)
        rc = read_model(model, sink, &rest, err);
    for (size_t i = 0; rc == 0 && i < json_array_size(files); i++)
        rc = read_file(json_array_get(files, i), i, sink, resources, err);
    json_decref(resources); /* the scene is the model alone, so no file is one of its resources */
    if (rc == 0)
        *ret_rest = rest;
    else
        json_decref(rest);
    return rc;
}

int orl_scene_document_read(const struct orl_file *document, const struct orl_incoming_sink *sink,
                            json_t **ret_rest, struct orl_error *err)
{
    json_t *doc = NULL;
    int rc = orl_json_parse(NULL, document->data, document->size, &doc, err);
    if (rc == 0)
        rc = orl_hbjson_is_model(doc)        ? read_model(doc, sink, ret_rest, err)
             : json_object_get(doc, "model") ? read_model_and_files(doc, sink, ret_rest, err)
                                             : read_files(doc, sink, ret_rest, err);
    json_decref(doc);
    return rc;
}
