/*
 * What emission is made of (compiler.h): instructions at the end of a slot's segment, by
 * instructions.c; trees and constants by emit.c; names, calls and choices by emit_calls.c. All
 * return 0 or an error. Inside of core/function only.
 */
#ifndef ORL_FUNCTION_EMIT_H
#define ORL_FUNCTION_EMIT_H

#include "function/compiler.h"

enum { ORL_FOLDING_DEPTH = 3000 }; /* of emission: constants that lie deeper are not folded */

/* A tree's value, left on top of the stack; constants by their value. */
int orl_emit(struct orl_compiler *c, uint32_t slot, const struct orl_term *node);

int orl_emit_operation(struct orl_compiler *c, uint32_t slot, enum orl_operation operation,
                       uint64_t index, uint32_t count);
int orl_emit_number(struct orl_compiler *c, uint32_t slot, double number);

size_t orl_emit_length(const struct orl_compiler *c, uint32_t slot);
/* Makes the instruction at a place lead to the next that will be emitted. */
void orl_emit_land(struct orl_compiler *c, uint32_t slot, size_t at);
/* Takes back a number that is all that was emitted since. */
bool orl_emit_take_number(struct orl_compiler *c, uint32_t slot, size_t since, double *ret_number);

/* A body is mentioned: it will be compiled. */
int orl_emit_await(struct orl_compiler *c, uint32_t slot);

/* Adds the place to an error, and returns its code. */
int orl_emit_place(struct orl_compiler *c, int line, int code);

int orl_emit_variable(struct orl_compiler *c, uint32_t slot, const struct orl_term *node);
int orl_emit_call(struct orl_compiler *c, uint32_t slot, const struct orl_term *node);
/* A call of a segment, or of a parameter. */
int orl_emit_site(struct orl_compiler *c, uint32_t slot, const struct orl_term *node,
                  enum orl_operation operation, uint32_t callee);

#endif
