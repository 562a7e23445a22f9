#include "core/tetmesh/stuffing/cut_stencils.h"

#include <cstddef>

namespace softreel {
namespace {

using Vertex = std::uint8_t;

/// The lattice tetrahedron in a positive orientation, doubled so that midpoints are integers.
constexpr std::array<std::array<int, 3>, 4> kCorners{{{0, 0, 0}, {0, 0, 4}, {-2, -2, 2}, {2, -2, 2}}};

constexpr std::array<int, 3> vertex_place(Vertex v) {
  if (v < 4) return kCorners[v];
  const auto [a, b] = kStencilEdges[v - 4U];
  std::array<int, 3> middle{};
  for (std::size_t k = 0; k < 3; ++k) middle[k] = (kCorners[a][k] + kCorners[b][k]) / 2;
  return middle;
}

constexpr int orientation(const StencilTet& tet) {
  const auto o = vertex_place(tet[0]);
  std::array<std::array<int, 3>, 3> d{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) d[i][k] = vertex_place(tet[i + 1])[k] - o[k];
  return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

constexpr void add(CutStencil& stencil, Vertex a, Vertex b, Vertex c, Vertex d) {
  StencilTet tet{a, b, c, d};
  if (orientation(tet) < 0) tet = {a, b, d, c};
  stencil.tets[stencil.count++] = tet;
}

constexpr Vertex cut(Vertex a, Vertex b) {
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [p, q] = kStencilEdges[e];
    if ((p == a && q == b) || (p == b && q == a)) return static_cast<Vertex>(4 + e);
  }
  return 0xff;
}

constexpr bool is_long(Vertex a, Vertex b) {
  return a / 2 == b / 2;
}

/// The rule of whole lattice tetrahedra. Joined by a long edge, the diagonal starts at its even end; joined by a short
/// one, it ends at the cut of the long edge.
constexpr DiagonalRule make_lattice_rule() {
  DiagonalRule rule;
  for (Vertex p = 0; p < 4; ++p)
    for (Vertex q = 0; q < 4; ++q)
      for (Vertex r = 0; r < 4; ++r) rule.starts_at_first[p][q][r] = is_long(p, q) ? p % 2 == 0 : is_long(q, r);
  return rule;
}

/// A prism (bottom[i], top[i]), i = 0..2, whose side (i, j) is split along bottom[i] - top[j] if `before[i][j]`. The
/// diagonals order the columns; without an order there would be no such split.
struct Prism {
  std::array<Vertex, 3> bottom{}, top{};
  std::array<std::array<bool, 3>, 3> before{};

