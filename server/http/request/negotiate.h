/* Content negotiation: Accept and Accept-Encoding (RFC 9110, 12.5.1 and 12.5.3). */
#ifndef ORL_SERVER_HTTP_REQUEST_NEGOTIATE_H
#define ORL_SERVER_HTTP_REQUEST_NEGOTIATE_H

/*
 * Returns the weight, 0 to 1, that the header gives to a media type or a coding (name, in lower
 * case). The most specific range that contains the name decides; of equally specific ones the
 * first. 0 if no range contains it, and without a header (NULL). Parameters other than the weight
 * are ignored.
 */
double orl_negotiate_weight(const char *header, const char *name);

#endif
