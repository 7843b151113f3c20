#include "dem_server/packing/isotropy.hpp"

#include <cmath>

namespace gabion::dem {
namespace {

/// Norm of the fourth-order tensor: each shear index stands for two components.
double tensor_norm(const Stiffness& c) {
  Eigen::Matrix<double, 6, 1> weight;
  weight << 1.0, 1.0, 1.0, 2.0, 2.0, 2.0;
  return std::sqrt((weight * weight.transpose()).cwiseProduct(c.cwiseProduct(c)).sum());
}

Stiffness from_moduli(double bulk, double shear) {
  Stiffness c = Stiffness::Zero();
  c.topLeftCorner<3, 3>().setConstant(bulk - 2.0 / 3.0 * shear);
  c.diagonal().head<3>().array() += 2.0 * shear;
  c.diagonal().tail<3>().setConstant(shear);
  return c;
}

}  // namespace

Isotropic isotropic_part(const Stiffness& stiffness) {
  const double iijj = stiffness.topLeftCorner<3, 3>().sum();
  const double ijij = stiffness.diagonal().head<3>().sum() + 2.0 * stiffness.diagonal().tail<3>().sum();
  Isotropic part;
  part.bulk = iijj / 9.0;
  part.shear = (3.0 * ijij - iijj) / 30.0;
  const double denominator = 3.0 * part.bulk + part.shear;
  if (denominator == 0.0) return part;
  part.young = 9.0 * part.bulk * part.shear / denominator;
  part.poisson = (3.0 * part.bulk - 2.0 * part.shear) / (2.0 * denominator);
  part.misfit = tensor_norm(stiffness - from_moduli(part.bulk, part.shear)) / tensor_norm(stiffness);
  return part;
}

Stiffness isotropic_stiffness(double young, double poisson) {
  return from_moduli(young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)));
}

}  // namespace gabion::dem
