#include "places_json.h"

#include <stdio.h>

#include "members.h"

enum { NAME_MAX_BYTES = 63 };

int orl_vec3_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    double numbers[3];
    if (!json_is_array(value) || json_array_size(value) != 3)
        return orl_json_wrong_type(value, path, "an array of 3 numbers", err);
    for (size_t i = 0; i < 3; i++) {
        const int rc = orl_json_real(json_array_get(value, i), path, &numbers[i], err);
        if (rc)
            return rc;
    }
    *(struct orl_vec3 *)into = orl_v3(numbers[0], numbers[1], numbers[2]);
    return 0;
}

int orl_place_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_named_place *place = into;
    const struct orl_json_member members[] = {
        {"name", .text = &place->name, .longest = NAME_MAX_BYTES},
        {"at", .decode = orl_vec3_from_json, .into = &place->at, .required = true},
        {0}};
    return orl_json_members(value, path, members, err);
}

int orl_places_name(struct orl_named_place *places, size_t n, struct orl_error *err)
{
    for (size_t i = 0; i < n; i++)
        if (!places[i].name && asprintf(&places[i].name, "point%zu", i + 1) < 0) {
            places[i].name = NULL;
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        }
    return 0;
}
