/*
 * Files by name: the provider from which the core gets them, opening without blocking, and search
 * that ignores case.
 *
 * The core opens no path that a scene names. It requests the file from the provider, which reads
 * from a folder, an upload or a test's array. No function here starts a program.
 */
#ifndef ORIEL_BASE_FILES_H
#define ORIEL_BASE_FILES_H

#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

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

/*
 * Opens files without blocking. open() of a FIFO waits for the other end, possibly for ever. These
 * functions do not wait, and reject everything but regular files.
 *
 * Errors: as for open(), -1 or NULL with errno set; orl_open_reason() returns the text for that
 * errno.
 */

/* errno for a folder, FIFO, socket or device in place of a regular file. */
#define ORL_OPEN_NOT_REGULAR EINVAL

/*
 * Opens a regular file, closed on exec. flags: O_RDONLY, O_WRONLY or O_RDWR, with O_CREAT (mode
 * 0666 less the umask), O_TRUNC, O_APPEND and O_NOFOLLOW.
 */
int orl_open_regular(const char *path, int flags);

/* Opens a regular file as a stream. mode: 'r' reads, 'w' truncates or creates, 'a' appends or
 * creates. */
FILE *orl_fopen_regular(const char *path, char mode);

/* Opens an existing pipe or device for writing: /dev/null, /dev/stdout, or a FIFO that has a
 * reader. A FIFO without one fails with ENXIO. Writes may wait for the reader. */
FILE *orl_fopen_device(const char *path);

/* Returns strerror, or "not a regular file". */
const char *orl_open_reason(int why);
/* Returns the code for a file of a store that does not open: ORL_ERR_CORRUPT if it is not regular,
 * so that it is made again; else ORL_ERR_IO. */
int orl_open_err_of_stored(int why);

/* Case-insensitive search of file names, for scenes from systems that ignore case. */

/* Finds a file below the folder, or from the root for an absolute name, whose name differs from
 * this one only in upper and lower case; of several the first by name. */
bool orl_find_ignoring_case(const char *folder, const char *name, char *ret_name, size_t size);
/* Returns true if the name has the ending, such as ".rad" in any case, and more before it. */
bool orl_name_has_ending(const char *name, const char *ending);

#endif
