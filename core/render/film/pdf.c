#include "render/film/image_files.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <zlib.h>

#include "base/io/out_file.h"

/* Height of capitals, and the unit of letter widths, relative to the font size. */
static const double capitals = 0.72, thousandth = 1e-3;
/* Line width around filled polygons; without it antialiasing readers show seams between
 * neighbours. */
static const double seam = 0.3;

struct orl_pdf {
    double width, height, scale; /* size in page units, and points per unit */
    FILE *page;                  /* stream of the page's drawing operators */
    char *content;
    size_t size;
};

int orl_pdf_new(double width, double height, double scale, struct orl_pdf **ret_pdf)
{
    struct orl_pdf *pdf = calloc(1, sizeof *pdf);
    if (!pdf)
        return ORL_ERR_NOMEM;
    *pdf = (struct orl_pdf){.width = width, .height = height, .scale = scale};
    pdf->page = open_memstream(&pdf->content, &pdf->size);
    if (!pdf->page) {
        free(pdf);
        return ORL_ERR_NOMEM;
    }
    fprintf(pdf->page, "%g 0 0 %g 0 %g cm 1 j 1 J\n", scale, -scale, scale * height);
    *ret_pdf = pdf;
    return 0;
}

void orl_pdf_free(struct orl_pdf *pdf)
{
    if (!pdf)
        return;
    if (pdf->page)
        fclose(pdf->page);
    free(pdf->content);
    free(pdf);
}

/* ---- Shapes ---------------------------------------------------------------------------------- */

static void put_color(const struct orl_pdf *pdf, const unsigned char rgb[3], const char *operator)
{
    fprintf(pdf->page, "%.4g %.4g %.4g %s ", rgb[0] / 255.0, rgb[1] / 255.0,
            rgb[2] / 255.0, operator);
}

static void put_corners(const struct orl_pdf *pdf, size_t n, const double x[], const double y[])
{
    for (size_t i = 0; i < n; i++)
        fprintf(pdf->page, "%.2f %.2f %c ", x[i], y[i], i == 0 ? 'm' : 'l');
}

void orl_pdf_fill(struct orl_pdf *pdf, size_t n, const double x[], const double y[],
                  const unsigned char rgb[3])
{
    put_color(pdf, rgb, "rg");
    put_color(pdf, rgb, "RG");
    fprintf(pdf->page, "%g w ", seam);
    put_corners(pdf, n, x, y);
    fputs("b\n", pdf->page);
}

void orl_pdf_path(struct orl_pdf *pdf, size_t n, const double x[], const double y[], double weight,
                  const unsigned char rgb[3])
{
    put_color(pdf, rgb, "RG");
    fprintf(pdf->page, "%.2f w ", weight);
    put_corners(pdf, n, x, y);
    fputs("S\n", pdf->page);
}

/* ---- Letters --------------------------------------------------------------------------------- */

enum font { HELVETICA, HELVETICA_BOLD, SYMBOL, DINGBATS, FONTS };
static const char *const fonts[FONTS] = {"Helvetica", "Helvetica-Bold", "Symbol", "ZapfDingbats"};

/* Widths of Helvetica and its bold from space to tilde, in thousandths of the size (Adobe's metrics
 * of the standard fonts). */
static const uint16_t widths[2][95] = {
    {278,  278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278,
     556,  556, 556, 556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556,
     1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778,
     667,  778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556,
     333,  556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556,
     556,  556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584},
    {278, 333, 474, 556, 556, 889, 722, 238, 333, 333, 389, 584, 278, 333, 278, 278,
     556, 556, 556, 556, 556, 556, 556, 556, 556, 556, 333, 333, 584, 584, 584, 611,
     975, 722, 722, 722, 722, 667, 611, 778, 722, 278, 556, 722, 611, 833, 722, 778,
     667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 333, 278, 333, 584, 556,
     333, 556, 611, 556, 611, 556, 333, 611, 611, 278, 278, 556, 278, 889, 611, 611,
     611, 611, 389, 556, 333, 611, 556, 778, 556, 556, 500, 389, 280, 389, 584}};

/* For each code of Latin-1 from 160 on, a letter of equal width. */
static const char like[] =
    " !ccccI\"sa<=-s\"-?=\"\"`gp.,\"oo\"\"\"?AAAAAAMCEEEEIIIIDNOOOOO=OUUUUYPs"
    "aaaaaamceeeeiiiidnooooo=ouuuuypy";
_Static_assert(sizeof like == 97, "one for each of 96");

/* A letter in a font. */
struct letter {
    enum font font;
    unsigned char code;
    double width;
};

/* Characters that only Symbol contains. */
static const struct {
    uint32_t point;
    struct letter letter;
} symbols[] = {{0x2212, {SYMBOL, 0x2d, 549}},
               {0x2264, {SYMBOL, 0xa3, 549}},
               {0x2265, {SYMBOL, 0xb3, 549}},
               {0x0394, {SYMBOL, 0x44, 612}},
               {0x221a, {SYMBOL, 0xd6, 549}}};

/* Characters at codes 128 and up, which Latin-1 leaves empty: a dash, and letters of Poland,
 * Turkey, Bohemia and Hungary. Each has the width of its base letter. */
