/* Names of the elements of a BSDF file that are read, and their parents. */
#include <string.h>

#include "bsdf/xml/xml.h"

static const struct {
    enum orl_xml_element parent;
    const char *name;
    enum orl_xml_element element;
} elements[] = {
    {EL_DOCUMENT, "WindowElement", EL_WINDOW},
    {EL_WINDOW, "FileType", EL_FILE_TYPE},
    {EL_WINDOW, "Optical", EL_OPTICAL},
    {EL_OPTICAL, "Layer", EL_LAYER},
    {EL_LAYER, "Material", EL_MATERIAL},
    {EL_MATERIAL, "Name", EL_NAME},
    {EL_MATERIAL, "Thickness", EL_THICKNESS},
    {EL_LAYER, "DataDefinition", EL_DEFINITION},
    {EL_DEFINITION, "IncidentDataStructure", EL_STRUCTURE},
    {EL_DEFINITION, "AngleBasis", EL_BASIS},
    {EL_BASIS, "AngleBasisName", EL_BASIS_NAME},
    {EL_BASIS, "AngleBasisBlock", EL_RING},
    {EL_RING, "nPhis", EL_RING_CELLS},
    {EL_RING, "ThetaBounds", EL_RING_BOUNDS},
    {EL_RING_BOUNDS, "LowerTheta", EL_RING_LOWER},
    {EL_RING_BOUNDS, "UpperTheta", EL_RING_UPPER},
    {EL_LAYER, "WavelengthData", EL_WAVELENGTH_DATA},
    {EL_WAVELENGTH_DATA, "Wavelength", EL_WAVELENGTH},
    {EL_WAVELENGTH_DATA, "WavelengthDataBlock", EL_BLOCK},
    {EL_BLOCK, "WavelengthDataDirection", EL_DIRECTION},
    {EL_BLOCK, "ColumnAngleBasis", EL_COLUMN_BASIS},
    {EL_BLOCK, "RowAngleBasis", EL_ROW_BASIS},
    {EL_BLOCK, "AngleBasis", EL_TREE_BASIS},
    {EL_BLOCK, "ScatteringData", EL_DATA},
};

enum orl_xml_element orl_xml_element_in(enum orl_xml_element parent, const char *name)
{
    for (size_t i = 0; i < sizeof elements / sizeof *elements; i++)
        if (elements[i].parent == parent && strcmp(elements[i].name, name) == 0)
            return elements[i].element;
    return EL_OTHER;
}

const char *orl_xml_element_name(enum orl_xml_element element)
{
    for (size_t i = 0; i < sizeof elements / sizeof *elements; i++)
        if (elements[i].element == element)
            return elements[i].name;
    return "";
}
