#include "function/interpreter/machine.h"

#include <math.h>
#include <stdalign.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = ORL_FUNCTION_LANES, STACK = ORL_FUNCTION_STACK };

/* ---- Arithmetic on lanes --------------------------------------------------------------------- */

/* The result replaces the first operand. Cheap operations are done for all lanes, others for the
 * active ones only. The return value gives the active lanes whose result is undefined; their value
 * is 0. */

static void lanes_add(double *a, const double *b)
{
    for (int l = 0; l < LANES; l++)
        a[l] += b[l];
}

static void lanes_subtract(double *a, const double *b)
{
    for (int l = 0; l < LANES; l++)
        a[l] -= b[l];
}

static void lanes_multiply(double *a, const double *b)
{
    for (int l = 0; l < LANES; l++)
        a[l] *= b[l];
}

static void lanes_negate(double *a)
{
    for (int l = 0; l < LANES; l++)
        a[l] = -a[l];
}

static unsigned lanes_divide(double *a, const double *b, unsigned active)
{
    unsigned undefined = 0;
    for (int l = 0; l < LANES; l++) {
        undefined |= b[l] == 0 ? 1U << l : 0;
        a[l] = b[l] == 0 ? 0 : a[l] / b[l];
    }
    return undefined & active;
}

static unsigned lanes_power(double *a, const double *b, unsigned active)
{
    unsigned undefined = 0;
    for (int l = 0; l < LANES; l++) {
        bool without = false;
        if (active >> l & 1)
            a[l] = orl_builtin_power(a[l], b[l], &without);
        undefined |= without ? 1U << l : 0;
    }
    return undefined;
}

/* Applies a built-in function to count arguments; the value replaces the first. At most
 * ORL_FUNCTION_PARAMETERS arguments are used. */
static unsigned lanes_apply(uint32_t which, double (*args)[ORL_FUNCTION_LANES], uint32_t count,
                            unsigned active)
{
    const uint32_t n = count < ORL_FUNCTION_PARAMETERS ? count : ORL_FUNCTION_PARAMETERS;
    double one[ORL_FUNCTION_PARAMETERS];
    unsigned undefined = 0;
    for (int l = 0; l < LANES; l++) {
        bool without = false;
        if (!(active >> l & 1))
            continue;
        for (uint32_t i = 0; i < n; i++)
            one[i] = args[i][l];
        args[0][l] = orl_builtin_apply(which, one, n, &without);
        undefined |= without ? 1U << l : 0;
    }
    return undefined;
}

/* Replaces n, rounded to the nearest integer, by the nth entry of a list, and 0 by the list's
 * length. */
static unsigned lanes_look_up(double *value, const double *list, size_t count, unsigned active)
{
    unsigned undefined = 0;
    for (int l = 0; l < LANES; l++) {
        const double wanted = floor(value[l] + 0.5);
        const bool is_there = wanted >= 1 && wanted <= (double)count;
        if (!is_there && !(wanted == 0))
            undefined |= 1U << l;
        value[l] = is_there ? list[(size_t)wanted - 1] : wanted == 0 ? (double)count : 0;
    }
    return undefined & active;
}

/* Returns the lanes above zero. */
static unsigned lanes_above_zero(const double *a)
{
    unsigned above = 0;
    for (int l = 0; l < LANES; l++)
        above |= a[l] > 0 ? 1U << l : 0;
    return above;
}

/* Copies the given lanes. */
static void lanes_copy(double *into, const double *from, unsigned lanes)
{
    for (int l = 0; l < LANES; l++)
        into[l] = lanes >> l & 1 ? from[l] : into[l];
}

/* ---- State and stack ------------------------------------------------------------------------- */

/* Lanes at a branch: those that entered it, and those of the first alternative or of the current
 * case. */
struct branch {
    uint8_t active, chosen;
};

struct orl_function_scratch {
    alignas(64) double values[STACK][LANES];
    uint8_t valid[STACK]; /* for arguments and variables: lanes that have been evaluated */
    struct branch branches[STACK];
};

/* Call frame: its arguments lie on the stack from base, and are evaluated in the caller's
 * context. */
struct frame {
    const struct orl_call_site *site;
    const struct frame *caller;
    uint32_t caller_segment;
    uint32_t base;
};

