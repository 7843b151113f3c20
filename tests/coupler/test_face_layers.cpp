#include <catch2/catch.hpp>

#include "coupler/ground/face_layers.hpp"
#include "tests/coupler/sample.hpp"

using namespace sample;
using coupler::FaceLayers;
using coupler::face_layers;

namespace {

constexpr double hole_top = 12.0, top = 24.0;  // the sample has elements above 12 m; its face zmax is the sixth

const Ground& ground() {
  static const Ground g = Ground::make(half, 3.0, 1.5, false);
  return g;
}

double factor_of(const FaceLayers& layers, std::size_t element) {
  return layers.factor[static_cast<std::size_t>(layers.material[element])];
}

/// What a column of elements through a point gives way under unit stress and modulus.
double compliance(const FaceLayers& layers, double x, double y, double from, double to) {
  const coupler::HexMesh& mesh = ground().mesh;
  double total = 0.0;
  for (std::size_t e = 0; e < mesh.cells.size(); ++e) {
    const Point centre = mesh.grid.cell_centre(mesh.cells[e]);
    const auto& z = mesh.grid.lines(2);
    const auto k = static_cast<std::size_t>(mesh.cells[e][2]);
    const bool here = mesh.grid.locate({x, y, centre[2]}) == mesh.cells[e] && z[k] >= from - 1e-9 && z[k + 1] <= to + 1e-9;
    if (here) total += (z[k + 1] - z[k]) / factor_of(layers, e);
  }
  return total;
}

}  // namespace

TEST_CASE("no offset leaves the mesh as it is", "[face_layers]") {
  const FaceLayers layers = face_layers(ground().mesh, {});
  CHECK(layers.factor == std::vector<double>{1.0});
  CHECK(layers.material == std::vector<std::int32_t>(ground().mesh.elements.size(), 0));
}

TEST_CASE("a held face shortens or lengthens the mesh by its offset", "[face_layers]") {
  for (const double offset : {0.3, 0.9, -0.4, 1e-6}) {
    const FaceLayers layers = face_layers(ground().mesh, {0, 0, 0, 0, 0, offset});
    CHECK(compliance(layers, 6, 6, hole_top, top) == Approx(top - hole_top - offset).epsilon(1e-12));
    for (const double factor : layers.factor) {
      CHECK(factor >= 0.8);
      CHECK(factor <= 4.0 / 3.0 + 1e-12);
    }
  }
}

TEST_CASE("a layer is as many elements thick as four offsets take", "[face_layers]") {
  const coupler::HexMesh& mesh = ground().mesh;
  for (const double offset : {0.3, 0.9}) {
    const FaceLayers layers = face_layers(mesh, {0, 0, 0, 0, 0, offset});
    double lowest = top;
    for (std::size_t e = 0; e < mesh.cells.size(); ++e)
      if (layers.material[e] != 0) lowest = std::min(lowest, mesh.grid.lines(2)[static_cast<std::size_t>(mesh.cells[e][2])]);
    CHECK(top - lowest >= 4.0 * offset);
    CHECK(top - lowest - 1.5 - 1e-9 < 4.0 * offset);
  }
}

TEST_CASE("where two layers meet both factors count", "[face_layers]") {
  const FaceLayers layers = face_layers(ground().mesh, {0.2, 0, 0, 0.1, 0, 0.3});
  const FaceLayers x = face_layers(ground().mesh, {0.2, 0, 0, 0, 0, 0}), y = face_layers(ground().mesh, {0, 0, 0, 0.1, 0, 0}),
                   z = face_layers(ground().mesh, {0, 0, 0, 0, 0, 0.3});
  for (std::size_t e = 0; e < layers.material.size(); ++e)
    CHECK(factor_of(layers, e) == Approx(factor_of(x, e) * factor_of(y, e) * factor_of(z, e)).epsilon(1e-14));
}
