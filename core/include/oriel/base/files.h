/*
 * Provider of named files. The core opens no path that a scene names. It asks the caller, which
 * reads from a folder, an upload or a test's array. No function here starts a program.
 */
#ifndef ORIEL_BASE_FILES_H
#define ORIEL_BASE_FILES_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>

/* Bytes of one file, not necessarily NUL-terminated. */
struct orl_file {
    const char *data;
    size_t size;
    void *handle; /* private to the provider; may be NULL */
};

/* A provider of files. open and close are called from the thread that loads the scene. */
struct orl_files {
    void *ctx;
    /* Fills ret_file, which stays valid until close, or returns ORL_ERR_NOT_FOUND or ORL_ERR_IO. */
    int (*open)(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err);
    void (*close)(void *ctx, struct orl_file *file);
    /* The callbacks from here on are optional. digest returns the SHA-256 of an open file if it is
     * known without reading; false: not known. */
    bool (*digest)(void *ctx, const char *name, unsigned char ret_digest[32]);
    /* Called when these bytes are not needed for now: the provider may release their memory. */
    void (*passed)(void *ctx, const struct orl_file *file, size_t begin, size_t end);
    /* Opens a file of the user's own library (function files, fonts and data that scenes rely on),
     * by a name that open does not know. Errors and close are those of open. */
    int (*library)(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err);
    /* Finds a file whose name differs from this one only in upper and lower case. */
    bool (*other_case)(void *ctx, const char *name, char *ret_name, size_t size);
};

/* Sets the hint of an error about a missing name, if a file's name differs from it only in upper
 * and lower case. Returns false and leaves the hint unchanged if there is none. */
bool orl_files_hint_case(const struct orl_files *files, const char *name, struct orl_error *err);

/* Files in the caller's memory: names[i] has contents[i]. Borrowed throughout. */
struct orl_memory_files {
    const char *const *names;
    const struct orl_file *contents;
    size_t count;
};
struct orl_files orl_files_from_memory(struct orl_memory_files *memory);

/*
 * Provides files below a folder of the local disk, mapped read-only. Names may be absolute or leave
 * the folder with "..": only for the user's own command line, never for an upload. Borrows folder,
 * which must outlive the result.
 */
struct orl_files orl_files_from_folder(const char *folder);

/* Implements `passed` for providers whose handle is a read-only mapping. */
void orl_files_release_pages(void *ctx, const struct orl_file *file, size_t begin, size_t end);

#endif
