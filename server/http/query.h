/*
 * What the arguments of a request's target may say. Threads: any.
 */
#ifndef ORL_SERVER_HTTP_QUERY_H
#define ORL_SERVER_HTTP_QUERY_H

#include <stdbool.h>

/* A number from 1 to most, in decimal digits and nothing else. */
bool orl_query_count(const char *text, unsigned long most, unsigned long *ret_count);

/* A number from low to high, as JSON writes it. */
bool orl_query_number(const char *text, double low, double high, double *ret_number);

#endif
