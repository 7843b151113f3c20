#pragma once
// The constraint rows that tie grains to nodes.
//
// Gap schemes (multipliers live on a mesh), normalised so that the grains' coefficients of a row sum to -1
// and a multiplier is an impulse (N s):
//   mortar, mortar2h   G_d(K,i) = -m_i q_i Phi_K(x_i)/s_K,   G_c = -G_d N,   s_K = sum_i m_i q_i Phi_K(x_i)
//   edge_hats          the same with q = 1 and Phi_K at the projection of x_i on the border
// Slave schemes (each tied grain follows the mesh), u_i = sum_J N_J u_J:
//   strict             N at the grain, grains of the overlap
//   edge               N of the border element at the grain, extrapolated
//   edge_projected     N at the projection of the grain on the border (4 nodes)
//
//   m_i  plain mass of grain i [kg]     q_i  its share inside the overlap     Phi_K  multiplier hat
// Sources: Xiao & Belytschko 2004 (strict), Frangin et al. 2006, Voisin-Leprince et al. 2023 (weak form).

#include <cstdint>
#include <string>
#include <vector>

#include "coupler/ground/mesh.hpp"
#include "coupler/ground/zone.hpp"

namespace gabion::coupler {

/// Compressed sparse rows.
struct SparseRows {
  std::vector<std::int32_t> row_ptr{0}, columns;
  std::vector<double> values;

  std::size_t rows() const { return row_ptr.size() - 1; }
  void push(std::int32_t column, double value) {
    columns.push_back(column);
    values.push_back(value);
  }
  void end_row() { row_ptr.push_back(static_cast<std::int32_t>(columns.size())); }
};

/// Grains as the interface sees them.
struct GrainSet {
  std::vector<Point> position;     ///< m
  std::vector<double> radius;      ///< m
  std::vector<double> plain_mass;  ///< kg
};

struct InterfaceRows {
  enum class Kind { gap, slave };
  Kind kind = Kind::gap;
  std::size_t slots = 0;  ///< rows on the wire

  SparseRows grains;  ///< gap: rows over grains; slave: one row per tied grain over slots
  SparseRows nodes;   ///< gap: rows over nodes; slave: one row per tied node, itself a slot
  std::vector<std::int32_t> tied_grains, tied_nodes;  ///< slave only

  // The multiplier mesh's hats at the overlap's grains, for the sponge (gap schemes)
  std::vector<std::int32_t> hat_grains;
  SparseRows hats;
  std::vector<double> share;  ///< q of hat_grains

  std::size_t grain_count = 0;   ///< grains that the rows tie
  std::size_t merged_rows = 0;   ///< rows joined with a neighbour for want of grains
  std::vector<Point> slot_position;  ///< where each row sits, m
};

/// True for schemes that project mean motion (gap), false for those that slave grains.
bool is_gap_scheme(const std::string& scheme);

/// scheme as in the scene's coupling.rows; reach in radii, for the edge schemes. Throws std::runtime_error
/// with what to do when nothing would be tied.
InterfaceRows build_rows(const std::string& scheme, const HexMesh& mesh, const Zone& zone, const GrainSet& grains,
                         double reach);

}  // namespace gabion::coupler