  constexpr void set_before(std::size_t i, std::size_t j, bool value) {
    before[i][j] = value;
    before[j][i] = !value;
  }
};

constexpr void add_prism(CutStencil& stencil, const Prism& prism) {
  std::array<std::size_t, 3> order{};
  for (std::size_t i = 0; i < 3; ++i) {
    std::size_t rank = 0;
    for (std::size_t j = 0; j < 3; ++j) rank += j != i && prism.before[j][i] ? 1U : 0U;
    order[rank] = i;
  }
  const auto [a, b, c] = order;
  add(stencil, prism.bottom[a], prism.bottom[b], prism.bottom[c], prism.top[c]);
  add(stencil, prism.bottom[a], prism.bottom[b], prism.top[b], prism.top[c]);
  add(stencil, prism.bottom[a], prism.top[a], prism.top[b], prism.top[c]);
}

/// Nodes of one sign, in ascending order.
struct NodeList {
  std::array<Vertex, 4> nodes{};
  std::size_t count = 0;
  constexpr void add(Vertex v) { nodes[count++] = v; }
  constexpr Vertex operator[](std::size_t i) const { return nodes[i]; }
};

constexpr void add_one_inside(CutStencil& stencil, Vertex p, const NodeList& outside, const NodeList& surface) {
  std::array<Vertex, 3> others{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < outside.count; ++i) others[n++] = cut(p, outside[i]);
  for (std::size_t i = 0; i < surface.count; ++i) others[n++] = surface[i];
  add(stencil, p, others[0], others[1], others[2]);
}

constexpr void add_pyramid(CutStencil& stencil, const DiagonalRule& rule, Vertex p, Vertex q, Vertex outside,
                           Vertex apex) {
  if (!rule.starts_at_first[p][q][outside]) {
    const Vertex swap = p;
    p = q;
    q = swap;
  }
  add(stencil, p, q, cut(q, outside), apex);
  add(stencil, p, cut(p, outside), cut(q, outside), apex);
}

/// Two nodes inside, two outside. The diagonal of the surface's own quadrilateral is nobody else's: it closes the order
/// where the two faces leave no choice, and starts at the lower outside node where they do.
constexpr void add_wedge(CutStencil& stencil, const DiagonalRule& rule, Vertex p, Vertex q, Vertex r, Vertex s) {
  Prism prism{{p, cut(p, r), cut(p, s)}, {q, cut(q, r), cut(q, s)}, {}};
  const bool r_after = rule.starts_at_first[p][q][r], s_after = rule.starts_at_first[p][q][s];
  prism.set_before(0, 1, r_after);
  prism.set_before(0, 2, s_after);
  prism.set_before(1, 2, r_after == s_after ? true : s_after);
  add_prism(stencil, prism);
}

constexpr void add_three_inside(CutStencil& stencil, const DiagonalRule& rule, const NodeList& inside, Vertex outside) {
  Prism prism;
  for (std::size_t i = 0; i < 3; ++i) {
    prism.bottom[i] = inside[i];
    prism.top[i] = cut(inside[i], outside);
    for (std::size_t j = i + 1; j < 3; ++j) prism.set_before(i, j, rule.starts_at_first[inside[i]][inside[j]][outside]);
  }
  add_prism(stencil, prism);
}

constexpr std::size_t kPatterns = 81;

constexpr CutStencil make_stencil(const std::array<NodeSign, 4>& signs, const DiagonalRule& rule) {
  NodeList inside, surface, outside;
  for (Vertex v = 0; v < 4; ++v) {
    if (signs[v] == NodeSign::Inside) inside.add(v);
    if (signs[v] == NodeSign::Surface) surface.add(v);
    if (signs[v] == NodeSign::Outside) outside.add(v);
  }
  CutStencil stencil;
  if (inside.count == 0) return stencil;
  if (outside.count == 0)
    add(stencil, 0, 1, 2, 3);
  else if (inside.count == 1)
    add_one_inside(stencil, inside[0], outside, surface);
  else if (inside.count == 3)
    add_three_inside(stencil, rule, inside, outside[0]);
  else if (outside.count == 1)
    add_pyramid(stencil, rule, inside[0], inside[1], outside[0], surface[0]);
  else
    add_wedge(stencil, rule, inside[0], inside[1], outside[0], outside[1]);
  return stencil;
}

constexpr std::array<CutStencil, kPatterns> make_stencils() {
  std::array<CutStencil, kPatterns> stencils{};
  for (std::size_t pattern = 0; pattern < kPatterns; ++pattern) {
    std::array<NodeSign, 4> signs{};
    std::size_t rest = pattern;
    for (NodeSign& sign : signs) {
      sign = static_cast<NodeSign>(static_cast<int>(rest % 3) - 1);
      rest /= 3;
    }
    stencils[pattern] = make_stencil(signs, make_lattice_rule());
  }
  return stencils;
}

constexpr std::array<CutStencil, kPatterns> kStencils = make_stencils();

}  // namespace

const CutStencil& cut_stencil(const std::array<NodeSign, 4>& signs) {
  std::size_t pattern = 0;
  for (std::size_t v = 4; v-- > 0;) pattern = 3 * pattern + static_cast<std::size_t>(static_cast<int>(signs[v]) + 1);
  return kStencils[pattern];
}

CutStencil cut_stencil(const std::array<NodeSign, 4>& signs, const DiagonalRule& rule) {
  return make_stencil(signs, rule);
}

}  // namespace softreel
