/*
 * Opens files without blocking. open() of a FIFO waits for the other end, possibly for ever. These
 * functions do not wait, and reject everything but regular files.
 *
 * Errors: as for open(), -1 or NULL with errno set; orl_open_reason() returns the text for that
 * errno.
 */
#ifndef ORIEL_BASE_OPEN_H
#define ORIEL_BASE_OPEN_H

#include <errno.h>
#include <stdio.h>

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

#endif
