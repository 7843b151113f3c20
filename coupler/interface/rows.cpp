#include "coupler/interface/rows.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

namespace gabion::coupler {

namespace {

constexpr double negligible = 1e-12;          // shape function values below are left out
constexpr double fewest_grains_per_row = 8.0;  // below, a row joins its neighbour: measured, condition stays under 500

struct TiedGrain {
  std::int32_t grain;
  double share;
};

/// Point x moved out of the hole across its nearest face, by a hair of the cell size.
Point out_of_hole(const Zone& zone, const Point& x, double hair) {
  if (zone.beyond_inner(x) >= 0.0) return x;
  Point moved = x;
  double nearest = scene::infinity;
  int axis_out = 0;
  double target = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const Box& hole = zone.inner();
    if (x[axis] - hole.lo[axis] < nearest) nearest = x[axis] - hole.lo[axis], axis_out = axis, target = hole.lo[axis] - hair;
    if (hole.hi[axis] - x[axis] < nearest) nearest = hole.hi[axis] - x[axis], axis_out = axis, target = hole.hi[axis] + hair;
  }
  moved[axis_out] = target;
  return moved;
}

/// Projection of x on the nearest outer face.
Point on_border(const Zone& zone, const Point& x) {
  Point projected = x;
  const int face = zone.nearest_outer_face(x);
  projected[face / 2] = zone.face_position(face);
  return projected;
}

std::vector<TiedGrain> grains_of_overlap(const Zone& zone, const GrainSet& grains) {
  std::vector<TiedGrain> tied;
  for (std::size_t i = 0; i < grains.position.size(); ++i) {
    const double share = zone.overlap_share(grains.position[i], grains.radius[i]);
    if (share > 0.0) tied.push_back({static_cast<std::int32_t>(i), share});
  }
  return tied;
}

std::vector<TiedGrain> grains_of_border(const Zone& zone, const GrainSet& grains, double reach) {
  std::vector<TiedGrain> tied;
  for (std::size_t i = 0; i < grains.position.size(); ++i)
    if (std::fabs(zone.beyond_outer(grains.position[i])) < reach * grains.radius[i] * (1 + 1e-9))
      tied.push_back({static_cast<std::int32_t>(i), 1.0});
  return tied;
}

/// Joins multiplier nodes that carry too few grains with the nearest one that carries enough.
/// Returns for each hat the row it belongs to.
std::vector<std::int32_t> merge_poor_hats(const std::vector<double>& grains_per_hat, const std::vector<Point>& position,
                                          InterfaceRows& rows) {
  std::vector<std::int32_t> row_of_hat(grains_per_hat.size(), -1);
  std::vector<std::size_t> kept;
  const double enough = std::min(fewest_grains_per_row, *std::max_element(grains_per_hat.begin(), grains_per_hat.end()));
  for (std::size_t k = 0; k < grains_per_hat.size(); ++k)
    if (grains_per_hat[k] >= enough) {
      row_of_hat[k] = static_cast<std::int32_t>(kept.size());
      kept.push_back(k);
      rows.slot_position.push_back(position[k]);
    }
  for (std::size_t k = 0; k < row_of_hat.size(); ++k) {
    if (row_of_hat[k] >= 0) continue;
    const auto distance = [&](std::size_t other) {
      double square = 0.0;
      for (int axis = 0; axis < 3; ++axis) square += std::pow(position[k][axis] - position[other][axis], 2);
      return square;
    };
    const auto nearest = std::min_element(kept.begin(), kept.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
    row_of_hat[k] = row_of_hat[*nearest];
    ++rows.merged_rows;
  }
  return row_of_hat;
}

/// Sorted, summed entries of one row.
void push_row(SparseRows& rows, const std::map<std::int32_t, double>& entries) {
  for (const auto& [column, value] : entries) rows.push(column, value);
  rows.end_row();
}

InterfaceRows gap_rows(const std::string& scheme, const HexMesh& mesh, const Zone& zone, const GrainSet& grains,
                       const std::vector<TiedGrain>& tied) {
  InterfaceRows rows;
  rows.kind = InterfaceRows::Kind::gap;
  rows.grain_count = tied.size();
  Grid multiplier_grid = mesh.grid;
  if (scheme == "mortar2h") {
    std::array<std::vector<double>, 3> kept;
    for (int axis = 0; axis < 3; ++axis)
      for (const Box* box : {&zone.outer(), &zone.inner()})
        for (const double p : {box->lo[axis], box->hi[axis]})
          if (std::isfinite(p)) kept[axis].push_back(p);
    multiplier_grid = mesh.grid.coarsened(kept);
  }
  const double hair = 1e-6 * (mesh.grid.lines(0)[1] - mesh.grid.lines(0)[0]);

  // hats: grid nodes of the multiplier mesh that some grain touches
  std::map<std::int64_t, std::int32_t> hat_of_node;
  std::vector<Stencil> hats_at_grain;
  for (const TiedGrain& t : tied) {
    const Point& x = grains.position[t.grain];
    const Point at = scheme == "edge_hats" ? on_border(zone, x) : x;
    Stencil s = multiplier_grid.stencil(multiplier_grid.locate(out_of_hole(zone, at, hair)), at);
    for (int c = 0; c < 8; ++c)
      if (std::fabs(s.value[c]) > negligible) hat_of_node.emplace(s.node[c], 0);
    hats_at_grain.push_back(s);
  }
  std::vector<Point> hat_position;
  for (auto& [node, hat] : hat_of_node) {
    hat = static_cast<std::int32_t>(hat_position.size());
    hat_position.push_back(multiplier_grid.node_position(node));
  }
  std::vector<double> grains_per_hat(hat_position.size(), 0.0);
  for (std::size_t t = 0; t < tied.size(); ++t)
    for (int c = 0; c < 8; ++c)
      if (hats_at_grain[t].value[c] > negligible)
        grains_per_hat[hat_of_node.at(hats_at_grain[t].node[c])] += tied[t].share;
  const std::vector<std::int32_t> row_of_hat = merge_poor_hats(grains_per_hat, hat_position, rows);
  rows.slots = rows.slot_position.size();

  // G_d and the hats per grain, then G_c = -G_d N
  std::vector<std::map<std::int32_t, double>> grain_entries(rows.slots), node_entries(rows.slots);
  std::vector<double> scale(rows.slots, 0.0);
  for (std::size_t t = 0; t < tied.size(); ++t) {
    const std::int32_t i = tied[t].grain;
    std::map<std::int32_t, double> hats;
    for (int c = 0; c < 8; ++c)
      if (std::fabs(hats_at_grain[t].value[c]) > negligible)
        hats[row_of_hat[hat_of_node.at(hats_at_grain[t].node[c])]] += hats_at_grain[t].value[c];
    const Stencil shape = mesh.stencil(zone, grains.position[i]);
    for (const auto& [row, phi] : hats) {
      const double coefficient = grains.plain_mass[i] * tied[t].share * phi;
      grain_entries[row][i] -= coefficient;
      scale[row] += coefficient;
      for (int c = 0; c < 8; ++c)
        if (std::fabs(shape.value[c]) > negligible)
          node_entries[row][static_cast<std::int32_t>(shape.node[c])] += coefficient * shape.value[c];
      rows.hats.push(row, phi);
    }
    rows.hats.end_row();
    rows.hat_grains.push_back(i);
    rows.share.push_back(tied[t].share);
  }
  for (std::size_t r = 0; r < rows.slots; ++r) {
    for (auto* entries : {&grain_entries[r], &node_entries[r]})
      for (auto& [column, value] : *entries) value /= scale[r];
    push_row(rows.grains, grain_entries[r]);
    push_row(rows.nodes, node_entries[r]);
  }
  return rows;
}

InterfaceRows slave_rows(const std::string& scheme, const HexMesh& mesh, const Zone& zone, const GrainSet& grains,
                         const std::vector<TiedGrain>& tied) {
  InterfaceRows rows;
  rows.kind = InterfaceRows::Kind::slave;
  rows.grain_count = tied.size();
  std::map<std::int32_t, std::int32_t> slot_of_node;
  std::vector<Stencil> stencils;
  for (const TiedGrain& t : tied) {
    const Point& x = grains.position[t.grain];
    stencils.push_back(mesh.stencil(zone, x, scheme == "edge_projected" ? on_border(zone, x) : x));
    for (int c = 0; c < 8; ++c)
      if (std::fabs(stencils.back().value[c]) > negligible)
        slot_of_node.emplace(static_cast<std::int32_t>(stencils.back().node[c]), 0);
  }
  for (auto& [node, slot] : slot_of_node) {
    slot = static_cast<std::int32_t>(rows.slots++);
    rows.tied_nodes.push_back(node);
    rows.nodes.push(slot, 1.0);
    rows.nodes.end_row();
    rows.slot_position.push_back(mesh.nodes[node]);
  }
  for (std::size_t t = 0; t < tied.size(); ++t) {
    std::map<std::int32_t, double> entries;
    for (int c = 0; c < 8; ++c)
      if (std::fabs(stencils[t].value[c]) > negligible)
        entries[slot_of_node.at(static_cast<std::int32_t>(stencils[t].node[c]))] += stencils[t].value[c];
    rows.tied_grains.push_back(tied[t].grain);
    push_row(rows.grains, entries);
  }
  return rows;
}

}  // namespace

bool is_gap_scheme(const std::string& scheme) {
  return scheme == "mortar" || scheme == "mortar2h" || scheme == "edge_hats";
}

InterfaceRows build_rows(const std::string& scheme, const HexMesh& mesh, const Zone& zone, const GrainSet& grains,
                         double reach) {
  const bool edge = scheme.starts_with("edge");
  const std::vector<TiedGrain> tied = edge ? grains_of_border(zone, grains, reach) : grains_of_overlap(zone, grains);
  if (tied.empty())
    throw std::runtime_error(edge ? "no grain lies within coupling.reach radii of the border; a lattice with planes s "
                                    "apart needs a reach of at least s/2: raise coupling.reach or move the zone's face"
                                  : "no grain lies in the overlap; enlarge coupling.overlap or check grains.zone");
  if (is_gap_scheme(scheme)) return gap_rows(scheme, mesh, zone, grains, tied);
  if (scheme != "strict") return slave_rows(scheme, mesh, zone, grains, tied);
  std::vector<TiedGrain> centred;  // strict ties by the centre alone
  for (const TiedGrain& t : tied)
    if (zone.beyond_inner(grains.position[t.grain]) >= -1e-9 * grains.radius[t.grain]) centred.push_back(t);
  return slave_rows(scheme, mesh, zone, grains, centred);
}

}  // namespace gabion::coupler
