/*
 * Code emission (compiler.h): instructions.c appends instructions to a slot's segment, emit_code.c
 * handles trees and constants, emit_calls.c handles names, calls and choices. All functions with a
 * code return 0 or an error. Inside of core/function only.
 */
#ifndef ORL_FUNCTION_CODEGEN_EMIT_CODE_H
#define ORL_FUNCTION_CODEGEN_EMIT_CODE_H

#include "function/codegen/compiler.h"

/* Recursion depth of emission beyond which constants are not folded. */
enum { ORL_FOLDING_DEPTH = 3000 };

/* Emits code that leaves a tree's value on top of the stack; constants are folded. */
int orl_emit(struct orl_compiler *c, uint32_t slot, const struct orl_term *node);

int orl_emit_operation(struct orl_compiler *c, uint32_t slot, enum orl_operation operation,
                       uint64_t index, uint32_t count);
int orl_emit_number(struct orl_compiler *c, uint32_t slot, double number);

size_t orl_emit_length(const struct orl_compiler *c, uint32_t slot);
/* Sets the jump target of the instruction at `at` to the next instruction emitted. */
void orl_emit_patch_jump(struct orl_compiler *c, uint32_t slot, size_t at);
/* Removes a number if it is the only instruction emitted after position `since`. */
bool orl_emit_take_number(struct orl_compiler *c, uint32_t slot, size_t since, double *ret_number);

/* Schedules a body for compilation. */
int orl_emit_schedule_body(struct orl_compiler *c, uint32_t slot);

/* Adds the file and line to an error. Returns code. */
int orl_emit_locate_error(struct orl_compiler *c, int line, int code);

int orl_emit_variable(struct orl_compiler *c, uint32_t slot, const struct orl_term *node);
int orl_emit_call(struct orl_compiler *c, uint32_t slot, const struct orl_term *node);
/* Emits a call of a segment, or of a parameter. */
int orl_emit_site(struct orl_compiler *c, uint32_t slot, const struct orl_term *node,
                  enum orl_operation operation, uint32_t callee);

#endif
