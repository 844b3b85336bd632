#include "runner/shared_place.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "parts/runner.h"

/* Checks that only the daemon's user has access: the folder holds uploads, and its contents run as
 * that user. */
static int check_folder(const char *folder, struct orl_error *err)
{
    struct stat st;
    if (mkdir(folder, 0700) != 0 && errno != EEXIST)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot make the shared folder '%s': %s",
                             folder, strerror(errno));
    if (stat(folder, &st) != 0 || !S_ISDIR(st.st_mode))
        return orl_error_set(err, ORL_ERR_INVALID, "the shared folder '%s' is no folder", folder);
    if (st.st_uid != geteuid() || (st.st_mode & 077) != 0) {
        orl_error_set(err, ORL_ERR_INVALID, "others than this user may use the shared folder '%s'",
                      folder);
        orl_error_hint(err, "chown and chmod 700 it, or name one that is not there yet");
        return ORL_ERR_INVALID;
    }
    return access(folder, W_OK) == 0
               ? 0
               : orl_error_set(err, ORL_ERR_IO, "cannot write to the shared folder '%s': %s",
                               folder, strerror(errno));
}

/* Finds oriel, which is installed beside the daemon. */
static int find_program(struct orl_shared_place *place, struct orl_error *err)
{
    char own[4096];
    const int rc = orl_own_program(own, err);
    if (rc)
        return rc;
    *strrchr(own, '/') = '\0';
    snprintf(place->program, sizeof place->program, "%.*s/oriel", (int)sizeof place->program - 8,
             own);
    if (access(place->program, X_OK) == 0)
        return 0;
    orl_error_set(err, ORL_ERR_NOT_FOUND, "'%s' is not there, which does parts", place->program);
    orl_error_hint(err, "Install oriel beside orield, where all nodes see it");
    return ORL_ERR_NOT_FOUND;
}

static int list_words(const struct orl_runner_options *options, struct orl_shared_place *place,
                      struct orl_error *err)
{
    for (size_t i = 0; i < ORL_RUNNER_NAMED; i++) {
        char *word = place->named[i];
        if (!options->named[i])
            continue;
        if (snprintf(word, ORL_SHARED_WORD, "--%s=%s", orl_runner_named[i], options->named[i]) >=
            ORL_SHARED_WORD)
            return orl_error_set(err, ORL_ERR_LIMIT, "--slurm-%s is too long", orl_runner_named[i]);
        place->words[place->n_words++] = word;
    }
    for (size_t i = 0; i < options->n_words; i++)
        place->words[place->n_words++] = options->words[i];
    return 0;
}

int orl_shared_place_open(const struct orl_runner_options *options,
                          struct orl_shared_place *ret_place, struct orl_error *err)
{
    char whole[4096];
    memset(ret_place, 0, sizeof *ret_place);
    ret_place->parts = options->parts;
    ret_place->part_threads = options->part_threads;
    ret_place->least_s = options->least_s;
    int rc = check_folder(options->shared, err);
    if (rc)
        return rc;
    if (!realpath(options->shared, whole) || strlen(whole) + 80 >= sizeof ret_place->folder)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of the shared folder is too long");
    snprintf(ret_place->folder, sizeof ret_place->folder, "%s", whole);
    rc = find_program(ret_place, err);
    return rc ? rc : list_words(options, ret_place, err);
}
