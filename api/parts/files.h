/*
 * Files as commands and parts write and read them: results appear whole or not at all (a temporary
 * name beside the target, synced, then renamed), so that a script never meets half a result.json.
 * Devices and pipes, as /dev/stdout, are written to as they are.
 */
#ifndef ORL_PARTS_FILES_H
#define ORL_PARTS_FILES_H

#include <dirent.h>
#include <stdio.h>

#include <jansson.h>

#include <oriel/error.h>

struct orl_new_file {
    FILE *stream;
    char target[4096], temporary[4096]; /* the latter "": written in place */
};

/* After open, exactly one of commit and abandon must follow. Commit that fails has abandoned. */
int orl_new_file_open(struct orl_new_file *ret_file, const char *target, struct orl_error *err);
int orl_new_file_commit(struct orl_new_file *file, struct orl_error *err);
void orl_new_file_abandon(struct orl_new_file *file);

/* Opens a regular file and says how large it is. */
int orl_open_for_reading(const char *path, FILE **ret_stream, long long *ret_size,
                         struct orl_error *err);

int orl_open_folder(const char *path, DIR **ret_entries, struct orl_error *err);

/* Makes the folder and those above it, as `mkdir -p` does. */
int orl_make_folder(const char *path, struct orl_error *err);

/* Removes it with all that is in it; of links, the links. */
void orl_remove_folder(const char *folder);

/* folder/name into ret_path[size]; an absolute name stands for itself. */
int orl_join_path(const char *folder, const char *name, char *ret_path, size_t size,
                  struct orl_error *err);

/* Writes a text, by way of orl_new_file. */
int orl_write_text(const char *path, const char *text, size_t size, struct orl_error *err);

/* Writes a JSON document, indented, by way of orl_new_file. */
int orl_write_json(const char *path, const json_t *json, struct orl_error *err);

#endif
