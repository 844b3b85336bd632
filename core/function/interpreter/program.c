#include "function/interpreter/machine.h"

#include <stdlib.h>

#include "base/io/checked_file.h"
#include "function/codegen/compiler.h"

void orl_function_free(struct orl_function *function)
{
    if (!function)
        return;
    free(function->code);
    free(function->segments);
    free(function->sites);
    free(function->arguments);
    free(function->tables);
    free(function->args);
    free(function);
}

uint64_t orl_function_inputs(const struct orl_function *function)
{
    return function->inputs;
}

uint64_t orl_function_fixed_inputs(const struct orl_function *function)
{
    return function->fixed_inputs;
}

bool orl_function_is_constant(const struct orl_function *function, size_t expression,
                              double *ret_value)
{
    return orl_segment_is_number(&function->segments[expression], ret_value);
}

/* ---- Serialisation --------------------------------------------------------------------------- */

/* Passes the array of all code, and the start of each segment's code in it. */
static void pass_code(struct orl_serializer *serializer, struct orl_function *f)
{
    orl_serialize_array(serializer, &f->code, f->n_code, sizeof *f->code);
    for (size_t i = 0; i < f->n_segments && serializer->code == 0; i++) {
        struct orl_segment segment = f->segments[i];
        uint64_t first = orl_serializer_reads(serializer) ? 0 : (uint64_t)(segment.code - f->code);
        segment.code = NULL;
        segment.room = 0;
        orl_serialize_value(serializer, &segment);
        orl_serialize_value(serializer, &first);
        if (first > f->n_code || segment.n > f->n_code - first)
            orl_serializer_fail(serializer, ORL_ERR_CORRUPT);
        if (orl_serializer_reads(serializer) && serializer->code == 0) {
            f->segments[i] = segment;
            f->segments[i].code = f->code + first;
        }
    }
}

static void pass_counts(struct orl_serializer *serializer, struct orl_function *f)
{
    size_t *const counts[] = {&f->n_code,   &f->n_segments,    &f->n_sites,  &f->n_arguments,
                              &f->n_tables, &f->n_expressions, &f->n_inputs, &f->program.n_args};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        orl_serialize_value(serializer, counts[i]);
    orl_serialize_value(serializer, &f->program.n_variables);
    orl_serialize_value(serializer, &f->inputs);
    orl_serialize_value(serializer, &f->operations);
}

void orl_function_serialize(struct orl_function **function, struct orl_serializer *serializer)
{
    const bool reads = orl_serializer_reads(serializer);
    bool there = !reads && *function;
    orl_serialize_value(serializer, &there);
    if (reads)
        *function = NULL;
    if (there)
        orl_serializer_alloc(serializer, function, 1, sizeof **function);
    struct orl_function *const f = *function;
    if (!f)
        return;
    pass_counts(serializer, f);
    orl_serializer_alloc(serializer, &f->segments, f->n_segments, sizeof *f->segments);
    pass_code(serializer, f);
    orl_serialize_array(serializer, &f->sites, f->n_sites, sizeof *f->sites);
    orl_serialize_array(serializer, &f->arguments, f->n_arguments, sizeof *f->arguments);
    orl_serialize_array(serializer, &f->tables, f->n_tables, sizeof *f->tables);
    orl_serialize_array(serializer, &f->args, f->program.n_args, sizeof *f->args);
    if (reads)
        f->program =
            (struct orl_program){f->segments, f->sites,          f->arguments,          f->tables,
                                 f->args,     f->program.n_args, f->program.n_variables};
}

/* ---- Values ---------------------------------------------------------------------------------- */

struct orl_function_outcome orl_function_evaluate(const struct orl_function *function,
                                                  struct orl_function_scratch *scratch,
                                                  const struct orl_function_lanes *inputs,
                                                  unsigned lanes,
                                                  struct orl_function_lanes *ret_values)
{
    struct orl_function_outcome outcome = {0, !orl_machine_begin(&function->program, scratch)};
    uint32_t operations = function->operations;
    for (uint32_t i = 0; !outcome.exceeded && i < function->n_expressions; i++) {
        const struct orl_function_outcome one = orl_machine_run(
            &function->program, scratch, i, inputs, lanes, &operations, &ret_values[i]);
        outcome.undefined |= one.undefined;
        outcome.exceeded = one.exceeded;
    }
    for (size_t i = 0; outcome.exceeded && i < function->n_expressions; i++)
        for (int l = 0; l < ORL_FUNCTION_LANES; l++)
            if (lanes >> l & 1)
                ret_values[i].at[l] = 0;
    return outcome;
}

struct orl_function_outcome orl_function_at(const struct orl_function *function,
                                            struct orl_function_scratch *scratch,
                                            const double *inputs, double *ret_values)
{
    struct orl_function_lanes wide[ORL_FUNCTION_INPUTS];
    struct orl_function_lanes values[ORL_FUNCTION_EXPRESSIONS];
    for (size_t i = 0; i < function->n_inputs; i++)
        for (int l = 0; function->inputs >> i & 1 && l < ORL_FUNCTION_LANES; l++)
            wide[i].at[l] = inputs[i];
    for (size_t i = 0; i < function->n_expressions; i++)
        values[i].at[0] = 0;
    const struct orl_function_outcome outcome =
        orl_function_evaluate(function, scratch, wide, 1, values);
    for (size_t i = 0; i < function->n_expressions; i++)
        ret_values[i] = values[i].at[0];
    return outcome;
}
