/* Parsers for the arguments of a request's target. Threads: any. */
#ifndef ORL_SERVER_HTTP_REQUEST_QUERY_H
#define ORL_SERVER_HTTP_REQUEST_QUERY_H

#include <stdbool.h>

/* Reads a number from 1 to most: decimal digits only. */
bool orl_query_count(const char *text, unsigned long most, unsigned long *ret_count);

/* Reads a number from low to high in JSON's syntax. */
bool orl_query_number(const char *text, double low, double high, double *ret_number);

#endif
