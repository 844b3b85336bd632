/*
 * Where named files come from. The core opens no path a scene names: it asks the caller, who
 * answers from a folder, an upload or a test's array. Nothing here ever starts a program.
 */
#ifndef ORIEL_FILES_H
#define ORIEL_FILES_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/error.h>

/* The bytes of one file. Need not end in NUL. */
struct orl_file {
    const char *data;
    size_t size;
    void *handle; /* the provider's own; NULL when it needs none */
};

/* A provider of files. open and close are called from the thread that loads the scene. */
struct orl_files {
    void *ctx;
    /* Fills ret_file, which stays valid until close, or returns ORL_ERR_NOT_FOUND / ORL_ERR_IO. */
    int (*open)(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err);
    void (*close)(void *ctx, struct orl_file *file);
    /* What follows is optional. The SHA-256 of a file that is open, where it is known without
     * reading; false: it is not. */
    bool (*digest)(void *ctx, const char *name, unsigned char ret_digest[32]);
    /* These bytes are not wanted again for now: the provider may let go of the memory they take. */
    void (*passed)(void *ctx, const struct orl_file *file, size_t begin, size_t end);
    /* Opens a file of the user's own library, where function files, fonts and data lie that scenes
     * count on: by a name that open does not know. Errors and close are those of open. */
    int (*library)(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err);
    /* Finds a file whose name differs from this one in upper and lower case alone. */
    bool (*other_case)(void *ctx, const char *name, char *ret_name, size_t size);
};

/* Sets the hint of an error about a name that is not there, if there is one that differs in upper
 * and lower case alone. Returns false and leaves the hint as it is if there is none. */
bool orl_files_hint_case(const struct orl_files *files, const char *name, struct orl_error *err);

/* Files held in memory, the caller's: names[i] has contents[i]. Borrowed throughout. */
struct orl_memory_files {
    const char *const *names;
    const struct orl_file *contents;
    size_t count;
};
struct orl_files orl_files_from_memory(struct orl_memory_files *memory);

/*
 * Files below a folder of the local disk, mapped read-only. Names may be absolute or climb out of
 * the folder: for the user's own command line only, never for an upload. Takes no ownership of
 * folder, which must outlive the result.
 */
struct orl_files orl_files_from_folder(const char *folder);

/* What passed is to providers of files that are mapped read-only at their handle. */
void orl_files_let_go(void *ctx, const struct orl_file *file, size_t begin, size_t end);

#endif
