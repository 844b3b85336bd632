#include "function/codegen/compiler.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "function/interpreter/machine.h"

int orl_compiler_no_memory(struct orl_compiler *c)
{
    return orl_error_set(c->err, ORL_ERR_NOMEM, "out of memory for a program");
}

int orl_compiler_add_slot(struct orl_compiler *c, struct orl_slots *slots, uint32_t slot)
{
    if (!orl_array_reserve(&slots->items, &slots->room, slots->n, sizeof *slots->items))
        return orl_compiler_no_memory(c);
    slots->items[slots->n++] = slot;
    return 0;
}

int orl_emit_locate_error(struct orl_compiler *c, int line, int code)
{
    if (c->file[0]) /* built-in texts have no place */
        orl_error_at(c->err, c->file, line, NULL);
    return code;
}

/* ---- Instructions ---------------------------------------------------------------------------- */

int orl_emit_operation(struct orl_compiler *c, uint32_t slot, enum orl_operation operation,
                       uint64_t index, uint32_t count)
{
    struct orl_segment *const segment = &c->segments[slot];
    if (c->n_instructions >= ORL_FUNCTION_INSTRUCTIONS) {
        orl_error_set(c->err, ORL_ERR_LIMIT, "functions have more than %lu instructions",
                      ORL_FUNCTION_INSTRUCTIONS);
        orl_error_hint(c->err, "put tables into data files");
        return orl_emit_locate_error(c, 0, ORL_ERR_LIMIT);
    }
    if (!orl_array_reserve(&segment->code, &segment->room, segment->n, sizeof *segment->code))
        return orl_compiler_no_memory(c);
    segment->code[segment->n++] =
        (struct orl_instruction){.operation = operation, .count = count, .index = index};
    c->n_instructions++;
    return 0;
}

int orl_emit_number(struct orl_compiler *c, uint32_t slot, double number)
{
    const int code = orl_emit_operation(c, slot, ORL_OP_NUMBER, 0, 0);
    if (code == 0)
        c->segments[slot].code[c->segments[slot].n - 1].number = number;
    return code;
}

size_t orl_emit_length(const struct orl_compiler *c, uint32_t slot)
{
    return c->segments[slot].n;
}

void orl_emit_patch_jump(struct orl_compiler *c, uint32_t slot, size_t at)
{
    c->segments[slot].code[at].index = c->segments[slot].n;
}

bool orl_emit_take_number(struct orl_compiler *c, uint32_t slot, size_t since, double *ret_number)
{
    struct orl_segment *const segment = &c->segments[slot];
    if (segment->n != since + 1 || segment->code[since].operation != ORL_OP_NUMBER)
        return false;
    *ret_number = segment->code[since].number;
    segment->n = since;
    c->n_instructions--;
    return true;
}

bool orl_segment_is_number(const struct orl_segment *segment, double *ret_number)
{
    if (!segment->finished || segment->n != 2 || segment->code[0].operation != ORL_OP_NUMBER)
        return false;
    *ret_number = segment->code[0].number;
    return true;
}

int orl_emit_schedule_body(struct orl_compiler *c, uint32_t slot)
{
    if (c->segments[slot].code)
        return 0;
    return orl_compiler_add_slot(c, &c->waiting, slot);
}

/* ---- Bodies ---------------------------------------------------------------------------------- */

int orl_emit_body(struct orl_compiler *c, uint32_t slot)
{
    const struct orl_formula *const body = c->bodies[slot];
    const char *const file = c->file;
    const bool plain = c->plain;
    const size_t room = 4;
    struct orl_segment *segment = &c->segments[slot];
    if (segment->code) /* compiled, or being compiled */
        return 0;
    segment->code = malloc(room * sizeof *segment->code);
    if (!segment->code)
        return orl_compiler_no_memory(c);
    segment->room = room;
    segment->n_parameters = body->n_parameters;
    c->file = body->file;
    c->plain = false;
    int code = orl_emit(c, slot, body->root);
    if (code == 0)
        code = orl_emit_operation(c, slot, ORL_OP_RETURN, 0, 0);
    c->file = file;
    c->plain = plain;
    segment = &c->segments[slot]; /* the array may have moved */
    segment->finished = code == 0;
    if (code < 0) { /* undo the attempt */
        c->n_instructions -= segment->n;
        free(segment->code);
        segment->code = NULL;
        segment->n = segment->room = 0;
    }
    return code;
}

/* Returns true for errors that end the compilation. Other errors in a referenced body are reported
 * when the program uses it. */
static bool is_fatal(int code)
{
    return code == ORL_ERR_NOMEM || code == ORL_ERR_LIMIT;
}

int orl_emit_waiting(struct orl_compiler *c, size_t base)
{
    struct orl_error *const err = c->err;
    int code = 0;
    while (!is_fatal(code) && c->waiting.n > base) {
        c->err = NULL;
        code = orl_emit_body(c, c->waiting.items[--c->waiting.n]);
        c->err = err;
    }
    if (is_fatal(code))
        return orl_error_set(err, code, "functions are too large to compile");
    return 0;
}

