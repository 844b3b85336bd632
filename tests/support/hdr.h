/*
 * Reads HDR images of Oriel and Radiance: run-length coded RGBE, scanlines from the top.
 */
#ifndef ORL_TESTS_SUPPORT_HDR_H
#define ORL_TESTS_SUPPORT_HDR_H

/*
 * Reads W/sr/m2 per channel, row by row; ret_rgb holds width * height. A channel's eight bits are
 * read as the middle of their step, except 0, which is 0. Fails the test unless the file has that
 * size. width: 8 to 32767.
 */
void hdr_read(const char *path, int width, int height, double (*ret_rgb)[3]);

#endif
