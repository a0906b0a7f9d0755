// Prepares DXF files for GDAL, which reads the shapes. What GDAL does not look at is done here: the
// encoding of names, the unit, layers written in upper and lower case, and entities that it would
// pass over without a word or stop at.
#pragma once

#include <string>
#include <vector>

namespace apothem {

struct DxfEntity {
  enum class Use {
    read,         ///< GDAL gives its shape
    left_out,     ///< it is no outline, see `remark`
    unbounded,    ///< a line without ends, which matters only between lines
    unsupported,  ///< it is drawn and cannot be read, see `remark`
  };
  Use use = Use::read;
  std::string type, layer;
  std::string place;   ///< for messages
  std::string remark;  ///< why it is left out, or what is wrong with it, and a remedy
};

struct DxfText {
  /// A DXF file in UTF-8. Each entity has its number in `entities` as its line type; those that
  /// GDAL does not read are points there.
  std::string text;
  std::vector<DxfEntity> entities;
  std::vector<int> owners;  ///< of each two lines of the text, the entity; -1 if it has none
  std::vector<DxfEntity> paper_space;  ///< what belongs to the sheet to be printed
  std::vector<std::string> layers;     ///< of its table
  int unit = 0;                        ///< $INSUNITS; 0 if it has none
};

/// Throws SceneError if the file is not a complete DXF file of text.
DxfText read_dxf(const std::string& file);

}  // namespace apothem