struct machine {
    const struct orl_program *program;
    struct orl_function_scratch *s;
    const struct orl_function_lanes *inputs;
    uint32_t *operations;
    uint32_t top, branch; /* first free index of each stack */
    uint32_t depth;
    unsigned active, undefined;
};

static bool run_segment(struct machine *m, uint32_t segment, size_t at, const struct frame *frame);

/* Returns the value n places below the top. */
static double *value_at(const struct machine *m, uint32_t n)
{
    return m->s->values[m->top - 1 - n];
}

/* Returns an uninitialised stack entry; NULL: the stack is full. */
static double *push_value(struct machine *m)
{
    return m->top < STACK ? m->s->values[m->top++] : NULL;
}

static bool push_number(struct machine *m, double number)
{
    double *const value = push_value(m);
    for (int l = 0; value && l < LANES; l++)
        value[l] = number;
    return value != NULL;
}

static bool push_copy(struct machine *m, const double *from)
{
    double *const value = push_value(m);
    if (value)
        memcpy(value, from, sizeof m->s->values[0]);
    return value != NULL;
}

/* Moves the given lanes of the top value into another value. */
static void take_lanes(struct machine *m, double *into, unsigned lanes)
{
    lanes_copy(into, value_at(m, 0), lanes);
    m->top--;
}

/* ---- Branches -------------------------------------------------------------------------------- */

/* begin_if, go_else and go_case return the next instruction. */
static size_t begin_if(struct machine *m, const struct orl_instruction *code, size_t at)
{
    const unsigned holds = lanes_above_zero(value_at(m, 0)) & m->active;
    m->top--;
    m->s->branches[m->branch++] = (struct branch){(uint8_t)m->active, (uint8_t)holds};
    if (holds == 0)
        return code[at].index;
    m->active = holds;
    return at + 1;
}

static size_t go_else(struct machine *m, const struct orl_instruction *code, size_t at)
{
    const struct branch branch = m->s->branches[m->branch - 1];
    if (branch.chosen == branch.active)
        return code[at].index;
    m->active = branch.active & ~(unsigned)branch.chosen;
    return at + 1;
}

static void end_if(struct machine *m)
{
    const struct branch branch = m->s->branches[--m->branch];
    m->active = branch.active;
    if (branch.chosen != 0 && branch.chosen != branch.active)
        take_lanes(m, value_at(m, 1), branch.active & ~(unsigned)branch.chosen);
}

/* Leaves the rounded choices on the stack, below the future value. */
static bool begin_select(struct machine *m, uint32_t count)
{
    double *const wanted = value_at(m, 0);
    double *const value = push_value(m);
    for (int l = 0; value && l < LANES; l++) {
        wanted[l] = floor(wanted[l] + 0.5);
        value[l] = wanted[l] == 0 ? count : 0;
        if (!(wanted[l] >= 0 && wanted[l] <= count))
            m->undefined |= 1U << l & m->active;
    }
    m->s->branches[m->branch++] = (struct branch){(uint8_t)m->active, 0};
    return value != NULL;
}

static size_t go_case(struct machine *m, const struct orl_instruction *code, size_t at)
{
    struct branch *const branch = &m->s->branches[m->branch - 1];
    const double *const wanted = value_at(m, 1);
    unsigned chosen = 0;
    for (int l = 0; l < LANES; l++)
        chosen |= wanted[l] == code[at].count ? 1U << l : 0;
    branch->chosen = (uint8_t)(chosen & branch->active);
    m->active = branch->chosen;
    return branch->chosen ? at + 1 : code[at].index;
}

static void end_select(struct machine *m)
{
    m->active = m->s->branches[--m->branch].active;
    memcpy(value_at(m, 1), value_at(m, 0), sizeof m->s->values[0]);
    m->top--;
}

/* ---- Arguments, variables, calls ------------------------------------------------------------- */

static bool push_parameter(struct machine *m, const struct frame *frame, uint32_t index);

static bool push_undefined(struct machine *m)
{
    m->undefined |= m->active;
    return push_number(m, 0);
}

/* Pushes an argument's value, evaluated in the context of the call. */
static bool push_argument(struct machine *m, struct orl_argument argument, uint32_t segment,
                          const struct frame *frame)
{
    if (argument.kind == ORL_ARGUMENT_CODE)
        return run_segment(m, segment, argument.index, frame);
    if (argument.kind == ORL_ARGUMENT_PARAMETER)
        return push_parameter(m, frame, argument.index);
    return push_undefined(m); /* a function has no value as a number */
}