static const struct {
    uint32_t point;
    char like;
    const char *name;
} added[] = {
    {0x2013, '_', "endash"},        {0x0104, 'A', "Aogonek"},       {0x0105, 'a', "aogonek"},
    {0x0106, 'C', "Cacute"},        {0x0107, 'c', "cacute"},        {0x0118, 'E', "Eogonek"},
    {0x0119, 'e', "eogonek"},       {0x0141, 'L', "Lslash"},        {0x0142, 'l', "lslash"},
    {0x0143, 'N', "Nacute"},        {0x0144, 'n', "nacute"},        {0x015a, 'S', "Sacute"},
    {0x015b, 's', "sacute"},        {0x017a, 'z', "zacute"},        {0x017b, 'Z', "Zdotaccent"},
    {0x017c, 'z', "zdotaccent"},    {0x011e, 'G', "Gbreve"},        {0x011f, 'g', "gbreve"},
    {0x0130, 'I', "Idotaccent"},    {0x0131, 'i', "dotlessi"},      {0x015e, 'S', "Scedilla"},
    {0x015f, 's', "scedilla"},      {0x010c, 'C', "Ccaron"},        {0x010d, 'c', "ccaron"},
    {0x0160, 'S', "Scaron"},        {0x0161, 's', "scaron"},        {0x017d, 'Z', "Zcaron"},
    {0x017e, 'z', "zcaron"},        {0x0150, 'O', "Ohungarumlaut"}, {0x0151, 'o', "ohungarumlaut"},
    {0x0171, 'u', "uhungarumlaut"}, {0x20ac, '0', "Euro"}};
enum { FIRST_ADDED = 128, ADDED = sizeof added / sizeof *added };
_Static_assert(ADDED <= 32, "up to where Latin-1 begins");

/* Returns the next UTF-8 code point; bytes of invalid sequences are taken one by one. */
static uint32_t next_point(const char **text)
{
    const unsigned char *s = (const unsigned char *)*text;
    const int more = s[0] >= 0xf0 ? 3 : s[0] >= 0xe0 ? 2 : s[0] >= 0xc0 ? 1 : 0;
    uint32_t point = more == 0 ? s[0] : s[0] & (0x3fU >> more);
    for (int i = 1; i <= more; i++) {
        if ((s[i] & 0xc0) != 0x80) {
            *text += 1;
            return 0xfffd;
        }
        point = point << 6 | (s[i] & 0x3fU);
    }
    *text += more + 1;
    return point;
}

static struct letter letter_of(uint32_t point, bool bold)
{
    const enum font font = bold ? HELVETICA_BOLD : HELVETICA;
    if (point < 0x20 || point == 0x7f)
        point = ' ';
    if (point < 0x7f)
        return (struct letter){font, (unsigned char)point, widths[bold][point - 0x20]};
    if (point >= 0xa0 && point < 0x100)
        return (struct letter){font, (unsigned char)point,
                               widths[bold][(unsigned char)like[point - 0xa0] - 0x20]};
    for (int i = 0; i < ADDED; i++)
        if (added[i].point == point)
            return (struct letter){font, (unsigned char)(FIRST_ADDED + i),
                                   widths[bold][added[i].like - 0x20]};
    for (size_t i = 0; i < sizeof symbols / sizeof *symbols; i++)
        if (symbols[i].point == point)
            return symbols[i].letter;
    return (struct letter){DINGBATS, 'o', 762};
}

static double text_width(const char *text, bool bold)
{
    double sum = 0;
    while (*text)
        sum += thousandth * letter_of(next_point(&text), bold).width;
    return sum;
}

static void put_code(FILE *page, unsigned char code)
{
    if (code == '(' || code == ')' || code == '\\')
        fprintf(page, "\\%c", code);
    else if (code < 0x20 || code > 0x7e)
        fprintf(page, "\\%03o", code);
    else
        fputc(code, page);
}

/* Writes the letters in runs of one font. */
static void put_letters(const struct orl_pdf *pdf, double size, bool bold, const char *text)
{
    enum font font = FONTS;
    while (*text) {
        const struct letter letter = letter_of(next_point(&text), bold);
        if (letter.font != font)
            fprintf(pdf->page, "%s/F%d %.3f Tf (", font == FONTS ? "" : ") Tj ", letter.font, size);
        font = letter.font;
        put_code(pdf->page, letter.code);
    }
    if (font != FONTS)
        fputs(") Tj ", pdf->page);
}

void orl_pdf_text(struct orl_pdf *pdf, double x, double y, double most, double rim,
                  const struct orl_canvas_text_style *text_style, const char *text)
{
    static const unsigned char white[3] = {255, 255, 255};
    const double size = text_style->size / capitals,
                 wide = size * text_width(text, text_style->bold);
    const double squeezed = wide > most && most > 0 ? most / wide : 1;
    const double left = x - 0.5 * (int)text_style->align * wide * squeezed;
    for (int pass = text_style->rimmed ? 0 : 1; pass < 2; pass++) {
        fprintf(pdf->page, "BT %d Tr %.2f Tz ", pass == 0 ? 1 : 0, 100 * squeezed);
        if (pass == 0)
            fprintf(pdf->page, "%.2f w ", 2 * rim);
        put_color(pdf, pass == 0 ? white : text_style->rgb, pass == 0 ? "RG" : "rg");
        fprintf(pdf->page,
                text_style->upright ? "0 -1 -1 0 %.2f %.2f Tm " : "1 0 0 -1 %.2f %.2f Tm ", left,
                y);
        put_letters(pdf, size, text_style->bold, text);
        fputs("ET\n", pdf->page);
    }
}

