#include "dem_server/polyhedron.hpp"

#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

namespace gabion::dem {
namespace {

/// Newell's normal of a face, unit.
Vec face_normal(const Polyhedron& body, const std::vector<int>& face) {
  Vec normal{};
  for (std::size_t k = 0; k < face.size(); ++k)
    normal += cross(body.vertices[face[k]], body.vertices[face[(k + 1) % face.size()]]);
  const double length = norm(normal);
  if (!(length > 0.0)) throw std::invalid_argument("a face has no area");
  return normal / splat(length);
}

void check_closed(const Polyhedron& body) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& face : body.faces)
    for (std::size_t k = 0; k < face.size(); ++k) ++edges[{face[k], face[(k + 1) % face.size()]}];
  for (const auto& [edge, count] : edges)
    if (count != 1 || !edges.count({edge.second, edge.first}))
      throw std::invalid_argument("the edge from corner " + std::to_string(edge.first) + " to " +
                                  std::to_string(edge.second) + " does not belong to exactly two faces");
}

void check_convex(const Polyhedron& body) {
  constexpr double tolerance = 1e-6;  // of the size
  const double size = std::cbrt(body.volume);
  for (std::size_t f = 0; f < body.faces.size(); ++f)
    for (std::size_t v = 0; v < body.vertices.size(); ++v)
      if (dot(body.vertices[v] - body.vertices[body.faces[f][0]], body.normals[f]) > tolerance * size)
        throw std::invalid_argument("corner " + std::to_string(v) + " lies outside face " + std::to_string(f) +
                                    ": the body is not convex, or a face is not plane or turns clockwise");
}

/// Volume, centroid and second moments from tetrahedra between the first corner and the faces' triangles.
void integrate(Polyhedron& body) {
  const Vec apex = body.vertices[0];
  double volume = 0.0, second[3][3] = {};
  Vec first{};
  for (const auto& face : body.faces)
    for (std::size_t k = 1; k + 1 < face.size(); ++k) {
      const Vec a = body.vertices[face[0]] - apex, b = body.vertices[face[k]] - apex,
                c = body.vertices[face[k + 1]] - apex;
      const double v = dot(a, cross(b, c)) / 6.0;
      volume += v;
      first += splat(v / 4.0) * (a + b + c);
      const Vec s = a + b + c;
      for (int p = 0; p < 3; ++p)
        for (int q = 0; q < 3; ++q) second[p][q] += v / 20.0 * (a[p] * a[q] + b[p] * b[q] + c[p] * c[q] + s[p] * s[q]);
    }
  if (!(volume > 0.0)) throw std::invalid_argument("the body has no volume, or its faces turn clockwise");
  const Vec centre = first / splat(volume);
  double trace = 0.0;
  for (int p = 0; p < 3; ++p)
    for (int q = 0; q < 3; ++q) second[p][q] = second[p][q] / volume - centre[p] * centre[q];
  for (int p = 0; p < 3; ++p) trace += second[p][p];
  for (int p = 0; p < 3; ++p)
    for (int q = 0; q < 3; ++q) body.inertia[p][q] = (p == q ? trace : 0.0) - second[p][q];
  body.volume = volume;
  body.centroid = apex + centre;
}

Vec nearest_on_segment(Vec x, Vec a, Vec b) {
  const Vec ab = b - a;
  const double t = std::fmin(1.0, std::fmax(0.0, dot(x - a, ab) / dot(ab, ab)));
  return a + splat(t) * ab;
}

}  // namespace

Polyhedron::Polyhedron(std::vector<Vec> corners, const std::vector<std::int32_t>& face_ptr,
                       const std::vector<std::int32_t>& face_vertices)
    : vertices(std::move(corners)) {
  if (vertices.size() < 4 || face_ptr.size() < 5 || face_ptr.front() != 0 ||
      static_cast<std::size_t>(face_ptr.back()) != face_vertices.size())
    throw std::invalid_argument("a body needs at least four corners and four faces, and face_ptr must fit");
  for (std::size_t f = 0; f + 1 < face_ptr.size(); ++f) {
    if (face_ptr[f + 1] < face_ptr[f] + 3)
      throw std::invalid_argument("face " + std::to_string(f) + " has fewer than three corners");
    faces.emplace_back(face_vertices.begin() + face_ptr[f], face_vertices.begin() + face_ptr[f + 1]);
    for (const int v : faces.back())
      if (v < 0 || static_cast<std::size_t>(v) >= vertices.size())
        throw std::invalid_argument("face " + std::to_string(f) + " names corner " + std::to_string(v));
  }
  check_closed(*this);
  integrate(*this);
  // about the centroid, so that a body far from the origin keeps its digits
  const Vec centre = centroid;
  for (Vec& v : vertices) v -= centre;
  for (const auto& face : faces) normals.push_back(face_normal(*this, face));
  check_convex(*this);
  for (Vec& v : vertices) v += centre;
}

void Polyhedron::move_to_axes(Vec origin, const Vec axes[3]) {
  const auto turned = [&](Vec x) { return vec(dot(x, axes[0]), dot(x, axes[1]), dot(x, axes[2])); };
  for (Vec& v : vertices) v = turned(v - origin);
  for (Vec& n : normals) n = turned(n);
  centroid = turned(centroid - origin);
}

double Polyhedron::radius() const {
  double largest = 0.0;
  for (const Vec v : vertices) largest = std::fmax(largest, norm(v));
  return largest;
}

NearestPoint nearest_point(const Polyhedron& body, Vec x) {
  double deepest = -INFINITY;
  std::size_t shallow_face = 0;
  for (std::size_t f = 0; f < body.faces.size(); ++f) {
    const double height = dot(x - body.vertices[body.faces[f][0]], body.normals[f]);
    if (height > deepest) {
      deepest = height;
      shallow_face = f;
    }
  }
  if (deepest <= 0.0) return {deepest, body.normals[shallow_face]};

  double best = INFINITY;
  Vec best_point{};
  const auto consider = [&](Vec point) {
    const double square = dot(x - point, x - point);
    if (square < best) {
      best = square;
      best_point = point;
    }
  };
  for (std::size_t f = 0; f < body.faces.size(); ++f) {
    const auto& face = body.faces[f];
    const double height = dot(x - body.vertices[face[0]], body.normals[f]);
    if (height <= 0.0) continue;
    bool within = true;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Vec a = body.vertices[face[k]], b = body.vertices[face[(k + 1) % face.size()]];
      if (dot(cross(body.normals[f], b - a), x - a) >= 0.0) continue;
      within = false;
      consider(nearest_on_segment(x, a, b));
    }
    if (within) consider(x - splat(height) * body.normals[f]);
  }
  const double distance = std::sqrt(best);
  if (distance <= 1e-300) return {0.0, body.normals[shallow_face]};
  return {distance, (x - best_point) / splat(distance)};
}

}  // namespace gabion::dem
