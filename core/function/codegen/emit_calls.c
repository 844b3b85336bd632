#include "function/codegen/compiler.h"

#include <math.h>
#include <string.h>

#include "base/memory/memory.h"
#include "function/interpreter/machine.h"

enum { TABLE_LEAST = 4 }; /* fewest numbers in select() for a look-up table */

/* ---- Names and calls ------------------------------------------------------------------------- */

static int report_undefined(struct orl_compiler *c, const struct orl_term *node, const char *name)
{
    const bool called = node->kind == ORL_NODE_CALL;
    if (!called && (node->definition->function.root || orl_builtin_named(name) >= 0)) {
        orl_error_set(c->err, ORL_ERR_SYNTAX,
                      "'%.100s' is a function and has no value without arguments", name);
        orl_error_hint(c->err, "give it arguments: %.100s(...)", name);
        return orl_emit_locate_error(c, node->line, ORL_ERR_SYNTAX);
    }
    orl_error_set(c->err, ORL_ERR_NOT_FOUND, "the %s '%.100s%s' is not defined",
                  called ? "function" : "variable", name, called ? "()" : "");
    orl_error_hint(c->err, "define it in the function file, or name the file that does");
    return orl_emit_locate_error(c, node->line, ORL_ERR_NOT_FOUND);
}

static int report_too_few(struct orl_compiler *c, const struct orl_term *node, uint32_t min_args)
{
    orl_error_set(c->err, ORL_ERR_SYNTAX, "%.100s() takes %u arguments, %u are given",
                  node->definition->name, min_args, node->n_args);
    orl_error_hint(c->err, "give it all of them");
    return orl_emit_locate_error(c, node->line, ORL_ERR_SYNTAX);
}

int orl_emit_variable(struct orl_compiler *c, uint32_t slot, const struct orl_term *node)
{
    const struct orl_formula *const body = orl_body_of(node);
    double number;
    int code = 0;
    if (!body || body != &node->definition->variable)
        return report_undefined(c, node, node->definition->name);
    if (node->constant && c->depth <= ORL_FOLDING_DEPTH)
        code = orl_emit_body(c, body->slot);
    if (code < 0)
        return code;
    if (orl_segment_is_number(&c->segments[body->slot], &number))
        return orl_emit_number(c, slot, number);
    if (!c->segments[body->slot].is_variable) {
        if (c->n_variables == ORL_FUNCTION_STACK / 2) {
            orl_error_set(c->err, ORL_ERR_LIMIT, "more than %d variables are needed at once",
                          ORL_FUNCTION_STACK / 2);
            return orl_emit_locate_error(c, node->line, ORL_ERR_LIMIT);
        }
        c->segments[body->slot].is_variable = true;
        c->segments[body->slot].variable = c->n_variables++;
    }
    code = orl_emit_schedule_body(c, body->slot);
    return code < 0 ? code : orl_emit_operation(c, slot, ORL_OP_VARIABLE, body->slot, 0);
}

/* Classifies an argument: a function's name or the caller's parameter; otherwise it needs code. */
static int pass_name(struct orl_compiler *c, const struct orl_term *node,
                     struct orl_argument *ret_argument)
{
    ret_argument->kind = ORL_ARGUMENT_CODE;
    if (node->kind == ORL_NODE_PARAMETER)
        *ret_argument = (struct orl_argument){ORL_ARGUMENT_PARAMETER, node->index};
    if (node->kind != ORL_NODE_NAME || node->definition->variable.root)
        return 0;
    const struct orl_formula *const body = orl_body_of(node);
    const int builtin = body ? -1 : orl_builtin_named(node->definition->name);
    if (builtin >= 0)
        *ret_argument = (struct orl_argument){ORL_ARGUMENT_BUILTIN, (uint32_t)builtin};
    if (!body)
        return 0;
    *ret_argument = (struct orl_argument){ORL_ARGUMENT_FUNCTION, body->slot};
    return orl_emit_schedule_body(c, body->slot);
}