/* ---- The file -------------------------------------------------------------------------------- */

enum {
    CATALOG = 1,
    PAGES,
    PAGE,
    CONTENT,
    ENCODING,
    FIRST_FONT,
    INFO = FIRST_FONT + FONTS,
    OBJECTS
};

static void begin_object(FILE *file, int number, long offsets[OBJECTS])
{
    offsets[number] = ftell(file);
    fprintf(file, "%d 0 obj\n", number);
}

static void put_fonts(FILE *file, long offsets[OBJECTS])
{
    begin_object(file, ENCODING, offsets);
    fprintf(file, "<</Type/Encoding/BaseEncoding/WinAnsiEncoding/Differences[%d", FIRST_ADDED);
    for (int i = 0; i < ADDED; i++)
        fprintf(file, "/%s", added[i].name);
    fputs("]>>\nendobj\n", file);
    for (int i = 0; i < FONTS; i++) {
        begin_object(file, FIRST_FONT + i, offsets);
        fprintf(file, "<</Type/Font/Subtype/Type1/BaseFont/%s", fonts[i]);
        if (i < SYMBOL)
            fprintf(file, "/Encoding %d 0 R", ENCODING);
        fputs(">>\nendobj\n", file);
    }
}

static void put_page(const struct orl_pdf *pdf, FILE *file, long offsets[OBJECTS])
{
    begin_object(file, CATALOG, offsets);
    fprintf(file, "<</Type/Catalog/Pages %d 0 R>>\nendobj\n", PAGES);
    begin_object(file, PAGES, offsets);
    fprintf(file, "<</Type/Pages/Count 1/Kids[%d 0 R]>>\nendobj\n", PAGE);
    begin_object(file, PAGE, offsets);
    fprintf(file, "<</Type/Page/Parent %d 0 R/MediaBox[0 0 %.2f %.2f]/Contents %d 0 R/Resources<<",
            PAGES, pdf->scale * pdf->width, pdf->scale * pdf->height, CONTENT);
    fputs("/Font<<", file);
    for (int i = 0; i < FONTS; i++)
        fprintf(file, "/F%d %d 0 R", i, FIRST_FONT + i);
    fputs(">>>>>>\nendobj\n", file);
    put_fonts(file, offsets);
    begin_object(file, INFO, offsets);
    fputs("<</Producer(Oriel)>>\nendobj\n", file);
}

static void put_file(const struct orl_pdf *pdf, FILE *file, const unsigned char *packed,
                     unsigned long bytes)
{
    long offsets[OBJECTS] = {0};
    fputs("%PDF-1.4\n%\xe2\xe3\xcf\xd3\n", file);
    put_page(pdf, file, offsets);
    begin_object(file, CONTENT, offsets);
    fprintf(file, "<</Length %lu/Filter/FlateDecode>>\nstream\n", bytes);
    fwrite(packed, 1, bytes, file);
    fputs("\nendstream\nendobj\n", file);
    const long table = ftell(file);
    fprintf(file, "xref\n0 %d\n0000000000 65535 f \n", OBJECTS);
    for (int i = 1; i < OBJECTS; i++)
        fprintf(file, "%010ld 00000 n \n", offsets[i]);
    fprintf(file, "trailer\n<</Size %d/Root %d 0 R/Info %d 0 R>>\nstartxref\n%ld\n%%%%EOF\n",
            OBJECTS, CATALOG, INFO, table);
}

/* Returns the compressed page, owned by the caller, or NULL if out of memory. */
static unsigned char *compress_page(struct orl_pdf *pdf, unsigned long *ret_bytes)
{
    const bool failed = ferror(pdf->page);
    const bool closed = fclose(pdf->page) == 0;
    pdf->page = NULL;
    if (failed || !closed || !pdf->content)
        return NULL;
    *ret_bytes = compressBound(pdf->size);
    unsigned char *packed = malloc(*ret_bytes);
    if (packed &&
        compress(packed, ret_bytes, (const unsigned char *)pdf->content, pdf->size) != Z_OK) {
        free(packed);
        packed = NULL;
    }
    return packed;
}

int orl_pdf_write(struct orl_pdf *pdf, const char *path, struct orl_error *err)
{
    struct orl_out_file file;
    unsigned long bytes = 0;
    unsigned char *packed = compress_page(pdf, &bytes);
    if (!packed)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory drawing '%s'", path);
    int code = orl_out_open(&file, path, err);
    if (code == 0) {
        put_file(pdf, file.stream, packed, bytes);
        code = orl_out_close(&file, 0, err);
    }
    free(packed);
    return code;
}
