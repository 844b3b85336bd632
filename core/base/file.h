/*
 * Writing a file so that it is whole or absent: path.part, sync, rename. Devices and pipes, as
 * /dev/stdout, are written to as they are.
 */
#ifndef ORL_BASE_FILE_H
#define ORL_BASE_FILE_H

#include <stdio.h>

#include <oriel/crew.h>
#include <oriel/error.h>

struct orl_out_file {
    FILE *stream;
    const atomic_bool *cancel; /* set by the caller after opening; or NULL */
    char path[4096], part[4104];
};

int orl_out_open(struct orl_out_file *file, const char *path, struct orl_error *err);
/* False once the file's cancel flag is set: loops that write a lot end then. */
bool orl_out_goes_on(const struct orl_out_file *file);
/* Writes n floats, and polls the cancel flag between blocks. */
void orl_out_floats(const struct orl_out_file *file, const float *values, size_t n);
/* Commits when code is 0 and nothing is cancelled; else removes. Returns code, ORL_ERR_CANCELLED,
 * or ORL_ERR_IO when committing failed. */
int orl_out_close(struct orl_out_file *file, int code, struct orl_error *err);

#endif