/* Stores the top value in a stack entry for the missing lanes, restores the active lanes, and
 * pushes the entry. */
static bool store_value(struct machine *m, uint32_t place, unsigned missing, unsigned active)
{
    take_lanes(m, m->s->values[place], missing);
    m->s->valid[place] |= (uint8_t)missing;
    m->active = active;
    return push_copy(m, m->s->values[place]);
}

static bool push_parameter(struct machine *m, const struct frame *frame, uint32_t index)
{
    if (!frame) /* only functions have parameters */
        return false;
    const uint32_t place = frame->base + index;
    const unsigned active = m->active, missing = active & ~(unsigned)m->s->valid[place];
    if (!missing)
        return push_copy(m, m->s->values[place]);
    m->active = missing;
    if (++m->depth > ORL_FUNCTION_DEPTH ||
        !push_argument(m, m->program->arguments[frame->site->first + index], frame->caller_segment,
                       frame->caller))
        return false;
    m->depth--;
    return store_value(m, place, missing, active);
}

static bool push_variable(struct machine *m, uint32_t segment)
{
    const uint32_t place = m->program->segments[segment].variable;
    const unsigned active = m->active, missing = active & ~(unsigned)m->s->valid[place];
    if (!missing)
        return push_copy(m, m->s->values[place]);
    m->active = missing;
    return run_segment(m, segment, 0, NULL) && store_value(m, place, missing, active);
}

static bool call_function(struct machine *m, const struct orl_call_site *site, uint32_t callee,
                          uint32_t segment, const struct frame *caller)
{
    const struct frame frame = {site, caller, segment, m->top};
    if (site->n > STACK - m->top)
        return false;
    memset(&m->s->valid[m->top], 0, site->n);
    m->top += site->n;
    if (!run_segment(m, callee, 0, &frame))
        return false;
    memcpy(m->s->values[frame.base], value_at(m, 0), sizeof m->s->values[0]);
    m->top = frame.base + 1;
    return true;
}

static void apply_builtin(struct machine *m, uint32_t which, uint32_t count)
{
    m->undefined |= lanes_apply(which, &m->s->values[m->top - count], count, m->active);
    m->top -= count - 1;
}

/* Calls the function that was passed for a parameter. */
static bool call_parameter(struct machine *m, const struct orl_call_site *site, uint32_t segment,
                           const struct frame *frame)
{
    const struct frame *from = frame;
    struct orl_argument callee = {ORL_ARGUMENT_PARAMETER, site->callee};
    while (from && callee.kind == ORL_ARGUMENT_PARAMETER) {
        callee = m->program->arguments[from->site->first + callee.index];
        from = from->caller;
    }
    if (callee.kind == ORL_ARGUMENT_FUNCTION &&
        m->program->segments[callee.index].n_parameters <= site->n)
        return call_function(m, site, callee.index, segment, frame);
    if (callee.kind != ORL_ARGUMENT_BUILTIN || orl_builtins[callee.index].min_args > site->n)
        return push_undefined(m);
    for (uint32_t i = 0; i < site->n; i++)
        if (!push_argument(m, m->program->arguments[site->first + i], segment, frame))
            return false;
    apply_builtin(m, callee.index, site->n);
    return true;
}

/* ---- The machine ----------------------------------------------------------------------------- */

/* Executes a binary operation on the two top values. */
static bool apply_binary(struct machine *m, enum orl_operation operation)
{
    double *const a = value_at(m, 1);
    const double *const b = value_at(m, 0);
    if (operation == ORL_OP_ADD)
        lanes_add(a, b);
    else if (operation == ORL_OP_SUBTRACT)
        lanes_subtract(a, b);
    else if (operation == ORL_OP_MULTIPLY)
        lanes_multiply(a, b);
    else if (operation == ORL_OP_DIVIDE)
        m->undefined |= lanes_divide(a, b, m->active);
    else
        m->undefined |= lanes_power(a, b, m->active);
    m->top--;
    return true;
}

static void look_up_value(struct machine *m, const double *list, size_t count)
{
    m->undefined |= lanes_look_up(value_at(m, 0), list, count, m->active);
}

/* Executes an instruction that needs neither frame nor position. Returns false if the stack is
 * full. */
