/* Files of rad: projects have names fit for a bundle, and each command names a file. */
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "fuzz/fuzz.h"
#include "project/project.h"

bool fuzz_rif(const uint8_t *data, size_t size)
{
    json_t *project = NULL;
    struct orl_error err = {0};
    char *exact = malloc(size ? size : 1);
    FUZZ_PROMISE(exact != NULL);
    if (size > 0)
        memcpy(exact, data, size);
    const int code = orl_rif_read("room.rif", exact, size, &project, &err);
    free(exact);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(project == NULL);
        return false;
    }
    fuzz_check_project(project);
    json_decref(project);
    return true;
}
