/*
 * Errors: one enum for the whole core, and a struct that carries the detail.
 *
 * Every fallible function returns 0 or a negative enum orl_err. On failure it fills the caller's
 * struct orl_error (which may be NULL). Outputs named ret_* are untouched on failure. The library
 * never prints, never exits, never aborts.
 */
#ifndef ORIEL_BASE_ERROR_H
#define ORIEL_BASE_ERROR_H

#include <stdarg.h>

enum orl_err {
    ORL_OK = 0,
    ORL_ERR_NOMEM = -1,       /* out of memory */
    ORL_ERR_IO = -2,          /* the operating system rejected a read, write or map */
    ORL_ERR_SYNTAX = -3,      /* scene, XML or view text that does not parse */
    ORL_ERR_UNSUPPORTED = -4, /* well formed, but a primitive or feature Oriel does not simulate */
    ORL_ERR_RANGE = -5,       /* a value out of its range, NaN or infinite */
    ORL_ERR_NOT_FOUND = -6,   /* a file, modifier or sensor list that is named but absent */
    ORL_ERR_LIMIT = -7,       /* a bound of limits.h was exceeded */
    ORL_ERR_CORRUPT = -8,     /* a stored file fails its checksum or its invariants */
    ORL_ERR_VERSION = -9,     /* a stored file of another format version */
    ORL_ERR_CANCELLED = -10,  /* the caller raised the cancel flag */
    ORL_ERR_INVALID = -11,    /* a job or call that contradicts itself */
    ORL_ERR_INTERNAL = -12,   /* a broken invariant in Oriel: a bug */
    ORL_ERR_FULL = -13,       /* the disk has no room for a file, or a quota is used up */
    ORL_ERR_UNLIT = -14, /* no light reached any sensor or view, and the job does not expect that */
};

enum { ORL_ERROR_NAME_MAX = 256, ORL_ERROR_TEXT_MAX = 512 };

/* Error detail: cause, place and remedy. Fields that do not apply are "" or 0. */
struct orl_error {
    int code;                           /* enum orl_err */
    char file[ORL_ERROR_NAME_MAX];      /* file name as given by the user */
    int line;                           /* 1-based; 0 when there is none */
    char primitive[ORL_ERROR_NAME_MAX]; /* "polygon wall_w", "WavelengthDataBlock" */
    char message[ORL_ERROR_TEXT_MAX];   /* one sentence: the cause */
    char hint[ORL_ERROR_TEXT_MAX];      /* one sentence: the remedy */
};

/* Fills err (may be NULL) with code and a printf-style message, and clears the rest. Returns
 * code. */
int orl_error_set(struct orl_error *err, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
int orl_error_vset(struct orl_error *err, int code, const char *format, va_list args)
    __attribute__((format(printf, 3, 0)));

/* Adds the place of the error; a NULL name leaves its field unchanged. */
void orl_error_at(struct orl_error *err, const char *file, int line, const char *primitive);

/* Adds the remedy. */
void orl_error_hint(struct orl_error *err, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Sets an error with a hint. Returns code. */
int orl_error_refuse(struct orl_error *err, int code, const char *hint, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Returns the code for an errno of the file system: ORL_ERR_FULL for ENOSPC and EDQUOT,
 * ORL_ERR_NOMEM for ENOMEM, else ORL_ERR_IO. */
int orl_err_of_errno(int why);

/* Sets ORL_ERR_NOMEM with the message "out of memory", and returns it. */
int orl_error_no_memory(struct orl_error *err);

/* Returns a stable, lower-case name for a code: "syntax", "not-found", ... Never NULL. */
const char *orl_err_name(int code);

/* Writes "file:line: primitive: message (hint)" with the absent parts left out. */
void orl_error_format(const struct orl_error *err, char *ret_text, unsigned long size);

#endif
