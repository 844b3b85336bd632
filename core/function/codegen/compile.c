#include "function/codegen/compiler.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/array.h"
#include "function/interpreter/program.h"

/* ---- Compilation ----------------------------------------------------------------------------- */

/* Parses the expressions, which become the first bodies. */
static int read_expressions(struct orl_compiler *c)
{
    const struct orl_function_request *const request = c->request;
    struct orl_arena *const arena = c->functions->arena;
    const size_t n = request->n_expressions;
    struct orl_formula *const bodies = orl_arena_alloc(arena, (n + 1) * sizeof *bodies);
    const char *const file =
        request->file ? orl_arena_copy_text(arena, request->file, strlen(request->file)) : "";
    c->bodies = malloc((n + 1) * sizeof(struct orl_formula *));
    if (!bodies || !file || !c->bodies)
        return orl_compiler_no_memory(c);
    c->bodies_room = n + 1;
    memset(bodies, 0, (n + 1) * sizeof *bodies);
    for (size_t i = 0; i < n; i++) {
        const char *const text = request->expressions[i];
        const int code =
            orl_syntax_expression(c->functions, request->context, request->file, request->line,
                                  text, strlen(text), &bodies[i].root, c->err);
        if (code < 0)
            return code;
        bodies[i].name = "";
        bodies[i].file = file;
        bodies[i].compilation = c->number;
        bodies[i].slot = (uint32_t)i;
        c->bodies[c->n_bodies++] = &bodies[i];
    }
    return 0;
}

/* Marks a segment as part of the program. */
static int use_segment(struct orl_compiler *c, uint32_t slot)
{
    if (c->segments[slot].is_used)
        return 0;
    if (!orl_array_reserve(&c->used, &c->used_room, c->n_used, sizeof *c->used))
        return orl_compiler_no_memory(c);
    c->segments[slot].is_used = true;
    c->used[c->n_used++] = slot;
    return 0;
}

static int use_instruction(struct orl_compiler *c, const struct orl_instruction *one)
{
    int code = 0;
    if (one->operation == ORL_OP_VARIABLE)
        return use_segment(c, (uint32_t)one->index);
    if (one->operation != ORL_OP_CALL && one->operation != ORL_OP_CALL_PARAMETER)
        return 0;
    const struct orl_call_site site = c->sites[one->index];
    if (one->operation == ORL_OP_CALL)
        code = use_segment(c, site.callee);
    for (uint32_t i = 0; code == 0 && i < site.n; i++)
        if (c->arguments[site.first + i].kind == ORL_ARGUMENT_FUNCTION)
            code = use_segment(c, c->arguments[site.first + i].index);
    return code;
}

/* Compiles the expressions and the bodies that their instructions use; other bodies are left
 * out. */
static int emit_all(struct orl_compiler *c)
{
    int code = 0;
    c->segments = calloc(c->n_bodies + 1, sizeof *c->segments);
    c->scratch = orl_function_scratch_new();
    if (!c->segments || !c->scratch)
        return orl_compiler_no_memory(c);
    c->segments_room = c->n_bodies + 1;
    c->n_segments = c->n_bodies;
    for (uint32_t i = 0; code == 0 && i < c->request->n_expressions; i++)
        code = use_segment(c, i);
    while (code == 0 && c->n_used > 0) {
        const uint32_t slot = c->used[--c->n_used];
        code = orl_emit_body(c, slot);
        if (code == 0)
            code = orl_emit_waiting(c, 0);
        for (size_t i = 0; code == 0 && i < c->segments[slot].n; i++)
            code = use_instruction(c, &c->segments[slot].code[i]);
    }
    return code;
}

static void *copy_bytes(const void *from, size_t bytes)
{
    void *const made = malloc(bytes ? bytes : 1);
    if (made && bytes)
        memcpy(made, from, bytes);
    return made;
}

/* Joins all code in one array, and moves the other arrays to the function. */
static int link_program(struct orl_compiler *c, struct orl_function *f)
{
    const struct orl_function_request *const request = c->request;
    size_t at = 0;
    f->code = malloc((c->n_instructions + 1) * sizeof *f->code);
    f->segments = calloc(c->n_bodies + 1, sizeof *f->segments);
    f->args = copy_bytes(request->arguments, request->n_arguments * sizeof(double));
    if (!f->code || !f->segments || !f->args)
        return orl_compiler_no_memory(c);
    for (size_t i = 0; i < c->n_bodies; i++) {
        const struct orl_segment *const segment = &c->segments[i];
        const size_t n = segment->is_used ? segment->n : 0;
        if (n)
            memcpy(f->code + at, segment->code, n * sizeof *f->code);
        f->segments[i] = *segment;
        f->segments[i].code = f->code + at;
        f->segments[i].n = n;
        at += n;
    }
    f->n_code = at;
    f->n_segments = c->n_bodies;
    f->n_sites = c->n_sites;
    f->n_arguments = c->n_arguments;
    f->n_tables = c->n_tables;
    f->sites = c->sites;
    f->arguments = c->arguments;
    f->tables = c->tables;
    c->sites = NULL;
    c->arguments = NULL;
    c->tables = NULL;
    f->program =
        (struct orl_program){f->segments,          f->sites,      f->arguments, f->tables, f->args,
                             request->n_arguments, c->n_variables};
    f->n_expressions = request->n_expressions;
    f->n_inputs = c->functions->n_inputs;
    f->inputs = c->inputs;
    f->fixed_inputs = c->fixed_inputs;
    f->operations = request->operations ? request->operations : ORL_FUNCTION_OPERATIONS;
    return 0;
}

static void free_compiler(struct orl_compiler *c)
{
    for (size_t i = 0; i < c->n_segments; i++)
        free(c->segments[i].code);
    free(c->bodies);
    free(c->segments);
    free(c->sites);
    free(c->arguments);
    free(c->tables);
    free(c->waiting);
    free(c->used);
    orl_function_scratch_free(c->scratch);
}

int orl_function_compile(struct orl_functions *functions,
                         const struct orl_function_request *request,
                         struct orl_function **ret_function, struct orl_error *err)
{
    struct orl_compiler c = {.functions = functions,
                             .request = request,
                             .number = ++functions->n_compilations,
                             .folding = functions->folding,
                             .file = "",
                             .err = err};
    if (request->n_expressions > ORL_FUNCTION_EXPRESSIONS)
        return orl_error_set(err, ORL_ERR_LIMIT, "more than %d expressions in one program",
                             ORL_FUNCTION_EXPRESSIONS);
    struct orl_function *const function = calloc(1, sizeof *function);
    if (!function)
        return orl_compiler_no_memory(&c);
    int code = read_expressions(&c);
    if (code == 0)
        code = orl_compiler_analyse(&c);
    if (code == 0)
        code = emit_all(&c);
    if (code == 0)
        code = link_program(&c, function);
    functions->folding = c.folding;
    free_compiler(&c);
    if (code < 0)
        orl_function_free(function);
    else
        *ret_function = function;
    return code;
}
