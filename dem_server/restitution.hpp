#pragma once
// Damping of a linear spring and dashpot that cannot pull, from its coefficient of restitution.

namespace gabion::dem {

/// Damping ratio gamma = c/(2 sqrt(k m*)) with which two bodies part at e times the speed at which they met, when
/// nothing else acts on them (Schwager & Poeschel 2007, who let contact end when the force falls to zero, which is
/// before the elongation does):
///
///   -ln e = (pi - 2 phi) tan phi,   gamma = sin phi     up to critical damping, e = exp(-2)
///   -ln e = 2 eta coth eta,         gamma = cosh eta    beyond it
///
/// restitution: above 0, at most 1 (gives exactly 0).
double damping_ratio(double restitution);

}  // namespace gabion::dem
