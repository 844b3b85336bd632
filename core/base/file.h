/*
 * Writing a file so that it is whole or absent: path.part, sync, rename. Devices and pipes, as
 * /dev/stdout, are written to as they are.
 */
#ifndef ORL_BASE_FILE_H
#define ORL_BASE_FILE_H

#include <stdio.h>

#include <oriel/error.h>

struct orl_out_file {
    FILE *stream;
    char path[4096], part[4104];
};

int orl_out_open(struct orl_out_file *file, const char *path, struct orl_error *err);
/* Commits when code is 0; else removes. Returns code, or ORL_ERR_IO when committing failed. */
int orl_out_close(struct orl_out_file *file, int code, struct orl_error *err);

#endif