/* Emits a call. Arguments are evaluated lazily: their code is placed before the call. */
int orl_emit_site(struct orl_compiler *c, uint32_t slot, const struct orl_term *node,
                  enum orl_operation operation, uint32_t callee)
{
    const size_t jump = orl_emit_length(c, slot), first = c->n_arguments;
    int code = orl_emit_operation(c, slot, ORL_OP_JUMP, 0, 0);
    for (uint32_t i = 0; code == 0 && i < node->n_args; i++) {
        if (!orl_array_reserve(&c->arguments, &c->arguments_room, c->n_arguments,
                               sizeof *c->arguments))
            return orl_compiler_no_memory(c);
        c->n_arguments++;
    }
    for (uint32_t i = 0; code == 0 && i < node->n_args; i++) {
        struct orl_argument argument = {ORL_ARGUMENT_CODE, 0};
        code = pass_name(c, node->args[i], &argument);
        if (code == 0 && argument.kind == ORL_ARGUMENT_CODE) {
            argument.index = (uint32_t)orl_emit_length(c, slot);
            code = orl_emit(c, slot, node->args[i]);
            if (code == 0)
                code = orl_emit_operation(c, slot, ORL_OP_RETURN, 0, 0);
        }
        c->arguments[first + i] = argument;
    }
    if (code < 0)
        return code;
    if (!orl_array_reserve(&c->sites, &c->sites_room, c->n_sites, sizeof *c->sites))
        return orl_compiler_no_memory(c);
    c->sites[c->n_sites] = (struct orl_call_site){callee, (uint32_t)first, node->n_args};
    orl_emit_patch_jump(c, slot, jump);
    return orl_emit_operation(c, slot, operation, c->n_sites++, 0);
}

/* Checks that function names are passed for parameters that the callee calls. */
static int check_functions(struct orl_compiler *c, const struct orl_term *node,
                           const struct orl_formula *callee)
{
    for (uint32_t i = 0; i < callee->n_parameters; i++) {
        struct orl_argument argument;
        if (!(callee->called >> i & 1))
            continue;
        const int code = pass_name(c, node->args[i], &argument);
        if (code < 0)
            return code;
        if (argument.kind != ORL_ARGUMENT_CODE)
            continue;
        orl_error_set(c->err, ORL_ERR_SYNTAX, "argument %u of %.100s() must be a function", i + 1,
                      callee->name);
        orl_error_hint(c->err, "write a function's name, without parentheses");
        return orl_emit_locate_error(c, node->line, ORL_ERR_SYNTAX);
    }
    return 0;
}

/* ---- Language constructs --------------------------------------------------------------------- */

static int emit_if(struct orl_compiler *c, uint32_t slot, const struct orl_term *node)
{
    const size_t since = orl_emit_length(c, slot);
    double condition;
    int code = orl_emit(c, slot, node->args[0]);
    if (code == 0 && orl_emit_take_number(c, slot, since, &condition))
        return orl_emit(c, slot, node->args[condition > 0 ? 1 : 2]);
    const size_t test = orl_emit_length(c, slot);
    if (code == 0)
        code = orl_emit_operation(c, slot, ORL_OP_IF, 0, 0);
    if (code == 0)
        code = orl_emit(c, slot, node->args[1]);
    const size_t other = orl_emit_length(c, slot);
    if (code == 0)
        code = orl_emit_operation(c, slot, ORL_OP_ELSE, 0, 0);
    if (code < 0)
        return code;
    orl_emit_patch_jump(c, slot, test);
    code = orl_emit(c, slot, node->args[2]);
    orl_emit_patch_jump(c, slot, other);
    return code < 0 ? code : orl_emit_operation(c, slot, ORL_OP_END, 0, 0);
}

/* Emits a table if all operands are numbers. Otherwise *ret_done is false. */
static int emit_table(struct orl_compiler *c, uint32_t slot, const struct orl_term *node,
                      bool *ret_done)
{
    const size_t first = c->n_tables;
    int code = 0;
    *ret_done = false;
    for (uint32_t i = 1; code == 0 && i < node->n_args; i++) {
        const size_t since = orl_emit_length(c, slot);
        double number;
        if (!orl_array_reserve(&c->tables, &c->tables_room, c->n_tables, sizeof *c->tables))
            return orl_compiler_no_memory(c);
        code = node->args[i]->constant ? orl_emit(c, slot, node->args[i]) : 0;
        if (code == 0 && !orl_emit_take_number(c, slot, since, &number)) {
            c->n_instructions -= orl_emit_length(c, slot) - since;
            c->segments[slot].n = since;
            c->n_tables = first;
            return 0;
        }
        if (code == 0)
            c->tables[c->n_tables++] = number;
    }
    *ret_done = true;
    return code < 0 ? code : orl_emit_operation(c, slot, ORL_OP_TABLE, first, node->n_args - 1);
}

