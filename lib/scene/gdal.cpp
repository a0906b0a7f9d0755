#include "lib/scene/gdal.hpp"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

#include "gdal_library.hpp"

namespace apothem {
namespace {

// Blocks of a DXF file are taken apart, so that every part of them keeps its own layer.
constexpr const char* kMergeBlocks = "DXF_MERGE_BLOCK_GEOMETRIES";
// DXF files are in UTF-8 when GDAL gets them, see dxf_text.hpp.
constexpr const char* kEncoding = "DXF_ENCODING";

template <class Function>
void find_function(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (function == nullptr) {
    throw std::runtime_error(std::string(kGdalLibrary) + " has no function " + name +
                             "; install GDAL 3.4 or newer");
  }
}

Gdal load_gdal() {
  void* library = dlopen(kGdalLibrary, RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) {
    throw std::runtime_error(std::string("drawings are read by GDAL, which cannot be loaded (") +
                             dlerror() + "); install the library GDAL (on Debian: " + kGdalPackage +
                             ")");
  }
  Gdal functions;
#define APOTHEM_FIND(name) find_function(library, #name, functions.name);
  APOTHEM_GDAL_FUNCTIONS(APOTHEM_FIND)
#undef APOTHEM_FIND
  for (const char* driver : {"RegisterOGRDXF", "RegisterOGRGeoJSON", "RegisterOGRCSV"}) {
    void (*register_driver)() = nullptr;
    find_function(library, driver, register_driver);
    register_driver();
  }
  return functions;
}

}  // namespace

const Gdal& gdal() {
  static const Gdal functions = load_gdal();
  return functions;
}

QuietGdal::QuietGdal() {
  gdal().CPLPushErrorHandler(gdal().CPLQuietErrorHandler);
  gdal().CPLSetThreadLocalConfigOption(kMergeBlocks, "NO");
  gdal().CPLSetThreadLocalConfigOption(kEncoding, "UTF-8");
  gdal().CPLErrorReset();
}

QuietGdal::~QuietGdal() {
  gdal().CPLSetThreadLocalConfigOption(kMergeBlocks, nullptr);
  gdal().CPLSetThreadLocalConfigOption(kEncoding, nullptr);
  gdal().CPLPopErrorHandler();
}

std::vector<Vec2> points_of(OGRGeometryH curve) {
  std::vector<Vec2> points;
  for (int i = 0; i < gdal().OGR_G_GetPointCount(curve); ++i) {
    points.emplace_back(gdal().OGR_G_GetX(curve, i), gdal().OGR_G_GetY(curve, i));
  }
  return points;
}

}  // namespace apothem