/* ---- Constants ------------------------------------------------------------------------------- */

static bool run_constant(struct orl_compiler *c, uint32_t slot, double *ret_value)
{
    const struct orl_program program = {c->segments,           c->sites,
                                        c->arguments,          c->tables,
                                        c->request->arguments, c->request->n_arguments,
                                        c->n_variables};
    struct orl_function_lanes value;
    if (!orl_machine_begin(&program, c->scratch))
        return false;
    const struct orl_function_outcome outcome =
        orl_machine_run(&program, c->scratch, slot, NULL, 1, &c->folding, &value);
    *ret_value = value.at[0];
    return !outcome.exceeded && !outcome.undefined;
}

static int emit_plain(struct orl_compiler *c, uint32_t slot, const struct orl_term *node);

/* Computes the value of a constant tree by running it; *ret_found is false if it is undefined. */
static int fold_constant(struct orl_compiler *c, const struct orl_term *node, bool *ret_found,
                         double *ret_value)
{
    struct orl_error *const err = c->err;
    const uint32_t slot = (uint32_t)c->n_segments;
    const size_t base = c->waiting.n;
    *ret_found = false;
    if (c->folding == 0 || c->depth > ORL_FOLDING_DEPTH)
        return 0;
    if (!orl_array_reserve(&c->segments, &c->segments_room, c->n_segments, sizeof *c->segments))
        return orl_compiler_no_memory(c);
    c->segments[c->n_segments++] = (struct orl_segment){0};
    c->plain = true;
    c->err = NULL;
    int code = emit_plain(c, slot, node);
    if (code == 0)
        code = orl_emit_operation(c, slot, ORL_OP_RETURN, 0, 0);
    c->err = err;
    c->plain = false;
    c->segments[slot].finished = code == 0;
    if (code == 0)
        code = orl_emit_waiting(c, base);
    if (code == 0)
        *ret_found = run_constant(c, slot, ret_value);
    c->waiting.n = base;
    c->n_instructions -= orl_emit_length(c, slot);
    free(c->segments[slot].code);
    c->n_segments--;
    if (is_fatal(code))
        return orl_error_set(err, code, "functions are too large to compile");
    return 0;
}

static int emit_chain(struct orl_compiler *c, uint32_t slot, const struct orl_term *node)
{
    int code = orl_emit(c, slot, node->args[0]);
    for (uint32_t i = 1; code == 0 && i < node->n_args; i++) {
        const char joint = node->operators[i];
        code = orl_emit(c, slot, node->args[i]);
        if (code == 0)
            code = orl_emit_operation(c, slot,
                                      joint == '+'   ? ORL_OP_ADD
                                      : joint == '-' ? ORL_OP_SUBTRACT
                                      : joint == '*' ? ORL_OP_MULTIPLY
                                      : joint == '/' ? ORL_OP_DIVIDE
                                                     : ORL_OP_POWER,
                                      0, 0);
    }
    return code;
}

static int emit_plain(struct orl_compiler *c, uint32_t slot, const struct orl_term *node)
{
    int code;
    switch ((enum orl_node_kind)node->kind) {
    case ORL_NODE_NUMBER:
        return orl_emit_number(c, slot, node->number);
    case ORL_NODE_PARAMETER:
        return orl_emit_operation(c, slot, ORL_OP_PARAMETER, node->index, 0);
    case ORL_NODE_INPUT:
        if (node->constant)
            return orl_emit_number(c, slot, c->request->fixed[node->index]);
        c->inputs |= UINT64_C(1) << node->index;
        return orl_emit_operation(c, slot, ORL_OP_INPUT, node->index, 0);
    case ORL_NODE_NAME:
        return orl_emit_variable(c, slot, node);
    case ORL_NODE_CALL:
        return orl_emit_call(c, slot, node);
    case ORL_NODE_CALL_PARAMETER:
        return orl_emit_site(c, slot, node, ORL_OP_CALL_PARAMETER, node->index);
    case ORL_NODE_CHAIN:
        return emit_chain(c, slot, node);
    case ORL_NODE_NEGATE:
        code = orl_emit(c, slot, node->args[0]);
        return code < 0 ? code : orl_emit_operation(c, slot, ORL_OP_NEGATE, 0, 0);
    }
    return ORL_ERR_INTERNAL;
}

static bool is_worth_folding(const struct orl_term *node)
{
    return node->constant && (node->kind == ORL_NODE_CALL || node->kind == ORL_NODE_CHAIN ||
                              node->kind == ORL_NODE_NEGATE);
}

int orl_emit(struct orl_compiler *c, uint32_t slot, const struct orl_term *node)
{
    bool found = false;
    double value = 0;
    int code = 0;
    c->depth++;
    if (!c->plain && is_worth_folding(node))
        code = fold_constant(c, node, &found, &value);
    if (code == 0)
        code = found ? orl_emit_number(c, slot, value) : emit_plain(c, slot, node);
    c->depth--;
    return code;
}