static int emit_select(struct orl_compiler *c, uint32_t slot, const struct orl_term *node)
{
    const size_t since = orl_emit_length(c, slot);
    const uint32_t n = node->n_args - 1;
    double wanted;
    bool done = false;
    int code = orl_emit(c, slot, node->args[0]);
    if (code == 0 && orl_emit_take_number(c, slot, since, &wanted)) {
        wanted = floor(wanted + 0.5);
        if (wanted == 0)
            return orl_emit_number(c, slot, n);
        if (wanted >= 1 && wanted <= n)
            return orl_emit(c, slot, node->args[(uint32_t)wanted]);
        code = orl_emit_number(c, slot, wanted);
    }
    if (code == 0 && n >= TABLE_LEAST)
        code = emit_table(c, slot, node, &done);
    if (code < 0 || done)
        return code;
    code = orl_emit_operation(c, slot, ORL_OP_SELECT, 0, n);
    for (uint32_t i = 1; code == 0 && i <= n; i++) {
        const size_t one = orl_emit_length(c, slot);
        code = orl_emit_operation(c, slot, ORL_OP_CASE, 0, i);
        if (code == 0)
            code = orl_emit(c, slot, node->args[i]);
        if (code == 0)
            code = orl_emit_operation(c, slot, ORL_OP_CHOSEN, 0, 0);
        if (code == 0)
            orl_emit_patch_jump(c, slot, one);
    }
    return code < 0 ? code : orl_emit_operation(c, slot, ORL_OP_END_SELECT, 0, 0);
}

/* Emits arg(n), which reads the program's arguments. */
static int emit_arg(struct orl_compiler *c, uint32_t slot, const struct orl_term *node)
{
    const size_t since = orl_emit_length(c, slot), n = c->request->n_arguments;
    double wanted;
    const int code = orl_emit(c, slot, node->args[0]);
    if (code < 0)
        return code;
    if (!orl_emit_take_number(c, slot, since, &wanted))
        return orl_emit_operation(c, slot, ORL_OP_ARG, 0, 0);
    wanted = floor(wanted + 0.5);
    if (wanted == 0)
        return orl_emit_number(c, slot, (double)n);
    if (wanted >= 1 && wanted <= (double)n)
        return orl_emit_number(c, slot, c->request->arguments[(size_t)wanted - 1]);
    orl_error_set(c->err, ORL_ERR_RANGE, "the function uses argument %.0f, but only %zu are given",
                  wanted, n);
    orl_error_hint(c->err, "give the primitive the real arguments that its function file needs");
    return orl_emit_locate_error(c, node->line, ORL_ERR_RANGE);
}

static int emit_builtin(struct orl_compiler *c, uint32_t slot, const struct orl_term *node)
{
    const char *const name = node->definition->name;
    if (strcmp(name, "arg") == 0)
        return emit_arg(c, slot, node);
    const int which = orl_builtin_named(name);
    if (which < 0)
        return report_undefined(c, node, name);
    if (node->n_args < orl_builtins[which].min_args)
        return report_too_few(c, node, orl_builtins[which].min_args);
    if (strcmp(name, "if") == 0)
        return emit_if(c, slot, node);
    if (strcmp(name, "select") == 0)
        return emit_select(c, slot, node);
    uint32_t n = orl_builtins[which].is_variadic ? node->n_args : orl_builtins[which].min_args;
    if (n > ORL_FUNCTION_PARAMETERS) {
        orl_error_set(c->err, ORL_ERR_LIMIT, "%s() has more than %d arguments", name,
                      ORL_FUNCTION_PARAMETERS);
        orl_error_hint(c->err, "nest several calls of %s() instead", name);
        return orl_emit_locate_error(c, node->line, ORL_ERR_LIMIT);
    }
    int code = 0;
    for (uint32_t i = 0; code == 0 && i < n; i++)
        code = orl_emit(c, slot, node->args[i]);
    return code < 0 ? code : orl_emit_operation(c, slot, ORL_OP_BUILTIN, (uint64_t)which, n);
}

int orl_emit_call(struct orl_compiler *c, uint32_t slot, const struct orl_term *node)
{
    const struct orl_formula *const body = orl_body_of(node);
    if (!body)
        return emit_builtin(c, slot, node);
    if (node->n_args < body->n_parameters)
        return report_too_few(c, node, body->n_parameters);
    int code = check_functions(c, node, body);
    if (code == 0)
        code = orl_emit_schedule_body(c, body->slot);
    return code < 0 ? code : orl_emit_site(c, slot, node, ORL_OP_CALL, body->slot);
}
