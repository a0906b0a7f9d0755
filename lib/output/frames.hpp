// The VTK time series: frames.pvd with one .vtu per frame for the bodies, contacts.pvd for the
// contact patches. Opens in ParaView.
#pragma once

#include <string>
#include <vector>

#include "model/model.hpp"
#include "model/state.hpp"

namespace apothem {

class FrameWriter {
 public:
  /// Creates the folder. Throws SystemFailure.
  FrameWriter(std::string folder, const Model& model);

  /// Writes the next frame, then both collections: whatever they list is complete on disk.
  /// Throws SystemFailure; the earlier frames are then intact.
  void write(const State& state, const std::vector<ContactRecord>& contacts);

  [[nodiscard]] int frames() const { return frames_; }

 private:
  std::string folder_;
  const Model& model_;
  int frames_ = 0;
  std::string bodies_collection_, contacts_collection_;
};

}  // namespace apothem
