#include "scene/parse/gltf/gltf_file.h"

#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/json_read.h>
#include <oriel/base/limits.h>

int orl_gltf_fail(const struct orl_gltf_item *at, int code, struct orl_error *err,
                  const char *format, ...)
{
    va_list args;
    va_start(args, format);
    orl_error_vset(err, code, format, args);
    va_end(args);
    orl_error_hint(err, "the file is damaged, or its exporter is faulty: export it again");
    orl_error_at(err, at->file, 0, at->name);
    return code;
}

int orl_gltf_find(const struct orl_gltf_item *at, const char *list, size_t index,
                  struct orl_gltf_item *ret_item, struct orl_error *err)
{
    const json_t *const object = json_array_get(json_object_get(at->root, list), index);
    if (!json_is_object(object))
        return orl_gltf_fail(at, ORL_ERR_SYNTAX, err, "it refers to %s[%zu], which does not exist",
                             list, index);
    *ret_item = (struct orl_gltf_item){at->file, at->root, object, ""};
    snprintf(ret_item->name, sizeof ret_item->name, "%s[%zu]", list, index);
    return 0;
}

static void name_inner(const struct orl_gltf_item *at, const char *key,
                       struct orl_gltf_item *ret_inner)
{
    *ret_inner = (struct orl_gltf_item){at->file, at->root, json_object_get(at->object, key), ""};
    snprintf(ret_inner->name, sizeof ret_inner->name, "%.50s%s%.30s", at->name,
             at->name[0] ? "." : "", key);
}

int orl_gltf_element(const struct orl_gltf_item *at, const char *list, size_t index,
                     struct orl_gltf_item *ret_part, struct orl_error *err)
{
    struct orl_gltf_item all;
    name_inner(at, list, &all);
    *ret_part = (struct orl_gltf_item){at->file, at->root, json_array_get(all.object, index), ""};
    snprintf(ret_part->name, sizeof ret_part->name, "%.70s[%zu]", all.name, index);
    return json_is_object(ret_part->object)
               ? 0
               : orl_gltf_fail(ret_part, ORL_ERR_SYNTAX, err, "an object is expected here");
}

int orl_gltf_member(const struct orl_gltf_item *at, const char *key,
                    struct orl_gltf_item *ret_inner, struct orl_error *err)
{
    name_inner(at, key, ret_inner);
    return !ret_inner->object || json_is_object(ret_inner->object)
               ? 0
               : orl_gltf_fail(ret_inner, ORL_ERR_SYNTAX, err, "an object is expected here");
}

int orl_gltf_length(const struct orl_gltf_item *at, const char *list, size_t *ret_length,
                    struct orl_error *err)
{
    struct orl_gltf_item all;
    name_inner(at, list, &all);
    *ret_length = json_array_size(all.object);
    return !all.object || json_is_array(all.object)
               ? 0
               : orl_gltf_fail(&all, ORL_ERR_SYNTAX, err, "a list is expected here");
}

static bool read_whole(const json_t *value, size_t *ret_value)
{
    const double number = json_number_value(value);
    if (!json_is_number(value) || !(number >= 0 && number <= 0x1p53) || number != floor(number))
        return false;
    *ret_value = (size_t)number;
    return true;
}

int orl_gltf_integer(const struct orl_gltf_item *at, const char *key, size_t *value,
                     struct orl_error *err)
{
    const json_t *const member = json_object_get(at->object, key);
    return !member || read_whole(member, value)
               ? 0
               : orl_gltf_fail(at, ORL_ERR_SYNTAX, err, "'%s' is not a whole number from 0 up",
                               key);
}

int orl_gltf_integer_in_list(const struct orl_gltf_item *at, const char *list, size_t i,
                             size_t *ret_value, struct orl_error *err)
{
    const json_t *const member = json_array_get(json_object_get(at->object, list), i);
    return read_whole(member, ret_value)
               ? 0
               : orl_gltf_fail(at, ORL_ERR_SYNTAX, err,
                               "'%s' has a member that is not a whole number from 0 up", list);
}

