/*
 * Every reader of text files behind one interface, each with a small file. A reader returns its
 * values as text, so that two files can be compared.
 */
#ifndef ORL_TESTS_SUPPORT_TEXT_READERS_H
#define ORL_TESTS_SUPPORT_TEXT_READERS_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>

struct text_values {
    char text[4096];
    size_t length;
};

/* A file with an error, the line of the error, and a part of its message. */
struct text_fault {
    const char *text; /* NULL: the reader has no such error */
    int line;
    const char *message;
};

struct text_reader {
    const char *name;
    int (*read)(const char *text, size_t size, struct text_values *values, struct orl_error *err);
    const char *text;   /* all lines end in "
                         * " */
    const char *latin1; /* equal values, with Latin-1 bytes in comments or names; or NULL */
    struct text_fault decimal_comma, empty_cell;
};

extern const struct text_reader text_readers[];
extern const size_t n_text_readers;

/* Returns true for XML, which declares its encoding. */
bool text_reader_takes_utf16(const struct text_reader *reader);

/* A BSDF whose basis is one ring of two cells. */
#define TWO_CELL_XML(name, thickness, values)                                                      \
    "<WindowElement><Optical><Layer><Material><Name>" name                                         \
    "</Name>\n<Thickness unit=\"Meter\">" thickness                                                \
    "</Thickness></Material>\n<DataDefinition><IncidentDataStructure>Columns"                      \
    "</IncidentDataStructure>\n<AngleBasis><AngleBasisName>two</AngleBasisName>\n"                 \
    "<AngleBasisBlock><Theta>0</Theta><nPhis>2</nPhis><ThetaBounds>\n<LowerTheta>0</LowerTheta>"   \
    "<UpperTheta>90</UpperTheta>\n</ThetaBounds></AngleBasisBlock></AngleBasis></"                 \
    "DataDefinition>\n"                                                                            \
    "<WavelengthData><Wavelength unit=\"Integral\">Visible</Wavelength>\n<WavelengthDataBlock>"    \
    "<WavelengthDataDirection>Transmission Front</WavelengthDataDirection>\n<ColumnAngleBasis>two" \
    "</ColumnAngleBasis><RowAngleBasis>two</RowAngleBasis>\n<ScatteringData>" values               \
    "</ScatteringData></WavelengthDataBlock></WavelengthData>\n</Layer></Optical></"               \
    "WindowElement>\n"

#endif
