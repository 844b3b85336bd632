#include "annual_job/annual_matrices_json.h"

#include "json/members.h"

enum { NAME_MAX_BYTES = 63, FILE_MAX_BYTES = 1024 };

static int decode_term(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_matrix_term *term = into;
    const struct orl_json_member members[] = {
        {"grid", .text = &term->grid, .longest = NAME_MAX_BYTES},
        {"coefficients", .text = &term->coefficients, .longest = FILE_MAX_BYTES},
        {"view", .text = &term->view, .longest = FILE_MAX_BYTES},
        {"transmission", .text = &term->transmission, .longest = FILE_MAX_BYTES},
        {"daylight", .text = &term->daylight, .longest = FILE_MAX_BYTES},
        {"sky", .text = &term->sky, .longest = FILE_MAX_BYTES, .required = true},
        {"subtract", .flag = &term->subtract},
        {0}};
    return orl_json_members(value, path, members, err);
}

int orl_annual_matrices_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err)
{
    struct orl_annual_request *request = into;
    const struct orl_json_list list = {.items = &request->terms,
                                       .count = &request->n_terms,
                                       .size = sizeof *request->terms,
                                       .most = ORL_MATRICES_MOST_TERMS,
                                       .each = decode_term,
                                       .empty = "the list is empty"};
    return orl_json_list(value, path, &list, err);
}
