#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>

#include "base/memory/memory.h"
#include "function/function.h"
#include "function/interpreter/machine.h"
#include "function/language/definitions.h"

static bool add_context(struct orl_functions *functions, const char *name, const char *file)
{
    if (!orl_array_reserve(&functions->contexts, &functions->contexts_room, functions->n_contexts,
                           sizeof *functions->contexts))
        return false;
    const char *const kept = orl_arena_copy_text(functions->arena, name, strlen(name));
    if (kept)
        functions->contexts[functions->n_contexts++] = (struct orl_context){kept, file};
    return kept != NULL;
}

struct orl_functions *orl_functions_new(const char *const *inputs, size_t n_inputs)
{
    struct orl_functions *const functions = calloc(1, sizeof *functions);
    if (!functions || n_inputs > ORL_FUNCTION_INPUTS)
        goto failed;
    functions->inputs = inputs;
    functions->n_inputs = n_inputs;
    functions->folding = ORL_FUNCTION_FOLDING;
    functions->arena = orl_arena_new();
    if (!functions->arena || !add_context(functions, "", ""))
        goto failed;
    const char *const start = orl_standard_text(ORL_STANDARD_START);
    if (orl_functions_define(functions, ORL_FUNCTION_GLOBAL, NULL, 0, start, strlen(start), NULL) ==
        0)
        return functions;
failed:
    orl_functions_free(functions);
    return NULL;
}

void orl_functions_free(struct orl_functions *functions)
{
    if (!functions)
        return;
    free(functions->table);
    free(functions->contexts);
    orl_arena_free(functions->arena);
    free(functions);
}

/* Returns the definition of a function in the context or the global one, or NULL. */
static const struct orl_definition *find_function(const struct orl_functions *functions,
                                                  int context, const char *name)
{
    const struct orl_definition *found =
        orl_definitions_find(functions, context, name, strlen(name));
    if (!orl_definitions_has(found, true))
        found = orl_definitions_find(functions, ORL_FUNCTION_GLOBAL, name, strlen(name));
    return orl_definitions_has(found, true) ? found : NULL;
}

bool orl_functions_has(const struct orl_functions *functions, int context, const char *name)
{
    return find_function(functions, context, name) != NULL;
}

uint32_t orl_functions_arity(const struct orl_functions *functions, int context, const char *name)
{
    const struct orl_definition *const definition = find_function(functions, context, name);
    const int builtin = orl_builtin_named(name);
    if (definition)
        return definition->function.n_parameters;
    return builtin < 0 ? 0 : orl_builtins[builtin].min_args;
}

int orl_functions_define(struct orl_functions *functions, int context, const char *file, int line,
                         const char *text, size_t length, struct orl_error *err)
{
    if (length > ORL_FUNCTION_TEXT - functions->text_bytes) {
        orl_error_set(err, ORL_ERR_LIMIT, "all function files together are longer than %lu bytes",
                      ORL_FUNCTION_TEXT);
        orl_error_at(err, file, line, NULL);
        orl_error_hint(err, "put tables into data files");
        return ORL_ERR_LIMIT;
    }
    functions->text_bytes += length;
    return orl_syntax_define(functions, context, file, line, text, length, err);
}

/* Derives a context's name from a file name, without folders and extension. */
static void name_context(const char *file, char ret_name[64])
{
    const char *const slash = strrchr(file, '/');
    snprintf(ret_name, 64, "%s", slash ? slash + 1 : file);
    char *const dot = strrchr(ret_name, '.');
    if (dot && dot > ret_name)
        *dot = '\0';
}

static int read_file(struct orl_functions *functions, const struct orl_files *files,
                     const char *name, int context, struct orl_error *err)
{
    struct orl_file file;
    int code = ORL_ERR_NOT_FOUND;
    if (files)
        code = files->open(files->ctx, name, &file, err);
    if (code == 0) {
        struct orl_slice text = {file.data, file.size};
        code = orl_text_trim(name, &text, err);
        if (code == 0)
            code = orl_functions_define(functions, context, name, 1, text.text, text.length, err);
        if (files->close)
            files->close(files->ctx, &file);
        return code;
    }
    const char *const text = code == ORL_ERR_NOT_FOUND ? orl_standard_text(name) : NULL;
    if (text)
        return orl_functions_define(functions, context, NULL, 0, text, strlen(text), err);
    if (code == ORL_ERR_NOT_FOUND) {
        orl_error_set(err, code, "there is no function file '%.200s'", name);
        orl_error_hint(err, "put it under this name beside the scene, or into a folder of RAYPATH");
    }
    return code;
}

int orl_functions_load(struct orl_functions *functions, const struct orl_files *files,
                       const char *name, bool global, int *ret_context, struct orl_error *err)
{
    char context[64];
    int code;
    for (size_t i = 1; !global && i < functions->n_contexts; i++)
        if (strcmp(functions->contexts[i].file, name) == 0) {
            *ret_context = (int)i;
            return 0;
        }
    if (global) {
        code = read_file(functions, files, name, ORL_FUNCTION_GLOBAL, err);
        if (code == 0)
            *ret_context = ORL_FUNCTION_GLOBAL;
        return code;
    }
    name_context(name, context);
    if (!add_context(functions, context, ""))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for definitions");
    const size_t made = functions->n_contexts - 1;
    code = read_file(functions, files, name, (int)made, err);
    if (code < 0)
        return code;
    functions->contexts[made].file = orl_arena_copy_text(functions->arena, name, strlen(name));
    if (!functions->contexts[made].file)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for definitions");
    *ret_context = (int)made;
    return 0;
}
