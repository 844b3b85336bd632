#include <stdlib.h>

#include "base/memory/array.h"
#include "function/codegen/emit_code.h"

int orl_compiler_no_memory(struct orl_compiler *c)
{
    return orl_error_set(c->err, ORL_ERR_NOMEM, "no memory for a program");
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
        orl_error_set(c->err, ORL_ERR_LIMIT, "functions come to more than %lu instructions",
                      ORL_FUNCTION_INSTRUCTIONS);
        orl_error_hint(c->err, "tables belong in data files");
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
    if (!orl_array_reserve(&c->waiting, &c->waiting_room, c->n_waiting, sizeof *c->waiting))
        return orl_compiler_no_memory(c);
    c->waiting[c->n_waiting++] = slot;
    return 0;
}