int orl_gltf_numbers(const struct orl_gltf_item *at, const char *key, size_t n, double *values,
                     bool *ret_given, struct orl_error *err)
{
    const json_t *const array = json_object_get(at->object, key);
    bool sound = json_is_array(array) && json_array_size(array) == n;
    *ret_given = array != NULL;
    for (size_t i = 0; sound && i < n; i++) {
        const json_t *const value = json_array_get(array, i);
        sound = json_is_number(value);
        values[i] = json_number_value(value);
    }
    return !array || sound
               ? 0
               : orl_gltf_fail(at, ORL_ERR_SYNTAX, err, "'%s' is not %zu numbers", key, n);
}

const char *orl_gltf_text(const struct orl_gltf_item *at, const char *key)
{
    return json_string_value(json_object_get(at->object, key));
}

enum { CHUNK_HEAD = 8, GLB_HEAD = 12, NAME_BYTES = 4096 };

/* ---- Containers ------------------------------------------------------------------------------ */

static bool is_binary(const char *data, size_t size)
{
    return size >= GLB_HEAD && memcmp(data, "glTF", 4) == 0;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/* Returns the offset behind a byte order mark and blanks. */
static size_t find_text(const char *data, size_t size)
{
    size_t at = size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    while (at < size && is_blank(data[at]))
        at++;
    return at;
}

bool orl_gltf_detect(const char *data, size_t size)
{
    const size_t at = find_text(data, size);
    return is_binary(data, size) || (at < size && data[at] == '{');
}

static size_t read_u32(const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    return (size_t)b[0] | (size_t)b[1] << 8 | (size_t)b[2] << 16 | (size_t)b[3] << 24;
}

static int refuse_file(const struct orl_gltf_file *file, int code, const char *what,
                       const char *mend, struct orl_error *err)
{
    orl_gltf_fail(&file->root, code, err, "%s", what);
    orl_error_hint(err, "%s", mend);
    return code;
}

/* Reads the chunks of a .glb: JSON, which is the first, and BIN. */
static int read_chunks(struct orl_gltf_file *file, const char *data, size_t size,
                       struct orl_gltf_bytes *ret_json, struct orl_error *err)
{
    static const char cut[] = "the file is truncated: copy or export it again";
    size_t at = GLB_HEAD;
    if (read_u32(data + 4) != 2)
        return refuse_file(file, ORL_ERR_UNSUPPORTED, "this is glTF, but not version 2",
                           "export it again as glTF 2.0", err);
    if (read_u32(data + 8) > size)
        return refuse_file(file, ORL_ERR_SYNTAX, "its header gives a longer file", cut, err);
    size = read_u32(data + 8);
    while (at <= size && size - at >= CHUNK_HEAD) {
        const size_t length = read_u32(data + at);
        const char *const type = data + at + 4;
        const struct orl_gltf_bytes chunk = {(const unsigned char *)type + 4, length};
        if (length > size - at - CHUNK_HEAD)
            return refuse_file(file, ORL_ERR_SYNTAX,
                               "one of its chunks extends beyond the file's end", cut, err);
        if (at == GLB_HEAD && memcmp(type, "JSON", 4) == 0)
            *ret_json = chunk;
        else if (!file->chunk.data && memcmp(type, "BIN", 4) == 0)
            file->chunk = chunk;
        at += CHUNK_HEAD + length;
    }
    return ret_json->data ? 0
                          : refuse_file(file, ORL_ERR_SYNTAX, "its first chunk is not JSON",
                                        "export it again as glTF 2.0", err);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static int read_json(struct orl_gltf_file *file, const char *text, size_t size,
                     struct orl_error *err)
{
    json_error_t where;
    const size_t begin = find_text(text, size);
    while (size > begin && (text[size - 1] == '\0' || is_blank(text[size - 1])))
        size--; /* strips the chunk's padding */
    if (orl_json_memory_estimate(text + begin, size - begin) > ORL_LIMIT_JSON_MEMORY)
        return refuse_file(file, ORL_ERR_LIMIT, "its JSON has too many values",
                           "export it as .glb, or split it into several files", err);
    file->document = orl_json_read(text + begin, size - begin, JSON_REJECT_DUPLICATES, &where);
    if (!file->document && errno == ENOMEM)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a glTF file");
    if (!file->document) {
        orl_gltf_fail(&file->root, ORL_ERR_SYNTAX, err,
                      "this is not a readable glTF 2.0 file: JSON line %d, column %d: %s",
                      where.line, where.column, where.text);
        return ORL_ERR_SYNTAX;
    }
    file->root.root = file->root.object = file->document;
    return 0;
}

static int check_version(const struct orl_gltf_file *file, struct orl_error *err)
{
    struct orl_gltf_item asset;
    const int code = orl_gltf_member(&file->root, "asset", &asset, err);
    const char *const version = orl_gltf_text(&asset, "version");
    const char *const least = orl_gltf_text(&asset, "minVersion");
    if (code)
        return code;
    if (!version)
        return refuse_file(
            file, ORL_ERR_SYNTAX,
            "this is not a readable glTF 2.0 file: it has no 'asset' with a 'version'",
            "export it again as glTF 2.0", err);
    return version[0] == '2' && (version[1] == '.' || !version[1]) &&
                   (!least || strcmp(least, "2.0") == 0)
               ? 0
               : refuse_file(file, ORL_ERR_UNSUPPORTED, "this is glTF, but not version 2.0",
                             "export it again as glTF 2.0", err);
}

/* Returns true for extensions that only concern ignored content (colours, textures, lights), or
 * that are supported. */
static bool is_known(const char *name)
{
    static const char *const known[] = {"KHR_materials_",
                                        "KHR_texture_",
                                        "KHR_lights_",
                                        "EXT_lights_",
                                        "EXT_texture_",
                                        "MSFT_texture_",
                                        "KHR_technique",
                                        "KHR_xmp",
                                        "KHR_animation_",
                                        "KHR_mesh_quantization",
                                        "EXT_mesh_gpu_instancing"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strncmp(name, known[i], strlen(known[i])) == 0)
            return true;
    return false;
}

static int check_extensions(const struct orl_gltf_file *file, struct orl_error *err)
{
    static const char list[] = "extensionsRequired";
    const json_t *const names = json_object_get(file->document, list);
    size_t count = 0;
    const int code = orl_gltf_length(&file->root, list, &count, err);
    for (size_t i = 0; i < count && code == 0; i++) {
        const char *const name = json_string_value(json_array_get(names, i));
        if (name && is_known(name))
            continue;
        orl_gltf_fail(&file->root, ORL_ERR_UNSUPPORTED, err,
                      "the extension '%.80s' is not supported", name ? name : "");
        orl_error_hint(err, "export it without this extension, for example without compression");
        return ORL_ERR_UNSUPPORTED;
    }
    return code;
}

/* ---- Buffers --------------------------------------------------------------------------------- */

/* Decodes "a%20b" to "a b"; false if the name is too long. */
static bool decode_name(const char *name, char ret_name[NAME_BYTES])
{
    size_t n = 0;
    for (; *name && n + 1 < NAME_BYTES; name++) {
        char digits[3] = {0}, *end = digits;
        if (*name == '%' && name[1])
            memcpy(digits, name + 1, 2);
        const long byte = strtol(digits, &end, 16);
        if (end == digits + 2 && byte > 0)
            name += 2;
        ret_name[n++] = end == digits + 2 && byte > 0 ? (char)byte : *name;
    }
    ret_name[n] = '\0';
    return *name == '\0';
}

/* Decodes "data:...;base64,...", with or without '=' at its end. */
static int decode_text(const struct orl_gltf_item *at, const char *uri,
                       struct orl_gltf_buffer *buffer, struct orl_error *err)
{
    static const char mark[] = ";base64";
    const char *const comma = strchr(uri, ',');
    if (!comma || (size_t)(comma - uri) < sizeof mark - 1 ||
        memcmp(comma - (sizeof mark - 1), mark, sizeof mark - 1) != 0)
        return orl_gltf_fail(at, ORL_ERR_UNSUPPORTED, err, "the data in its 'uri' are not base64");
    size_t length = strlen(comma + 1);
    while (length > 0 && comma[length] == '=')
        length--;
    buffer->decoded = malloc(length / 4 * 3 + 3);
    if (!buffer->decoded)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a glTF file");
    if (sodium_base642bin(buffer->decoded, length / 4 * 3 + 3, comma + 1, length, NULL,
                          &buffer->bytes.size, NULL,
                          sodium_base64_VARIANT_ORIGINAL_NO_PADDING) != 0)
        return orl_gltf_fail(at, ORL_ERR_SYNTAX, err, "its base64 data are invalid");
    buffer->bytes.data = buffer->decoded;
    return 0;
}

static int open_external(const struct orl_gltf_file *file, const struct orl_gltf_item *at,
                         const char *uri, struct orl_gltf_bytes *ret_bytes, struct orl_error *err)
{
    struct orl_file opened;
    char name[NAME_BYTES];
    if (!decode_name(uri, name))
        return orl_gltf_fail(at, ORL_ERR_LIMIT, err, "its 'uri' is too long");
    const int code = file->external->open(file->external->ctx, name, &opened, err);
    if (code)
        orl_error_at(err, at->file, 0, at->name);
    else
        *ret_bytes = (struct orl_gltf_bytes){(const unsigned char *)opened.data, opened.size};
    return code;
}

static int open_buffer(struct orl_gltf_file *file, const struct orl_gltf_item *at, size_t index,
                       struct orl_gltf_buffer *buffer, struct orl_error *err)
{
    const char *const uri = orl_gltf_text(at, "uri");
    size_t length = 0;
    int code = orl_gltf_integer(at, "byteLength", &length, err);
    if (code)
        return code;
    if (uri && strncmp(uri, "data:", 5) == 0)
        code = decode_text(at, uri, buffer, err);
    else if (uri)
        code = open_external(file, at, uri, &buffer->bytes, err);
    else if (index == 0 && file->chunk.data)
        buffer->bytes = file->chunk;
    else
        code = orl_gltf_fail(at, ORL_ERR_SYNTAX, err, "it has neither a 'uri' nor a binary chunk");
    if (code == 0 && buffer->bytes.size < length)
        code = orl_gltf_fail(at, ORL_ERR_SYNTAX, err, "it has %zu bytes, but states %zu",
                             buffer->bytes.size, length);
    buffer->bytes.size = length;
    return code;
}

int orl_gltf_file_buffer(struct orl_gltf_file *file, const struct orl_gltf_item *at, size_t index,
                         struct orl_gltf_bytes *ret_bytes, struct orl_error *err)
{
    struct orl_gltf_item item = {0};
    int code = orl_gltf_find(at, "buffers", index, &item, err);
    if (code == 0 && !file->buffers[index].bytes.data)
        code = open_buffer(file, &item, index, &file->buffers[index], err);
    if (code == 0)
        *ret_bytes = file->buffers[index].bytes;
    return code;
}

/* ---- The file -------------------------------------------------------------------------------- */

int orl_gltf_file_step(struct orl_gltf_file *file, const struct orl_gltf_item *at, uint64_t steps,
                       struct orl_error *err)
{
    file->steps += steps;
    if (file->steps <= ORL_LIMIT_SURFACES)
        return 0;
    orl_gltf_fail(
        at, ORL_ERR_LIMIT, err,
        "here the file exceeds %lu triangles, counting every use of a mesh and sparse vertices",
        ORL_LIMIT_SURFACES);
    orl_error_hint(err, "export less of it, or repeat parts of it with octree instances");
    return ORL_ERR_LIMIT;
}

int orl_gltf_file_open(struct orl_gltf_file *file, const char *name, const char *data, size_t size,
                       const struct orl_gltf_buffers *external, struct orl_error *err)
{
    struct orl_gltf_bytes json = {(const unsigned char *)data, size};
    int code = 0;
    *file = (struct orl_gltf_file){.root = {.file = name}, .external = external};
    if (is_binary(data, size)) {
        json = (struct orl_gltf_bytes){NULL, 0};
        code = read_chunks(file, data, size, &json, err);
    }
    if (code == 0)
        code = read_json(file, (const char *)json.data, json.size, err);
    if (code == 0)
        code = check_version(file, err);
    if (code == 0)
        code = check_extensions(file, err);
    if (code == 0)
        code = orl_gltf_length(&file->root, "buffers", &file->n_buffers, err);
    if (code == 0 && file->n_buffers > 0)
        file->buffers = calloc(file->n_buffers, sizeof *file->buffers);
    return code == 0 && file->n_buffers > 0 && !file->buffers
               ? orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a glTF file")
               : code;
}

void orl_gltf_file_done(struct orl_gltf_file *file)
{
    for (size_t i = 0; file->buffers && i < file->n_buffers; i++)
        free(file->buffers[i].decoded);
    free(file->buffers);
    json_decref(file->document);
}
