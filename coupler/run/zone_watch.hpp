#pragma once
// Was the zone of the grains large enough? The mesh is linear: ground that yields must be grains alone.
//
//   damage of a grain   share of its contacts that slide or are broken, largest so far
//   shell k             tied side of one outer face: grains whose distance inward from it lies in [k, k + 1) mean diameters
//   damaged share       of the contacts of a shell at one look, largest so far
//   missed              damaged share times 1 - w, the mesh's part there; above `tolerable_damage` the zone is too small, by as far
//                       as damage came from the inner end of the overlap towards that face
//   yield ratio         what the contacts of the overlap use of their strength, mean over them, largest so far; the mesh beside
//                       them carries the same load
//   unresolved energy   kinetic energy of the overlap's grains beside the motion that the mesh can follow, largest so far, J:
//                       sum of q_i m_i |v_i - sum_K Phi_K(x_i) v_K|^2/2, v_K = sum m_i q_i Phi_K v_i / sum m_i q_i Phi_K

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "coupler/ground/zone.hpp"
#include "coupler/interface/rows.hpp"

namespace gabion::coupler {

class ZoneWatch {
 public:
  static constexpr double tolerable_damage = 0.01;   ///< share of contacts
  static constexpr double tolerable_energy = 0.02;   ///< unresolved over the largest energy of the run
  static constexpr double fewest_contacts = 50;      ///< of a shell, below which its share says nothing

  /// rows may be null: without an interface only the damage of grains is kept.
  ZoneWatch(const Zone& zone, const GrainSet& grains, const InterfaceRows* rows);

  /// yield: [n][3], the engine's field of that name; velocity: [n][3], m/s, used where the rows have hats.
  void look(std::span<const double> yield, std::span<const double> velocity);
  bool needs_velocity() const { return rows_ && !rows_->hat_grains.empty(); }

  const std::vector<double>& damage() const { return damage_; }  ///< [n]

  /// False before the first look, and where the ground yields that the mesh shares.
  bool large_enough() const;
  /// What summary.json says under "zone"; null without an interface or before the first look. energy: largest of the run, J.
  nlohmann::json verdict(double energy) const;
  /// What needs attention, in words. tied_damage: largest share of the contacts of tied grains that slid or were broken.
  std::vector<std::string> advice(double energy, double tied_damage) const;

  /// For checkpoints.
  nlohmann::json memory() const;
  void remember(const nlohmann::json& memory);

 private:
  struct Shell {
    double contacts = 0.0, damaged = 0.0;  ///< of the present look
    double share = 0.0;                    ///< largest so far
    double sure = 0.0;                     ///< the same, less its standard error
  };
  double depth_of_damage(int face) const;
  double missed(int face) const;
  double unresolved(std::span<const double> velocity) const;

  Zone zone_;
  const InterfaceRows* rows_;
  std::vector<double> mass_;          ///< plain, of each grain, kg
  double width_ = 0.0;                ///< of a shell, m
  std::vector<std::int32_t> shell_;   ///< of each grain: index into shells_, -1 inside
  std::size_t shells_a_face_ = 0;
  std::size_t hats_ = 0;              ///< of the multiplier mesh
  std::vector<Shell> shells_;         ///< by face, then from the outer face inwards
  std::vector<double> damage_;
  double yield_ratio_ = 0.0, unresolved_ = 0.0;
  bool looked_ = false;
};

}  // namespace gabion::coupler
