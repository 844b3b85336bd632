#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "function/codegen/compiler.h"
#include "function/interpreter/machine.h"

/* Dependency between two bodies, by slots. */
struct use {
    uint32_t used, user;
};

struct survey {
    struct orl_compiler *c;
    struct use *uses;
    size_t n_uses, uses_room;
    uint32_t user;
};

/* Gives the body a slot, if it has none. */
static int assign_slot(struct orl_compiler *c, struct orl_formula *body)
{
    if (body->compilation == c->number)
        return 0;
    if (!orl_array_reserve(&c->bodies, &c->bodies_room, c->n_bodies, sizeof(struct orl_formula *)))
        return orl_compiler_no_memory(c);
    body->compilation = c->number;
    body->slot = (uint32_t)c->n_bodies;
    body->open = false;
    c->bodies[c->n_bodies++] = body;
    return 0;
}

static bool is_fixed(const struct orl_compiler *c, uint32_t input)
{
    return c->request->fixed && !isnan(c->request->fixed[input]);
}

/* Records the bodies that a tree uses, and marks the user as open if it reads an input. */
static int visit_term(struct survey *s, struct orl_term *node)
{
    struct orl_compiler *const c = s->c;
    int code = 0;
    if (++c->functions->work > ORL_FUNCTION_WORK)
        return orl_error_set(c->err, ORL_ERR_LIMIT,
                             "all functions together are too large to compile");
    if (node->kind == ORL_NODE_INPUT && !is_fixed(c, node->index))
        c->bodies[s->user]->open = true;
    else if (node->kind == ORL_NODE_INPUT)
        c->fixed_inputs |= UINT64_C(1) << node->index;
    if (node->kind == ORL_NODE_NAME || node->kind == ORL_NODE_CALL) {
        struct orl_formula *const body = orl_body_of(node);
        if (body) {
            code = assign_slot(c, body);
            if (code == 0 &&
                !orl_array_reserve(&s->uses, &s->uses_room, s->n_uses, sizeof *s->uses))
                code = orl_compiler_no_memory(c);
            if (code == 0)
                s->uses[s->n_uses++] = (struct use){body->slot, s->user};
        }
    }
    for (uint32_t i = 0; code == 0 && i < node->n_args; i++)
        code = visit_term(s, node->args[i]);
    return code;
}

static int compare_uses(const void *a, const void *b)
{
    const struct use *const left = a, *const right = b;
    if (left->used != right->used)
        return left->used < right->used ? -1 : 1;
    return left->user < right->user ? -1 : left->user > right->user;
}

/* Propagates openness: bodies that use an open body are open. */
static int propagate_open(struct survey *s)
{
    struct orl_compiler *const c = s->c;
    const size_t n = c->n_bodies;
    size_t *const first = calloc(n + 1, sizeof *first);
    uint32_t *const open = malloc((n + 1) * sizeof *open);
    size_t n_open = 0, at = 0;
    if (!first || !open) {
        free(first);
        free(open);
        return orl_compiler_no_memory(c);
    }
    if (s->n_uses)
        qsort(s->uses, s->n_uses, sizeof *s->uses, compare_uses);
    for (size_t i = 0; i <= n; i++) {
        while (at < s->n_uses && s->uses[at].used < i)
            at++;
        first[i] = at;
    }
    for (uint32_t i = 0; i < n; i++)
        if (c->bodies[i]->open)
            open[n_open++] = i;
    while (n_open > 0) {
        const uint32_t one = open[--n_open];
        for (size_t i = first[one]; i < first[one + 1]; i++) {
            struct orl_formula *const user = c->bodies[s->uses[i].user];
            if (!user->open)
                open[n_open++] = user->slot;
            user->open = true;
        }
    }
    free(first);
    free(open);
    return 0;
}

/* Sets the constant flag of each node of a tree. */
static bool mark_constants(const struct orl_compiler *c, struct orl_term *node)
{
    bool constant = true;
    for (uint32_t i = 0; i < node->n_args; i++)
        constant &= mark_constants(c, node->args[i]);
    if (node->kind == ORL_NODE_PARAMETER || node->kind == ORL_NODE_CALL_PARAMETER)
        constant = false;
    if (node->kind == ORL_NODE_INPUT)
        constant = is_fixed(c, node->index);
    if (node->kind == ORL_NODE_NAME || node->kind == ORL_NODE_CALL) {
        const struct orl_formula *const body = orl_body_of(node);
        constant = constant && !(body && body->open);
    }
    return node->constant = constant;
}

/* Finds the bodies that the expressions need, and the constant nodes. */
static int analyse_program(struct orl_compiler *c)
{
    struct survey s = {.c = c};
    int code = 0;
    for (; code == 0 && s.user < c->n_bodies; s.user++)
        code = visit_term(&s, c->bodies[s.user]->root);
    if (code == 0)
        code = propagate_open(&s);
    for (size_t i = 0; code == 0 && i < c->n_bodies; i++)
        mark_constants(c, c->bodies[i]->root);
    free(s.uses);
    return code;
}

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
    c->segments[slot].is_used = true;
    return orl_compiler_add_slot(c, &c->used, slot);
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
    while (code == 0 && c->used.n > 0) {
        const uint32_t slot = c->used.items[--c->used.n];
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
    free(c->waiting.items);
    free(c->used.items);
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
        code = analyse_program(&c);
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
