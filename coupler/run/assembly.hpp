#pragma once
// What a scene in one of its models is made of, before anything is sent to an engine.

#include <cstdint>
#include <vector>

#include "coupler/ground/elasticity.hpp"
#include "coupler/ground/face_layers.hpp"
#include "coupler/ground/grains.hpp"
#include "coupler/ground/mesh.hpp"
#include "coupler/interface/rows.hpp"
#include "coupler/scene/scene.hpp"

namespace gabion::coupler {

struct Assembly {
  bool has_grains = false, has_mesh = false;
  Zone zone;
  std::vector<std::int32_t> origin;    ///< index in the packing of each grain
  GrainSet grains;                     ///< plain masses filled in by configure_dem
  std::vector<std::int32_t> material;  ///< of each grain, index into scene.materials
  double bond_gap = 0.0;
  std::vector<std::int32_t> clump;  ///< of each grain, -1 for single ones; empty without clumps; filled in by configure_dem
  HexMesh mesh;
  Elasticity elasticity;
  FaceLayers layers;  ///< of the mesh

  bool coupled() const { return has_grains && has_mesh; }
};

bool uses_grains(scene::Model model);
bool uses_mesh(scene::Model model);
/// True when the scene needs the stiffness of the packing: for the mesh, or for absorbing faces.
bool needs_elasticity(const scene::Scene& scene);

/// Where zone, mesh and grains come from; see design notes in docs/theory.md.
Assembly assemble(const scene::Scene& scene, const Packing& packing, const Elasticity& elasticity);

/// The part of the ground that the continuum replaces (bounding box), at least two mean diameters inside the
/// packing: where its stiffness is measured.
Box homogenisation_window(const scene::Scene& scene, const Packing& packing);

}  // namespace gabion::coupler
