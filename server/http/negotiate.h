/*
 * What a client would rather have: Accept and Accept-Encoding (RFC 9110, 12.5.1 and 12.5.3).
 */
#ifndef ORL_SERVER_HTTP_NEGOTIATE_H
#define ORL_SERVER_HTTP_NEGOTIATE_H

/*
 * The weight, 0 to 1, that the header gives to name, a media type or a coding in lower case, by the
 * most specific of its ranges that name lies in; of two alike the first. 0 where none does, and
 * without a header (NULL). Parameters other than the weight are passed over.
 */
double orl_negotiate_weight(const char *header, const char *name);

#endif