static bool execute_simple(struct machine *m, const struct orl_instruction *one)
{
    const struct orl_program *const program = m->program;
    switch ((enum orl_operation)one->operation) {
    case ORL_OP_NUMBER:
        return push_number(m, one->number);
    case ORL_OP_INPUT:
        return push_copy(m, m->inputs[one->index].at);
    case ORL_OP_ARG:
        look_up_value(m, program->args, program->n_args);
        return true;
    case ORL_OP_NEGATE:
        lanes_negate(value_at(m, 0));
        return true;
    case ORL_OP_BUILTIN:
        apply_builtin(m, (uint32_t)one->index, one->count);
        return true;
    case ORL_OP_END:
        end_if(m);
        return true;
    case ORL_OP_SELECT:
        return begin_select(m, one->count);
    case ORL_OP_CHOSEN:
        take_lanes(m, value_at(m, 1), m->active);
        return true;
    case ORL_OP_END_SELECT:
        end_select(m);
        return true;
    case ORL_OP_TABLE:
        look_up_value(m, program->tables + one->index, one->count);
        return true;
    default:
        return apply_binary(m, (enum orl_operation)one->operation);
    }
}

static bool execute_segment(struct machine *m, uint32_t segment, size_t at,
                            const struct frame *frame)
{
    const struct orl_program *const program = m->program;
    const struct orl_instruction *const code = program->segments[segment].code;
    for (bool ok = true; ok; at++) {
        const struct orl_instruction *const one = &code[at];
        if (*m->operations == 0)
            return false;
        --*m->operations;
        switch ((enum orl_operation)one->operation) {
        case ORL_OP_RETURN:
            return true;
        case ORL_OP_PARAMETER:
            ok = push_parameter(m, frame, (uint32_t)one->index);
            break;
        case ORL_OP_VARIABLE:
            ok = push_variable(m, (uint32_t)one->index);
            break;
        case ORL_OP_CALL:
            ok = call_function(m, &program->sites[one->index], program->sites[one->index].callee,
                               segment, frame);
            break;
        case ORL_OP_CALL_PARAMETER:
            ok = call_parameter(m, &program->sites[one->index], segment, frame);
            break;
        case ORL_OP_IF:
            at = begin_if(m, code, at) - 1;
            break;
        case ORL_OP_ELSE:
            at = go_else(m, code, at) - 1;
            break;
        case ORL_OP_CASE:
            at = go_case(m, code, at) - 1;
            break;
        case ORL_OP_JUMP:
            at = one->index - 1;
            break;
        default:
            ok = execute_simple(m, one);
        }
    }
    return false;
}

/* Runs a segment until it returns, for the active lanes, and leaves its value on top. */
static bool run_segment(struct machine *m, uint32_t segment, size_t at, const struct frame *frame)
{
    if (!m->program->segments[segment].finished || ++m->depth > ORL_FUNCTION_DEPTH ||
        m->branch > STACK - ORL_FUNCTION_NESTING)
        return false;
    const bool ok = execute_segment(m, segment, at, frame);
    m->depth--;
    return ok;
}

bool orl_machine_begin(const struct orl_program *program, struct orl_function_scratch *scratch)
{
    if (program->n_variables > STACK / 2)
        return false;
    memset(scratch->valid, 0, program->n_variables);
    return true;
}

struct orl_function_outcome orl_machine_run(const struct orl_program *program,
                                            struct orl_function_scratch *scratch, uint32_t segment,
                                            const struct orl_function_lanes *inputs, unsigned lanes,
                                            uint32_t *operations,
                                            struct orl_function_lanes *ret_value)
{
    struct machine m = {.program = program,
                        .s = scratch,
                        .inputs = inputs,
                        .operations = operations,
                        .top = program->n_variables,
                        .active = lanes & 0xffU};
    const bool ok = run_segment(&m, segment, 0, NULL);
    for (int l = 0; l < LANES; l++)
        if (lanes >> l & 1)
            ret_value->at[l] = ok ? value_at(&m, 0)[l] : 0;
    return (struct orl_function_outcome){ok ? m.undefined : 0, !ok};
}

struct orl_function_scratch *orl_function_scratch_new(void)
{
    return aligned_alloc(64, (sizeof(struct orl_function_scratch) + 63) / 64 * 64);
}

struct orl_function_scratch *orl_function_scratch_of_thread(void)
{
    static _Thread_local struct orl_function_scratch scratch;
    return &scratch;
}

void orl_function_scratch_free(struct orl_function_scratch *scratch)
{
    free(scratch);
}
