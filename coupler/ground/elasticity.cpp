#include "coupler/ground/elasticity.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace gabion::coupler {

Stiffness isotropic_stiffness(double young, double poisson) {
  if (!(young > 0.0)) throw std::invalid_argument("Young's modulus must be above 0, is " + std::to_string(young));
  if (!(poisson > -1.0 && poisson < 0.5))
    throw std::invalid_argument("Poisson's ratio must lie between -1 and 0.5, is " + std::to_string(poisson));
  const double shear = young / (2.0 * (1.0 + poisson));
  const double lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
  Stiffness c{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) c[i][j] = lambda;
    c[i][i] += 2.0 * shear;
    c[i + 3][i + 3] = shear;
  }
  return c;
}

IsotropicFit isotropic_fit(const Stiffness& c) {
  double trace_ij = 0.0;  // C_iijj
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) trace_ij += c[i][j];
  const double full = c[0][0] + c[1][1] + c[2][2] + 2.0 * (c[3][3] + c[4][4] + c[5][5]);  // C_ijij
  const double bulk = trace_ij / 9.0, shear = (3.0 * full - trace_ij) / 30.0;
  IsotropicFit fit;
  fit.young = 9.0 * bulk * shear / (3.0 * bulk + shear);
  fit.poisson = (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear));
  const Stiffness iso = isotropic_stiffness(fit.young, fit.poisson);
  double rest = 0.0, total = 0.0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const double kelvin = (i < 3 ? 1.0 : 2.0) * (j < 3 ? 1.0 : 2.0);
      rest += kelvin * std::pow(c[i][j] - iso[i][j], 2);
      total += kelvin * c[i][j] * c[i][j];
    }
  fit.misfit = std::sqrt(rest / total);
  return fit;
}

double p_modulus(const Stiffness& c, int axis) { return c[axis][axis]; }

double s_modulus(const Stiffness& c, int axis) {
  // shear components that involve the axis: yz 3, zx 4, xy 5
  const int first = axis == 0 ? 4 : 3, second = axis == 2 ? 4 : 5;
  return 0.5 * (c[first][first] + c[second][second]);
}

}  // namespace gabion::coupler
