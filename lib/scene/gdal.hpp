// GDAL, the library that reads drawings. It brings a hundred other libraries along, which take 0.15
// s to load. So no program is linked with it: it is loaded when the first drawing is read.
#pragma once

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

#include <vector>

#include "geometry/polygon/point.hpp"

// The functions of GDAL that are used, by their own names.
#define APOTHEM_GDAL_FUNCTIONS(F)  \
  F(CPLErrorReset)                 \
  F(CPLGetLastErrorMsg)            \
  F(CPLGetLastErrorType)           \
  F(CPLPopErrorHandler)            \
  F(CPLPushErrorHandler)           \
  F(CPLQuietErrorHandler)          \
  F(CPLSetThreadLocalConfigOption) \
  F(GDALClose)                     \
  F(GDALDatasetGetLayer)           \
  F(GDALDatasetGetLayerCount)      \
  F(GDALOpenEx)                    \
  F(OGRGetGEOSVersion)             \
  F(OGR_F_Destroy)                 \
  F(OGR_F_GetFieldAsString)        \
  F(OGR_F_GetFieldCount)           \
  F(OGR_F_GetFieldDefnRef)         \
  F(OGR_F_GetGeometryRef)          \
  F(OGR_F_GetStyleString)          \
  F(OGR_Fld_GetNameRef)            \
  F(OGR_GT_Flatten)                \
  F(OGR_G_AddGeometry)             \
  F(OGR_G_AddPoint_2D)             \
  F(OGR_G_CreateFromWkt)           \
  F(OGR_G_CreateGeometry)          \
  F(OGR_G_DestroyGeometry)         \
  F(OGR_G_GetGeometryCount)        \
  F(OGR_G_GetGeometryRef)          \
  F(OGR_G_GetGeometryType)         \
  F(OGR_G_GetLinearGeometry)       \
  F(OGR_G_GetPointCount)           \
  F(OGR_G_GetX)                    \
  F(OGR_G_GetY)                    \
  F(OGR_G_Polygonize)              \
  F(OGR_G_Union)                   \
  F(OGR_L_GetNextFeature)          \
  F(OSRDestroySpatialReference)    \
  F(OSRGetLinearUnits)             \
  F(OSRIsGeographic)               \
  F(OSRNewSpatialReference)        \
  F(OSRSetFromUserInput)           \
  F(VSIFCloseL)                    \
  F(VSIFileFromMemBuffer)          \
  F(VSIUnlink)

namespace apothem {

struct Gdal {
#define APOTHEM_POINTER(name) decltype(&::name) name;
  APOTHEM_GDAL_FUNCTIONS(APOTHEM_POINTER)
#undef APOTHEM_POINTER
};

/// The functions of GDAL, with the drivers for DXF, GeoJSON and CSV registered. Throws
/// std::runtime_error if the library is not installed.
const Gdal& gdal();

/// Keeps GDAL from printing its errors, which are thrown instead, and says how it reads drawings.
class QuietGdal {
 public:
  QuietGdal();
  ~QuietGdal();
  QuietGdal(const QuietGdal&) = delete;
  QuietGdal& operator=(const QuietGdal&) = delete;
};

/// Owns a geometry of GDAL.
class Geometry {
 public:
  explicit Geometry(OGRGeometryH handle) : handle_(handle) {}
  ~Geometry() { gdal().OGR_G_DestroyGeometry(handle_); }
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;
  [[nodiscard]] OGRGeometryH get() const { return handle_; }

 private:
  OGRGeometryH handle_;
};

/// The points of a line or a ring.
std::vector<Vec2> points_of(OGRGeometryH curve);

}  // namespace apothem
